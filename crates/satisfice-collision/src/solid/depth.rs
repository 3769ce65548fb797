//! How deep two solids overlap: the length of the shortest translation of one after which no point of one lies inside the other.
//!
//! For convex solids that is the distance from the origin to the surface of their Minkowski difference, all a - b: the least over all
//! directions n of h(n) = max n.a - min n.b. A polytope within the difference is expanded where its surface is closest to
//! the origin (van den Bergen 2001, Proximity queries and penetration depth computation on 3D game objects): its distance is a lower bound,
//! each h(n) an upper one, and they meet at a facet of the difference.
//!
//! For others the upper bound is that of their convex hulls. A lower bound is the distance of any vertex inside the other solid from that
//! one's surface: it has to leave.

use super::hull::{ConvexHull, cross, dot, sub};
use super::unit::Unit;
use super::{Solid, distance};
use crate::broad::FeatureTree;
use crate::distance::Point;
use crate::{FeatureKind, Mesh};

/// Bounds of a depth, in the unit of the meshes, and a translation that attains the upper one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Depth {
    /// No shorter translation separates the solids.
    pub at_least: f64,
    /// A translation of this length separates them. For convex solids within 1e-12 of their size of the lower bound, unless the search was
    /// ended.
    pub at_most: f64,
    /// Where the first solid has to be moved, of length 1.
    pub direction: Point,
}

/// The bounds agree if they differ by no more than this part of the sizes.
const AGREEMENT: f64 = 1e-12;
/// What rounding can do, as a part of the sizes; also to bodies that are convex but for it.
const ROUNDING: f64 = 1e-12;
/// Facets of round bodies need about as many points as these have vertices; beyond, the bounds are left as they are.
const MOST_POINTS: usize = 4000;
/// Vertices of which each gives a lower bound.
const VERTICES: usize = 1000;

pub(super) fn depth(first: &Solid, second: &Solid, stop: &(dyn Fn() -> bool + Sync)) -> Depth {
    let (a, b): (Vec<Point>, Vec<Point>) = (first.corners().collect(), second.corners().collect());
    let of_hulls = of_hulls(&a, &b, stop);
    let at_least = if first.is_convex && second.is_convex {
        of_hulls.at_least
    } else {
        let deepest = |points: &[Point], other: &Solid| {
            let step = points.len().div_ceil(VERTICES).max(1);
            let some = points.iter().step_by(step).take_while(|_| !stop());
            some.filter(|point| other.contains(**point))
                .map(|&point| distance_to(other, point))
                .fold(0.0, f64::max)
        };
        deepest(&a, second).max(deepest(&b, first)).min(of_hulls.at_most)
    };
    Depth { at_least, ..of_hulls }
}

/// From a point to the surface, rounded down.
fn distance_to(solid: &Solid, point: Point) -> f64 {
    Mesh::new(vec![point], Vec::new(), Vec::new()).map_or(0.0, |probe| {
        distance(&FeatureTree::new(&probe, FeatureKind::Vertex), &solid.tree).next_down()
    })
}

/// Of the convex hulls of two sets of points.
fn of_hulls(a: &[Point], b: &[Point], stop: &(dyn Fn() -> bool + Sync)) -> Depth {
    let Some(unit) = Unit::of(a.iter().chain(b).copied()) else {
        return Depth {
            at_least: 0.0,
            at_most: f64::INFINITY,
            direction: [0.0, 0.0, 1.0],
        };
    };
    let local = |points: &[Point]| -> Vec<Point> { points.iter().map(|&p| unit.place(p)).collect() };
    let difference = Difference {
        a: local(a),
        b: local(b),
    };
    let found = difference.depth(stop);
    Depth {
        at_least: unit.back(found.at_least),
        at_most: unit.back(found.at_most),
        direction: found.direction,
    }
}

/// The Minkowski difference of two sets of points.
struct Difference {
    a: Vec<Point>,
    b: Vec<Point>,
}

impl Difference {
    /// The point furthest along a direction.
    fn support(&self, n: Point) -> Point {
        let furthest = |points: &[Point], sign: f64| {
            let first = (f64::NEG_INFINITY, [0.0; 3]);
            let pick = |best: (f64, Point), &p: &Point| {
                let height = sign * dot(n, p);
                if height > best.0 { (height, p) } else { best }
            };
            points.iter().fold(first, pick).1
        };
        sub(furthest(&self.a, 1.0), furthest(&self.b, -1.0))
    }

    fn depth(&self, stop: &(dyn Fn() -> bool + Sync)) -> Depth {
        let mut depth = Depth {
            at_least: 0.0,
            at_most: f64::INFINITY,
            direction: [0.0, 0.0, 1.0],
        };
        let (corners, flat) = self.simplex();
        let Some(mut hull) = corners.and_then(ConvexHull::new) else {
            // all in a plane: no point of one is inside the other
            return Depth {
                at_most: 0.0,
                direction: flat,
                ..depth
            };
        };
        for _ in 0..MOST_POINTS {
            let Some(facet) = hull.closest() else { break };
            let point = self.support(facet.normal);
            let height = dot(facet.normal, point);
            if height < depth.at_most {
                depth.at_most = height;
                depth.direction = facet.normal.map(|c| -c);
            }
            depth.at_least = facet.offset;
            let is_settled = height - facet.offset <= AGREEMENT || height <= 0.0;
            if is_settled || stop() || !hull.insert(point) {
                break;
            }
        }
        // Rounding outwards; a height may be below the offset by it.
        Depth {
            at_least: (depth.at_least.min(depth.at_most) - ROUNDING).max(0.0),
            at_most: if depth.at_most <= 0.0 {
                0.0
            } else {
                depth.at_most + ROUNDING
            },
            direction: depth.direction,
        }
    }

    /// Four corners of the difference that do not lie in a plane; if there are none, a direction along which it has no extent.
    fn simplex(&self) -> (Option<[Point; 4]>, Point) {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let both = |n: Point| [self.support(n), self.support(n.map(|c| -c))];
        let length = |p: Point| dot(p, p);
        let widest = axes.map(both).into_iter();
        let widest = widest.max_by(|[p, q], [r, s]| length(sub(*p, *q)).total_cmp(&length(sub(*r, *s))));
        let Some([p, q]) = widest else {
            return (None, axes[2]);
        };
        let along = sub(q, p);
        let across = |from: Point| cross(along, sub(from, p));
        let sideways = axes.map(|axis| cross(along, axis));
        let candidates = sideways.into_iter().flat_map(both);
        let third = candidates.max_by(|r, s| length(across(*r)).total_cmp(&length(across(*s))));
        let Some(r) = third else {
            return (None, axes[2]);
        };
        let normal = across(r);
        if length(normal) == 0.0 {
            return (None, axes[2]);
        }
        let height = |s: &Point| dot(normal, sub(*s, p)).abs();
        let fourth = both(normal)
            .into_iter()
            .max_by(|s, t| height(s).total_cmp(&height(t)));
        let unit = normal.map(|c| c / length(normal).sqrt());
        (fourth.map(|s| [p, q, r, s]), unit)
    }
}
