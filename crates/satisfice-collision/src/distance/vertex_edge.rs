//! Vertex against edge: a point and a segment.

use super::frame::{Frame, Limits, Verdict};
use super::resolve::{self, Hulls};
use super::vector::{dot, sub};
use super::{Decision, FeaturePair, PairKind, Point, Proximity, Segment, Threshold, measure};

/// A point and a segment.
#[derive(Debug, Clone, Copy)]
pub struct VertexEdge;

/// The parameter in `[0, 1]` of the point of the segment `q + t e` nearest to `p`, `t = (p - q).e / e.e`, approximately.
#[inline(always)]
pub(super) fn parameter(p: Point, q: Point, e: Point) -> f64 {
    let t = dot(sub(p, q), e) / dot(e, e);
    // Written so that the NaN of a segment without length becomes its start.
    if t > 0.0 {
        if t < 1.0 { t } else { 1.0 }
    } else {
        0.0
    }
}

impl Hulls<1, 2> for VertexEdge {
    #[inline(always)]
    fn filter(frame: &Frame<1, 2>, limits: &Limits) -> Verdict {
        let [q, r] = frame.b;
        let t = parameter(frame.a[0], q, sub(r, q));
        frame.judge(frame.difference(&[1.0], &[1.0 - t, t]), limits)
    }
}

/// Whether the distance is below delta, and how that is known. Cost: about 10 ns.
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
