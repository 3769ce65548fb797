//! Vertex against vertex.

use super::frame::{Limits, PairFrame, Verdict};
use super::resolve::{self, Hulls};
use super::vector::{dot, sub};
use super::{DecidedBy, Decision, FeaturePair, PairKind, Point, Proximity, Threshold, measure};

/// Two points.
#[derive(Debug, Clone, Copy)]
pub struct VertexVertex;

/// 8u with u = 2^-53. Three differences, three products and two sums leave `fl(|a - b|^2)` within 5.1u of the true
/// square in relation to it, the comparison's own product adds 1u.
const SLACK: f64 = 4.0 * f64::EPSILON;

/// Whether `|a - b| < delta`, and the stage that proved it.
#[inline]
pub fn decide(a: &Point, b: &Point, threshold: Threshold) -> Decision {
    let v = sub(*a, *b);
    let squared = dot(v, v);
    // Between these ends nothing overflowed, and what underflowed is below u^2 in relation to the sum.
    if squared > 1e-270 && squared < 1e300 {
        if squared * (1.0 + SLACK) < threshold.squared_below() {
            return Decision {
                within: true,
                by: DecidedBy::Filter,
            };
        }
        if squared * (1.0 - SLACK) > threshold.squared_above() {
            return Decision {
                within: false,
                by: DecidedBy::Filter,
            };
        }
    }
    resolve::decide::<VertexVertex, 1, 1>(&[*a], &[*b], threshold)
}

/// Whether `|a - b| < delta`.
#[inline]
pub fn within(a: &Point, b: &Point, threshold: Threshold) -> bool {
    decide(a, b, threshold).within
}

/// The distance `|a - b|`.
pub fn proximity(a: &Point, b: &Point) -> Proximity {
    resolve::proximity::<1, 1>(&[*a], &[*b])
}

impl Hulls<1, 1> for VertexVertex {
    #[inline(always)]
    fn filter(frame: &PairFrame<1, 1>, limits: &Limits) -> Verdict {
        frame.judge(sub(frame.a[0], frame.b[0]), limits)
    }
}

impl FeaturePair for VertexVertex {
    type A = Point;
    type B = Point;
    const KIND: PairKind = PairKind::VertexVertex;

    #[inline]
    fn decide(a: &Point, b: &Point, threshold: Threshold) -> Decision {
        decide(a, b, threshold)
    }

    fn proximity(a: &Point, b: &Point) -> Proximity {
        proximity(a, b)
    }

    fn measure(a: &Point, b: &Point) -> f64 {
        measure::hulls(&[*a], &[*b])
    }
}
