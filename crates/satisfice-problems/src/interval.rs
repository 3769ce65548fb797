//! Intervals with outward rounding: bounds of everything that f64 arithmetic can give inside a box.
//!
//! Sums, products, quotients and roots are rounded correctly by IEEE 754, so one step outwards contains the exact and the
//! rounded result. Of sin, cos, exp and ln the platform's errors are assumed to be below 4 units in the last place, which
//! holds for the common libraries (below 1 in glibc).

use core::f64::consts::PI;

/// A closed interval `[lower, upper]`; NaN at an end means "anything".
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub lower: f64,
    /// Upper end.
    pub upper: f64,
}

/// Units in the last place by which functions of the platform are widened.
const LIBRARY_ERROR: u32 = 4;

/// Beyond this, reducing an angle by a rounded pi says nothing.
const LARGEST_ANGLE: f64 = 1e9;

impl Interval {
    /// Everything.
    pub const ENTIRE: Self = Self {
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
    };

    /// `[lower, upper]`.
    #[must_use]
    pub const fn new(lower: f64, upper: f64) -> Self {
        Self { lower, upper }
    }

    /// Outward by one step; an interval with a NaN becomes everything.
    fn outward(lower: f64, upper: f64) -> Self {
        if lower.is_nan() || upper.is_nan() {
            return Self::ENTIRE;
        }
        Self::new(lower.next_down(), upper.next_up())
    }

    fn outward_by(mut self, steps: u32) -> Self {
        for _ in 0..steps {
            self = Self::outward(self.lower, self.upper);
        }
        self
    }

    /// The middle; finite where both ends are.
    #[must_use]
    pub fn middle(self) -> f64 {
        0.5 * self.lower + 0.5 * self.upper
    }

    /// Length, rounded up.
    #[must_use]
    pub fn width(self) -> f64 {
        (self.upper - self.lower).next_up()
    }

    /// Whether `x` lies inside.
    #[must_use]
    pub fn contains(self, x: f64) -> bool {
        self.lower <= x && x <= self.upper
    }

    fn is_anything(self) -> bool {
        self.lower.is_nan() || self.upper.is_nan()
    }

    /// The least absolute value inside.
    #[must_use]
    pub fn mignitude(self) -> f64 {
        if self.contains(0.0) || self.is_anything() {
            0.0
        } else {
            self.lower.abs().min(self.upper.abs())
        }
    }

    /// The greatest absolute value inside.
    #[must_use]
    pub fn magnitude(self) -> f64 {
        if self.is_anything() {
            return f64::INFINITY;
        }
        self.lower.abs().max(self.upper.abs())
    }

    /// The square, tighter than a product with itself.
    #[must_use]
    pub fn square(self) -> Self {
        let (least, greatest) = (self.mignitude(), self.magnitude());
        let squares = Self::outward(least * least, greatest * greatest);
        Self::new(squares.lower.max(0.0), squares.upper)
    }

    /// The square root of what is not negative; 0 stands for the rest.
    #[must_use]
    pub fn sqrt(self) -> Self {
        let roots = Self::outward(self.lower.max(0.0).sqrt(), self.upper.max(0.0).sqrt());
        Self::new(roots.lower.max(0.0), roots.upper)
    }

    /// e^x.
    #[must_use]
    pub fn exp(self) -> Self {
        let ends = Self::new(self.lower.exp(), self.upper.exp()).outward_by(LIBRARY_ERROR);
        Self::new(ends.lower.max(0.0), ends.upper)
    }

    /// The natural logarithm of what is positive.
    #[must_use]
    pub fn ln(self) -> Self {
        if self.upper.is_nan() || self.upper <= 0.0 {
            return Self::ENTIRE;
        }
        Self::new(self.lower.max(0.0).ln(), self.upper.ln()).outward_by(LIBRARY_ERROR)
    }

    /// cos x.
    #[must_use]
    pub fn cos(self) -> Self {
        self.wave(0.0, f64::cos)
    }

    /// sin x.
    #[must_use]
    pub fn sin(self) -> Self {
        self.wave(0.5, f64::sin)
    }

