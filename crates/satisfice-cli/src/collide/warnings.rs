//! Signs of wrong units, wrong scales and seams. They do not change the pairs, which are exact for the given numbers.

use std::collections::BTreeSet;

use satisfice_catalogue::quantity::shown;
use satisfice_collision::distance::PairKind;
use satisfice_collision::{Aabb, FeatureKind};

use super::arguments::Find;
use super::scene::World;
use super::weld;

/// A file in single precision leaves fewer than 3 digits inside a body that lies so many sizes from the origin.
const FAR: f64 = 1e4;
/// Numbers of single precision have 29 bits fewer than those of double precision.
const SINGLE: f64 = (1_u32 << 29) as f64;
/// Bodies of one scene seldom differ so much in size: a thousand is metres against millimetres.
const UNLIKE: f64 = 999.0;

/// One line each, for stderr.
pub(super) fn warnings(world: &World) -> Vec<String> {
    let mut said = Vec::new();
    let name = |body: usize| &world.bodies[body].name;
    let sizes: Vec<f64> = world.bodies.iter().map(|body| body.bounds().size()).collect();
    let (kind_a, kind_b) = world.kinds();
    for kind in if kind_a == kind_b {
        vec![kind_a]
    } else {
        vec![kind_a, kind_b]
    } {
        for body in world.without(kind) {
            said.push(format!(
                "{} has no {}: no pair has one of it there",
                name(body),
                kind.plural()
            ));
        }
    }

    if kind_a == FeatureKind::Triangle || kind_b == FeatureKind::Triangle {
        for body in &world.bodies {
            let lines = body.unplaced().lines().len();
            if lines > 0 && !body.unplaced().triangles().is_empty() {
                said.push(format!(
                    "{} has {} beside its triangles (lines, or faces of two corners): no pair of triangles has one of them",
                    body.name,
                    if lines == 1 { "1 edge".to_owned() } else { format!("{} edges", shown::count(lines as u64)) }
                ));
            }
        }
    }

    let threshold = world.request.threshold;
    let largest = sizes.iter().fold(0.0_f64, |most, &size| most.max(size));
    if largest > 0.0 && threshold > largest && threshold.is_finite() {
        said.push(format!(
            "the threshold {} is larger than every body (the largest is {} long), so that most pairs will be found: \
             is it in the unit of the meshes?",
            readable(threshold),
            readable(largest)
        ));
    }

    let extended = || (0..).zip(&sizes).filter(|(_, size)| **size > 0.0);
    let least = extended().min_by(|a, b| a.1.total_cmp(b.1));
    let most = extended().max_by(|a, b| a.1.total_cmp(b.1));
    if let (Some((small, least)), Some((large, most))) = (least, most)
        && most / least > UNLIKE
    {
        said.push(format!(
            "{} is {} times as large as {}: are both in the same unit?",
            name(large),
            readable(most / least),
            name(small)
        ));
    }

    for body in &world.bodies {
        let bounds = body.bounds();
        let reach = bounds
            .min
            .iter()
            .chain(&bounds.max)
            .fold(0.0_f64, |most, c| most.max(c.abs()));
        let step = reach - reach.next_down();
        if step > threshold {
            // Moving helps only what lies away from the origin.
            let advice = if reach > 2.0 * bounds.size() {
                "move it near the origin before it is written"
            } else {
                "is it in the unit of the meshes?"
            };
            said.push(format!(
                "{} has coordinates up to {}, where neighbouring numbers are {} apart, more than the threshold: {advice}",
                body.name,
                readable(reach),
                readable(step)
            ));
        } else if reach > FAR * bounds.size().max(threshold) {
            said.push(format!(
                "{} lies {} from the origin, {} times its size: in a file of single precision (STL, most PLY) its coordinates \
                 are steps of {}; move it near the origin before it is written",
                body.name,
                readable(reach),
                readable(reach / bounds.size().max(threshold)),
                readable(SINGLE * step)
            ));
        }
    }
    said.extend(seams(world));
    said
}

