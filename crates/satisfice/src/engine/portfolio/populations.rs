//! Populations that adapt their covariance, for continuous spaces: local searches that follow the trend of a rugged landscape.
//!
//! Beyer, Sendhoff 2017, doi 10.1109/TEVC.2017.2680320 (MA-ES), with its default weights and learning rates.

use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::local::luby::luby;
use crate::engine::low_discrepancy;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::Space;
use crate::state::Saved;

/// Populations side by side, so that one can propose while others wait for outcomes.
const TOGETHER: usize = 3;
/// The first step is drawn between these shares of the axes: large ones for the trend, small ones for narrow basins.
const FIRST_STEP: (f64, f64) = (0.003, 0.3);
/// A population whose steps fall below this share of the axes has converged.
const CONVERGED: f64 = 1e-14;
/// A population is hopeless when its distance to delta exceeds this many times the differences among its members.
const HOPELESS: f64 = 1e4;
/// Matrices have 320 kB at most.
const MOST_AXES: usize = 200;
/// The largest population: tags count its members.
const LARGEST: usize = 1 << 12;

/// One population: a mean, a step size sigma as a share of the axes, and a matrix M of the mutations sigma M N(0, I).
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
struct Population<S> {
    running: bool,
    mean: Vec<S>,
    sigma: f64,
    matrix: Vec<f64>,
    path: Vec<f64>,
    /// Members: draws of N(0, I), M times these, fitness; so many proposed, so many told.
    draws: Vec<f64>,
    steps: Vec<f64>,
    fitness: Vec<f64>,
    proposed: usize,
    told: usize,
    /// Weights of the better half, best first; the members by fitness, and M times the path, as memory.
    weights: Vec<f64>,
    order: Vec<usize>,
    turned: Vec<f64>,
    best: f64,
    /// Generations since the best fell.
    stalled: usize,
}

/// Restarted populations. The sizes follow the universal restart sequence; the starts are spread over the space by an additive
/// recurrence, which meets every slice of an axis in turn where independent draws leave out one in three.
#[derive(Debug, Clone)]
pub(super) struct Populations<S> {
    populations: Vec<Population<S>>,
    restarts: u64,
    /// The recurrence at its start, in [0, 1).
    offset: Vec<f64>,
    next: usize,
}

impl<S: Real> Populations<S> {
    pub(super) fn new() -> Self {
        Self {
            populations: Vec::new(),
            restarts: 0,
            offset: Vec::new(),
            next: 0,
        }
    }

    /// Populations work on continuous axes only, and on at most [`MOST_AXES`], where a matrix takes no more memory and time than a
    /// few steps.
    pub(super) fn begin(&mut self, context: &dyn Context<S>) {
        let axes = context.space().axes();
        let continuous = axes.len() <= MOST_AXES && axes.iter().all(|axis| !axis.is_integer());
        self.populations.clear();
        let idle = Population {
            running: false,
            ..Population::default()
        };
        self.populations
            .resize(if continuous { TOGETHER } else { 0 }, idle);
        self.next = 0;
    }

    pub(super) fn are_usable(&self) -> bool {
        !self.populations.is_empty()
    }

    pub(super) fn save(&self, state: &mut crate::state::State) {
        self.populations.save(state);
        self.restarts.save(state);
        self.offset.save(state);
        self.next.save(state);
    }

    pub(super) fn restore(&mut self, from: &mut crate::state::Reader<'_>) -> Result<(), crate::Error> {
        self.populations = from.read()?;
        self.restarts = from.read()?;
        self.offset = from.read()?;
        self.next = from.read()?;
        Ok(())
    }

    /// Proposes a member of the next population that has one left in this generation, and returns its index.
    pub(super) fn propose(
        &mut self,
        context: &dyn Context<S>,
        rng: &mut SearchRng,
        out: &mut Batch<S>,
    ) -> Option<usize> {
        let count = self.populations.len();
        let index = (0..count)
            .map(|turn| (self.next + turn) % count)
            .find(|&index| self.populations[index].has_more())?;
        let population = &mut self.populations[index];
        if !population.running {
            let axes = context.space().dimension();
            if self.offset.len() != axes {
                self.offset = (0..axes).map(|_| rng.uniform()).collect();
            }
            self.restarts += 1;
            population.start(luby(self.restarts), context, rng);
            spread(&self.offset, self.restarts, context.space(), &mut population.mean);
        }
        let member = population.proposed;
        out.push_with(|position| population.propose(context, rng, position));
        if !population.has_more() {
            self.next = (index + 1) % count;
        }
        Some(index * LARGEST + member)
    }

