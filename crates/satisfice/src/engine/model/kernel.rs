//! Matérn covariance of smoothness 5/2.

use super::lanes::{LANES, Lanes, exp_of_minus};

/// Covariances at squared distances in length scales: `(1 + s + s²/3) exp(-s)` with `s = √(5 square)`.
///
/// Rasmussen, Williams 2006, Gaussian Processes for Machine Learning, Eq. 4.17.
#[inline(always)]
pub(super) fn matern(squares: &Lanes) -> Lanes {
    let s = roots(squares);
    let mut values = exp_of_minus(&s);
    for (value, s) in values.iter_mut().zip(s) {
        *value *= 1.0 + s + s * s * (1.0 / 3.0);
    }
    values
}

/// What [`matern`] grows by with the logarithm of the length scale of one axis, divided by the squared distance along that
/// axis: `5/3 (1 + s) exp(-s)`.
#[inline(always)]
pub(super) fn matern_slope(squares: &Lanes) -> Lanes {
    let s = roots(squares);
    let mut values = exp_of_minus(&s);
    for (value, s) in values.iter_mut().zip(s) {
        *value *= (5.0 / 3.0) * (1.0 + s);
    }
    values
}

#[inline(always)]
fn roots(squares: &Lanes) -> Lanes {
    let mut s = [0.0; LANES];
    for (s, square) in s.iter_mut().zip(squares) {
        *s = (5.0 * square).sqrt();
    }
    s
}

/// One of the coordinates in which points are compared, and the axis that it is of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Feature {
    /// A number in length scales.
    Number { axis: usize },
    /// A category: equal ones are 0 apart, and any two others have the same squared distance, `1 / length²`.
    Category { axis: usize, square: f64 },
}

impl Feature {
    pub(super) fn axis(self) -> usize {
        match self {
            Self::Number { axis } | Self::Category { axis, .. } => axis,
        }
    }

    /// Squared distances of one coordinate to those of a block.
    #[inline(always)]
    pub(super) fn squares(self, x: f64, lanes: &Lanes) -> Lanes {
        match self {
            Self::Number { .. } => lanes.map(|y| (x - y) * (x - y)),
            Self::Category { square, .. } => lanes.map(|y| if x == y { 0.0 } else { square }),
        }
    }
}

/// Squared distances of one point to a block of points, `block[j]` holding feature `j` of each.
#[inline(always)]
pub(super) fn squares(features: &[Feature], point: &[f64], block: &[Lanes]) -> Lanes {
    let mut sum = [0.0; LANES];
    for ((feature, &x), lanes) in features.iter().zip(point).zip(block) {
        let squares = feature.squares(x, lanes);
        for (sum, square) in sum.iter_mut().zip(squares) {
            *sum += square;
        }
    }
    sum
}

/// Covariances of one point with a block of points.
#[inline(always)]
pub(super) fn covariances(features: &[Feature], point: &[f64], block: &[Lanes]) -> Lanes {
    matern(&squares(features, point, block))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(square: f64) -> f64 {
        matern(&[square; LANES])[7]
    }

    #[test]
    fn covariance_falls_from_one_to_zero() {
        assert_eq!(at(0.0), 1.0);
        // (1 + √5 + 5/3) exp(-√5)
        approx::assert_relative_eq!(at(1.0), 0.523_994_108_831_820_3, max_relative = 1e-12);
        assert!(at(1e6) < 1e-200);
    }

    #[test]
    fn the_slope_is_the_derivative_by_the_logarithm_of_a_length_scale() {
        // Squared distance 0.7 along this axis and 0.2 along the others.
        let scaled = |log_scale: f64| at(0.2 + 0.7 / (2.0 * log_scale).exp());
        let h = 1e-5;
        let difference = (scaled(h) - scaled(-h)) / (2.0 * h);
        let slope = matern_slope(&[0.9; LANES])[0] * 0.7;
        approx::assert_relative_eq!(slope, difference, max_relative = 1e-8);
    }
}
