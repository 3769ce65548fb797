//! Triangle against triangle, 0 if they meet.

use super::frame::{Limits, PairFrame, Verdict};
use super::gjk;
use super::resolve::{self, Hulls};
use super::{Decision, FeaturePair, PairKind, Proximity, Threshold, Triangle, measure};

/// Two triangles.
#[derive(Debug, Clone, Copy)]
pub struct TriangleTriangle;

impl Hulls<3, 3> for TriangleTriangle {
    #[inline(always)]
    fn filter(frame: &PairFrame<3, 3>, limits: &Limits) -> Verdict {
        gjk::filter(frame, limits)
    }
}

/// Whether the distance is below delta, and the stage that proved it. For many pairs
/// [`TriangleBatch`](super::TriangleBatch) is faster.
#[inline]
pub fn decide(a: &Triangle, b: &Triangle, threshold: Threshold) -> Decision {
    resolve::decide::<TriangleTriangle, 3, 3>(a, b, threshold)
}

/// Whether the distance is below delta.
#[inline]
pub fn within(a: &Triangle, b: &Triangle, threshold: Threshold) -> bool {
    decide(a, b, threshold).within
}

/// Distance and closest points.
pub fn proximity(a: &Triangle, b: &Triangle) -> Proximity {
    resolve::proximity::<3, 3>(a, b)
}

impl FeaturePair for TriangleTriangle {
    type A = Triangle;
    type B = Triangle;
    const KIND: PairKind = PairKind::TriangleTriangle;

    #[inline]
    fn decide(a: &Triangle, b: &Triangle, threshold: Threshold) -> Decision {
        decide(a, b, threshold)
    }

    fn proximity(a: &Triangle, b: &Triangle) -> Proximity {
        proximity(a, b)
    }

    fn measure(a: &Triangle, b: &Triangle) -> f64 {
        measure::hulls(a, b)
    }
}
