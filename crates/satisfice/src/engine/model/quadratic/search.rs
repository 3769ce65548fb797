//! One local search by quadratic models.

use super::eigen;
use super::minimum::{dot, minimum};
use crate::engine::model::factor::Factor;

/// Prior variance of a slope beside that of a curvature, over the trust region.
const SLOPE: f64 = 1e3;
/// Share of the variances that covers for rounding.
const NUGGET: f64 = 1e-10;
const LEAST_NUGGET: f64 = 1e-12;
/// Points that a model knows, at most, or two for each axis.
const KNOWN: usize = 64;
/// Squared distance, in radii, beyond which points are left out where others are enough.
const FAR: f64 = 100.0;
/// Squared distance within which a point shows what F is like in the trust region.
const NEAR: f64 = 4.0;
/// Ratios of the reduction to what was predicted: within these the prediction was good, below the others poor and useless.
const GOOD: core::ops::Range<f64> = 0.7..1.4;
const POOR: f64 = 0.25;
const USELESS: f64 = -10.0;
/// What becomes of the radius after a good, a poor and a useless prediction.
const GROWS: f64 = 1.5;
const SHRINKS: f64 = 0.5;
const COLLAPSES: f64 = 0.25;
/// How much longer than the shortest the axes of the trust region may be: so many times more after a good prediction, less after a poor one.
const STRETCH: f64 = 4.0;
const SHORTENS: f64 = 0.5;
/// Longest axis of the trust region, as a share of the axes of the space.
const LONGEST: f64 = 0.3;
/// The search ends where predictions that can be trusted promise less than this share of the way to the threshold, more often than so many
/// times one after the other: the norm of residuals has a kink that no quadratic has.
const HOPELESS: f64 = 0.1;
const DOUBTS: usize = 2;

/// What [`QuadraticSearch::propose`] has found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Proposal {
    /// A point that shows more of F.
    Looks,
    /// The model's minimum in the trust region.
    Steps,
    /// The model's minimum, by a model that has predicted well: where that is known, the search need not go on.
    Converges,
    /// None: the search has ended.
    Ends,
}

/// A search from a point down to a minimum, in shares of the axes.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct QuadraticSearch {
    axes: usize,
    /// Points that were evaluated, and F there.
    points: Vec<f64>,
    values: Vec<f64>,
    /// Which of them is the best.
    best: usize,
    /// Second derivatives, and the axes of the trust region: directions of length 1, one a row, and lengths in radii.
    curvatures: Vec<f64>,
    directions: Vec<f64>,
    lengths: Vec<f64>,
    pub(super) radius: f64,
    /// Limit of the lengths.
    stretch: f64,
    /// Directions that were tried before there is a model.
    tried: usize,
    /// Whether the last prediction was good.
    is_trusted: bool,
    /// Trusted predictions without hope, one after the other.
    doubts: usize,
    /// The point that is out, and by how much F is to fall there, if the model says so.
    pub(super) proposed: Vec<f64>,
    predicted: Option<f64>,
    /// How many points the model had in its trust region.
    near: usize,
}

impl QuadraticSearch {
    /// Begins at a point, with a trust region of this radius along directions that `normal` draws. Memory is reused.
    pub(super) fn start(
        &mut self,
        point: impl Iterator<Item = f64>,
        value: f64,
        radius: f64,
        mut normal: impl FnMut() -> f64,
    ) {
        self.points.clear();
        self.points.extend(point);
        let n = self.points.len();
        self.axes = n;
        self.values.clear();
        self.values.push(value);
        self.best = 0;
        self.curvatures.clear();
        self.curvatures.resize(n * n, 0.0);
        self.lengths.clear();
        self.lengths.resize(n, 1.0);
        (self.radius, self.stretch) = (radius, 1.0);
        (self.tried, self.doubts, self.near) = (0, 0, 0);
        self.is_trusted = false;
        self.predicted = None;
        self.proposed.clear();
        // Gram and Schmidt.
        self.directions.clear();
        for i in 0..n {
            self.directions.extend((0..n).map(|_| normal()));
            let (others, direction) = self.directions.split_at_mut(i * n);
            for other in others.chunks_exact(n) {
                let along = dot(other, direction);
                for (x, other) in direction.iter_mut().zip(other) {
                    *x -= along * other;
                }
            }
            let length = dot(direction, direction).sqrt();
            for (j, x) in direction.iter_mut().enumerate() {
                *x = if length > 1e-9 {
                    *x / length
                } else {
                    f64::from(u8::from(i == j))
                };
            }
        }
    }

