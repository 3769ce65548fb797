//! The certificates of `frame` in double-double arithmetic, for decisions in the filter's band and for distances.
//!
//! A double-double is the unevaluated sum of two doubles. With u = 2^-53 its operations have the relative errors proved by
//! Joldes, Muller and Popescu (2017, doi:10.1145/3121432): sum 3u^2 + 13u^3 (their algorithm 6), product below 7u^2
//! (algorithm 10), here loosely 8u^2; a division is only used for weights, whose error is harmless because any weights do.
//!
//! Local coordinates are *exact* differences here (`two_sum`). With rho, gap and directions as in `frame`:
//!
//! * a dot product is wrong by at most `(8 + 2 * 3.1) u^2 rho |v|_1`, a gap by twice that and `3.1 * 2.01 u^2 rho |v|_1`:
//!   below `36 u^2 rho |v|_1`; we subtract `256 u^2 rho |v|_1 = 2^-98 rho |v|_1`.
//! * `v = w + s x + t y` with weights that satisfy `s, t >= 0` and `s, t <= 1` or `s + t <= 1` as computed: x, y, w are
//!   rounded once (3.1u^2, of at most 2 rho), products 8u^2, two sums 3.1u^2 of at most 6 rho, and a sum of weights may exceed 1 by
//!   3.1u^2: below `90 u^2 rho` a component, `160 u^2 rho` in norm; we use `1024 u^2 rho = 2^-96 rho`.
//!
//! Underflow adds absolute errors near 2^-1074 in a frame with rho >= 2^-100, which the factors of 6 and more contain.

use super::candidates::Guess;
use super::frame::{Limits, PairFrame, Verdict};
use super::vector::{ldexp, scale};
use super::{Point, frame};

/// u^2.
const UNIT_SQUARED: f64 = f64::EPSILON * f64::EPSILON / 4.0;
const GAP_ERROR: f64 = 256.0 * UNIT_SQUARED;
const SPAN_ERROR: f64 = 1024.0 * UNIT_SQUARED;

/// The sum of two doubles, the second below half a unit in the last place of the first.
#[derive(Debug, Clone, Copy)]
pub(super) struct DoubleDouble(pub(super) f64, pub(super) f64);

type DoubleVector = [DoubleDouble; 3];

#[inline(always)]
pub(super) fn two_sum(x: f64, y: f64) -> DoubleDouble {
    let sum = x + y;
    let from_y = sum - x;
    let from_x = sum - from_y;
    DoubleDouble(sum, (x - from_x) + (y - from_y))
}

fn fast_two_sum(x: f64, y: f64) -> DoubleDouble {
    let sum = x + y;
    DoubleDouble(sum, y - (sum - x))
}

/// Dekker's product. Without a fused multiply-add in the target, `f64::mul_add` would be a library call.
#[inline(always)]
pub(super) fn two_product(x: f64, y: f64) -> DoubleDouble {
    let split = |x: f64| {
        let c = 134_217_729.0 * x;
        let high = c - (c - x);
        (high, x - high)
    };
    let product = x * y;
    let ((xh, xl), (yh, yl)) = (split(x), split(y));
    DoubleDouble(product, ((xh * yh - product) + xh * yl + xl * yh) + xl * yl)
}

impl DoubleDouble {
    fn from_f64(x: f64) -> Self {
        Self(x, 0.0)
    }

    fn plus(self, other: Self) -> Self {
        let high = two_sum(self.0, other.0);
        let low = two_sum(self.1, other.1);
        let first = fast_two_sum(high.0, high.1 + low.0);
        fast_two_sum(first.0, first.1 + low.1)
    }

    fn negated(self) -> Self {
        Self(-self.0, -self.1)
    }

    fn minus(self, other: Self) -> Self {
        self.plus(other.negated())
    }

    fn times(self, other: Self) -> Self {
        let product = two_product(self.0, other.0);
        fast_two_sum(product.0, product.1 + (self.0 * other.1 + self.1 * other.0))
    }

