//! Bodies that overlap as solids: they are looked at again, and the way out that the report names has to lead out.

use std::collections::BTreeMap;

use satisfice::StopReason;
use satisfice_collision::distance::Point;
use satisfice_collision::{Aabb, Mesh};

use super::ROUNDING;
use super::checks::Checks;
use crate::collide::overlaps::{self, Overlap};
use crate::collide::report::Head;
use crate::collide::scene::World;

pub(super) fn check(
    head: &Head,
    listed: &[Overlap],
    world: &World,
    checks: &mut Checks,
) -> anyhow::Result<()> {
    let (found, _) = overlaps::find(world.solids()?, &|| false);
    let was_stopped = matches!(head.stop_reason, StopReason::Time | StopReason::Cancelled);
    if !was_stopped {
        let all: Vec<String> = found.iter().map(|overlap| overlap.text(&world.bodies)).collect();
        let expected = format!("{} of them: {}", all.len(), all.join("; "));
        checks.that(listed.len() == all.len(), "overlaps", listed.len(), expected);
    }
    let mut found: BTreeMap<[usize; 2], Overlap> = found
        .into_iter()
        .map(|overlap| ([overlap.a, overlap.b], overlap))
        .collect();
    for (index, given) in listed.iter().enumerate() {
        let place = format!("overlaps[{index}]");
        let Some(is) = found.remove(&[given.a, given.b]) else {
            checks.that(false, place, given, "bodies that overlap, listed once");
            continue;
        };
        // A search that was stopped has wider bounds.
        let is_same = given.agrees(&is) && (was_stopped || has_same_depth(given, &is));
        checks.that(is_same, &place, given, is.text(&world.bodies));
        // A place beyond all numbers was refused when the scene was read.
        let [Ok(a), Ok(b)] = [given.a, given.b].map(|body| world.bodies[body].placed()) else {
            continue;
        };
        let expected = "a direction of length 1 along which depth_at_most separates the bodies";
        checks.that(
            leads_out(given, &a, &b),
            format!("{place}.direction"),
            given.direction,
            expected,
        );
    }
    Ok(())
}

fn has_same_depth(given: &Overlap, is: &Overlap) -> bool {
    let slack = ROUNDING * is.depth_at_most.unwrap_or(is.depth_at_least);
    let same = |one: f64, two: f64| (one - two).abs() <= slack;
    same(given.depth_at_least, is.depth_at_least)
        && match (given.depth_at_most, is.depth_at_most) {
            (Some(given), Some(is)) => same(given, is),
            (given, is) => given == is,
        }
}

/// Whether the first body, moved along the direction by the upper bound of the depth, lies just beside the second one.
fn leads_out(given: &Overlap, a: &Mesh, b: &Mesh) -> bool {
    let n = given.direction;
    if (dot(n, n) - 1.0).abs() > ROUNDING {
        return false;
    }
    let Some(depth) = given.depth_at_most else {
        return true;
    };
    let corners = |mesh: &Mesh| -> Vec<Point> {
        let corners = mesh.triangles().iter().flatten();
        corners.map(|&v| mesh.vertex(v)).collect()
    };
    let (a, b) = (corners(a), corners(b));
    let Some(around) = Aabb::of_points(a.iter().chain(&b).copied()) else {
        return false;
    };
    let slack = ROUNDING * around.size();
    let height = |p: &Point| dot(n, std::array::from_fn(|k| p[k] - around.min[k]));
    let lowest = a.iter().map(height).fold(f64::INFINITY, f64::min);
    let highest = b.iter().map(height).fold(f64::NEG_INFINITY, f64::max);
    let needed = highest - lowest;
    // Differences of the largest numbers are infinite and tell nothing.
    !needed.is_finite() || (needed <= depth + slack && (depth == 0.0 || needed >= depth - slack))
}

fn dot(a: Point, b: Point) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