    /// Tells the outcome of a member.
    pub(super) fn tell(&mut self, tag: usize, context: &dyn Context<S>, outcome: Outcome<S>) {
        let population = &mut self.populations[tag / LARGEST];
        // The population has ended: others of its generation were in the same batch.
        if !population.running {
            return;
        }
        population.running = !outcome.is_hit();
        population.fitness[tag % LARGEST] = outcome.fitness().f64();
        population.told += 1;
        if population.running && population.told == population.fitness.len() {
            population.adapt(context);
        }
    }
}

/// Moves the position to point `k` of a sequence that covers the space evenly.
fn spread<S: Real>(offset: &[f64], k: u64, space: &Space<S>, position: &mut [S]) {
    let units = low_discrepancy::point(k, offset);
    for ((x, axis), unit) in position.iter_mut().zip(space.axes()).zip(units) {
        *x = axis.at(unit);
    }
}

impl<S: Real> Population<S> {
    fn has_more(&self) -> bool {
        !self.running || self.proposed < self.fitness.len()
    }

    /// Resets everything but the mean.
    fn start(&mut self, times: u64, context: &dyn Context<S>, rng: &mut SearchRng) {
        let space = context.space();
        let n = space.dimension();
        let least = 4.0 + (3.0 * (n as f64).ln()).floor();
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "small and positive"
        )]
        let members = ((least * times as f64) as usize).min(LARGEST);
        self.mean.resize(n, S::zero());
        let (smallest, largest) = FIRST_STEP;
        // In many dimensions small steps lead into local minima only, on a line or in a plane they are cheap and find narrow
        // basins.
        let preference = if n <= 2 {
            0.5
        } else {
            (n as f64 / 4.0).clamp(2.0, 3.0)
        };
        self.sigma = largest * (smallest / largest).powf(rng.uniform().powf(preference));
        self.matrix.clear();
        self.matrix.resize(n * n, 0.0);
        for diagonal in self.matrix.iter_mut().step_by(n + 1) {
            *diagonal = 1.0;
        }
        self.path.clear();
        self.path.resize(n, 0.0);
        for memory in [&mut self.draws, &mut self.steps] {
            memory.clear();
            memory.resize(members * n, 0.0);
        }
        self.fitness.clear();
        self.fitness.resize(members, f64::INFINITY);
        self.order.clear();
        self.order.extend(0..members);
        self.weights.clear();
        let parents = members / 2;
        self.weights
            .extend((0..parents).map(|i| (parents as f64 + 0.5).ln() - (i as f64 + 1.0).ln()));
        let sum: f64 = self.weights.iter().sum();
        self.weights.iter_mut().for_each(|weight| *weight /= sum);
        self.turned.resize(n, 0.0);
        (self.proposed, self.told, self.stalled) = (0, 0, 0);
        self.best = f64::INFINITY;
        self.running = true;
    }

    fn propose(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, position: &mut [S]) {
        let space = context.space();
        let n = self.mean.len();
        let row = self.proposed * n..(self.proposed + 1) * n;
        let (draw, step) = (&mut self.draws[row.clone()], &mut self.steps[row]);
        for z in &mut *draw {
            *z = rng.normal();
        }
        for (step, matrix) in step.iter_mut().zip(self.matrix.chunks_exact(n)) {
            *step = matrix.iter().zip(&*draw).map(|(m, z)| m * z).sum();
        }
        for (((x, &mean), axis), &step) in position.iter_mut().zip(&self.mean).zip(space.axes()).zip(&*step) {
            *x = mean + axis.width() * S::of(self.sigma * step);
        }
        space.keep_inside(position);
        self.proposed += 1;
    }

    /// The next generation. Cost: O(D^2) a member of the better half.
    fn adapt(&mut self, context: &dyn Context<S>) {
        let n = self.mean.len();
        let (d, members) = (n as f64, self.fitness.len());
        let Self {
            weights,
            order,
            draws,
            steps,
            matrix,
            path,
            turned,
            ..
        } = self;
        order.sort_unstable_by(|&a, &b| self.fitness[a].total_cmp(&self.fitness[b]).then(a.cmp(&b)));
        let parents = weights.len();
        let effective = 1.0 / weights.iter().map(|weight| weight * weight).sum::<f64>();
        let path_rate = (effective + 2.0) / (d + effective + 5.0);
        let one_rate = 2.0 / ((d + 1.3).powi(2) + effective);
        let all_rate = (2.0 * (effective - 2.0 + 1.0 / effective) / ((d + 2.0).powi(2) + effective))
            .clamp(0.0, 1.0 - one_rate);
        let damping = 1.0 + path_rate + 2.0 * (((effective - 1.0) / (d + 1.0)).sqrt() - 1.0).max(0.0);

        let best = self.fitness[order[0]];
        let middle = self.fitness[order[parents]];
        self.stalled = if best < self.best { 0 } else { self.stalled + 1 };
        self.best = self.best.min(best);

        let widths = context.space().axes().iter().map(crate::Axis::width);
        let reach = (effective * path_rate * (2.0 - path_rate)).sqrt();
        for (j, (mean, width)) in self.mean.iter_mut().zip(widths).enumerate() {
            let weighted = |rows: &[f64]| -> f64 {
                weights
                    .iter()
                    .zip(&*order)
                    .map(|(w, &i)| w * rows[i * n + j])
                    .sum()
            };
            *mean = *mean + width * S::of(self.sigma * weighted(steps));
            path[j] = (1.0 - path_rate) * path[j] + reach * weighted(draws);
        }
        context.space().keep_inside(&mut self.mean);
        // M (1 - c1/2 - cmu/2 + c1/2 p p^T + cmu/2 sum w z z^T); the M z are the steps.
        for (turned, row) in turned.iter_mut().zip(matrix.chunks_exact(n)) {
            *turned = row.iter().zip(&*path).map(|(m, p)| m * p).sum();
        }
        let keep = 1.0 - 0.5 * (one_rate + all_rate);
        for (k, row) in matrix.chunks_exact_mut(n).enumerate() {
            for (m, p) in row.iter_mut().zip(&*path) {
                *m = keep * *m + 0.5 * one_rate * turned[k] * p;
            }
            for (w, &i) in weights.iter().zip(&*order) {
                let factor = 0.5 * all_rate * w * steps[i * n + k];
                for (m, z) in row.iter_mut().zip(&draws[i * n..(i + 1) * n]) {
                    *m += factor * z;
                }
            }
        }
        let length = path.iter().map(|p| p * p).sum::<f64>().sqrt();
        let expected = d.sqrt() * (1.0 - 0.25 / d + 1.0 / (21.0 * d * d));
        self.sigma *= (path_rate / damping * (length / expected - 1.0)).exp();

        let spread = (matrix.iter().map(|m| m * m).sum::<f64>() / d).sqrt() * self.sigma;
        let patience = 20 + 30 * n / members;
        let lacking = self.best - context.threshold().f64();
        let hopeless = HOPELESS * (middle - best) < lacking;
        self.running = spread > CONVERGED
            && spread.is_finite()
            && self.stalled <= patience
            && !hopeless
            && !context.is_deleted(&self.mean);
        (self.proposed, self.told) = (0, 0);
    }
}