    fn over(self, other: Self) -> Self {
        let first = self.0 / other.0;
        let rest = self.minus(other.times(Self::from_f64(first)));
        let second = rest.0 / other.0;
        let rest = rest.minus(other.times(Self::from_f64(second)));
        fast_two_sum(first, second).plus(Self::from_f64(rest.0 / other.0))
    }

    fn is_negative(self) -> bool {
        self.0 < 0.0
    }
}

fn sub(p: DoubleVector, q: DoubleVector) -> DoubleVector {
    [p[0].minus(q[0]), p[1].minus(q[1]), p[2].minus(q[2])]
}

fn dot(p: DoubleVector, q: DoubleVector) -> DoubleDouble {
    p[0].times(q[0]).plus(p[1].times(q[1])).plus(p[2].times(q[2]))
}

fn plus_scaled(p: DoubleVector, s: DoubleDouble, q: DoubleVector) -> DoubleVector {
    [0, 1, 2].map(|k| p[k].plus(s.times(q[k])))
}

/// A pair of points of the features and what it proves.
#[derive(Debug, Clone, Copy)]
pub(super) struct PointPair {
    v: DoubleVector,
    squared: DoubleDouble,
    gap: DoubleDouble,
    rho: f64,
    pub(super) weights_a: [f64; 3],
    pub(super) weights_b: [f64; 3],
}

impl PointPair {
    /// The nearest points of the affine hulls of the parts that `guess` uses. `None` if they fall outside the parts.
    pub(super) fn new<const M: usize, const N: usize>(
        a: &[Point; M],
        b: &[Point; N],
        frame: &PairFrame<M, N>,
        guess: &Guess,
    ) -> Option<Self> {
        let (local_a, local_b) = exact_differences(a, b, frame.exponent);
        let parts_a: ([usize; 3], usize) = used(&guess.a);
        let parts_b: ([usize; 3], usize) = used(&guess.b);
        let (on_a, on_b) = (&parts_a.0[..parts_a.1], &parts_b.0[..parts_b.1]);
        let w = sub(local_a[*on_a.first()?], local_b[*on_b.first()?]);
        // Directions in which the difference can move: along A, or against B.
        let mut moves = [w; 4];
        let mut count = 0;
        for &i in &on_a[1..] {
            moves[count] = sub(local_a[i], local_a[on_a[0]]);
            count += 1;
        }
        for &j in &on_b[1..] {
            moves[count] = sub(local_b[on_b[0]], local_b[j]);
            count += 1;
        }
        let (v, steps) = match count {
            0 => (w, [DoubleDouble(0.0, 0.0); 2]),
            1 => {
                let x = moves[0];
                let s = dot(w, x).negated().over(dot(x, x));
                (plus_scaled(w, s, x), [s, DoubleDouble(0.0, 0.0)])
            }
            2 => {
                let [x, y, ..] = moves;
                let (xx, yy, xy, wx, wy) = (dot(x, x), dot(y, y), dot(x, y), dot(w, x), dot(w, y));
                let det = xx.times(yy).minus(xy.times(xy));
                let s = xy.times(wy).minus(yy.times(wx)).over(det);
                let t = xy.times(wx).minus(xx.times(wy)).over(det);
                (plus_scaled(plus_scaled(w, s, x), t, y), [s, t])
            }
            _ => return None,
        };
        let (mut weights_a, mut weights_b) = ([0.0; 3], [0.0; 3]);
        let (steps_a, steps_b) = steps[..count].split_at(on_a.len() - 1);
        for (weights, on, steps) in [(&mut weights_a, on_a, steps_a), (&mut weights_b, on_b, steps_b)] {
            let mut rest = DoubleDouble::from_f64(1.0);
            for (&k, &step) in on[1..].iter().zip(steps) {
                if step.0.is_nan() || step.is_negative() {
                    return None;
                }
                weights[k] = step.0;
                rest = rest.minus(step);
            }
            if rest.is_negative() {
                return None;
            }
            weights[on[0]] = rest.0;
        }
        let lowest = |points: &[DoubleVector], v: DoubleVector| {
            points
                .iter()
                .map(|&p| dot(v, p))
                .reduce(|x, y| if y.minus(x).is_negative() { y } else { x })
        };
        let against = v.map(DoubleDouble::negated);
        let gap = lowest(&local_a, v)?.plus(lowest(&local_b, against)?);
        Some(Self {
            v,
            squared: dot(v, v),
            gap,
            rho: frame.rho,
            weights_a,
            weights_b,
        })
    }

