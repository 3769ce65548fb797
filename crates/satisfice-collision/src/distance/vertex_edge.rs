//! Vertex against edge: a point and a segment.

use super::frame::{Limits, PairFrame, Verdict};
use super::resolve::{self, Hulls};
use super::vector::sub;
use super::{Decision, FeaturePair, PairKind, Point, Proximity, Segment, Threshold, closest, measure};

/// A point and a segment.
#[derive(Debug, Clone, Copy)]
pub struct VertexEdge;

impl Hulls<1, 2> for VertexEdge {
    #[inline(always)]
    fn filter(frame: &PairFrame<1, 2>, limits: &Limits) -> Verdict {
        let [q, r] = frame.b;
        let t = closest::on_segment(frame.a[0], q, sub(r, q));
        frame.judge(frame.difference(&[1.0], &[1.0 - t, t]), limits)
    }
}

/// Whether the distance is below delta, and the stage that proved it.
#[inline]
pub fn decide(a: &Point, b: &Segment, threshold: Threshold) -> Decision {
    resolve::decide::<VertexEdge, 1, 2>(&[*a], b, threshold)
}

/// Whether the distance is below delta.
#[inline]
pub fn within(a: &Point, b: &Segment, threshold: Threshold) -> bool {
    decide(a, b, threshold).within
}

/// Distance and closest points.
pub fn proximity(a: &Point, b: &Segment) -> Proximity {
    resolve::proximity::<1, 2>(&[*a], b)
}

impl FeaturePair for VertexEdge {
    type A = Point;
    type B = Segment;
    const KIND: PairKind = PairKind::VertexEdge;

    #[inline]
    fn decide(a: &Point, b: &Segment, threshold: Threshold) -> Decision {
        decide(a, b, threshold)
    }

    fn proximity(a: &Point, b: &Segment) -> Proximity {
        proximity(a, b)
    }

    fn measure(a: &Point, b: &Segment) -> f64 {
        measure::hulls(&[*a], b)
    }
}
