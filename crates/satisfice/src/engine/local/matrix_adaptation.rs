//! The matrix adaptation evolution strategy: a rotation-invariant local search by generations.
//!
//! Beyer, Sendhoff 2017, doi 10.1109/TEVC.2017.2680320, with weights and rates as published there. In many dimensions only the
//! variances are adapted, in O(D), at the faster rates of Ros, Hansen 2008, doi 10.1007/978-3-540-87700-4_30.

use core::mem;

use crate::seed::SearchRng;

/// In more dimensions than this, M is diagonal: a full matrix would take 8 D^2 bytes and every sample D^2 operations.
const FULL: usize = 200;

/// The distribution m + sigma M N(0, I) of a generation, and its samples. Coordinates are shares of the axes' widths.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Distribution {
    pub(super) mean: Vec<f64>,
    sigma: f64,
    /// Row by row; or the diagonal.
    matrix: Vec<f64>,
    path: Vec<f64>,
    /// Of the better half, which sum to 1.
    weights: Vec<f64>,
    /// Draws of N(0, I), and M times them, sample after sample.
    draws: Vec<f64>,
    steps: Vec<f64>,
    fitness: Vec<f64>,
    /// Memory of one adaptation: the samples from the best on, and the mean draw of the better half.
    #[serde(skip)]
    order: Vec<usize>,
    #[serde(skip)]
    centre: Vec<f64>,
}

/// The usual size of a generation.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a few dozens"
)]
pub(super) fn usual_size(dimension: usize) -> usize {
    4 + (3.0 * (dimension as f64).ln()) as usize
}

impl Distribution {
    /// Isotropic. Memory is reused.
    pub(super) fn reset(&mut self, mean: &[f64], sigma: f64, size: usize) {
        let n = mean.len();
        self.mean.clear();
        self.mean.extend_from_slice(mean);
        self.sigma = sigma;
        self.path.clear();
        self.path.resize(n, 0.0);
        self.matrix.clear();
        if n > FULL {
            self.matrix.resize(n, 1.0);
        } else {
            self.matrix.resize(n * n, 0.0);
            for diagonal in self.matrix.iter_mut().step_by(n + 1) {
                *diagonal = 1.0;
            }
        }
        let parents = (size / 2).max(1);
        let middle = (size as f64 + 1.0) / 2.0;
        self.weights.clear();
        self.weights
            .extend((1..=parents).map(|rank| middle.ln() - (rank as f64).ln()));
        let sum: f64 = self.weights.iter().sum();
        for weight in &mut self.weights {
            *weight /= sum;
        }
        self.draws.clear();
        self.steps.clear();
        self.fitness.clear();
    }

    fn is_diagonal(&self) -> bool {
        self.mean.len() > FULL
    }

    /// How many samples this generation has.
    pub(super) fn sampled(&self) -> usize {
        self.draws.len() / self.mean.len()
    }

    /// How many of them have been told.
    pub(super) fn told(&self) -> usize {
        self.fitness.len()
    }

    /// Draws the next sample of this generation. Cost: O(D^2), or O(D) with variances only.
    pub(super) fn sample(&mut self, rng: &mut SearchRng) -> impl Iterator<Item = f64> {
        let n = self.mean.len();
        let start = self.draws.len();
        self.draws.extend((0..n).map(|_| rng.normal()));
        let draw = &self.draws[start..];
        if self.is_diagonal() {
            self.steps
                .extend(self.matrix.iter().zip(draw).map(|(a, z)| a * z));
        } else {
            let rows = self.matrix.chunks_exact(n);
            self.steps
                .extend(rows.map(|row| row.iter().zip(draw).map(|(a, z)| a * z).sum::<f64>()));
        }
        let steps = &self.steps[start..];
        self.mean.iter().zip(steps).map(|(m, s)| m + self.sigma * s)
    }

    /// Whether this is a distribution in so many dimensions, with at most so many samples a generation.
    pub(super) fn fit(&self, dimension: usize, size: usize) -> bool {
        let entries = if dimension > FULL {
            dimension
        } else {
            dimension * dimension
        };
        self.mean.len() == dimension
            && self.path.len() == dimension
            && self.matrix.len() == entries
            && self.weights.len() == (size / 2).max(1)
            && self.draws.len() == self.steps.len()
            && self.draws.len() == self.sampled() * dimension
            && self.sampled() <= size
            && self.told() <= self.sampled()
    }

