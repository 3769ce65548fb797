//! Edge against triangle: a segment and a triangle, 0 if the segment meets the triangle.

use super::frame::{Limits, PairFrame, Verdict};
use super::gjk;
use super::resolve::{self, Hulls};
use super::{Decision, FeaturePair, PairKind, Proximity, Segment, Threshold, Triangle, measure};

/// A segment and a triangle.
#[derive(Debug, Clone, Copy)]
pub struct EdgeTriangle;

impl Hulls<2, 3> for EdgeTriangle {
    #[inline(always)]
    fn filter(frame: &PairFrame<2, 3>, limits: &Limits) -> Verdict {
        gjk::filter(frame, limits)
    }
}

/// Whether the distance is below delta, and the stage that proved it.
#[inline]
pub fn decide(a: &Segment, b: &Triangle, threshold: Threshold) -> Decision {
    resolve::decide::<EdgeTriangle, 2, 3>(a, b, threshold)
}

/// Whether the distance is below delta.
#[inline]
pub fn within(a: &Segment, b: &Triangle, threshold: Threshold) -> bool {
    decide(a, b, threshold).within
}

/// Distance and closest points.
pub fn proximity(a: &Segment, b: &Triangle) -> Proximity {
    resolve::proximity::<2, 3>(a, b)
}

impl FeaturePair for EdgeTriangle {
    type A = Segment;
    type B = Triangle;
    const KIND: PairKind = PairKind::EdgeTriangle;

    #[inline]
    fn decide(a: &Segment, b: &Triangle, threshold: Threshold) -> Decision {
        decide(a, b, threshold)
    }

    fn proximity(a: &Segment, b: &Triangle) -> Proximity {
        proximity(a, b)
    }

    fn measure(a: &Segment, b: &Triangle) -> f64 {
        measure::hulls(a, b)
    }
}
