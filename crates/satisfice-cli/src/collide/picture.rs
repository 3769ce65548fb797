//! The picture of a scene: bodies, triangles of pairs highlighted, closest points marked.

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::bail;
use satisfice_collision::FeatureKind;
use satisfice_collision::broad::Method;
use satisfice_collision::scene::Contact;
use satisfice_picture::{Picture, Up, View};

use super::arguments::Axis;
use super::scene::{Feature, Pair, World};

const WIDTH: u32 = 1400;
const HEIGHT: u32 = 1000;
/// More marks than this cover each other; evenly chosen ones are drawn then.
const MARKS: usize = 20_000;

/// Refuses what is no picture, before the work begins.
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

/// Which axis points upwards where nobody says so: y in OBJ and PLY, as most viewers take it, z in STL, as printers do.
fn usual_up(mesh: &Path) -> Axis {
    let is_stl = mesh
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("stl"));
    if is_stl { Axis::Z } else { Axis::Y }
}

/// The scene with the pairs that were found, and, where they are known, those that were not.
pub(super) fn draw(
    world: &World,
    up: Option<Axis>,
    found: &[Contact],
    missed: &[Contact],
) -> anyhow::Result<Vec<u8>> {
    let first = world.request.paths.first();
    let up = up.or(first.map(|path| usual_up(path))).unwrap_or(Axis::Z);
    let view = View {
        up: match up {
            Axis::X => Up::X,
            Axis::Y => Up::Y,
            Axis::Z => Up::Z,
        },
        ..View::default()
    };
    let mut picture = Picture::new(WIDTH, HEIGHT, view);
    world.bodies.iter().for_each(|mesh| picture.body(mesh));
    let (kind_a, kind_b) = world.kinds();
    for Pair { a, b } in world.pairs(found) {
        for (kind, Feature { body, feature }) in [(kind_a, a), (kind_b, b)] {
            if kind == FeatureKind::Triangle {
                picture.highlight(body, feature);
            }
        }
    }
    let scene = world.scene(Method::Auto)?;
    for (contacts, was_found) in [(found, true), (missed, false)] {
        for contact in contacts.iter().step_by(contacts.len().div_ceil(MARKS).max(1)) {
            let nearest = scene.proximity(*contact)?;
            picture.pair(nearest.point_a, nearest.point_b, was_found);
        }
    }
    Ok(picture.png()?)
}

/// What `all` has and `found` has not.
pub(super) fn missed(all: &[Contact], found: &[Contact]) -> Vec<Contact> {
    let found: BTreeSet<_> = found.iter().collect();
    all.iter()
        .filter(|contact| !found.contains(contact))
        .copied()
        .collect()
}
