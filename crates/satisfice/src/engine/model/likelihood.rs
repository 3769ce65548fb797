//! How likely the observed values are under length scales and noise, and the scales that make them likeliest.

use super::factor::Factor;
use super::kernel::{Feature, covariances, matern_slope, squares};
use super::lanes::{LANES, Lanes, on_wide_vectors};
use super::points::Points;
use super::scales::Scales;
use pulp::NullaryFnOnce;

/// Scaled points, their factor, and the mean and variance that are likeliest given the scales.
#[derive(Debug, Clone, Default)]
pub(super) struct Fit {
    pub(super) points: Points,
    pub(super) factor: Factor,
    /// Mean of each output: generalised least squares.
    pub(super) mean: Vec<f64>,
    /// Variance of each output.
    pub(super) variance: Vec<f64>,
}

/// Variances below this count as this: all values are equal.
const LEAST_VARIANCE: f64 = 1e-300;

impl Fit {
    /// Scales the points and factors their covariance. Cost: n³ / 6.
    pub(super) fn factor(&mut self, scales: &Scales, inputs: &[&[f64]]) {
        on_wide_vectors(Refactor {
            fit: self,
            scales,
            inputs,
        });
    }

    #[inline(always)]
    fn refactor(&mut self, scales: &Scales, inputs: &[&[f64]]) {
        self.points.clear(scales.features());
        for input in inputs {
            self.points.push(scales.scaled_point(input).into_iter());
        }
        let variance = 1.0 + scales.noise();
        self.factor.clear();
        let mut rows: Vec<Lanes> = Vec::with_capacity(inputs.len() + LANES);
        for b in 0..self.points.blocks() {
            let (block, count) = (self.points.block(b), self.points.count(b));
            rows.clear();
            for j in 0..b * LANES + count {
                rows.push(covariances(&self.points.features, self.points.row(j), block));
            }
            for lane in 0..count {
                rows[b * LANES + lane][lane] = variance;
            }
            self.factor.push_block(&mut rows, count);
        }
    }

    /// Sets means and variances to their likeliest values. Returns `L⁻¹ (y - mean)` for each output.
    #[expect(clippy::cast_precision_loss, reason = "a number of points")]
    pub(super) fn moments(&mut self, values: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mut ones = vec![1.0; values[0].len()];
        self.factor.solve_one(&mut ones);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let weight = dot(&ones, &ones);
        self.mean.clear();
        self.variance.clear();
        let mut all = values.to_vec();
        for solved in &mut all {
            self.factor.solve_one(solved);
            let mean = dot(&ones, solved) / weight;
            for (z, one) in solved.iter_mut().zip(&ones) {
                *z -= mean * one;
            }
            self.mean.push(mean);
            self.variance
                .push((dot(solved, solved) / solved.len() as f64).max(LEAST_VARIANCE));
        }
        all
    }

    /// The negative logarithm of likelihood and prior up to a constant, and its gradient by the logarithms of the scales.
    /// Means and variances are profiled out. Cost: n³ / 2.
    ///
    /// Rasmussen, Williams 2006, Eq. 5.9, with `K` in units of the variance.
    #[expect(clippy::cast_precision_loss, reason = "a number of points")]
    fn evaluate(&mut self, scales: &Scales, inputs: &[&[f64]], values: &[Vec<f64>]) -> (f64, Vec<f64>) {
        self.factor(scales, inputs);
        let mut weights = self.moments(values);
        let mut loss = 0.0;
        for (weights, variance) in weights.iter_mut().zip(&self.variance) {
            self.factor.solve_transposed(weights);
            let root = variance.sqrt();
            weights.iter_mut().for_each(|weight| *weight /= root);
            loss += inputs.len() as f64 / 2.0 * variance.ln() + self.factor.log_determinant();
        }
        let mut gradient = vec![0.0; scales.logs.len()];
        on_wide_vectors(Slopes {
            fit: self,
            scales,
            weights: &weights,
            gradient: &mut gradient,
        });
        (loss + scales.prior(&mut gradient), gradient)
    }

