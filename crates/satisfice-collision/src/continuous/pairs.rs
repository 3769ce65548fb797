//! The kinds of moving pairs.

use super::advance::{Goal, free_until};
use super::hull::{ParallelogramHull, PointHull, SegmentHull, TriangleHull};
use super::motion::{Moving, PairMotion};
use super::resolve::{Solved, solve};
use super::swept::Swept;
use crate::distance::{
    PairKind, Point, Proximity, Segment, Triangle, edge_edge, vertex_edge, vertex_triangle, vertex_vertex,
};

mod sealed {
    /// The solver of a kind, which is no part of the public interface.
    pub trait Solve<B>: Sized {
        fn solve(
            a: &super::Moving<Self>,
            b: &super::Moving<B>,
            delta: f64,
            goal: super::Goal<'_>,
        ) -> super::Solved;

        fn free_until(a: &super::Moving<Self>, b: &super::Moving<B>, delta: f64, from: f64) -> f64;
    }
}

pub(super) use sealed::Solve;

/// Features that can be asked about in motion: `A: Against<B>`.
///
/// Implemented for a point against a point, a segment or a triangle, and for a segment against a segment.
pub trait Against<B: Copy>: Copy + Solve<B> {
    /// The kind of the pair.
    const KIND: PairKind;

    /// Distance and closest points of the pair at rest.
    fn proximity(&self, other: &B) -> Proximity;

    /// The feature at a time between 0 and 1, rounded.
    fn between(motion: &Moving<Self>, time: f64) -> Self;

    /// The other feature at a time between 0 and 1, rounded.
    fn other_between(motion: &Moving<B>, time: f64) -> B;
}

/// A point on its way, rounded, and exact at both ends.
fn lerp(from: Point, to: Point, time: f64) -> Point {
    if time == 1.0 {
        return to;
    }
    // Halves, so that a difference of two huge coordinates stays finite.
    std::array::from_fn(|k| from[k] + 2.0 * (time * (0.5 * to[k] - 0.5 * from[k])))
}

fn lerp_all<const N: usize>(from: [Point; N], to: [Point; N], time: f64) -> [Point; N] {
    std::array::from_fn(|k| lerp(from[k], to[k], time))
}

macro_rules! against {
    ($a:ty, $b:ty, $kind:ident, $hull:ident, $corners:literal, $module:ident, $vertices_a:expr, $vertices_b:expr, $at_a:expr, $at_b:expr) => {
        impl Solve<$b> for $a {
            #[inline]
            fn solve(a: &Moving<$a>, b: &Moving<$b>, delta: f64, goal: Goal<'_>) -> Solved {
                let motion = PairMotion {
                    from_a: $vertices_a(a.from),
                    to_a: $vertices_a(a.to),
                    from_b: $vertices_b(b.from),
                    to_b: $vertices_b(b.to),
                };
                solve::<$hull, $corners, _, _>(&motion, delta, goal)
            }

            #[inline]
            fn free_until(a: &Moving<$a>, b: &Moving<$b>, delta: f64, from: f64) -> f64 {
                let motion = PairMotion {
                    from_a: $vertices_a(a.from),
                    to_a: $vertices_a(a.to),
                    from_b: $vertices_b(b.from),
                    to_b: $vertices_b(b.to),
                };
                Swept::<$corners>::new(&motion, delta)
                    .map_or(from, |swept| free_until::<$hull, $corners>(&swept, from))
            }
        }

        impl Against<$b> for $a {
            const KIND: PairKind = PairKind::$kind;

            fn proximity(&self, other: &$b) -> Proximity {
                $module::proximity(self, other)
            }

            fn between(motion: &Moving<$a>, time: f64) -> $a {
                $at_a(motion.from, motion.to, time)
            }

            fn other_between(motion: &Moving<$b>, time: f64) -> $b {
                $at_b(motion.from, motion.to, time)
            }
        }
    };
}

/// A point as its one vertex.
fn one(point: Point) -> [Point; 1] {
    [point]
}

/// A feature that is an array of its vertices already.
fn all<const N: usize>(vertices: [Point; N]) -> [Point; N] {
    vertices
}

against!(
    Point,
    Point,
    VertexVertex,
    PointHull,
    1,
    vertex_vertex,
    one,
    one,
    lerp,
    lerp
);
against!(
    Point,
    Segment,
    VertexEdge,
    SegmentHull,
    2,
    vertex_edge,
    one,
    all,
    lerp,
    lerp_all
);
against!(
    Point,
    Triangle,
    VertexTriangle,
    TriangleHull,
    3,
    vertex_triangle,
    one,
    all,
    lerp,
    lerp_all
);
against!(
    Segment,
    Segment,
    EdgeEdge,
    ParallelogramHull,
    4,
    edge_edge,
    all,
    all,
    lerp_all,
    lerp_all
);
