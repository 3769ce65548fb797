//! The picture of a scene: bodies, triangles of pairs highlighted, closest points marked.

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::bail;
use satisfice_collision::FeatureKind;
use satisfice_picture::{Picture, Up, View};

use super::arguments::Axis;
use super::body::NamedBody;
use super::scene::{Feature, Pair, World};

const WIDTH: u32 = 1400;
const HEIGHT: u32 = 1000;
/// More marks than this cover each other; evenly chosen ones are drawn then.
const MARKS: usize = 20_000;

/// Refuses a file that is not a picture, before the work begins.
pub(super) fn check(path: Option<&Path>) -> anyhow::Result<()> {
    if let Some(path) = path
        && path != Path::new("-")
        && !path
            .extension()
            .is_some_and(|ending| ending.eq_ignore_ascii_case("png"))
    {
        bail!("cannot draw {}: a picture is a .png file", path.display());
    }
    Ok(())
}

/// The axis that points upwards by default: y in most formats, as viewers take them, z in STL, as printers do.
fn usual_up(mesh: &Path) -> Axis {
    let is_stl = mesh
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("stl"));
    if is_stl { Axis::Z } else { Axis::Y }
}

/// The axis that points upwards in what is drawn of a scene.
pub(super) fn up_of(bodies: &[NamedBody], asked: Option<Axis>) -> Axis {
    let first = bodies.first();
    asked
        .or(first.map(|body| usual_up(&body.file)))
        .unwrap_or(Axis::Z)
}

/// The scene with the pairs that were found and, if they are known, those that were missed.
pub(super) fn draw(
    world: &World,
    up: Option<Axis>,
    found: &[Pair],
    missed: &[Pair],
) -> anyhow::Result<Vec<u8>> {
    let up = up_of(&world.bodies, up);
    let view = View {
        up: match up {
            Axis::X => Up::X,
            Axis::Y => Up::Y,
            Axis::Z => Up::Z,
        },
        ..View::default()
    };
    let placed = world.bodies.iter().map(NamedBody::placed);
    let placed = placed.collect::<Result<Vec<_>, _>>()?;
    let mut picture = Picture::new(WIDTH, HEIGHT, view);
    placed.iter().for_each(|mesh| picture.body(mesh));
    let (kind_a, kind_b) = world.kinds();
    for Pair { a, b } in found {
        for (kind, &Feature { body, feature }) in [(kind_a, a), (kind_b, b)] {
            if kind == FeatureKind::Triangle {
                picture.highlight(body as usize, feature);
            }
        }
    }
    let measure = world.measure()?;
    for (pairs, was_found) in [(found, true), (missed, false)] {
        for pair in pairs.iter().step_by(pairs.len().div_ceil(MARKS).max(1)) {
            let nearest = measure.proximity(pair)?;
            picture.pair(nearest.point_a, nearest.point_b, was_found);
        }
    }
    Ok(picture.png()?)
}

/// The pairs of `all` that are not in `found`.
pub(super) fn missed(all: &[Pair], found: &[Pair]) -> Vec<Pair> {
    let found: BTreeSet<_> = found.iter().collect();
    all.iter().filter(|pair| !found.contains(pair)).copied().collect()
}
