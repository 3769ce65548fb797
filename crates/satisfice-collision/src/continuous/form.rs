//! Polynomials of the time as binary forms with integer coefficients.
//!
//! With `s = 1 - t` a polynomial of degree n is `sum_i c_i s^(n-i) t^i`. On `0 <= t <= 1` both variables are at least 0,
//! so the signs of the coefficients bound the sign of the form, and Descartes' rule counts its roots. The coefficients are
//! those of Bernstein's form times a binomial, so no division occurs.

use std::ops::{Add, Mul, Neg, Sub};

use dashu_int::{IBig, Sign};

use super::conditions::Polynomial;

/// A form of degree `len - 1`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Form(Vec<IBig>);

impl Form {
    pub(super) fn new(coefficients: Vec<IBig>) -> Self {
        Self(coefficients)
    }

    /// The linear function with these values at `t = 0` and `t = 1`.
    pub(super) fn linear(from: IBig, to: IBig) -> Self {
        Self(vec![from, to])
    }

    pub(super) fn coefficients(&self) -> &[IBig] {
        &self.0
    }

    pub(super) fn into_coefficients(self) -> Vec<IBig> {
        self.0
    }

    pub(super) fn is_zero(&self) -> bool {
        self.0.iter().all(IBig::is_zero)
    }

    /// The sign at `t = 0`: -1, 0 or 1.
    pub(super) fn sign_at_start(&self) -> i32 {
        sign(&self.0[0])
    }

    /// The sign at `t = 1`.
    pub(super) fn sign_at_end(&self) -> i32 {
        sign(&self.0[self.0.len() - 1])
    }

    /// The number of sign changes among the coefficients: the number of roots with `0 < t < 1`, or more by an even number.
    pub(super) fn sign_changes(&self) -> usize {
        let signs: Vec<i32> = self.0.iter().map(sign).filter(|&sign| sign != 0).collect();
        signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
    }

    /// Whether no coefficient is above 0: the form is above 0 nowhere in `[0, 1]`.
    pub(super) fn is_nowhere_positive(&self) -> bool {
        self.0.iter().all(|c| sign(c) <= 0)
    }

    /// Whether no coefficient is below 0 and one is above 0: the form is above 0 wherever `0 < t < 1`.
    pub(super) fn is_positive_inside(&self) -> bool {
        self.0.iter().all(|c| sign(c) >= 0) && !self.is_zero()
    }

    /// Times `(s + t)^power`, which is 1: the same function as a form of a higher degree.
    pub(super) fn raised(&self, power: usize) -> Self {
        let mut coefficients = self.0.clone();
        for _ in 0..power {
            coefficients.push(IBig::ZERO);
            for i in (1..coefficients.len()).rev() {
                let (low, high) = coefficients.split_at_mut(i);
                high[0] += &low[i - 1];
            }
        }
        Self(coefficients)
    }

    /// The form on the first half of the step, times a power of two.
    pub(super) fn first_half(&self) -> Self {
        let mut coefficients = self.0.clone();
        coefficients.reverse();
        shift_and_double(&mut coefficients);
        coefficients.reverse();
        Self(coefficients)
    }

    /// The form on the second half of the step, times the same power of two.
    pub(super) fn second_half(&self) -> Self {
        let mut coefficients = self.0.clone();
        shift_and_double(&mut coefficients);
        Self(coefficients)
    }
}

/// `p(x)` becomes `p(1 + 2 x)`.
fn shift_and_double(coefficients: &mut [IBig]) {
    let n = coefficients.len();
    for from in 0..n {
        for i in (from..n - 1).rev() {
            let (low, high) = coefficients.split_at_mut(i + 1);
            low[i] += &high[0];
        }
    }
    for (power, c) in coefficients.iter_mut().enumerate() {
        *c <<= power;
    }
}

pub(super) fn sign(x: &IBig) -> i32 {
    if x.is_zero() {
        0
    } else if x.sign() == Sign::Negative {
        -1
    } else {
        1
    }
}

impl Add for &Form {
    type Output = Form;

    fn add(self, other: Self) -> Form {
        assert_eq!(self.0.len(), other.0.len(), "sums are of one degree");
        Form(self.0.iter().zip(&other.0).map(|(a, b)| a + b).collect())
    }
}

impl Sub for &Form {
    type Output = Form;

    fn sub(self, other: Self) -> Form {
        assert_eq!(self.0.len(), other.0.len(), "differences are of one degree");
        Form(self.0.iter().zip(&other.0).map(|(a, b)| a - b).collect())
    }
}

impl Mul for &Form {
    type Output = Form;

    fn mul(self, other: Self) -> Form {
        let mut product = vec![IBig::ZERO; self.0.len() + other.0.len() - 1];
        for (i, a) in self.0.iter().enumerate() {
            for (j, b) in other.0.iter().enumerate() {
                product[i + j] += a * b;
            }
        }
        Form(product)
    }
}

impl Neg for Form {
    type Output = Form;

    fn neg(self) -> Form {
        Form(self.0.into_iter().map(|c| -c).collect())
    }
}

impl Polynomial for Form {
    fn plus(&self, other: &Self) -> Self {
        self + other
    }

    fn minus(&self, other: &Self) -> Self {
        self - other
    }

    fn times(&self, other: &Self) -> Self {
        self * other
    }

    fn negated(&self) -> Self {
        -self.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn form(coefficients: &[i32]) -> Form {
        Form(coefficients.iter().map(|&c| IBig::from(c)).collect())
    }

    #[test]
    fn halves_are_the_form_on_half_the_step() {
        // (1 - t) + 3 t = 1 + 2 t, squared: 1 at 0, 4 at 1/2, 9 at 1.
        let linear = form(&[1, 3]);
        let square = &linear * &linear;
        assert_eq!(square, form(&[1, 6, 9]));
        assert_eq!(square.first_half(), form(&[4, 16, 16]));
        assert_eq!(square.second_half(), form(&[16, 48, 36]));
    }

    #[test]
    fn raising_keeps_the_function() {
        let linear = form(&[-1, 2]);
        assert_eq!(linear.raised(2), form(&[-1, 0, 3, 2]));
        assert_eq!(linear.sign_changes(), 1);
        assert_eq!(linear.raised(2).sign_changes(), 1);
    }
}
