//! The (1+1) evolution strategy with covariance adaptation: a rotation-invariant local search, one candidate at a time.
//!
//! Igel, Suttorp, Hansen 2006, doi 10.1145/1143997.1144082, with the update of the Cholesky factor and of its inverse in
//! O(D^2) of Suttorp, Hansen, Igel 2009, doi 10.1007/s10994-009-5102-1; constants as published there. In many dimensions only the
//! variances are adapted, in O(D), at the rate of Ros, Hansen 2008, doi 10.1007/978-3-540-87700-4_30.

use crate::scalar::Real;
use crate::seed::SearchRng;

/// Success rate at which the step size stays.
const TARGET: f64 = 2.0 / 11.0;
/// Success rates above this stall the evolution path.
const STALL: f64 = 0.44;
const SMOOTHING: f64 = 1.0 / 12.0;
/// Longest step: one of many more widths would be reflected to where rounding puts it.
const LONGEST: f64 = 1024.0;

/// In more dimensions than this, A is diagonal: two full matrices would take 16 D^2 bytes and every step 2 D^2 operations.
const FULL: usize = 200;

/// The mutation distribution sigma A N(0, I), in units of the axes' widths.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(in crate::engine) struct Mutation {
    dimension: usize,
    pub(in crate::engine) sigma: f64,
    success: f64,
    path: Vec<f64>,
    /// A and its inverse, row by row; or A's diagonal, and nothing.
    factor: Vec<f64>,
    inverse: Vec<f64>,
    /// The last draw of N(0, I) and A times it.
    draw: Vec<f64>,
    step: Vec<f64>,
}

impl Mutation {
    /// Isotropic, with this step size. Memory is reused.
    pub(in crate::engine) fn reset(&mut self, dimension: usize, sigma: f64) {
        self.dimension = dimension;
        self.sigma = sigma;
        self.success = TARGET;
        for vector in [&mut self.path, &mut self.draw, &mut self.step] {
            vector.clear();
            vector.resize(dimension, 0.0);
        }
        self.factor.clear();
        self.inverse.clear();
        if dimension > FULL {
            self.factor.resize(dimension, 1.0);
            return;
        }
        for matrix in [&mut self.factor, &mut self.inverse] {
            matrix.resize(dimension * dimension, 0.0);
            for diagonal in matrix.iter_mut().step_by(dimension + 1) {
                *diagonal = 1.0;
            }
        }
    }

    /// Adds a mutation, `widths` times the draw, to a position. Cost: O(D^2), or O(D) with variances only.
    pub(in crate::engine) fn apply<S: Real>(
        &mut self,
        rng: &mut SearchRng,
        widths: impl Iterator<Item = S>,
        position: &mut [S],
    ) {
        for z in &mut self.draw {
            *z = rng.normal();
        }
        if self.is_diagonal() {
            for ((step, a), z) in self.step.iter_mut().zip(&self.factor).zip(&self.draw) {
                *step = a * z;
            }
        } else {
            for (row, step) in self.factor.chunks_exact(self.dimension).zip(&mut self.step) {
                *step = row.iter().zip(&self.draw).map(|(a, z)| a * z).sum();
            }
        }
        for ((x, width), &step) in position.iter_mut().zip(widths).zip(&self.step) {
            *x = *x + width * S::of(self.sigma * step);
        }
    }

    /// Whether restored parts are of so many dimensions.
    pub(in crate::engine) fn fits(&self, dimension: usize) -> bool {
        let (factor, inverse) = if dimension > FULL {
            (dimension, 0)
        } else {
            (dimension * dimension, dimension * dimension)
        };
        let vectors = [&self.path, &self.draw, &self.step];
        self.dimension == dimension
            && vectors.iter().all(|vector| vector.len() == dimension)
            && (self.factor.len(), self.inverse.len()) == (factor, inverse)
    }

    fn is_diagonal(&self) -> bool {
        self.dimension > FULL
    }