    /// Adds `½ tr((K⁻¹ - w wᵀ) dK)` for each scale, `weights` being `w = K⁻¹ (y - mean) / σ`.
    #[inline(always)]
    fn slopes(&self, scales: &Scales, weights: &[Vec<f64>], gradient: &mut [f64]) {
        let n = self.points.len();
        let mut inverse: Vec<Vec<Lanes>> = Vec::with_capacity(self.points.blocks());
        for b in 0..self.points.blocks() {
            inverse.push(self.factor.inverse_columns(b));
        }
        let (by_length, by_noise) = gradient.split_at_mut(scales.axes());
        let features = &self.points.features;
        let mut sums = vec![[0.0; LANES]; features.len()];
        let mut trace = 0.0;
        for (b, columns) in inverse.iter().enumerate() {
            let (start, count, block) = (b * LANES, self.points.count(b), self.points.block(b));
            for i in start..n {
                let mut entry = product(&inverse[i / LANES], columns, i, start);
                if weights.len() > 1 {
                    entry.iter_mut().for_each(|entry| *entry *= weights.len() as f64);
                }
                for weights in weights {
                    for lane in 0..count {
                        entry[lane] -= weights[i] * weights[start + lane];
                    }
                }
                if i < start + count {
                    trace += entry[i - start];
                    // Each pair of points once; a point does not move from itself.
                    entry[i - start..].fill(0.0);
                }
                entry[count..].fill(0.0);
                let row = self.points.row(i);
                let slope = matern_slope(&squares(features, row, block));
                for lane in 0..LANES {
                    entry[lane] *= slope[lane];
                }
                for (((sum, feature), &x), y) in sums.iter_mut().zip(features).zip(row).zip(block) {
                    match feature {
                        Feature::Number { .. } => {
                            for lane in 0..LANES {
                                let d = x - y[lane];
                                sum[lane] += entry[lane] * d * d;
                            }
                        }
                        Feature::Category { .. } => {
                            let squares = feature.squares(x, y);
                            for lane in 0..LANES {
                                sum[lane] += entry[lane] * squares[lane];
                            }
                        }
                    }
                }
            }
        }
        for (feature, sum) in features.iter().zip(sums) {
            by_length[feature.axis()] += sum.iter().sum::<f64>();
        }
        by_noise[0] += scales.noise() * trace / 2.0;
    }
}

/// [`Fit::factor`] on wide vectors.
struct Refactor<'a> {
    fit: &'a mut Fit,
    scales: &'a Scales,
    inputs: &'a [&'a [f64]],
}

impl NullaryFnOnce for Refactor<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.fit.refactor(self.scales, self.inputs);
    }
}

/// [`Fit::slopes`] on wide vectors.
struct Slopes<'a> {
    fit: &'a Fit,
    scales: &'a Scales,
    weights: &'a [Vec<f64>],
    gradient: &'a mut [f64],
}

impl NullaryFnOnce for Slopes<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.fit.slopes(self.scales, self.weights, self.gradient);
    }
}

/// Row `i` of `K⁻¹ = L⁻ᵀ L⁻¹` in the columns of a block that starts at `start <= i`.
#[inline(always)]
fn product(of_row: &[Lanes], columns: &[Lanes], i: usize, start: usize) -> Lanes {
    let (own, lane) = (i / LANES * LANES, i % LANES);
    let mut sum = [0.0; LANES];
    for (a, b) in of_row[i - own..].iter().zip(&columns[i - start..]) {
        let a = a[lane];
        for (sum, b) in sum.iter_mut().zip(b) {
            *sum += a * b;
        }
    }
    sum
}

/// First step of a logarithm.
const FIRST_STEP: f64 = 0.4;
/// Longest step of a logarithm.
const LONGEST_STEP: f64 = 1.0;

/// A coordinate of iRprop⁻ (Igel, Hüsken 2003, doi 10.1016/S0925-2312(01)00700-7): steps along the sign of the slope. Their length
/// grows while the sign stays, and halves when it changes; that step and the next comparison are skipped.
#[derive(Debug, Clone)]
struct SignDescent {
    length: f64,
    slope: f64,
}

impl SignDescent {
    /// The step at a point with this slope.
    fn step(&mut self, slope: f64) -> f64 {
        let sign = slope * self.slope;
        if sign > 0.0 {
            self.length = (self.length * 1.2).min(LONGEST_STEP);
        } else if sign < 0.0 {
            self.length *= 0.5;
        }
        self.slope = if sign < 0.0 { 0.0 } else { slope };
        if self.slope == 0.0 {
            0.0
        } else {
            -self.length.copysign(self.slope)
        }
    }
}

