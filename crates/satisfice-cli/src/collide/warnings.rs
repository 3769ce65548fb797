//! What looks like a slip of units or of scale; the pairs are exact for the numbers as they are all the same.

use satisfice_collision::Mesh;

use super::scene::World;

/// A file in single precision leaves fewer than 3 digits inside a body that lies so many sizes from the origin.
const FAR: f64 = 1e4;
/// Bodies of one scene seldom differ so much in size: a thousand is metres against millimetres.
const UNLIKE: f64 = 999.0;

/// One line each, for stderr.
pub(super) fn warnings(world: &World) -> Vec<String> {
    let mut said = Vec::new();
    let name = |body: usize| world.request.paths[body].display();
    let bodies = || world.bodies.iter().enumerate();
    let sizes: Vec<f64> = world.bodies.iter().map(Mesh::size).collect();
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

    let threshold = world.request.threshold;
    let largest = sizes.iter().fold(0.0_f64, |most, &size| most.max(size));
    if largest > 0.0 && threshold > largest {
        said.push(format!(
            "the threshold {threshold} is larger than every body (the largest is {largest} long), so that most pairs will be found: \
             is it in the unit of the meshes?"
        ));
    }

    let extended = || (0..).zip(&sizes).filter(|(_, size)| **size > 0.0);
    let least = extended().min_by(|a, b| a.1.total_cmp(b.1));
    let most = extended().max_by(|a, b| a.1.total_cmp(b.1));
    if let (Some((small, least)), Some((large, most))) = (least, most)
        && most / least > UNLIKE
    {
        said.push(format!(
            "{} is {:.0} times as large as {}: are both in the same unit?",
            name(large),
            most / least,
            name(small)
        ));
    }

    for (body, mesh) in bodies() {
        let bounds = mesh.bounds();
        let reach = bounds
            .min
            .iter()
            .chain(&bounds.max)
            .fold(0.0_f64, |most, c| most.max(c.abs()));
        let step = f64::EPSILON * reach;
        if step > threshold {
            said.push(format!(
                "{} has coordinates up to {reach:.3e}, where neighbouring numbers are {step:.1e} apart, more than the threshold: \
                 move it near the origin before it is written",
                name(body)
            ));
        } else if reach > FAR * mesh.size().max(threshold) {
            said.push(format!(
                "{} lies {reach:.3e} from the origin, {:.0e} times its size: in a file of single precision (STL, most PLY) its \
                 coordinates are steps of {:.1e}; move it near the origin before it is written",
                name(body),
                reach / mesh.size().max(threshold),
                f64::from(f32::EPSILON) * reach
            ));
        }
    }
    said
}
