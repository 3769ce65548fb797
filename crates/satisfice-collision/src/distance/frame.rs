//! The floating-point filter: local coordinates and two certificates with proved error bounds.
//!
//! Features are convex hulls of `M` and `N` points. Any method may propose a pair of points or a direction. Only one of two
//! certificates turns a proposal into a decision, so that a poor proposal cannot make a wrong decision:
//!
//! * **upper bound**: any point of A and any point of B are at least as far apart as the features;
//! * **lower bound**: for any direction v, `gap(v) = min_i v.a_i - max_j v.b_j` gives `distance >= gap(v) / |v|`.
//!
//! # Error bounds
//! u = 2^-53. Operations obey `fl(x op y) = (x op y)(1 + e)`, and also `= (x op y) / (1 + e)`, `|e| <= u`, plus an absolute
//! 2^-1075 where a product underflows. The frame holds `a^_i = fl(a_i - o)`, `b^_j = fl(b_j - o)` for the origin
//! `o = a_0`; `rho` is the largest of their components in absolute value, and 2^-100 <= rho <= 2^100. By the second
//! form above each component is wrong by at most `u rho`. (Frames brought into this range by a power of two add at most
//! 2^-1072 to that where components become denormal; this and all underflows below vanish in the slack stated.)
//!
//! **Gap.** `fl(v.x^)` differs from `v.x` by at most `u rho |v|_1` (the components) plus `3.01 u rho |v|_1` (three
//! products, two sums). Both sides: `8.02 u rho |v|_1`. The subtraction of the two extremes, at most
//! `2.01 rho |v|_1` apart, adds `2.01 u rho |v|_1`; subtracting the error term itself adds no more than another
//! `2.02 u rho |v|_1`. Together below `12.1 u rho |v|_1`, and we subtract `16 u rho |v|_1 = 2^-49 rho |v|_1`, the norm as
//! computed (relative error 3u). So G, the result, is at most the true gap. A G below 2^-300 proves nothing; G >= 2^-300 gives
//! `|v|_1 >= 2^-402`, hence `v.v >= 2^-806` is computed without harm from underflow, with relative error 3.01u, and the
//! slack `3.9 u rho |v|_1 >= 2^-556` dwarfs every 2^-1072. With `D >= delta^2` the test
//! `fl(G G) >= fl(fl(D fl(v.v)) (1 + 8u))` implies
//! `G^2 (1 + u) >= D v.v (1 - 3.01u)(1 - u)(1 + 8u)(1 - u)`, hence `G^2 > delta^2 |v|^2`: not within. (If the right side underflows
//! it is below 2^-1000 and the left above 2^-600; if it overflows the test fails.)
//!
//! **Upper bound.** `v^` is the computed `sum_k l_k w^_k` over at most four differences `w^ = fl(a^_i - b^_j)`, or
//! `sum_i l_i a^_i - sum_j m_j b^_j`, with weights `>= 0` whose sum S is within 5u of 1. A component of `w^` is off by at
//! most `4.01 u rho`, products and sums add at most `4.01 u * 2.01 rho`, the missing normalisation `5u * 2.01 rho`: below
//! `23 u rho`, hence below `40 u rho` in Euclidean norm. (For the second form `2 (1 + 3.01 + 5) + 2.1` = 20.2 instead of 23.)
//! We use `E = 64 u rho = 2^-47 rho`. With `delta_ <= delta`, `m = fl(delta_ - E) > 0` the test
//! `fl(fl(v^.v^)(1 + 8u)) < fl(m m)` implies `|v^|^2 (1 - 3.01u)(1 + 8u)(1 - u) < (delta_ - E)^2 (1 + u)^3`, hence
//! `|v^| < delta_ - E` and the distance, at most `|v^| + E`, is below delta. (Underflow in `v^.v^` moves `|v^|` by less than
//! 2^-536, the slack of 24 u rho is at least 2^-149.)

use super::vector::{cross, dot, exponent, ldexp, power_of_two, scale, sub};
use super::{Point, Threshold};

/// 1 + 8u.
pub(super) const ABOVE_ONE: f64 = 1.0 + 8.0 * (f64::EPSILON / 2.0);
/// 16u: the error of a gap in units of `rho |v|_1`.
pub(super) const GAP_ERROR: f64 = 8.0 * f64::EPSILON;
/// 64u: the error of an upper bound in units of `rho`.
pub(super) const SPAN_ERROR: f64 = 32.0 * f64::EPSILON;
/// 2^-300, the least gap that is believed.
pub(super) const LEAST_GAP: f64 = f64::from_bits((1023 - 300) << 52);
/// 2^-100 and 2^100, between which `rho` needs no scaling.
pub(super) const LEAST_RHO: f64 = f64::from_bits((1023 - 100) << 52);
pub(super) const GREATEST_RHO: f64 = f64::from_bits((1023 + 100) << 52);

