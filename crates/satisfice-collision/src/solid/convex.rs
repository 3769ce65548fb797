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
    let Some(unit) = Unit::of(mesh.vertices().iter().copied()).filter(|_| is_oriented(mesh)) else {
        return false;
    };
    let points: Vec<Point> = mesh.vertices().iter().map(|&p| unit.place(p)).collect();
    let adjacency = mesh.adjacency();
    let mut side = 0.0;
    for corners in mesh.triangles() {
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

/// Whether each edge belongs to two triangles that run along it in opposite directions.
fn is_oriented(mesh: &Mesh) -> bool {
    let sides = mesh
        .triangles()
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut sides: Vec<[u32; 2]> = sides.collect();
    sides.sort_unstable();
    let is_once = sides.windows(2).all(|two| two[0] != two[1]);
    is_once
        && sides
            .iter()
            .all(|&[a, b]| a != b && sides.binary_search(&[b, a]).is_ok())
}
