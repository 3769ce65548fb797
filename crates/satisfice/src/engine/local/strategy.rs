//! The evolution strategy with covariance matrix self-adaptation: a rotation-invariant local search by generations.
//!
//! Beyer, Sendhoff 2008, doi 10.1007/978-3-540-87700-4_13, with weights, elites and sizes after Ahrari and others 2022,
//! doi 10.1109/TEVC.2021.3117116. Every sample has a step size of its own, and the sizes of the best are inherited. In many dimensions
//! only the variances are adapted, in O(D), at the faster rates of Ros, Hansen 2008, doi 10.1007/978-3-540-87700-4_30.

use core::mem;

use super::repelled::Repelled;
use crate::seed::SearchRng;

/// In more dimensions than this, C is diagonal: a full matrix would take 8 D^2 bytes and every sample D^2 operations.
const FULL: usize = 200;
/// Samples of a generation, for each root of D.
const SIZE: f64 = 6.0;
/// Shares of a generation: those that are recombined, and those that the next one competes with.
const PARENTS: f64 = 0.2;
const ELITES: f64 = 0.1;
/// Log-normal steps: the variance of a step size's logarithm, times D.
const VARIATION: f64 = 0.25;
/// The largest step, and the inverse of the smallest.
const LARGEST: f64 = 1e100;
/// The smallest square of a pivot of the factor, as a share of the variance.
const PIVOT: f64 = 1e-14;

/// The distribution m + s A N(0, I) of a generation, where A A^T = C, and its samples. Coordinates are shares of the axes' widths.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Strategy {
    pub(super) mean: Vec<f64>,
    sigma: f64,
    /// C row by row, or its diagonal; and A, of which the part above the diagonal is not used.
    covariance: Vec<f64>,
    factor: Vec<f64>,
    /// Of those that are recombined, which sum to 1.
    weights: Vec<f64>,
    /// Places, step sizes and fitness: of the elites of the last generation, then of the samples.
    places: Vec<f64>,
    sizes: Vec<f64>,
    fitness: Vec<f64>,
    elites: usize,
    /// Memory of one sample: the draw of N(0, I), and of one adaptation: the samples from the best on, and the steps' squares.
    #[serde(skip)]
    draw: Vec<f64>,
    #[serde(skip)]
    order: Vec<usize>,
    #[serde(skip)]
    before: Vec<f64>,
}

/// The usual size of a generation.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "positive and small"
)]
pub(super) fn usual_size(dimension: usize) -> usize {
    (SIZE * (dimension as f64).sqrt()) as usize
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a share of a size"
)]
fn share(of: usize, share: f64) -> usize {
    ((of as f64 * share).round() as usize).max(1)
}

fn set_to_identity(matrix: &mut Vec<f64>, n: usize) {
    matrix.clear();
    if n > FULL {
        matrix.resize(n, 1.0);
    } else {
        matrix.resize(n * n, 0.0);
        for diagonal in matrix.iter_mut().step_by(n + 1) {
            *diagonal = 1.0;
        }
    }
}

/// `displacement := (sigma A)^-1 displacement`.
fn whiten(factor: &[f64], sigma: f64, displacement: &mut [f64]) {
    let n = displacement.len();
    if n > FULL {
        for (x, a) in displacement.iter_mut().zip(factor) {
            *x /= sigma * a;
        }
        return;
    }
    for (j, row) in factor.chunks_exact(n).enumerate() {
        let known: f64 = row[..j].iter().zip(&*displacement).map(|(a, x)| a * x).sum();
        displacement[j] = (displacement[j] / sigma - known) / row[j];
    }
}

impl Strategy {
    /// Isotropic. Memory is reused.
    pub(super) fn reset(&mut self, mean: &[f64], sigma: f64, size: usize) {
        let n = mean.len();
        self.mean.clear();
        self.mean.extend_from_slice(mean);
        self.sigma = sigma;
        set_to_identity(&mut self.covariance, n);
        set_to_identity(&mut self.factor, n);
        let parents = share(size, PARENTS);
        let first = (parents as f64 + 1.0).ln();
        self.weights.clear();
        self.weights
            .extend((1..=parents).map(|rank| first - (rank as f64).ln()));
        let sum: f64 = self.weights.iter().sum();
        self.weights.iter_mut().for_each(|weight| *weight /= sum);
        self.elites = 0;
        self.places.clear();
        self.sizes.clear();
        self.fitness.clear();
    }

    fn is_diagonal(&self) -> bool {
        self.mean.len() > FULL
    }