    /// A function that is 1 at `(phase + 2 k) pi`, -1 at `(phase + 2 k + 1) pi` and monotone between.
    fn wave(self, phase: f64, function: fn(f64) -> f64) -> Self {
        if self.magnitude() >= LARGEST_ANGLE || self.width() >= 2.0 * PI {
            return Self::new(-1.0, 1.0);
        }
        // Extrema whose place is in doubt by rounding count as inside.
        let doubt = |x: f64| 8.0 * f64::EPSILON * (1.0 + x.abs());
        let (from, to) = (self.lower / PI - phase, self.upper / PI - phase);
        let first = (from - doubt(from)).ceil();
        let last = (to + doubt(to)).floor();
        let (a, b) = (function(self.lower), function(self.upper));
        let mut ends = Self::new(a.min(b), a.max(b)).outward_by(LIBRARY_ERROR);
        for k in [first, first + 1.0] {
            if k <= last && k % 2.0 == 0.0 {
                ends.upper = 1.0;
            } else if k <= last {
                ends.lower = -1.0;
            }
        }
        Self::new(ends.lower.max(-1.0), ends.upper.min(1.0))
    }
}

impl core::ops::Add for Interval {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::outward(self.lower + other.lower, self.upper + other.upper)
    }
}

impl core::ops::Sub for Interval {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::outward(self.lower - other.upper, self.upper - other.lower)
    }
}

impl core::ops::Neg for Interval {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.upper, -self.lower)
    }
}

impl core::ops::Mul for Interval {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let products = [
            self.lower * other.lower,
            self.lower * other.upper,
            self.upper * other.lower,
            self.upper * other.upper,
        ];
        if products.iter().any(|product| product.is_nan()) {
            return Self::ENTIRE; // 0 * infinity
        }
        Self::outward(
            products.iter().copied().fold(f64::INFINITY, f64::min),
            products.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        )
    }
}

impl core::ops::Div for Interval {
    type Output = Self;
    /// Everything where the divisor contains 0.
    fn div(self, other: Self) -> Self {
        if other.mignitude() == 0.0 {
            return Self::ENTIRE;
        }
        let quotients = [
            self.lower / other.lower,
            self.lower / other.upper,
            self.upper / other.lower,
            self.upper / other.upper,
        ];
        if quotients.iter().any(|quotient| quotient.is_nan()) {
            return Self::ENTIRE;
        }
        Self::outward(
            quotients.iter().copied().fold(f64::INFINITY, f64::min),
            quotients.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every function at random points of random intervals, those that end on extrema included.
    #[test]
    fn images_contain_the_values_inside() {
        let mut rng = satisfice::SearchRng::new(3);
        for trial in 0..100_000 {
            let scale = [0.1, 1.0, 7.0, 1e4][trial % 4];
            let mut draw = || {
                let x = scale * (2.0 * rng.uniform() - 1.0);
                if trial % 5 == 0 {
                    (x * 2.0 / PI).round() * PI / 2.0
                } else {
                    x
                }
            };
            let (a, b, c, d) = (draw(), draw(), draw(), draw());
            let x = Interval::new(a.min(b), a.max(b));
            let y = Interval::new(c.min(d), c.max(d));
            let share = rng.uniform();
            let (p, q) = (
                (x.lower + share * (x.upper - x.lower)).min(x.upper),
                (y.lower + share * (y.upper - y.lower)).min(y.upper),
            );
            for (image, value) in [
                (x + y, p + q),
                (x - y, p - q),
                (x * y, p * q),
                (x / y, p / q),
                (-x, -p),
                (x.square(), p * p),
                (x.sin(), p.sin()),
                (x.cos(), p.cos()),
                (x.exp(), p.exp()),
            ] {
                assert!(
                    value.is_nan() || image.contains(value),
                    "{x:?} {y:?} at {p} {q}: {value} not in {image:?}"
                );
            }
            if p > 0.0 {
                assert!(x.ln().contains(p.ln()) && x.sqrt().contains(p.sqrt()));
            }
        }
    }

    #[test]
    fn extrema_inside_are_seen() {
        assert_eq!(Interval::new(0.1, 3.0).sin().upper, 1.0);
        assert_eq!(Interval::new(-0.1, 0.1).cos().upper, 1.0);
        assert_eq!(Interval::new(3.0, 3.2).cos().lower, -1.0);
        assert!(Interval::new(0.1, 0.2).cos().width() < 0.016);
        assert_eq!(Interval::new(0.0, f64::NAN).sin(), Interval::new(-1.0, 1.0));
    }
}