/// Surfaces can meet where no pair of the kind that was compared is near. Said of two bodies without a pair whose boxes are close
/// enough, and of every distance that is not one of surfaces.
pub(super) fn surfaces_not_compared(world: &World, touching: &BTreeSet<[usize; 2]>) -> Option<String> {
    let request = &world.request;
    let compared = match request.kind {
        PairKind::VertexVertex => "only vertices were compared",
        PairKind::VertexEdge => "only vertices and edges were compared",
        PairKind::VertexTriangle => "only vertices and triangles were compared, not edges with edges",
        PairKind::EdgeEdge => "only edges were compared, not vertices with triangles",
        // The nearest points of two surfaces are on an edge of one of them.
        PairKind::EdgeTriangle | PairKind::TriangleTriangle => return None,
    };
    let advice = "--pairs triangle-triangle compares surfaces";
    let mut boxes: Vec<_> = (0..)
        .zip(&world.bodies)
        .filter(|(_, body)| !body.unplaced().triangles().is_empty())
        .map(|(number, body)| (number, &body.name, body.bounds()))
        .collect();
    match request.find {
        Find::First if !touching.is_empty() => return None,
        Find::Closest(_) if boxes.len() > 1 => {
            return Some(format!("{compared}; surfaces may be closer than that: {advice}"));
        }
        // Solids that overlap are found by their volumes.
        Find::All | Find::First | Find::Closest(_) if request.solid => return None,
        _ => {}
    }
    boxes.sort_by(|(_, _, a), (_, _, b)| a.min[0].total_cmp(&b.min[0]));
    let (a, b) = boxes.iter().enumerate().find_map(|(index, (number, a, box_a))| {
        let is_near = |k: usize, b: &Aabb| {
            b.min[k] - box_a.max[k] < request.threshold && box_a.min[k] - b.max[k] < request.threshold
        };
        boxes[index + 1..]
            .iter()
            .take_while(|(_, _, box_b)| is_near(0, box_b))
            .find(|(other, _, box_b)| {
                let pair = [*number.min(other), *number.max(other)];
                is_near(1, box_b) && is_near(2, box_b) && !touching.contains(&pair)
            })
            .map(|(other, b, _)| if number < other { (*a, *b) } else { (*b, *a) })
    })?;
    Some(format!(
        "{compared}; the surfaces of {a} and {b} may be closer than the threshold all the same, as their boxes are: {advice}"
    ))
}

/// Seams make pairs of a body with itself: the vertices on both sides are not neighbours on the mesh.
fn seams(world: &World) -> Vec<String> {
    if !world.request.within || world.request.inputs.weld.is_some() {
        return Vec::new();
    }
    let said = world.bodies.iter().filter_map(|body| {
        let mesh = body.placed().ok()?;
        let (count, distance) = weld::seams(&mesh).ok()?;
        (count > 0).then(|| {
            format!(
                "{} has {} others, as at seams: the features on both sides make pairs; --weld {} joins them",
                body.name,
                match count {
                    1 => "1 vertex that lies on".to_owned(),
                    many => format!("{} vertices that lie on", readable(many as f64)),
                },
                readable(distance)
            )
        })
    });
    said.collect()
}

/// Three digits, thousands apart, and powers of ten where they are shorter.
fn readable(x: f64) -> String {
    let rounded: f64 = format!("{x:.2e}").parse().unwrap_or(x);
    match rounded.abs() {
        0.0 => "0".to_owned(),
        f64::INFINITY => "more than 1e308".to_owned(),
        v if (1e-3..1e3).contains(&v) => format!("{rounded}"),
        v if (1e3..1e7).contains(&v) => shown::count(v as u64),
        _ => format!("{rounded:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_readable() {
        for (x, text) in [
            (0.0, "0"),
            (1.999_999_9, "2"),
            (2.5, "2.5"),
            (5000.0, "5,000"),
            (1e6, "1,000,000"),
            (1.000_01e13, "1e13"),
            (2.22e-4, "2.22e-4"),
            (540.0, "540"),
            (1e300 / 1e-300, "more than 1e308"),
        ] {
            assert_eq!(readable(x), text);
        }
    }
}
