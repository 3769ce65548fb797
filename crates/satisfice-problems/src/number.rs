//! One arithmetic for real numbers, intervals and derivatives, so that a system is written once.

use core::ops::{Add, Div, Mul, Neg, Sub};

use satisfice::interval::{EnclosureOps, Interval, IntervalOps, widened};

/// Error bound of the standard library's elementary functions, in units in the last place.
const LIBRARY_ERROR: u32 = 2;

/// The numbers of equations. A system that is generic over this trait is evaluated in `f64`, bounded in [`Interval`] and
/// differentiated in [`Dual`].
pub trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// A constant.
    fn constant(value: f64) -> Self;
    /// x^2.
    fn square(self) -> Self;
    /// sin x, x in radians.
    fn sin(self) -> Self;
    /// cos x, x in radians.
    fn cos(self) -> Self;
    /// e^x.
    fn exp(self) -> Self;
    /// The natural logarithm.
    fn ln(self) -> Self;
    /// The square root.
    fn sqrt(self) -> Self;

    /// A multiple.
    fn times(self, factor: f64) -> Self {
        self * Self::constant(factor)
    }
    /// A sum with a constant.
    fn plus(self, summand: f64) -> Self {
        self + Self::constant(summand)
    }
    /// x^n by squaring, for n >= 1.
    fn power(self, n: u32) -> Self {
        if n <= 1 {
            self
        } else if n.is_multiple_of(2) {
            self.power(n / 2).square()
        } else {
            self * self.power(n - 1)
        }
    }
}

impl Number for f64 {
    fn constant(value: f64) -> Self {
        value
    }
    fn square(self) -> Self {
        self * self
    }
    fn sin(self) -> Self {
        Self::sin(self)
    }
    fn cos(self) -> Self {
        Self::cos(self)
    }
    fn exp(self) -> Self {
        Self::exp(self)
    }
    fn ln(self) -> Self {
        Self::ln(self)
    }
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }
}

impl Number for Interval {
    fn constant(value: f64) -> Self {
        <Self as IntervalOps>::new(value, value)
    }
    fn square(self) -> Self {
        self.sqr()
    }
    fn sin(self) -> Self {
        widened(EnclosureOps::sin(self), LIBRARY_ERROR)
    }
    fn cos(self) -> Self {
        widened(EnclosureOps::cos(self), LIBRARY_ERROR)
    }
    fn exp(self) -> Self {
        widened(EnclosureOps::exp(self), LIBRARY_ERROR)
    }
    fn ln(self) -> Self {
        widened(EnclosureOps::log(self), LIBRARY_ERROR)
    }
    fn sqrt(self) -> Self {
        EnclosureOps::sqrt(self)
    }
}

/// A value with its derivative along one direction: forward differentiation. Over [`Interval`] it bounds both.
///
/// ```
/// use satisfice_problems::number::{Dual, Number};
/// let x = Dual { value: 3.0, slope: 1.0 };
/// assert_eq!(x.square().slope, 6.0); // d/dx x^2 = 2 x
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual<N> {
    /// The value.
    pub value: N,
    /// The derivative.
    pub slope: N,
}

impl<N: Number> Dual<N> {
    /// By the chain rule.
    fn chain(value: N, outer: N, inner: N) -> Self {
        Self {
            value,
            slope: outer * inner,
        }
    }
}

impl<N: Number> Add for Dual<N> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            slope: self.slope + other.slope,
        }
    }
}

impl<N: Number> Sub for Dual<N> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            slope: self.slope - other.slope,
        }
    }
}

impl<N: Number> Mul for Dual<N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            slope: self.slope * other.value + self.value * other.slope,
        }
    }
}

impl<N: Number> Div for Dual<N> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self {
            value,
            slope: (self.slope - value * other.slope) / other.value,
        }
    }
}

impl<N: Number> Neg for Dual<N> {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            value: -self.value,
            slope: -self.slope,
        }
    }
}

impl<N: Number> Number for Dual<N> {
    fn constant(value: f64) -> Self {
        Self {
            value: N::constant(value),
            slope: N::constant(0.0),
        }
    }
    fn square(self) -> Self {
        Self::chain(self.value.square(), self.value.times(2.0), self.slope)
    }
    fn sin(self) -> Self {
        Self::chain(self.value.sin(), self.value.cos(), self.slope)
    }
    fn cos(self) -> Self {
        Self::chain(self.value.cos(), -self.value.sin(), self.slope)
    }
    fn exp(self) -> Self {
        let value = self.value.exp();
        Self::chain(value, value, self.slope)
    }
    fn ln(self) -> Self {
        Self::chain(self.value.ln(), N::constant(1.0) / self.value, self.slope)
    }
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        Self::chain(value, N::constant(0.5) / value, self.slope)
    }
    fn times(self, factor: f64) -> Self {
        Self {
            value: self.value.times(factor),
            slope: self.slope.times(factor),
        }
    }
    fn plus(self, summand: f64) -> Self {
        Self {
            value: self.value.plus(summand),
            slope: self.slope,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn sample<N: Number>(x: N) -> N {
        (x.sin() * x.exp() / x.plus(2.0).sqrt() - x.power(5).times(0.3)).cos() + x.plus(3.0).ln()
            - (-x).square()
    }

    #[test]
    fn slopes_are_those_of_difference_quotients() {
        for x in [-0.9, 0.1, 0.7, 1.3] {
            let h = 1e-5;
            let quotient = (sample(x + h) - sample(x - h)) / (2.0 * h);
            let dual = sample(Dual { value: x, slope: 1.0 });
            assert_relative_eq!(dual.slope, quotient, max_relative = 1e-8);
            assert_relative_eq!(dual.value, sample(x));
            let interval = sample(Dual {
                value: <Interval as IntervalOps>::new(x - 1e-3, x + 1e-3),
                slope: Interval::constant(1.0),
            });
            let inside = |range: Interval, value: f64| range.inf() <= value && value <= range.sup();
            assert!(inside(interval.slope, dual.slope) && inside(interval.value, dual.value));
        }
    }
}
