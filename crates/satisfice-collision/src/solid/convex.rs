//! Whether a closed connected surface is convex but for rounding: a block that was turned is no exact block any more.
//!
//! A closed connected surface that is convex around each of its points is convex (van Heijenoort 1952, doi:10.4153/CJM-1952-021-3). It is so
//! around a vertex if every triangle there has all neighbours of its corners on one side.

use super::hull::{cross, dot, sub};
use super::unit::Unit;
use crate::Mesh;
use crate::distance::Point;

/// A point this near a plane counts as in it, in parts of the size.
const FLAT: f64 = 1e-13;
/// A triangle whose height is this part of its length says nothing about its plane.
const SLIVER: f64 = 1e-6;

/// Of a mesh with one connected part.
pub(super) fn is_convex(mesh: &Mesh) -> bool {
    let Some((unit, triangles)) = Unit::of(mesh.vertices().iter().copied()).zip(oriented(mesh.triangles()))
    else {
        return false;
    };
    let points: Vec<Point> = mesh.vertices().iter().map(|&p| unit.place(p)).collect();
    let adjacency = mesh.adjacency();
    let mut side = 0.0;
    for corners in &triangles {
        let [a, b, c] = corners.map(|v| points[v as usize]);
        let normal = cross(sub(b, a), sub(c, a));
        let double = dot(normal, normal).sqrt();
        let longest = [sub(b, a), sub(c, b), sub(a, c)].map(|side| dot(side, side));
        if double <= SLIVER * longest.into_iter().fold(0.0, f64::max) {
            return false;
        }
        for &v in corners.iter().flat_map(|&corner| adjacency.neighbours(corner)) {
            let height = dot(normal, sub(points[v as usize], a)) / double;
            if height.abs() <= FLAT {
                continue;
            }
            if height * side < 0.0 {
                return false;
            }
            side = height.signum();
        }
    }
    side != 0.0
}

/// The triangles turned so that the two at each edge run along it in opposite directions; `None` if there are not two at each edge, if
/// edges do not join all of them, or if the surface has one side only.
fn oriented(triangles: &[[u32; 3]]) -> Option<Vec<[u32; 3]>> {
    let sides_of = |[a, b, c]: [u32; 3]| [[a, b], [b, c], [c, a]];
    let both_ways = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
    let mut sides: Vec<([u32; 2], usize)> = triangles
        .iter()
        .enumerate()
        .flat_map(|(index, &triangle)| sides_of(triangle).map(|side| (both_ways(side), index)))
        .collect();
    sides.sort_unstable();
    let are_two = |same: &[([u32; 2], usize)]| same.len() == 2 && same[0].0[0] != same[0].0[1];
    if !sides.chunk_by(|one, two| one.0 == two.0).all(are_two) {
        return None;
    }
    let mut turned: Vec<Option<[u32; 3]>> = vec![None; triangles.len()];
    *turned.first_mut()? = Some(triangles[0]);
    let mut left = vec![0];
    while let Some(index) = left.pop() {
        for side in sides_of(turned[index]?) {
            let first = sides.partition_point(|(other, _)| *other < both_ways(side));
            let [(_, one), (_, two)] = [sides[first], sides[first + 1]];
            let other = if one == index { two } else { one };
            let runs_along = |triangle: [u32; 3]| sides_of(triangle).contains(&side);
            match turned[other] {
                Some(there) if runs_along(there) => return None,
                Some(_) => {}
                None => {
                    let [a, b, c] = triangles[other];
                    let is_against = !runs_along([a, b, c]);
                    turned[other] = Some(if is_against { [a, b, c] } else { [a, c, b] });
                    left.push(other);
                }
            }
        }
    }
    turned.into_iter().collect()
}
