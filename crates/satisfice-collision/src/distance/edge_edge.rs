//! Edge against edge: two segments.

use super::frame::{Limits, PairFrame, Verdict};
use super::resolve::{self, Hulls};
use super::{Decision, FeaturePair, PairKind, Proximity, Segment, Threshold, closest, measure};

/// Two segments.
#[derive(Debug, Clone, Copy)]
pub struct EdgeEdge;

impl Hulls<2, 2> for EdgeEdge {
    #[inline(always)]
    fn filter(frame: &PairFrame<2, 2>, limits: &Limits) -> Verdict {
        let (s, t) = closest::of_segments(&frame.a, &frame.b);
        frame.judge(frame.difference(&[1.0 - s, s], &[1.0 - t, t]), limits)
    }
}

/// Whether the distance is below delta, and the stage that proved it.
#[inline]
pub fn decide(a: &Segment, b: &Segment, threshold: Threshold) -> Decision {
    resolve::decide::<EdgeEdge, 2, 2>(a, b, threshold)
}

/// Whether the distance is below delta.
#[inline]
pub fn within(a: &Segment, b: &Segment, threshold: Threshold) -> bool {
    decide(a, b, threshold).within
}

/// Distance and closest points.
pub fn proximity(a: &Segment, b: &Segment) -> Proximity {
    resolve::proximity::<2, 2>(a, b)
}

impl FeaturePair for EdgeEdge {
    type A = Segment;
    type B = Segment;
    const KIND: PairKind = PairKind::EdgeEdge;

    #[inline]
    fn decide(a: &Segment, b: &Segment, threshold: Threshold) -> Decision {
        decide(a, b, threshold)
    }

    fn proximity(a: &Segment, b: &Segment) -> Proximity {
        proximity(a, b)
    }

    fn measure(a: &Segment, b: &Segment) -> f64 {
        measure::hulls(a, b)
    }
}
