//! Vertex against vertex.

use super::extended::{two_product, two_sum};
use super::frame::{Limits, PairFrame, Verdict};
use super::resolve::{self, Hulls};
use super::vector::{dot, sub};
use super::{DecidedBy, Decision, Feature, FeaturePair, PairKind, Point, Proximity, Threshold, measure};

/// Two points.
#[derive(Debug, Clone, Copy)]
pub struct VertexVertex;

/// 8u with u = 2^-53. Three differences, three products and two sums leave `fl(|a - b|^2)` within 5.1u of the true
/// square in relation to it, the comparison's own product adds 1u.
const SLACK: f64 = 4.0 * f64::EPSILON;

/// 2^-200; between it and its inverse no square or its rounding error leaves the normal range with an effect.
const LEAST_SQUARE: f64 = f64::from_bits((1023 - 200) << 52);

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
#[inline]
pub fn proximity(a: &Point, b: &Point) -> Proximity {
    let Some(distance) = distance(a, b) else {
        return resolve::proximity::<1, 1>(&[*a], &[*b]);
    };
    Proximity {
        distance,
        point_a: *a,
        point_b: *b,
        weights_a: [1.0, 0.0, 0.0],
        weights_b: [1.0, 0.0, 0.0],
        feature_a: Feature::Vertex(0),
        feature_b: Feature::Vertex(0),
        by: DecidedBy::Extended,
    }
}

/// `|a - b|`, rounded to nearest but for values within 2^-45 units in the last place of a tie. `None` for points that coincide,
/// are not finite, or whose square could overflow or underflow.
///
/// A difference is `h + l` without error, `|l| <= u |h|`, its square `p + e + l (2h + l)` with `p + e = h h`. The sum of the three p is
/// `s + t`, again without error; all else is below `5u s` and is summed with relative error 4u, so that the square is known
/// within 2^-101 of itself. One step of Newton from `sqrt(s)` leaves `8u^2` of the root.
#[inline]
fn distance(a: &Point, b: &Point) -> Option<f64> {
    let mut squares = [0.0; 3];
    let mut rest = 0.0;
    for k in 0..3 {
        let difference = two_sum(a[k], -b[k]);
        let square = two_product(difference.0, difference.0);
        squares[k] = square.0;
        rest += square.1 + difference.1 * (2.0 * difference.0 + difference.1);
    }
    let first = two_sum(squares[0], squares[1]);
    let sum = two_sum(first.0, squares[2]);
    if !(LEAST_SQUARE..=1.0 / LEAST_SQUARE).contains(&sum.0) {
        return None;
    }
    rest += first.1 + sum.1;
    let root = sum.0.sqrt();
    let square = two_product(root, root);
    Some(root + ((sum.0 - square.0) - square.1 + rest) / (2.0 * root))
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

    #[inline]
    fn distance(a: &Point, b: &Point) -> f64 {
        distance(a, b).unwrap_or_else(|| resolve::proximity::<1, 1>(&[*a], &[*b]).distance)
    }

    fn measure(a: &Point, b: &Point) -> f64 {
        measure::hulls(&[*a], &[*b])
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt as _, SeedableRng};

    use super::*;

    /// The way of all kinds has a referee in rational arithmetic; this one gives the same to the bit.
    #[test]
    fn the_short_way_gives_what_the_long_one_gives() {
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(9);
        for case in 0..40_000_u32 {
            let unit = 2.0_f64.powi([0, -20, 90, -90, 110, -110, 480, -520][case as usize % 8]);
            let offset = [0.0, 1.0, 1_048_576.0][case as usize % 3];
            let apart = [1.0, 1e-3, 1e-9, 1e-16][case as usize / 7 % 4];
            let a: Point = std::array::from_fn(|_| unit * (offset + rng.random::<f64>()));
            let b = a.map(|x| match rng.random_range(0..4) {
                0 => x,
                1 => x.next_up(),
                _ => x + unit * apart * (rng.random::<f64>() - 0.5),
            });
            assert_eq!(
                proximity(&a, &b),
                resolve::proximity::<1, 1>(&[a], &[b]),
                "{a:?} {b:?}"
            );
            assert_eq!(VertexVertex::distance(&a, &b), proximity(&a, &b).distance);
        }
    }

    #[test]
    fn squares_that_cannot_be_computed_are_left_to_the_long_way() {
        let far = |x: f64| proximity(&[0.0; 3], &[x, 0.0, 0.0]).distance;
        for x in [0.0, 5e-324, 1e-200, 1e-31, 1e-30, 1e30, 1e31, 1e200, f64::MAX] {
            assert_eq!(far(x).to_bits(), x.to_bits());
        }
        assert!(far(f64::NAN).is_nan() && far(f64::INFINITY).is_nan());
        assert_eq!(proximity(&[f64::MAX; 3], &[-f64::MAX; 3]).distance, f64::INFINITY);
    }
}
