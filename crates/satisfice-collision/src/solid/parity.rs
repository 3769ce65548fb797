//! Whether a point lies inside a closed surface: how often the way up from it crosses the surface, decided exactly.
//!
//! The point counts as moved by nothing at all, so little along y and still less along x that the way up meets no edge: an edge is passed if
//! its ends lie on both sides of the point along y, one that lies level with it counting as below, and if the point is to the left
//! of it. Both triangles of an edge see the same, so that no crossing is missed or counted twice.

use crate::Aabb;
use crate::Placement;
use crate::broad::{FeatureTree, near_segment};
use crate::distance::orientation::{side_of_line, side_of_plane};
use crate::distance::{Point, Triangle};

pub(super) fn is_inside(tree: &FeatureTree, bounds: &Aabb, point: Point) -> bool {
    let is_in_box = (0..3).all(|k| bounds.min[k] <= point[k] && point[k] <= bounds.max[k]);
    if !is_in_box {
        return false;
    }
    let up = [point, [point[0], point[1], bounds.max[2]]];
    let mut is_inside = false;
    near_segment((tree, &Placement::IDENTITY), &up, |triangle| {
        is_inside ^= is_below(point, &tree.triangle(triangle));
    });
    is_inside
}

/// Whether the way up from a point crosses a triangle.
fn is_below(point: Point, &[a, b, c]: &Triangle) -> bool {
    let crossed = [[a, b], [b, c], [c, a]]
        .iter()
        .filter(|edge| is_left(point, edge))
        .count();
    if crossed % 2 == 0 {
        return false;
    }
    // not 0: a triangle without area from above is not crossed
    let turned = side_of_line(a, b, c, 0);
    turned * side_of_plane([a, b, c], point) > 0
}

/// Whether the way from a point along x crosses an edge, as seen from above.
fn is_left(point: Point, &[a, b]: &[Point; 2]) -> bool {
    let is_above = |p: Point| p[1] > point[1];
    if is_above(a) == is_above(b) {
        return false;
    }
    let (low, high) = if is_above(b) { (a, b) } else { (b, a) };
    side_of_line(low, high, point, 0) > 0
}