/// The result of the certificates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Verdict {
    Within,
    Apart,
    Unknown,
}

/// Two features in local coordinates: `local = (posed - a_0) * 2^-exponent`.
#[derive(Debug, Clone, Copy)]
pub(super) struct PairFrame<const M: usize, const N: usize> {
    pub(super) a: [Point; M],
    pub(super) b: [Point; N],
    /// Largest component, in absolute value.
    pub(super) rho: f64,
    pub(super) exponent: i32,
}

/// Delta in the unit of a frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// At most delta.
    pub(super) below: f64,
    /// At least delta.
    pub(super) above: f64,
    /// At least delta squared.
    pub(super) squared_above: f64,
    /// `fl(below - E)`, squared; -1 if the difference is not positive.
    reach: f64,
}

/// Why there is no frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NoFrame {
    /// All points are the same.
    Coincident,
    NotFinite,
}

impl<const M: usize, const N: usize> PairFrame<M, N> {
    #[inline(always)]
    pub(super) fn new(a: &[Point; M], b: &[Point; N]) -> Result<Self, NoFrame> {
        let frame = Self::centred(a, b);
        if frame.rho >= LEAST_RHO && frame.rho <= GREATEST_RHO {
            Ok(frame)
        } else {
            Self::scaled(a, b)
        }
    }

    #[inline(always)]
    fn centred(a: &[Point; M], b: &[Point; N]) -> Self {
        let origin = a[0];
        let a = a.map(|p| sub(p, origin));
        let b = b.map(|p| sub(p, origin));
        // One chain of maxima per axis. NaN passes unnoticed here; `has_nan` finds it later.
        let mut most = [0.0_f64; 3];
        for p in a[1..].iter().chain(&b) {
            for k in 0..3 {
                most[k] = greatest(most[k], p[k].abs());
            }
        }
        Self {
            a,
            b,
            rho: greatest(greatest(most[0], most[1]), most[2]),
            exponent: 0,
        }
    }

    /// The rare frame that needs a power of two to be in range.
    #[cold]
    #[inline(never)]
    fn scaled(a: &[Point; M], b: &[Point; N]) -> Result<Self, NoFrame> {
        if !a.iter().chain(b).flatten().all(|x| x.is_finite()) {
            return Err(NoFrame::NotFinite);
        }
        let mut frame = Self::centred(a, b);
        if !frame.rho.is_finite() {
            // A difference overflowed; quarters cannot.
            frame = Self::centred(&a.map(|p| scale(p, 0.25)), &b.map(|p| scale(p, 0.25)));
            frame.exponent = 2;
        }
        if frame.rho == 0.0 {
            return Err(NoFrame::Coincident);
        }
        let shift = exponent(frame.rho);
        // Two factors, each a power of two in the normal range.
        let (first, second) = (power_of_two(-(shift / 2)), power_of_two(shift / 2 - shift));
        let bring = |x: f64| x * first * second;
        Ok(Self {
            a: frame.a.map(|p| p.map(bring)),
            b: frame.b.map(|p| p.map(bring)),
            rho: bring(frame.rho),
            exponent: frame.exponent + shift,
        })
    }

    #[inline(always)]
    pub(super) fn limits(&self, threshold: Threshold) -> Limits {
        let (below, above, squared_above) = if self.exponent == 0 {
            (threshold.get(), threshold.get(), threshold.squared_above())
        } else {
            let delta = ldexp(threshold.get(), -self.exponent);
            let above = delta.next_up();
            (delta.next_down(), above, (above * above).next_up())
        };
        let margin = below - SPAN_ERROR * self.rho;
        let reach = if margin > 0.0 { margin * margin } else { -1.0 };
        Limits {
            below,
            above,
            squared_above,
            reach,
        }
    }

    /// Whether a coordinate is NaN. Every difference of points is then NaN (even with a weight of 0), so that no certificate
    /// holds; therefore this test may come afterwards.
    pub(super) fn has_nan(&self) -> bool {
        self.a.iter().chain(&self.b).flatten().any(|x| x.is_nan())
    }

