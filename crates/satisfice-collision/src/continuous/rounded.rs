//! Polynomials of the time in floating point, with a bound of their error.
//!
//! u = 2^-53. The coefficients are those of a binary form (`form`), each wrong by at most `error`. A sum or a difference adds the
//! errors and `u` times the result. A coefficient of a product is a sum of at most n products, n the least number of coefficients, each
//! of which is wrong by `A e_b + B e_a + e_a e_b` and has a rounding, as has each sum: `n (n + 1) u A B` in all, for bounds A, B of
//! the coefficients as computed. Underflow vanishes in `TINY`; `SLACK` covers the roundings of the bounds themselves.

use super::conditions::{Conditions, Polynomial};
use super::integers::Interval;
use super::motion::PairMotion;
use super::swept::{RANGE, TINY, U, inverse_power_of_two};
use super::vector::{largest, sub};

/// As many coefficients as the highest degree has.
const MOST: usize = 7;
/// Above the roundings of a bound.
const SLACK: f64 = 1.0 + 64.0 * U;

/// A polynomial of a degree of at most six.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rounded {
    coefficients: [f64; MOST],
    len: usize,
    error: f64,
}

impl Rounded {
    fn new(coefficients: [f64; MOST], len: usize, error: f64) -> Self {
        Self {
            coefficients,
            len,
            error: error * SLACK + TINY,
        }
    }

    fn largest(&self) -> f64 {
        self.coefficients.iter().fold(0.0, |most, c| most.max(c.abs()))
    }

    fn combined(&self, other: &Self, f: impl Fn(f64, f64) -> f64) -> Self {
        assert_eq!(self.len, other.len, "sums are of one degree");
        let mut sums = [0.0; MOST];
        let pairs = self.coefficients.iter().zip(&other.coefficients);
        for (sum, (&a, &b)) in sums.iter_mut().zip(pairs).take(self.len) {
            *sum = f(a, b);
        }
        let exact = Self::new(sums, self.len, 0.0);
        let error = self.error + other.error + U * exact.largest();
        Self::new(sums, self.len, error)
    }

    /// In Bernstein's form, whose coefficients bound the polynomial for times from 0 to 1.
    pub(super) fn bernstein(&self) -> Bernstein {
        let degree = self.len - 1;
        let mut coefficients = self.coefficients;
        let mut binomial = 1.0;
        for (k, c) in coefficients.iter_mut().enumerate().take(self.len) {
            *c /= binomial;
            // exact: small integers
            binomial = binomial * (degree - k) as f64 / (k + 1) as f64;
        }
        Bernstein(Self::new(coefficients, self.len, self.error + U * self.largest()))
    }
}

impl Polynomial for Rounded {
    fn plus(&self, other: &Self) -> Self {
        self.combined(other, |a, b| a + b)
    }

    fn minus(&self, other: &Self) -> Self {
        self.combined(other, |a, b| a - b)
    }

    fn times(&self, other: &Self) -> Self {
        let mut products = [0.0; MOST];
        for i in 0..self.len {
            for j in 0..other.len {
                products[i + j] += self.coefficients[i] * other.coefficients[j];
            }
        }
        let n = self.len.min(other.len) as f64;
        let (a, b) = (self.largest(), other.largest());
        let inherited = a * other.error + b * self.error + self.error * other.error;
        let error = n * (inherited + (n + 1.0) * U * a * b);
        Self::new(products, self.len + other.len - 1, error)
    }

    fn negated(&self) -> Self {
        Self {
            coefficients: self.coefficients.map(|c| -c),
            ..*self
        }
    }
}

/// A polynomial by its coefficients in Bernstein's form, each wrong by at most the error.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bernstein(Rounded);

impl Bernstein {
    fn coefficients(&self) -> &[f64] {
        &self.0.coefficients[..self.0.len]
    }

    /// Surely above 0 from 0 to 1.
    pub(super) fn is_positive(&self) -> bool {
        self.coefficients().iter().all(|&c| c > self.0.error)
    }

    /// Surely below 0 from 0 to 1.
    pub(super) fn is_negative(&self) -> bool {
        self.coefficients().iter().all(|&c| c < -self.0.error)
    }

    /// Surely above 0 at 0.
    pub(super) fn is_positive_at_start(&self) -> bool {
        self.0.coefficients[0] > self.0.error
    }

    /// Surely of different signs at 0 and 1.
    pub(super) fn has_root(&self) -> bool {
        let [first, last] = [self.0.coefficients[0], self.0.coefficients[self.0.len - 1]];
        first.abs() > self.0.error && last.abs() > self.0.error && (first > 0.0) != (last > 0.0)
    }

    /// Whether the error hides all coefficients, so that no part of it tells more.
    pub(super) fn is_hidden(&self) -> bool {
        self.coefficients().iter().all(|c| c.abs() <= self.0.error)
    }

    /// The polynomial on both halves of the step (de Casteljau). Means of numbers off by `error` are off by that and their rounding, once in
    /// each round.
    pub(super) fn halves(&self) -> [Self; 2] {
        let len = self.0.len;
        let mut first = self.0.coefficients;
        let mut second = first;
        for (round, coefficient) in first.iter_mut().enumerate().take(len).skip(1) {
            for k in 0..len - round {
                second[k] = 0.5 * (second[k] + second[k + 1]);
            }
            *coefficient = second[0];
        }
        let error = self.0.error + (len - 1) as f64 * U * self.0.largest();
        [first, second].map(|half| Self(Rounded::new(half, len, error)))
    }
}

/// The conditions of a motion over a part of the step, rounded, in a unit in which no difference is 2 or more. `None` if
/// the differences are all 0, huge or tiny.
///
/// A difference has one rounding, its products with both times (which are exact unless the part is tiny) one or two each, their sum one.
pub(super) fn rounded<const M: usize, const N: usize>(
    motion: &PairMotion<M, N>,
    delta: f64,
    during: Interval,
) -> Option<Conditions<Rounded>> {
    let mut ends = Vec::with_capacity(M * N);
    for i in 0..M {
        for j in 0..N {
            ends.push([
                sub(motion.from_a[i], motion.from_b[j]),
                sub(motion.to_a[i], motion.to_b[j]),
            ]);
        }
    }
    let size = ends
        .as_flattened()
        .iter()
        .fold(0.0_f64, |size, p| size.max(largest(*p)));
    let is_in_range = size < RANGE && size > 1.0 / RANGE;
    if !is_in_range {
        return None;
    }
    let scale = inverse_power_of_two(size);
    let error = 16.0 * U * size * scale;
    let [first, last] = [during.start(), during.end()];
    let linear = |[from, to]: [f64; 2]| {
        let at = |time: f64| from * (1.0 - time) + to * time;
        let [from, to] = [at(first), at(last)];
        Rounded::new([from, to, 0.0, 0.0, 0.0, 0.0, 0.0], 2, error)
    };
    let corner = |[p, q]: &[[f64; 3]; 2]| [0, 1, 2].map(|k| linear([p[k] * scale, q[k] * scale]));
    let delta = delta * scale;
    let delta_squared = (delta > 0.0).then(|| {
        // (s + t)^2 delta^2, with s + t = 1
        let constant = Rounded::new([delta, delta, 0.0, 0.0, 0.0, 0.0, 0.0], 2, 0.0);
        constant.times(&constant)
    });
    Some(Conditions {
        corners: ends.iter().map(corner).collect(),
        delta_squared,
    })
}