    /// Whether restored parts fit each other and so many axes.
    pub(super) fn fits(&self, axes: usize) -> bool {
        let square = axes * axes;
        self.axes == axes
            && self.best < self.values.len()
            && self.values.len().checked_mul(axes) == Some(self.points.len())
            && [self.curvatures.len(), self.directions.len()] == [square, square]
            && self.lengths.len() == axes
            && [0, axes].contains(&self.proposed.len())
    }

    fn point(&self, i: usize) -> &[f64] {
        &self.points[i * self.axes..(i + 1) * self.axes]
    }

    /// The best point and F there.
    pub(super) fn best(&self) -> (&[f64], f64) {
        (self.point(self.best), self.values[self.best])
    }

    /// Number of coefficients of a quadratic without its constant.
    fn coefficients(&self) -> usize {
        self.axes * (self.axes + 3) / 2
    }

    /// Evaluations after which a search is given up.
    fn patience(&self) -> usize {
        150 + 10 * self.axes
    }

    /// Finds the next point; `periodic` says which axes have no ends. No step is shorter than `shortest`.
    pub(super) fn propose(
        &mut self,
        threshold: f64,
        shortest: f64,
        periodic: &[bool],
        memory: &mut Memory,
    ) -> Proposal {
        while self.radius >= shortest && self.values.len() < self.patience() {
            let mut proposal = Proposal::Looks;
            self.predicted = None;
            memory.step.clear();
            memory.step.resize(self.axes, 0.0);
            if self.tried < self.axes {
                memory.step[self.tried] = 1.0;
                self.tried += 1;
            } else {
                let (predicted, is_inside) = self.model(memory);
                let way = self.values[self.best] - threshold;
                let is_sure = is_inside && self.is_trusted && self.values.len() > self.coefficients();
                let is_hopeless = is_sure && predicted < HOPELESS * way;
                self.doubts = if is_hopeless { self.doubts + 1 } else { 0 };
                if self.doubts > DOUBTS {
                    return Proposal::Ends;
                }
                if predicted > 1e-14 * self.values[self.best].abs() {
                    self.predicted = Some(predicted);
                    proposal = if is_sure {
                        Proposal::Converges
                    } else {
                        Proposal::Steps
                    };
                }
            }
            self.go(&memory.step, periodic);
            let n = self.axes;
            if !self
                .points
                .chunks_exact(n)
                .any(|point| *point == self.proposed[..])
            {
                return proposal;
            }
            self.radius *= SHRINKS;
        }
        Proposal::Ends
    }

    /// Writes the point that many radii along the axes of the trust region away from the best one.
    fn go(&mut self, step: &[f64], periodic: &[bool]) {
        let n = self.axes;
        self.proposed.clear();
        self.proposed
            .extend_from_slice(&self.points[self.best * n..(self.best + 1) * n]);
        for ((direction, length), step) in self.directions.chunks_exact(n).zip(&self.lengths).zip(step) {
            for (x, along) in self.proposed.iter_mut().zip(direction) {
                *x += self.radius * length * step * along;
            }
        }
        for (x, &periodic) in self.proposed.iter_mut().zip(periodic) {
            if !periodic {
                *x = x.clamp(0.0, 1.0);
            }
        }
    }