    /// `min v.a - max v.b` as computed.
    #[inline(always)]
    pub(super) fn gap(&self, v: Point) -> f64 {
        let mut nearest_a = dot(v, self.a[0]);
        for &p in &self.a[1..] {
            nearest_a = least(nearest_a, dot(v, p));
        }
        let mut nearest_b = dot(v, self.b[0]);
        for &q in &self.b[1..] {
            nearest_b = -least(-nearest_b, -dot(v, q));
        }
        nearest_a - nearest_b
    }

    /// Whether `gap`, computed for direction `v`, proves that the features are at least delta apart.
    /// `squared` is `v.v`.
    #[inline(always)]
    pub(super) fn is_apart(&self, gap: f64, v: Point, squared: f64, limits: &Limits) -> bool {
        let g = gap - GAP_ERROR * self.rho * (v[0].abs() + v[1].abs() + v[2].abs());
        g > LEAST_GAP && g * g >= limits.squared_above * squared * ABOVE_ONE
    }

    /// Both certificates for one proposal: `v` is the difference of a point of A and a point of B.
    #[inline(always)]
    pub(super) fn judge(&self, v: Point, limits: &Limits) -> Verdict {
        let squared = dot(v, v);
        if limits.is_within(squared) {
            Verdict::Within
        } else if self.is_apart(self.gap(v), v, squared, limits) {
            Verdict::Apart
        } else {
            Verdict::Unknown
        }
    }

    /// The difference of the points with the given weights.
    #[inline(always)]
    pub(super) fn difference(&self, weights_a: &[f64; M], weights_b: &[f64; N]) -> Point {
        sub(
            super::vector::combine(&self.a, weights_a),
            super::vector::combine(&self.b, weights_b),
        )
    }
}

impl Limits {
    /// Whether a difference of two points of the features, `squared = v.v`, proves that they are within delta.
    #[inline(always)]
    pub(super) fn is_within(&self, squared: f64) -> bool {
        squared * ABOVE_ONE < self.reach
    }
}

/// The larger of two numbers in one instruction; `x` if `y` is NaN.
#[inline(always)]
fn greatest(x: f64, y: f64) -> f64 {
    if y > x { y } else { x }
}

/// The smaller of two finite numbers in one instruction.
#[inline(always)]
pub(super) fn least(x: f64, y: f64) -> f64 {
    if x < y { x } else { y }
}

/// The first edge of `hull`, as a pair of its vertices, that provably passes through the triangle `t`; all in the
/// coordinates of a frame with this `rho`.
///
/// Each sign is that of a determinant of three differences of components at most `2 rho`. A component is wrong by at most
/// `4.01 u rho`; the determinant, six products of three, by at most `6 (3 * 4.01 u rho * (2.01 rho)^2 + 5.1 u (2.01 rho)^3)` for the
/// components and its own rounding, below `545 u rho^3`; we ask for `1024 u rho^3`.
pub(super) fn piercing(hull: &[Point], edges: &[[usize; 2]], t: &[Point; 3], rho: f64) -> Option<[usize; 2]> {
    let bound = 512.0 * f64::EPSILON * rho * rho * rho;
    let sign = |x: f64| i8::from(x > bound) - i8::from(x < -bound);
    let n = cross(sub(t[1], t[0]), sub(t[2], t[0]));
    let mut sides = [0; 3];
    for (side, &p) in sides.iter_mut().zip(hull) {
        *side = sign(dot(n, sub(p, t[0])));
    }
    let volume = |a: Point, b: Point, c: Point, d: Point| sign(dot(cross(sub(b, a), sub(c, a)), sub(d, a)));
    edges.iter().copied().find(|&[i, k]| {
        let (p, q) = (hull[i], hull[k]);
        sides[i] * sides[k] == -1 && {
            let turn = volume(p, q, t[0], t[1]);
            turn != 0 && turn == volume(p, q, t[1], t[2]) && turn == volume(p, q, t[2], t[0])
        }
    })
}

/// The point in which the segment `p q` crosses the plane of `t`: the parameter on the segment and the barycentric weights,
/// approximately. Meaningful for an edge from `piercing`.
pub(super) fn crossing(p: Point, q: Point, t: &[Point; 3]) -> (f64, [f64; 3]) {
    let n = cross(sub(t[1], t[0]), sub(t[2], t[0]));
    let (from, to) = (dot(n, sub(p, t[0])).abs(), dot(n, sub(q, t[0])).abs());
    let d = sub(q, p);
    let turn = |k: usize, l: usize| dot(d, cross(sub(t[k], p), sub(t[l], p))).abs();
    let volumes = [turn(1, 2), turn(2, 0), turn(0, 1)];
    let sum = volumes[0] + volumes[1] + volumes[2];
    (from / (from + to), volumes.map(|volume| volume / sum))
}
