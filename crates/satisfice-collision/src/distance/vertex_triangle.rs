//! Vertex against triangle.

use super::frame::{Limits, PairFrame, Verdict};
use super::resolve::{self, Hulls};
use super::{Decision, FeaturePair, PairKind, Point, Proximity, Threshold, Triangle, closest, measure};

/// A point and a triangle.
#[derive(Debug, Clone, Copy)]
pub struct VertexTriangle;

impl Hulls<1, 3> for VertexTriangle {
    #[inline(always)]
    fn filter(frame: &PairFrame<1, 3>, limits: &Limits) -> Verdict {
        frame.judge(
            frame.difference(&[1.0], &closest::on_triangle(frame.a[0], &frame.b)),
            limits,
        )
    }
}

/// Whether the distance is below delta, and the stage that proved it.
#[inline]
pub fn decide(a: &Point, b: &Triangle, threshold: Threshold) -> Decision {
    resolve::decide::<VertexTriangle, 1, 3>(&[*a], b, threshold)
}

/// Whether the distance is below delta.
#[inline]
pub fn within(a: &Point, b: &Triangle, threshold: Threshold) -> bool {
    decide(a, b, threshold).within
}

/// Distance and closest points.
pub fn proximity(a: &Point, b: &Triangle) -> Proximity {
    resolve::proximity::<1, 3>(&[*a], b)
}

impl FeaturePair for VertexTriangle {
    type A = Point;
    type B = Triangle;
    const KIND: PairKind = PairKind::VertexTriangle;

    #[inline]
    fn decide(a: &Point, b: &Triangle, threshold: Threshold) -> Decision {
        decide(a, b, threshold)
    }

    fn proximity(a: &Point, b: &Triangle) -> Proximity {
        proximity(a, b)
    }

    fn measure(a: &Point, b: &Triangle) -> f64 {
        measure::hulls(&[*a], b)
    }
}