    /// How many samples this generation has.
    pub(super) fn sampled(&self) -> usize {
        self.sizes.len() - self.elites
    }

    /// How many of them have been told.
    pub(super) fn told(&self) -> usize {
        self.fitness.len() - self.elites
    }

    /// Draws the next sample of this generation that is not refused; `confine` brings a coordinate back into its bounds. Cost: O(D^2), or
    /// O(D) with variances only, and what the refusals cost.
    pub(super) fn sample(
        &mut self,
        rng: &mut SearchRng,
        repelled: &mut Repelled,
        confine: impl Fn(usize, f64) -> f64,
    ) -> &[f64] {
        let n = self.mean.len();
        let scale = (VARIATION / n as f64).sqrt();
        let start = self.places.len();
        loop {
            let factor = (scale * rng.normal()).exp();
            self.draw.clear();
            self.draw.extend((0..n).map(|_| factor * rng.normal()));
            if repelled.refuses(&self.draw) {
                continue;
            }
            let is_inside = self.place_draw(&confine);
            if !is_inside && !repelled.is_empty() {
                self.draw.clear();
                let steps = self.places[start..].iter().zip(&self.mean);
                self.draw.extend(steps.map(|(x, m)| x - m));
                whiten(&self.factor, self.sigma, &mut self.draw);
                if repelled.refuses(&self.draw) {
                    self.places.truncate(start);
                    continue;
                }
            }
            self.sizes.push(self.sigma * factor);
            return &self.places[start..];
        }
    }

    /// Appends the place of the draw, within its bounds, and tells whether it was there before.
    fn place_draw(&mut self, confine: impl Fn(usize, f64) -> f64) -> bool {
        let Self {
            mean,
            sigma,
            factor,
            places,
            draw,
            ..
        } = self;
        let n = mean.len();
        let mut is_inside = true;
        let mut place = |j: usize, step: f64| {
            let x = mean[j] + *sigma * step;
            let inside = confine(j, x);
            is_inside &= inside == x;
            inside
        };
        if n > FULL {
            let along = factor.iter().zip(&*draw).enumerate();
            places.extend(along.map(|(j, (a, z))| place(j, a * z)));
        } else {
            let rows = factor.chunks_exact(n).enumerate();
            places.extend(rows.map(|(j, row)| {
                let along = row[..=j].iter().zip(&*draw);
                place(j, along.map(|(a, z)| a * z).sum())
            }));
        }
        is_inside
    }

    /// Turns a displacement from the mean into the draw of N(0, I) that leads there. Cost: O(D^2), or O(D) with variances only.
    pub(super) fn whiten(&self, displacement: &mut [f64]) {
        whiten(&self.factor, self.sigma, displacement);
    }

    /// Moves the mean along an axis that is periodic, and with it what the samples of the next generation compete with.
    pub(super) fn shift(&mut self, axis: usize, by: f64) {
        self.mean[axis] += by;
        let n = self.mean.len();
        for place in self.places.chunks_exact_mut(n) {
            place[axis] += by;
        }
    }

    /// Whether this is a distribution in so many dimensions, with at most so many samples a generation.
    pub(super) fn fit(&self, dimension: usize, size: usize) -> bool {
        let entries = if dimension > FULL {
            dimension
        } else {
            dimension * dimension
        };
        self.mean.len() == dimension
            && self.covariance.len() == entries
            && self.factor.len() == entries
            && self.weights.len() == share(size, PARENTS)
            && self.elites <= self.fitness.len()
            && self.fitness.len() <= self.sizes.len()
            && self.places.len() == self.sizes.len() * dimension
            && self.sampled() <= size
    }

    /// Takes the fitness of the next sample that has none.
    pub(super) fn tell(&mut self, fitness: f64) {
        self.fitness
            .push(if fitness.is_nan() { f64::INFINITY } else { fitness });
    }

    /// The root of the mean square of a sample's distance from the mean.
    pub(super) fn spread(&self) -> f64 {
        let step = if self.is_diagonal() {
            1
        } else {
            self.mean.len() + 1
        };
        let trace: f64 = self.covariance.iter().step_by(step).sum();
        self.sigma * trace.sqrt()
    }