    /// `|v|_1`.
    fn taxicab(&self) -> f64 {
        self.v[0].0.abs() + self.v[1].0.abs() + self.v[2].0.abs()
    }

    /// A proved lower bound of the gap.
    fn safe_gap(&self) -> DoubleDouble {
        self.gap
            .minus(DoubleDouble::from_f64(GAP_ERROR * self.rho * self.taxicab()))
    }

    /// Compares with delta. Squares and products here are wrong by less than 40u^2 of themselves, 128u^2 is granted.
    pub(super) fn judge(&self, limits: &Limits) -> Verdict {
        let exceeds = |x: DoubleDouble, y: DoubleDouble| x.minus(y).0 > 128.0 * UNIT_SQUARED * x.0;
        let margin =
            DoubleDouble::from_f64(limits.below).minus(DoubleDouble::from_f64(SPAN_ERROR * self.rho));
        let gap = self.safe_gap();
        let above = DoubleDouble::from_f64(limits.above);
        // Outside these ends a square could overflow or lose its low part to underflow.
        let in_range = |x: f64| x > frame::LEAST_GAP && x < 1.0 / frame::LEAST_GAP;
        if in_range(margin.0) && exceeds(margin.times(margin), self.squared) {
            Verdict::Within
        } else if in_range(gap.0)
            && in_range(limits.above)
            && exceeds(gap.times(gap), above.times(above).times(self.squared))
        {
            Verdict::Apart
        } else {
            Verdict::Unknown
        }
    }

    /// The distance in the frame, if both bounds agree on it to 2^-55: rounding the root to nearest then leaves it
    /// within one unit in the last place.
    pub(super) fn distance(&self) -> Option<f64> {
        let tolerance = f64::EPSILON / 16.0;
        let root = sqrt(self.squared);
        let spread = self.squared.minus(self.safe_gap()).0;
        (root > frame::LEAST_GAP
            && spread.abs() <= tolerance * self.squared.0
            && SPAN_ERROR * self.rho <= tolerance * root)
            .then_some(root)
    }
}

/// The square root of a double-double, rounded once.
fn sqrt(x: DoubleDouble) -> f64 {
    let root = x.0.sqrt();
    let rest = x.minus(two_product(root, root)).0;
    root + rest / (2.0 * root)
}

/// The numbers of the vertices with a weight.
fn used(weights: &[f64; 3]) -> ([usize; 3], usize) {
    let mut numbers = [0; 3];
    let mut count = 0;
    for (k, &weight) in weights.iter().enumerate() {
        if weight > 0.0 {
            numbers[count] = k;
            count += 1;
        }
    }
    (numbers, count)
}

/// The local coordinates of `frame` without its rounding.
fn exact_differences<const M: usize, const N: usize>(
    a: &[Point; M],
    b: &[Point; N],
    exponent: i32,
) -> ([DoubleVector; M], [DoubleVector; N]) {
    // Quarters of numbers near f64::MAX, as in the frame; otherwise the numbers as they are.
    let quarter = exponent >= 900;
    let prepared = |p: Point| if quarter { scale(p, 0.25) } else { p };
    let shift = if quarter { 2 - exponent } else { -exponent };
    let origin = prepared(a[0]);
    let local = |p: Point| {
        let p = prepared(p);
        [0, 1, 2].map(|k| {
            let difference = two_sum(p[k], -origin[k]);
            if shift == 0 {
                difference
            } else {
                DoubleDouble(ldexp(difference.0, shift), ldexp(difference.1, shift))
            }
        })
    };
    (a.map(local), b.map(local))
}