    /// Takes F at the point that was proposed.
    pub(super) fn learn(&mut self, value: f64) {
        let best = self.values[self.best];
        let value = if value.is_nan() { f64::INFINITY } else { value };
        if let Some(predicted) = self.predicted {
            let ratio = (best - value) / predicted;
            self.is_trusted &= ratio >= 2.0 * POOR;
            if GOOD.contains(&ratio) {
                self.is_trusted = true;
                self.radius *= GROWS;
                self.stretch *= STRETCH;
            } else if ratio < POOR {
                self.stretch = (self.stretch * SHORTENS).max(1.0);
                if ratio < USELESS {
                    self.radius *= COLLAPSES;
                } else if self.near >= self.axes {
                    self.radius *= SHRINKS;
                }
            }
        }
        if value < f64::INFINITY {
            self.points.extend_from_slice(&self.proposed);
            self.values.push(value);
            if value < best {
                self.best = self.values.len() - 1;
            }
        } else if self.predicted.is_none() {
            self.radius *= SHRINKS;
        }
    }

    /// Fits the model to the points next to the best one. Writes the step to its minimum in the trust region, in radii along the axes of that;
    /// returns by how much F falls there, and whether the minimum is inside.
    ///
    /// Second derivatives change as little as the points allow (Powell 2004): those of a Gaussian process whose mean is the model before.
    fn model(&mut self, memory: &mut Memory) -> (f64, bool) {
        let n = self.axes;
        self.look_around(memory);
        self.weigh(memory);
        memory.slope.clear();
        memory.slope.resize(n, 0.0);
        for (weight, &(_, i)) in memory.weights.iter().zip(&memory.others) {
            memory.dual.clear();
            memory.dual.resize(n, 0.0);
            let axes = self.directions.chunks_exact(n).zip(&self.lengths);
            for ((direction, length), z) in axes.zip(&memory.places[i * n..]) {
                for (dual, along) in memory.dual.iter_mut().zip(direction) {
                    *dual += z / (length * self.radius) * along;
                }
            }
            for (a, row) in memory.dual.iter().zip(self.curvatures.chunks_exact_mut(n)) {
                for (entry, b) in row.iter_mut().zip(&memory.dual) {
                    *entry += weight * a * b;
                }
            }
            for (slope, a) in memory.slope.iter_mut().zip(&memory.dual) {
                *slope += SLOPE * weight * a;
            }
        }
        memory.matrix.clear();
        memory.matrix.extend_from_slice(&self.curvatures);
        eigen::symmetric(&mut memory.matrix, n, &mut self.directions);
        let values = memory.matrix.iter().step_by(n + 1);
        let steepest = values.clone().fold(0.0_f64, |most, value| most.max(value.abs()));
        let longest = (LONGEST / self.radius).max(1.0);
        for (length, value) in self.lengths.iter_mut().zip(values.clone()) {
            let shape = (steepest / value.abs()).sqrt();
            *length = if shape.is_nan() {
                1.0
            } else {
                shape.min(self.stretch).min(longest).max(1.0)
            };
        }
        memory.slopes.clear();
        memory.bends.clear();
        let axes = self.directions.chunks_exact(n).zip(&self.lengths);
        for ((direction, length), value) in axes.zip(values) {
            let scale = length * self.radius;
            memory.slopes.push(scale * dot(direction, &memory.slope));
            memory.bends.push(scale * scale * value);
        }
        minimum(&memory.slopes, &memory.bends, &mut memory.step)
    }

    /// Finds the points that the model knows, and where they are: distances from the best point in radii, along each axis of the trust
    /// region.
    fn look_around(&mut self, memory: &mut Memory) {
        let n = self.axes;
        memory.others.clear();
        memory.places.clear();
        let here = self.point(self.best);
        for i in 0..self.values.len() {
            memory.apart.clear();
            memory
                .apart
                .extend(self.point(i).iter().zip(here).map(|(a, b)| a - b));
            let axes = self.directions.chunks_exact(n).zip(&self.lengths);
            let apart = &memory.apart;
            memory
                .places
                .extend(axes.map(|(direction, length)| dot(direction, apart) / (length * self.radius)));
            let z = &memory.places[i * n..];
            if i != self.best {
                memory.others.push((dot(z, z), i));
            }
        }
        memory
            .others
            .sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let enough = self.coefficients();
        memory.others.truncate((enough + n + 1).min(KNOWN.max(2 * n)));
        while memory.others.len() > enough && memory.others.last().is_some_and(|other| other.0 > FAR) {
            memory.others.pop();
        }
        self.near = memory.others.iter().filter(|other| other.0 <= NEAR).count();
    }