    /// Adapts to the generation, all of which has been told, and begins the next one. Cost: O(D^2) a sample and O(D^3).
    pub(super) fn adapt(&mut self) {
        let n = self.mean.len();
        let d = n as f64;
        let effective = 1.0 / self.weights.iter().map(|w| w * w).sum::<f64>();
        let mut time = 1.0 + d * (d + 1.0) / (2.0 * effective);
        if self.is_diagonal() {
            time = (time * 3.0 / (d + 2.0)).max(1.0);
        }
        let rate = 1.0 / time;
        let mut order = mem::take(&mut self.order);
        order.clear();
        order.extend(0..self.fitness.len());
        order.sort_unstable_by(|&a, &b| self.fitness[a].total_cmp(&self.fitness[b]).then(a.cmp(&b)));

        // Sizes are drawn about sigma, but those of refused samples are missing.
        let drawn = self.sizes.iter().map(|size| size.ln()).sum::<f64>() / self.sizes.len() as f64;
        let best = order.iter().zip(&self.weights);
        let inherited: f64 = best.map(|(&k, weight)| weight * self.sizes[k].ln()).sum();
        let sigma = (self.sigma.ln() + inherited - drawn).exp();
        let sigma = sigma.clamp(1.0 / LARGEST, LARGEST);
        self.before.clone_from(&self.mean);
        self.mean.fill(0.0);
        self.covariance.iter_mut().for_each(|c| *c *= 1.0 - rate);
        for (&k, &weight) in order.iter().zip(&self.weights) {
            let place = &self.places[k * n..(k + 1) * n];
            self.draw.clear();
            let steps = place.iter().zip(&self.before);
            self.draw.extend(steps.map(|(x, m)| (x - m) / self.sizes[k]));
            for (m, x) in self.mean.iter_mut().zip(place) {
                *m += weight * x;
            }
            let share = rate * weight;
            if n > FULL {
                for (c, z) in self.covariance.iter_mut().zip(&self.draw) {
                    *c += share * z * z;
                }
            } else {
                for (j, row) in self.covariance.chunks_exact_mut(n).enumerate() {
                    let scaled = share * self.draw[j];
                    for (c, z) in row.iter_mut().zip(&self.draw[..=j]) {
                        *c += scaled * z;
                    }
                }
            }
        }
        self.sigma = sigma;
        self.keep_elites(&order);
        self.order = order;
        self.decompose();
    }

    /// The best of this generation compete with the next one.
    fn keep_elites(&mut self, order: &[usize]) {
        let n = self.mean.len();
        let count = share(self.sampled(), ELITES);
        let total = self.sizes.len();
        for &k in &order[..count] {
            self.places.extend_from_within(k * n..(k + 1) * n);
            self.sizes.push(self.sizes[k]);
            self.fitness.push(self.fitness[k]);
        }
        self.places.drain(..total * n);
        self.sizes.drain(..total);
        self.fitness.drain(..total);
        self.elites = count;
    }

