//! Which components are those of a hit.

use core::f64::consts::FRAC_2_PI;

use super::record::Record;

/// Square of the deviation of a normal weight with the mass of an interval, in squares of half its width.
const WIDTH: f64 = FRAC_2_PI;
/// Values that differ by less than this share are the same: they may be rounded to single precision, and sums in another order.
const SAME: f64 = 1e-4;

/// What of the components decides whether a point is a hit, each of them divided by its limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(super) enum Norm {
    /// Each magnitude is at most 1. F may ask for more, but the components do not tell.
    Greatest,
    /// The sum of the squares is at most 1.
    Euclidean,
}

impl Norm {
    /// The Euclidean norm, if F is that or its square, in units of `delta`, at all of these points.
    pub(super) fn of(record: &Record, known: &[usize], delta: f64) -> Self {
        // The norm, and its square.
        let (mut may_be, mut count) = ([true; 2], 0);
        for &i in known {
            let squares: f64 = record.components(i).iter().map(|x| x * x).sum();
            let share = record.values[i] / delta;
            if squares.is_finite() && share.is_finite() {
                let is = |norm: f64| (share - norm).abs() <= SAME * norm;
                may_be = [may_be[0] && is(squares.sqrt()), may_be[1] && is(squares)];
                count += 1;
            }
        }
        if count > 0 && record.component_count() > 1 && may_be != [false; 2] {
            Self::Euclidean
        } else {
            Self::Greatest
        }
    }
}

/// The components of hits, in the scale in which they are learned.
#[derive(Debug, Clone)]
pub(super) struct ComponentLimits {
    norm: Norm,
    /// Largest magnitude of each component at a hit.
    values: Vec<f64>,
}

impl Default for ComponentLimits {
    fn default() -> Self {
        Self::new(Norm::Greatest, Vec::new())
    }
}

impl ComponentLimits {
    /// For the inverse hyperbolic sines of components that are, at a hit, at most these.
    pub(super) fn new(norm: Norm, values: Vec<f64>) -> Self {
        Self { norm, values }
    }

    /// Whether F itself is modelled.
    pub(super) fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Square of the deviation of the weight along component `k`.
    pub(super) fn square(&self, k: usize) -> f64 {
        WIDTH * self.values[k] * self.values[k]
    }

    /// The logarithm of the probability of a hit, for components with these means and variances: the expectation of a normal weight as wide
    /// as the limits, which has a closed form. Where a prediction is nearly certain, the weight has a tail that hits do not have: a sure miss
    /// a few limits away from a known root, or in a corner of the limits outside the ball of hits, would seem better than a point of which
    /// little is known. Chernoff's bound on the probability of a hit has no such tail, and counts where it is lower.
    pub(super) fn score(&self, means: &[f64], variances: &[f64]) -> f64 {
        let (mut value, mut distance, mut tail) = (0.0, 0.0, Tail::default());
        for (k, (mean, variance)) in means.iter().zip(variances).enumerate() {
            let (square, limit) = (self.square(k), self.values[k]);
            let sum = variance + square;
            value += 0.5 * (square / sum).ln();
            let beyond = (mean.abs() - limit).max(0.0);
            distance += (mean * mean / sum).max(beyond * beyond / variance);
            if self.norm == Norm::Euclidean {
                tail.add(*mean, *variance, limit);
            }
        }
        value - 0.5 * distance.max(tail.distance())
    }
}

/// How far the means of components are beyond the ball of hits, along the line to its centre.
#[derive(Debug, Clone, Copy, Default)]
struct Tail {
    squares: f64,
    /// Variance along that line, times `squares`.
    spread: f64,
}

impl Tail {
    /// Adds a component, of which the inverse hyperbolic sine is learned.
    fn add(&mut self, mean: f64, variance: f64, limit: f64) {
        let unit = 1.0 / sinh(limit);
        let sinh = sinh(mean);
        let component = unit * sinh;
        self.squares += component * component;
        self.spread += component * component * variance * unit * unit * (1.0 + sinh * sinh);
    }

    /// Squared, in deviations.
    fn distance(self) -> f64 {
        let beyond = self.squares.sqrt() - 1.0;
        if beyond > 0.0 {
            beyond * beyond * self.squares / self.spread
        } else {
            0.0
        }
    }
}

