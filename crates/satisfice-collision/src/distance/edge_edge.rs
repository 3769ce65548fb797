//! Edge against edge: two segments.

use super::frame::{Frame, Limits, Verdict};
use super::resolve::{self, Hulls};
use super::vector::{dot, sub};
use super::{Decision, FeaturePair, PairKind, Proximity, Segment, Threshold, measure};

/// Two segments.
#[derive(Debug, Clone, Copy)]
pub struct EdgeEdge;

/// Parameters `(s, t)` in `[0, 1]` of the nearest points `p + s d` and `q + t e`, approximately: the lines' minimum,
/// clamped to one segment, projected to the other and back (Lumelsky 1985, doi:10.1016/0020-0190(85)90032-8).
/// Lines that are parallel as far as can be computed start from `s = 0`.
#[inline(always)]
pub(super) fn parameters(a: &Segment, b: &Segment) -> (f64, f64) {
    let (d, e, r) = (sub(a[1], a[0]), sub(b[1], b[0]), sub(a[0], b[0]));
    let (dd, ee, de) = (dot(d, d), dot(e, e), dot(d, e));
    let (dr, er) = (dot(d, r), dot(e, r));
    let s = unit((de * er - dr * ee) / (dd * ee - de * de));
    let t = unit((de * s + er) / ee);
    (unit((de * t - dr) / dd), t)
}

/// Clamps to `[0, 1]`; NaN becomes 0.
#[inline(always)]
fn unit(x: f64) -> f64 {
    if x > 0.0 {
        if x < 1.0 { x } else { 1.0 }
    } else {
        0.0
    }
}

impl Hulls<2, 2> for EdgeEdge {
    #[inline(always)]
    fn filter(frame: &Frame<2, 2>, limits: &Limits) -> Verdict {
        let (s, t) = parameters(&frame.a, &frame.b);
        frame.judge(frame.difference(&[1.0 - s, s], &[1.0 - t, t]), limits)
    }
}

/// Whether the distance is below delta, and how that is known. Cost: about 20 ns.
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