/// Improves the scales by [`SignDescent`], unless it is to `stop`. Returns the best scales of all steps.
pub(super) fn likeliest(
    from: &Scales,
    inputs: &[&[f64]],
    values: &[Vec<f64>],
    steps: usize,
    stop: &dyn Fn() -> bool,
) -> Scales {
    let mut fit = Fit::default();
    let mut scales = from.clone();
    let mut best = (f64::INFINITY, from.clone());
    let mut descents = vec![
        SignDescent {
            length: FIRST_STEP,
            slope: 0.0,
        };
        scales.logs.len()
    ];
    for _ in 0..steps {
        if stop() {
            break;
        }
        let (loss, gradient) = fit.evaluate(&scales, inputs, values);
        if loss < best.0 {
            best = (loss, scales.clone());
        }
        for (k, (descent, slope)) in descents.iter_mut().zip(gradient).enumerate() {
            let step = descent.step(slope);
            if step != 0.0 {
                scales.shift(k, step);
            }
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::model::units::Shape;

    /// Points of a plane and values that change along the first axis only.
    fn data(n: usize) -> (Vec<Vec<f64>>, Vec<f64>) {
        let point = |i: usize| vec![(i as f64 * 0.754_877).fract(), (i as f64 * 0.569_840).fract()];
        let inputs: Vec<_> = (1..=n).map(point).collect();
        let values = inputs.iter().map(|x| (6.0 * x[0]).sin()).collect();
        (inputs, values)
    }

    #[test]
    fn the_gradient_agrees_with_differences() {
        let (mut inputs, values) = data(37);
        let other = values.iter().map(|y| y * y - 0.3 * y).collect();
        let values = [values, other];
        for (i, input) in inputs.iter_mut().enumerate() {
            input.extend([(i as f64 * 0.31).fract(), ((i % 3) as f64 + 0.5) / 3.0]);
        }
        let inputs: Vec<&[f64]> = inputs.iter().map(Vec::as_slice).collect();
        let mut scales = Scales::new(vec![Shape::Line, Shape::Line, Shape::Circle, Shape::Category]);
        scales.logs = vec![-0.4, 0.3, -0.2, 0.6, -4.0];
        let (_, gradient) = Fit::default().evaluate(&scales, &inputs, &values);
        for (k, slope) in gradient.iter().enumerate() {
            let at = |step: f64| {
                let mut moved = scales.clone();
                moved.logs[k] += step;
                Fit::default().evaluate(&moved, &inputs, &values).0
            };
            let difference = (at(1e-5) - at(-1e-5)) / 2e-5;
            assert!(
                (slope - difference).abs() < 1e-4 * (1.0 + slope.abs()),
                "{k}: {slope} {difference}"
            );
        }
    }

    /// The table of the paper for one coordinate: the sign stays, changes, rests once, and stays again.
    #[test]
    fn steps_are_those_of_irprop_minus() {
        let mut descent = SignDescent {
            length: FIRST_STEP,
            slope: 0.0,
        };
        let slopes = [2.0, 0.5, -1.0, -3.0, -0.1, 0.0, 4.0, f64::MIN_POSITIVE];
        let steps = slopes.map(|slope| descent.step(slope));
        let expected = [
            -0.4,              // the first
            -0.4 * 1.2,        // the same sign
            0.0,               // another sign: half the length, no step
            0.4 * 1.2 / 2.0,   // no comparison after a change of sign
            0.24 * 1.2,        // the same sign
            0.0,               // no slope
            -0.24 * 1.2,       // nothing to compare with
            -0.24 * 1.2 * 1.2, // the same sign, however flat
        ];
        for (step, expected) in steps.into_iter().zip(expected) {
            assert!((step - expected).abs() < 1e-15, "{steps:?}");
        }
        for _ in 0..40 {
            assert!(descent.step(1.0) >= -LONGEST_STEP);
        }
        assert_eq!(descent.length, LONGEST_STEP);
    }

    #[test]
    fn an_axis_without_effect_gets_a_long_scale() {
        let (inputs, values) = data(40);
        let values = [values];
        let inputs: Vec<&[f64]> = inputs.iter().map(Vec::as_slice).collect();
        let scales = likeliest(&Scales::new(vec![Shape::Line; 2]), &inputs, &values, 40, &|| {
            false
        });
        assert!(scales.length(1) > 3.0 * scales.length(0), "{scales:?}");
    }
}