    /// Adapts to whether the last mutation was a success. Cost: that of [`apply`](Self::apply) for a success, O(1) else.
    pub(in crate::engine) fn adapt(&mut self, succeeded: bool) {
        let n = self.dimension as f64;
        self.success += SMOOTHING * (f64::from(u8::from(succeeded)) - self.success);
        self.sigma *= ((self.success - TARGET) / ((1.0 - TARGET) * (1.0 + n / 2.0))).exp();
        // On a plateau every step succeeds.
        self.sigma = self.sigma.min(LONGEST);
        if !succeeded {
            return;
        }
        let faster = if self.is_diagonal() { (n + 2.0) / 3.0 } else { 1.0 };
        let (path_rate, rate) = (2.0 / (n + 2.0), faster * 2.0 / (n * n + 6.0));
        let keep = if self.success < STALL {
            let weight = (path_rate * (2.0 - path_rate)).sqrt();
            for (p, s) in self.path.iter_mut().zip(&self.step) {
                *p = (1.0 - path_rate) * *p + weight * s;
            }
            1.0 - rate
        } else {
            for p in &mut self.path {
                *p *= 1.0 - path_rate;
            }
            1.0 - rate + rate * path_rate * (2.0 - path_rate)
        };
        if self.is_diagonal() {
            for (a, p) in self.factor.iter_mut().zip(&self.path) {
                *a = (keep * *a * *a + rate * p * p).sqrt();
            }
        } else {
            self.update_factor(keep, rate);
        }
    }