    /// Finds the weights of these points in the change of the model.
    fn weigh(&self, memory: &mut Memory) {
        let n = self.axes;
        let here = self.point(self.best);
        memory.factor.clear();
        memory.weights.clear();
        for (j, &(square, i)) in memory.others.iter().enumerate() {
            let covariance = |along: f64| along * (SLOPE + 0.5 * along);
            let place = |i: usize| &memory.places[i * n..(i + 1) * n];
            let covariances = memory.others[..j]
                .iter()
                .map(|&(_, other)| covariance(dot(place(other), place(i))));
            memory
                .factor
                .push(covariances, covariance(square) * (1.0 + NUGGET) + LEAST_NUGGET);
            memory.apart.clear();
            memory
                .apart
                .extend(self.point(i).iter().zip(here).map(|(a, b)| a - b));
            let bent: f64 = self
                .curvatures
                .chunks_exact(n)
                .zip(&memory.apart)
                .map(|(row, a)| a * dot(row, &memory.apart))
                .sum();
            memory
                .weights
                .push(self.values[i] - self.values[self.best] - 0.5 * bent);
        }
        memory.factor.solve_one(&mut memory.weights);
        memory.factor.solve_transposed(&mut memory.weights);
    }
}

/// Memory for one proposal after the other; nothing in it is kept.
#[derive(Debug, Default)]
pub(super) struct Memory {
    step: Vec<f64>,
    /// Squared distances and numbers of the points that the model knows; the places of all.
    others: Vec<(f64, usize)>,
    places: Vec<f64>,
    apart: Vec<f64>,
    factor: Factor,
    weights: Vec<f64>,
    dual: Vec<f64>,
    slope: Vec<f64>,
    matrix: Vec<f64>,
    slopes: Vec<f64>,
    bends: Vec<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SearchRng;

    /// Evaluations until F is below the threshold, from a point; `None` if the search ends before.
    fn evaluations(fitness: impl Fn(&[f64]) -> f64, start: &[f64], threshold: f64) -> Option<usize> {
        let (mut rng, mut search) = (SearchRng::new(1), QuadraticSearch::default());
        search.start(start.iter().copied(), fitness(start), 0.05, || rng.normal());
        let mut memory = Memory::default();
        let periodic = vec![false; start.len()];
        for count in 1..1000 {
            if search.propose(threshold, 1e-9, &periodic, &mut memory) == Proposal::Ends {
                return None;
            }
            let value = fitness(&search.proposed);
            if value < threshold {
                return Some(count);
            }
            search.learn(value);
        }
        None
    }

    fn sphere(x: &[f64]) -> f64 {
        x.iter()
            .enumerate()
            .map(|(i, x)| (x - 0.3 - 0.1 * i as f64).powi(2))
            .sum()
    }

    /// 14 coefficients, and the way there in a trust region that grows from a twentieth of the axes.
    #[test]
    fn a_quadratic_is_solved_once_its_coefficients_are_known() {
        let count = evaluations(sphere, &[0.9, 0.1, 0.2, 0.5], 1e-9).unwrap();
        assert!(count <= 30, "{count}");
    }

    /// F is the sum of squares of two residuals, one of which is a hundred times as steep, along a parabola.
    #[test]
    fn a_narrow_curved_valley_is_followed() {
        let valley = |x: &[f64]| (1e2 * (x[1] - 0.4 * x[0] * x[0] - 0.2)).powi(2) + (x[0] - 0.8).powi(2);
        let count = evaluations(valley, &[0.2, 0.9], 1e-6).unwrap();
        assert!(count <= 120, "{count}");
    }

    #[test]
    fn a_minimum_above_the_threshold_ends_the_search() {
        assert_eq!(evaluations(|x| sphere(x) + 1.0, &[0.9, 0.1], 0.5), None);
    }
}