/// The hyperbolic sine up to a thousandth of its argument where that is at most 1; farther out, less, which is enough: no hit is there.
fn sinh(x: f64) -> f64 {
    let square = x * x;
    x * (1.0 + square / 6.0 * (1.0 + square / 20.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::model::record::PointKind;

    /// The normal weight has the mass of the box, and its expectation under a normal distribution is the integral.
    #[test]
    fn a_box_is_scored_by_the_integral_of_a_weight() {
        let (mean, variance, limit): (f64, f64, f64) = (0.7, 0.09, 0.2);
        let square = FRAC_2_PI * limit * limit;
        let (mut mass, mut expected) = (0.0, 0.0);
        for i in -40_000..40_000 {
            let x = f64::from(i) * 1e-4;
            let weight = (-x * x / 2.0 / square).exp();
            mass += weight * 1e-4;
            let density =
                (-(x - mean).powi(2) / 2.0 / variance).exp() / (core::f64::consts::TAU * variance).sqrt();
            expected += weight * density * 1e-4;
        }
        approx::assert_relative_eq!(mass, 2.0 * limit, max_relative = 1e-6);
        let score = |count: usize| {
            let limits = ComponentLimits::new(Norm::Greatest, vec![limit; count]);
            limits.score(&vec![mean; count], &vec![variance; count])
        };
        approx::assert_relative_eq!(score(1).exp(), expected, max_relative = 1e-6);
        approx::assert_relative_eq!(score(2), 2.0 * score(1));
    }

    /// A point that is three limits away for certain is worse than one of which little is known.
    #[test]
    fn a_certain_miss_beside_a_root_is_no_candidate() {
        let limit = 0.003;
        for norm in [Norm::Greatest, Norm::Euclidean] {
            let limits = ComponentLimits::new(norm, vec![limit]);
            let score = |mean: f64, variance: f64| limits.score(&[mean], &[variance]);
            let (certain, unknown) = (score(0.01, 1e-7), score(0.5, 0.1));
            assert!(unknown > certain);
            // Chernoff: P(|y| < limit) <= exp(-(0.01 - limit)² / 2 / variance).
            assert!(certain <= -(0.007_f64.powi(2)) / 2.0 / 1e-7 * 0.999);
            let within = score(0.002, 1e-7);
            assert!(within > unknown && within > -2.5);
        }
    }

    /// Twelve components of half their limits are within the box, and the sum of their squares is 3: for certain no hit. Where little is
    /// certain, both norms ask for the same.
    #[test]
    fn a_corner_of_the_box_is_outside_the_ball() {
        let score = |norm, mean: f64, variance: f64| {
            ComponentLimits::new(norm, vec![0.01; 12]).score(&[mean; 12], &[variance; 12])
        };
        assert!(score(Norm::Greatest, 0.005, 1e-10) > -3.0);
        assert!(score(Norm::Euclidean, 0.005, 1e-10) < -1e4);
        for (mean, variance) in [(0.0028, 1e-10), (0.005, 1e-4)] {
            assert_eq!(
                score(Norm::Euclidean, mean, variance),
                score(Norm::Greatest, mean, variance)
            );
        }
    }

    #[test]
    fn the_norm_is_what_f_is_at_all_points() {
        let norm = |f: &dyn Fn(&[f64]) -> f64, count: usize| {
            let mut record = Record::default();
            record.clear(1);
            for i in 0..8_u32 {
                let all: Vec<f64> = (0..count)
                    .map(|k| (f64::from(i) - 3.5) * 0.4 + k as f64)
                    .collect();
                record.add(&[f64::from(i)], 0.01 * f(&all), PointKind::Miss);
                record.add_components(&all);
            }
            // What has no number says nothing.
            record.add(&[0.5], f64::NAN, PointKind::Miss);
            record.add_components(&vec![f64::NAN; count]);
            Norm::of(&record, &(0..9).collect::<Vec<_>>(), 0.01)
        };
        let squares = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
        assert_eq!(norm(&squares, 3), Norm::Euclidean);
        assert_eq!(norm(&|x| squares(x).sqrt(), 3), Norm::Euclidean);
        assert_eq!(
            norm(&|x| x.iter().fold(0.0, |most, x| x.abs().max(most)), 3),
            Norm::Greatest
        );
        assert_eq!(norm(&|x| x.iter().map(|x| x.abs()).sum(), 2), Norm::Greatest);
        assert_eq!(
            norm(
                &|x| if squares(x) > 2.0 {
                    squares(x)
                } else {
                    squares(x).sqrt()
                },
                2
            ),
            Norm::Greatest
        );
        assert_eq!(norm(&|_| f64::NAN, 2), Norm::Greatest);
        // A single component is its own greatest.
        assert_eq!(norm(&squares, 1), Norm::Greatest);
    }
}