    /// Takes the fitness of the next sample that has none.
    pub(super) fn tell(&mut self, fitness: f64) {
        self.fitness
            .push(if fitness.is_nan() { f64::INFINITY } else { fitness });
    }

    /// The root of the mean square of a sample's distance from the mean.
    pub(super) fn spread(&self) -> f64 {
        self.sigma * self.matrix.iter().map(|a| a * a).sum::<f64>().sqrt()
    }

    /// Adapts to the generation, all of which has been told, and begins the next one. Cost: O(D^2) a sample.
    pub(super) fn adapt(&mut self) {
        let n = self.mean.len();
        let d = n as f64;
        let effective = 1.0 / self.weights.iter().map(|w| w * w).sum::<f64>();
        let path_rate = (effective + 2.0) / (d + effective + 5.0);
        let damping =
            1.0 + path_rate + 2.0 * (((effective - 1.0) / (d + 1.0)).max(0.0).sqrt() - 1.0).max(0.0);
        let mut one = 2.0 / ((d + 1.3).powi(2) + effective);
        let mut many = 2.0 * (effective - 2.0 + 1.0 / effective) / ((d + 2.0).powi(2) + effective);
        if self.is_diagonal() {
            let faster = (d + 2.0) / 3.0;
            one *= faster;
            many *= faster;
        }
        let many = many.min(1.0 - one);

        let (mut order, mut centre) = (mem::take(&mut self.order), mem::take(&mut self.centre));
        order.clear();
        order.extend(0..self.fitness.len());
        order.sort_unstable_by(|&a, &b| self.fitness[a].total_cmp(&self.fitness[b]).then(a.cmp(&b)));
        order.truncate(self.weights.len());
        centre.clear();
        centre.resize(n, 0.0);
        for (&k, &weight) in order.iter().zip(&self.weights) {
            let row = k * n..(k + 1) * n;
            for (c, z) in centre.iter_mut().zip(&self.draws[row.clone()]) {
                *c += weight * z;
            }
            for (m, s) in self.mean.iter_mut().zip(&self.steps[row]) {
                *m += weight * self.sigma * s;
            }
        }
        let push = (path_rate * (2.0 - path_rate) * effective).sqrt();
        for (p, c) in self.path.iter_mut().zip(&centre) {
            *p = (1.0 - path_rate) * *p + push * c;
        }
        // M := M ((1 - one/2 - many/2) I + one/2 p p^T + many/2 sum_i w_i z_i z_i^T), where M z_i are the steps.
        let keep = 1.0 - 0.5 * one - 0.5 * many;
        if self.is_diagonal() {
            for (j, a) in self.matrix.iter_mut().enumerate() {
                let square: f64 = order
                    .iter()
                    .zip(&self.weights)
                    .map(|(k, w)| w * self.draws[k * n + j].powi(2))
                    .sum();
                *a *= keep + 0.5 * one * self.path[j].powi(2) + 0.5 * many * square;
            }
        } else {
            for row in self.matrix.chunks_exact_mut(n) {
                let along: f64 = row.iter().zip(&self.path).map(|(a, p)| a * p).sum();
                for (a, p) in row.iter_mut().zip(&self.path) {
                    *a = keep * *a + 0.5 * one * along * p;
                }
            }
            for (&k, &weight) in order.iter().zip(&self.weights) {
                let draw = &self.draws[k * n..(k + 1) * n];
                for (row, step) in self.matrix.chunks_exact_mut(n).zip(&self.steps[k * n..]) {
                    for (a, z) in row.iter_mut().zip(draw) {
                        *a += 0.5 * many * weight * step * z;
                    }
                }
            }
        }
        let length = self.path.iter().map(|p| p * p).sum::<f64>().sqrt();
        let expected = d.sqrt() * (1.0 - 1.0 / (4.0 * d) + 1.0 / (21.0 * d * d));
        self.sigma *= (path_rate / damping * (length / expected - 1.0)).min(1.0).exp();
        self.draws.clear();
        self.steps.clear();
        self.fitness.clear();
        (self.order, self.centre) = (order, centre);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(n: usize, size: usize, sigma: f64, fitness: impl Fn(&[f64]) -> f64) -> Distribution {
        let (mut rng, mut distribution) = (SearchRng::new(4), Distribution::default());
        distribution.reset(&vec![0.5; n], sigma, size);
        for _ in 0..size {
            let x: Vec<f64> = distribution.sample(&mut rng).collect();
            distribution.tell(fitness(&x));
        }
        distribution
    }

    #[test]
    fn a_rotated_ridge_of_condition_1e6_is_descended() {
        let ridge = |x: &[f64]| (x[0] + x[1]).powi(2) + 1e6 * (x[0] - x[1]).powi(2);
        let (mut rng, mut distribution) = (SearchRng::new(1), Distribution::default());
        distribution.reset(&[1.0, 0.5], 0.3, usual_size(2));
        for _ in 0..200 {
            for _ in 0..usual_size(2) {
                let x: Vec<f64> = distribution.sample(&mut rng).collect();
                distribution.tell(ridge(&x));
            }
            distribution.adapt();
        }
        let best = ridge(&distribution.mean);
        assert!(best < 1e-10, "{best}");
    }

    /// Beyer, Sendhoff 2017, one generation: m := m + sigma sum w d, s := sqrt(mu cs (2 - cs)) sum w z,
    /// M := M (I + c1/2 (s s^T - I) + cw/2 (sum w z z^T - I)), sigma := sigma exp(cs/ds (|s| / chi - 1)).
    #[test]
    fn a_generation_follows_the_published_equations() {
        let (n, size, sigma) = (3, 8, 0.25);
        let mut distribution = told(n, size, sigma, |x| x[0] + 2.0 * x[1] - x[2]);
        let before = distribution.clone();
        distribution.adapt();

        let raw: Vec<f64> = (1..=4).map(|i| 4.5_f64.ln() - f64::from(i).ln()).collect();
        let w: Vec<f64> = raw.iter().map(|x| x / raw.iter().sum::<f64>()).collect();
        let mu = 1.0 / w.iter().map(|w| w * w).sum::<f64>();
        let cs = (mu + 2.0) / (3.0 + mu + 5.0);
        let ds = 1.0 + cs + 2.0 * (((mu - 1.0) / 4.0).sqrt() - 1.0).max(0.0);
        let c1 = 2.0 / (4.3_f64.powi(2) + mu);
        let cw = (2.0 * (mu - 2.0 + 1.0 / mu) / (25.0 + mu)).min(1.0 - c1);
        let mut order: Vec<usize> = (0..size).collect();
        order.sort_by(|&a, &b| before.fitness[a].total_cmp(&before.fitness[b]));
        // M is the identity, so that steps are draws.
        let z = |rank: usize, j: usize| before.draws[order[rank] * n + j];
        let centre: Vec<f64> = (0..n).map(|j| (0..4).map(|r| w[r] * z(r, j)).sum()).collect();
        let path: Vec<f64> = centre.iter().map(|c| (mu * cs * (2.0 - cs)).sqrt() * c).collect();
        for i in 0..n {
            approx::assert_relative_eq!(
                distribution.mean[i],
                0.5 + sigma * centre[i],
                max_relative = 1e-12
            );
            for j in 0..n {
                let identity = f64::from(u8::from(i == j));
                let outer: f64 = (0..4).map(|r| w[r] * z(r, i) * z(r, j)).sum();
                let expected =
                    identity + 0.5 * c1 * (path[i] * path[j] - identity) + 0.5 * cw * (outer - identity);
                approx::assert_relative_eq!(distribution.matrix[i * n + j], expected, epsilon = 1e-12);
            }
        }
        let length = path.iter().map(|p| p * p).sum::<f64>().sqrt();
        let chi = 3.0_f64.sqrt() * (1.0 - 1.0 / 12.0 + 1.0 / 189.0);
        let expected = sigma * (cs / ds * (length / chi - 1.0)).exp();
        approx::assert_relative_eq!(distribution.sigma, expected, max_relative = 1e-12);
    }

    #[test]
    fn many_dimensions_adapt_their_variances() {
        let n = FULL + 1;
        let mut distribution = told(n, usual_size(n), 1.0, |x| x[0]);
        assert_eq!(distribution.matrix.len(), n);
        distribution.adapt();
        assert!(distribution.matrix.iter().all(|a| *a > 0.0 && a.is_finite()));
    }
}
