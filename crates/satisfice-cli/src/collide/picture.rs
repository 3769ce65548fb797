//! The picture of a scene: bodies, triangles of pairs highlighted, closest points marked.

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::bail;
use satisfice_bench::picture::{Picture, View};
use satisfice_collision::broad::{FeatureKind, Method};
use satisfice_collision::scene::Contact;

use super::scene::World;

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

/// The scene with the pairs that were found, and, where they are known, those that were not.
pub(super) fn draw(world: &World, found: &[Contact], missed: &[Contact]) -> anyhow::Result<Vec<u8>> {
    let mut picture = Picture::new(WIDTH, HEIGHT, View::default());
    world.bodies.iter().for_each(|mesh| picture.body(mesh));
    let (kind_a, kind_b) = world.kinds();
    for contact in found {
        for (kind, body, feature) in [
            (kind_a, contact.body_a, contact.a),
            (kind_b, contact.body_b, contact.b),
        ] {
            if kind == FeatureKind::Triangle {
                picture.highlight(body, feature);
            }
        }
    }
    let scene = world.scene(Method::Auto);
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