    /// A A^T := keep A A^T + rate p p^T, in A and in its inverse.
    fn update_factor(&mut self, keep: f64, rate: f64) {
        let n = self.dimension;
        // w = A^-1 p; the draw's memory is free until the next mutation.
        for (row, w) in self.inverse.chunks_exact(n).zip(&mut self.draw) {
            *w = row.iter().zip(&self.path).map(|(a, p)| a * p).sum();
        }
        let square: f64 = self.draw.iter().map(|w| w * w).sum();
        if !(square > 1e-24 && square.is_finite()) {
            return;
        }
        let root = (1.0 + rate / keep * square).sqrt();
        let (a, b) = (keep.sqrt(), keep.sqrt() / square * (root - 1.0));
        for (row, &p) in self.factor.chunks_exact_mut(n).zip(&self.path) {
            for (x, &w) in row.iter_mut().zip(&self.draw) {
                *x = a * *x + b * p * w;
            }
        }
        // w^T A^-1, into the step's memory.
        self.step.fill(0.0);
        for (row, &w) in self.inverse.chunks_exact(n).zip(&self.draw) {
            for (s, &x) in self.step.iter_mut().zip(row) {
                *s += w * x;
            }
        }
        let (a, b) = (1.0 / keep.sqrt(), (1.0 - 1.0 / root) / (keep.sqrt() * square));
        for (row, &w) in self.inverse.chunks_exact_mut(n).zip(&self.draw) {
            for (x, &s) in row.iter_mut().zip(&self.step) {
                *x = a * *x - b * w * s;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Evaluations to reduce F below 1e-10 from the distance of 1.
    fn evaluations(fitness: impl Fn(&[f64]) -> f64, dimension: usize) -> usize {
        let mut rng = SearchRng::new(1);
        let mut mutation = Mutation::default();
        mutation.reset(dimension, 0.3);
        let mut x = vec![1.0; dimension];
        let mut best = fitness(&x);
        for evaluation in 1..200_000 {
            let mut y = x.clone();
            mutation.apply(&mut rng, core::iter::repeat(1.0), &mut y);
            let f = fitness(&y);
            mutation.adapt(f <= best);
            if f <= best {
                (x, best) = (y, f);
            }
            if best < 1e-10 {
                return evaluation;
            }
        }
        panic!("not converged: {best}")
    }

    #[test]
    fn restored_parts_fit_their_dimensions() {
        for dimension in [2, FULL, FULL + 1] {
            let mut mutation = Mutation::default();
            mutation.reset(dimension, 0.3);
            assert!(mutation.fits(dimension) && !mutation.fits(dimension + 1));
            mutation.dimension = 0;
            assert!(!mutation.fits(dimension));
        }
    }

    #[test]
    fn a_rotated_ridge_of_condition_1e6_costs_little_more_than_a_sphere() {
        let sphere = evaluations(|x| x.iter().map(|x| x * x).sum(), 4);
        // Axes of the ellipsoid along (1,1,1,1), (1,-1,0,0), (1,1,-2,0), (1,1,1,-3).
        let ridge = evaluations(
            |x| {
                let across = [
                    x[0] - x[1],
                    x[0] + x[1] - 2.0 * x[2],
                    x[0] + x[1] + x[2] - 3.0 * x[3],
                ];
                (x[0] + x[1] + x[2] + x[3]).powi(2) + 1e6 * across.iter().map(|a| a * a).sum::<f64>()
            },
            4,
        );
        assert!(sphere < 600 && ridge < 6 * sphere, "{sphere} {ridge}");
    }

    /// Ros, Hansen 2008: the variances of the full update, at (n + 2) / 3 times its rate.
    #[test]
    fn many_dimensions_adapt_their_variances() {
        let n = FULL + 1;
        let mut mutation = Mutation::default();
        mutation.reset(n, 1.0);
        let mut y = vec![0.0_f64; n];
        mutation.apply(&mut SearchRng::new(9), core::iter::repeat(1.0), &mut y);
        mutation.adapt(true);
        let d = n as f64;
        let cc = 2.0 / (d + 2.0);
        let ccov = 2.0 / (d * d + 6.0) * (d + 2.0) / 3.0;
        for (a, y) in mutation.factor.iter().zip(&y) {
            let expected = (1.0 - ccov) + ccov * cc * (2.0 - cc) * y * y;
            approx::assert_relative_eq!(a * a, expected, max_relative = 1e-12);
        }
        assert_eq!((mutation.factor.len(), mutation.inverse.len()), (n, 0));
    }

    #[test]
    fn the_inverse_stays_the_inverse() {
        let (mut rng, mut mutation) = (SearchRng::new(3), Mutation::default());
        mutation.reset(3, 1.0);
        let mut x = [0.0_f64; 3];
        for i in 0..500 {
            mutation.apply(&mut rng, core::iter::repeat(1.0), &mut x);
            mutation.adapt(i % 3 == 0);
        }
        for i in 0..3 {
            for j in 0..3 {
                let entry: f64 = (0..3)
                    .map(|k| mutation.factor[3 * i + k] * mutation.inverse[3 * k + j])
                    .sum();
                approx::assert_abs_diff_eq!(entry, f64::from(u8::from(i == j)), epsilon = 1e-8);
            }
        }
    }

    /// Igel, Suttorp, Hansen 2006: p := (1 - c) p + c [success], sigma := sigma exp((p - pt) / (d (1 - pt))), with c = 1/12,
    /// pt = 2/11, d = 1 + n/2.
    #[test]
    fn the_step_size_follows_the_success_rate() {
        let mut mutation = Mutation::default();
        mutation.reset(4, 0.5);
        let (mut rate, mut sigma): (f64, f64) = (2.0 / 11.0, 0.5);
        for success in [false, true, true, false, false, true] {
            let mut position = [0.0_f64; 4];
            mutation.apply(&mut SearchRng::new(1), core::iter::repeat(1.0), &mut position);
            mutation.adapt(success);
            rate = (11.0 * rate + f64::from(u8::from(success))) / 12.0;
            sigma *= ((rate - 2.0 / 11.0) / (3.0 * (9.0 / 11.0))).exp();
            approx::assert_relative_eq!(mutation.success, rate, max_relative = 1e-13);
            approx::assert_relative_eq!(mutation.sigma, sigma, max_relative = 1e-13);
        }
    }

    /// A first success below the stall threshold: C := (1 - ccov) C + ccov p p^T with p = sqrt(cc (2 - cc)) y, where y is the
    /// step, cc = 2 / (n + 2) and ccov = 2 / (n^2 + 6).
    #[test]
    fn the_covariance_takes_up_the_path() {
        let mut mutation = Mutation::default();
        mutation.reset(2, 1.0);
        let mut y = [0.0_f64; 2];
        mutation.apply(&mut SearchRng::new(9), core::iter::repeat(1.0), &mut y);
        mutation.adapt(true);
        let square = 0.5 * (2.0 - 0.5); // cc (2 - cc)
        let ccov = 0.2;
        let a = &mutation.factor;
        for i in 0..2 {
            for j in 0..2 {
                let covariance = a[2 * i] * a[2 * j] + a[2 * i + 1] * a[2 * j + 1];
                let identity = f64::from(u8::from(i == j));
                let expected = (1.0 - ccov) * identity + ccov * square * y[i] * y[j];
                approx::assert_relative_eq!(covariance, expected, max_relative = 1e-12, epsilon = 1e-12);
            }
        }
    }
}