    /// C := I, if it has overflowed; then A := the lower triangle with A A^T = C (Cholesky); the root of the diagonal with variances only.
    fn decompose(&mut self) {
        let n = self.mean.len();
        if !self.spread().is_finite() {
            set_to_identity(&mut self.covariance, n);
        }
        if n > FULL {
            for (a, c) in self.factor.iter_mut().zip(&self.covariance) {
                *a = c.max(f64::MIN_POSITIVE).sqrt();
            }
            return;
        }
        for j in 0..n {
            let (above, rest) = self.factor.split_at_mut(j * n);
            let row = &mut rest[..n];
            for i in 0..j {
                let other = &above[i * n..(i + 1) * n];
                let known: f64 = row[..i].iter().zip(other).map(|(a, b)| a * b).sum();
                row[i] = (self.covariance[j * n + i] - known) / other[i];
            }
            let variance = self.covariance[j * n + j];
            let known: f64 = row[..j].iter().map(|a| a * a).sum();
            let square = (variance - known).max(PIVOT * variance);
            row[j] = square.max(f64::MIN_POSITIVE).sqrt();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(n: usize, size: usize, sigma: f64, fitness: impl Fn(&[f64]) -> f64) -> Strategy {
        let (mut rng, mut strategy) = (SearchRng::new(4), Strategy::default());
        let mut repelled = Repelled::default();
        strategy.reset(&vec![0.5; n], sigma, size);
        for _ in 0..size {
            let value = fitness(strategy.sample(&mut rng, &mut repelled, |_, x| x));
            strategy.tell(value);
        }
        strategy
    }

    #[test]
    fn a_rotated_ridge_of_condition_1e6_is_descended() {
        let ridge = |x: &[f64]| (x[0] + x[1]).powi(2) + 1e6 * (x[0] - x[1]).powi(2);
        let mut strategy = told(2, usual_size(2), 0.3, ridge);
        let (mut rng, mut repelled) = (SearchRng::new(1), Repelled::default());
        for _ in 0..200 {
            strategy.adapt();
            for _ in 0..usual_size(2) {
                let value = ridge(strategy.sample(&mut rng, &mut repelled, |_, x| x));
                strategy.tell(value);
            }
        }
        let best = ridge(&strategy.mean);
        assert!(best < 1e-10, "{best}");
    }

    /// Beyer, Sendhoff 2008, one generation: m := sum w x, C := (1 - 1/t) C + 1/t sum w z z^T where z = (x - m) / s, and
    /// t = 1 + D (D + 1) / (2 mu); the steps by their geometric mean, relative to that of all.
    #[test]
    fn a_generation_follows_the_published_equations() {
        let (n, size, sigma) = (3, 10, 0.25);
        let mut strategy = told(n, size, sigma, |x| x[0] + 2.0 * x[1] - x[2]);
        let before = strategy.clone();
        strategy.adapt();

        let raw = [3.0_f64.ln(), 3.0_f64.ln() - 2.0_f64.ln()];
        let w = raw.map(|x| x / (raw[0] + raw[1]));
        let mu = 1.0 / (w[0] * w[0] + w[1] * w[1]);
        let rate = 1.0 / (1.0 + 12.0 / (2.0 * mu));
        let mut order: Vec<usize> = (0..size).collect();
        order.sort_by(|&a, &b| before.fitness[a].total_cmp(&before.fitness[b]));
        let x = |rank: usize, j: usize| before.places[order[rank] * n + j];
        let s = |rank: usize| before.sizes[order[rank]];
        let geometric = before.sizes.iter().map(|s| s.ln()).sum::<f64>() / size as f64;
        for i in 0..n {
            let mean = w[0] * x(0, i) + w[1] * x(1, i);
            approx::assert_relative_eq!(strategy.mean[i], mean, max_relative = 1e-12);
            for j in 0..=i {
                let z = |rank: usize, j: usize| (x(rank, j) - 0.5) / s(rank);
                let outer: f64 = (0..2).map(|rank| w[rank] * z(rank, i) * z(rank, j)).sum();
                let expected = (1.0 - rate) * f64::from(u8::from(i == j)) + rate * outer;
                approx::assert_relative_eq!(strategy.covariance[i * n + j], expected, epsilon = 1e-12);
                let product: f64 = (0..=j)
                    .map(|k| strategy.factor[i * n + k] * strategy.factor[j * n + k])
                    .sum();
                approx::assert_relative_eq!(product, expected, epsilon = 1e-12);
            }
        }
        let expected = sigma * (w[0] * s(0).ln() + w[1] * s(1).ln() - geometric).exp();
        approx::assert_relative_eq!(strategy.sigma, expected, max_relative = 1e-12);
        assert_eq!(
            (strategy.sampled(), strategy.fitness[0]),
            (0, before.fitness[order[0]])
        );
    }

    #[test]
    fn whitening_undoes_the_factor() {
        let mut strategy = told(3, 10, 0.25, |x| x[0] + 2.0 * x[1] - x[2]);
        strategy.adapt();
        strategy.sample(&mut SearchRng::new(2), &mut Repelled::default(), |_, x| x);
        let last = strategy.places.len() - 3;
        let steps = strategy.places[last..].iter().zip(&strategy.mean);
        let mut steps: Vec<f64> = steps.map(|(x, m)| x - m).collect();
        strategy.whiten(&mut steps);
        for (a, b) in steps.iter().zip(&strategy.draw) {
            approx::assert_relative_eq!(*a, *b, max_relative = 1e-9);
        }
    }

    #[test]
    fn many_dimensions_adapt_their_variances() {
        let n = FULL + 1;
        let mut strategy = told(n, usual_size(n), 1.0, |x| x[0]);
        assert_eq!(strategy.covariance.len(), n);
        strategy.adapt();
        assert!(strategy.factor.iter().all(|a| *a > 0.0 && a.is_finite()));
    }

    #[test]
    fn a_flat_function_keeps_it_finite() {
        let mut strategy = told(2, usual_size(2), 0.3, |_| f64::INFINITY);
        let (mut rng, mut repelled) = (SearchRng::new(1), Repelled::default());
        for _ in 0..3000 {
            strategy.adapt();
            for _ in 0..usual_size(2) {
                strategy.sample(&mut rng, &mut repelled, |_, x| x.clamp(0.0, 1.0));
                strategy.tell(f64::NAN);
            }
        }
        assert!(strategy.places.iter().all(|x| x.is_finite()));
    }
}