#[cfg(test)]
mod generation;
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn starts_meet_every_slice_of_every_axis() {
        for dimension in 1..6 {
            let space = Space::<f64>::cube(dimension, -1.0, 3.0).unwrap();
            let offset = vec![0.3; dimension];
            let mut seen = vec![[false; 8]; dimension];
            let mut position = vec![0.0; dimension];
            for k in 0..64 {
                spread(&offset, k, &space, &mut position);
                for (seen, x) in seen.iter_mut().zip(&position) {
                    seen[((x + 1.0) * 2.0) as usize] = true;
                }
            }
            assert!(seen.iter().flatten().all(|seen| *seen), "{dimension}");
        }
    }

    /// x_k = frac(x_0 + k g^-(j+1)) on axis j; in the plane, g = 1.3247… is the real root of g^3 = g + 1.
    #[test]
    fn starts_are_the_published_recurrence() {
        let g = 1.324_717_957_244_746_f64;
        let space = Space::<f64>::cube(2, 0.0, 1.0).unwrap();
        let mut position = [0.0; 2];
        for k in 1..50 {
            spread(&[0.5, 0.25], k, &space, &mut position);
            let expected = [(0.5 + k as f64 / g).fract(), (0.25 + k as f64 / (g * g)).fract()];
            for (x, expected) in position.iter().zip(expected) {
                approx::assert_abs_diff_eq!(*x, expected, epsilon = 1e-10);
            }
        }
    }
}
