//! A guess at the point of a hull nearest to the origin, and a direction from it.
//!
//! Nothing here is believed: a direction has to prove itself in `swept`, so rounding costs speed only. Directions are
//! orthogonal to the part of the hull that the point lies on, so that they are good to the last digits also where the hull
//! nearly contains the origin.

use super::vector::{along, cross, dot, sub};
use crate::distance::Point;

/// The guess.
#[derive(Debug, Clone, Copy)]
pub(super) struct Nearest {
    /// A point of the hull, up to rounding.
    pub(super) point: Point,
    /// From the origin towards the hull.
    pub(super) direction: Point,
}

#[inline(always)]
pub(super) fn segment(p: Point, q: Point) -> Nearest {
    let x = sub(q, p);
    let (px, xx) = (dot(p, x), dot(x, x));
    let s = -px / xx;
    if s > 0.0 && s < 1.0 {
        let point = along(p, x, s);
        let direction = along(point, x, -dot(point, x) / xx);
        Nearest { point, direction }
    } else {
        let point = if s >= 1.0 { q } else { p };
        Nearest {
            point,
            direction: point,
        }
    }
}

/// By the sides of the triangle's edges on which the origin lies.
#[inline(always)]
pub(super) fn triangle(w: &[Point; 3]) -> Nearest {
    let (x, y) = (sub(w[1], w[0]), sub(w[2], w[0]));
    let normal = cross(x, y);
    let sides = [
        dot(cross(w[1], w[2]), normal),
        dot(cross(w[2], w[0]), normal),
        dot(cross(w[0], w[1]), normal),
    ];
    let sum = sides[0] + sides[1] + sides[2];
    if sides.iter().all(|&side| side > 0.0) {
        let point = along(along(w[0], x, sides[1] / sum), y, sides[2] / sum);
        return across(normal, point, w[0]);
    }
    let edges = [[1, 2], [2, 0], [0, 1]].map(|[i, j]| (w[i], w[j]));
    nearest_edge(edges, sides.map(|side| side > 0.0))
}

/// Of the corners `w`, `w + y`, `w + x`, `w + x + y`, by the coordinates `u` and `v` of the origin's projection `w + u x + v y`.
#[inline(always)]
pub(super) fn parallelogram(w: &[Point; 4]) -> Nearest {
    let (x, y) = (sub(w[2], w[0]), sub(w[1], w[0]));
    let normal = cross(x, y);
    let squared = dot(normal, normal);
    let u = dot(cross(y, w[0]), normal) / squared;
    let v = dot(cross(w[0], x), normal) / squared;
    let inside = [u > 0.0, u < 1.0, v > 0.0, v < 1.0];
    if inside == [true; 4] {
        return across(normal, along(along(w[0], x, u), y, v), w[0]);
    }
    let edges = [[0, 1], [2, 3], [0, 2], [1, 3]].map(|[i, j]| (w[i], w[j]));
    nearest_edge(edges, inside)
}

/// A point inside a face with this normal, of which `w` is a corner.
#[inline(always)]
fn across(normal: Point, point: Point, w: Point) -> Nearest {
    let direction = if dot(normal, w) < 0.0 {
        normal.map(|n| -n)
    } else {
        normal
    };
    Nearest { point, direction }
}

/// The nearest among the edges of which the origin lies outside.
#[inline(always)]
fn nearest_edge<const N: usize>(edges: [(Point, Point); N], inside: [bool; N]) -> Nearest {
    let mut best: Option<(f64, Nearest)> = None;
    for ((p, q), inside) in edges.into_iter().zip(inside) {
        if !inside {
            let nearest = segment(p, q);
            let squared = dot(nearest.point, nearest.point);
            if best.is_none_or(|(least, _)| squared < least) {
                best = Some((squared, nearest));
            }
        }
    }
    best.map_or(
        Nearest {
            point: edges[0].0,
            direction: edges[0].0,
        },
        |(_, nearest)| nearest,
    )
}
