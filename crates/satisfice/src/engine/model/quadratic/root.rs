//! One local search for a root of the components of F, by a linear model of each.

use super::eigen;
use super::minimum::{dot, minimum};
use super::search::Proposal;

/// Step of a difference quotient, as a share of the radius.
const LOOK: f64 = 1e-4;
/// Ratios of the reduction to what was predicted: above the first the prediction was good, below the second poor.
const GOOD: f64 = 0.7;
const POOR: f64 = 0.25;
/// The radius in lengths of the step, after a good and after a poor prediction.
const GROWS: f64 = 2.0;
const SHRINKS: f64 = 0.25;
/// After so many poor steps the slopes are looked up anew.
const POOR_STEPS: usize = 2;
/// The search ends where slopes that were looked up at its point promise no more than the first share of the sum of squares at their minimum,
/// or the second in the trust region.
const HOPELESS: f64 = 0.1;
const STUCK: f64 = 1e-3;
/// Evaluations after which a search is given up, and so many more for each axis.
const PATIENCE: (usize, usize) = (30, 5);

/// A search from a point down to a root, in shares of the axes: Gauss-Newton steps in a trust region (Levenberg 1944, doi
/// 10.1090/qam/10666), with slopes that are looked up along the axes and then corrected by each step (Broyden 1965, doi
/// 10.1090/S0025-5718-1965-0198670-6).
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct RootSearch {
    /// The best point, and the components there.
    point: Vec<f64>,
    residuals: Vec<f64>,
    /// Slopes of all components along the first axis, then along the next.
    slopes: Vec<f64>,
    radius: f64,
    /// Axes along which the slopes were looked up, and steps since then, of which so many were poor.
    looked: usize,
    steps: usize,
    poor: usize,
    evaluations: usize,
    /// By how much the sum of squares is to fall at the point that is out, if it is a step.
    predicted: Option<f64>,
    is_trusted: bool,
    /// The point that is out.
    pub(super) proposed: Vec<f64>,
}

impl RootSearch {
    /// Begins at a point with these components, with steps of at most this length. Memory is reused.
    pub(super) fn start(
        &mut self,
        point: impl Iterator<Item = f64>,
        residuals: impl Iterator<Item = f64>,
        radius: f64,
    ) {
        self.point.clear();
        self.point.extend(point);
        self.residuals.clear();
        self.residuals.extend(residuals);
        self.slopes.clear();
        self.slopes.resize(self.point.len() * self.residuals.len(), 0.0);
        self.radius = radius;
        self.evaluations = 0;
        self.predicted = None;
        self.is_trusted = false;
        self.proposed.clear();
        self.look_again();
    }

    /// Whether the components at the start are numbers.
    pub(super) fn is_possible(&self) -> bool {
        dot(&self.residuals, &self.residuals).is_finite()
    }

    /// Whether restored parts fit each other and so many axes.
    pub(super) fn fits(&self, axes: usize, components: usize) -> bool {
        self.point.len() == axes
            && self.residuals.len() == components
            && components > 0
            && axes.checked_mul(components) == Some(self.slopes.len())
            && self.looked <= axes
            && [0, axes].contains(&self.proposed.len())
            && (self.predicted.is_none() || self.proposed.len() == axes)
    }

    fn look_again(&mut self) {
        (self.looked, self.steps, self.poor) = (0, 0, 0);
    }

    /// Finds the next point; `periodic` says which axes have no ends. No step is shorter than `shortest`.
    pub(super) fn propose(&mut self, shortest: f64, periodic: &[bool], memory: &mut RootMemory) -> Proposal {
        let (n, m) = (self.point.len(), self.residuals.len());
        let squares = dot(&self.residuals, &self.residuals);
        let patience = PATIENCE.0 + PATIENCE.1 * n;
        if self.radius < shortest || self.evaluations >= patience {
            return Proposal::Ends;
        }
        self.evaluations += 1;
        self.predicted = None;
        self.proposed.clear();
        self.proposed.extend_from_slice(&self.point);
        if self.looked == n {
            let is_inside = self.step(periodic, memory);
            memory.rest.clear();
            memory.rest.extend_from_slice(&self.residuals);
            let moves = self.proposed.iter().zip(&self.point);
            for (slopes, (x, from)) in self.slopes.chunks_exact(m).zip(moves) {
                for (rest, slope) in memory.rest.iter_mut().zip(slopes) {
                    *rest += slope * (x - from);
                }
            }
            let falls = squares - dot(&memory.rest, &memory.rest);
            let least = if is_inside { HOPELESS } else { STUCK };
            if falls > least * squares {
                self.predicted = Some(falls);
                return if is_inside && self.is_trusted {
                    Proposal::Converges
                } else {
                    Proposal::Steps
                };
            }
            if self.steps == 0 {
                return Proposal::Ends;
            }
            self.look_again();
            self.proposed.copy_from_slice(&self.point);
        }
        let by = (LOOK * self.radius).max(shortest);
        let x = &mut self.proposed[self.looked];
        *x += if periodic[self.looked] || *x + by <= 1.0 {
            by
        } else {
            -by
        };
        Proposal::Looks
    }

    /// Moves the proposed point from the best one to the minimum of the sum of squares in the trust region; whether that is inside.
    fn step(&mut self, periodic: &[bool], memory: &mut RootMemory) -> bool {
        let (n, m) = (self.point.len(), self.residuals.len());
        let axes = self.slopes.chunks_exact(m);
        memory.matrix.clear();
        for a in axes.clone() {
            memory.matrix.extend(axes.clone().map(|b| dot(a, b)));
        }
        memory.slope.clear();
        memory.slope.extend(axes.map(|a| dot(a, &self.residuals)));
        eigen::symmetric(&mut memory.matrix, n, &mut memory.directions);
        memory.slopes.clear();
        memory.bends.clear();
        let values = memory.matrix.iter().step_by(n + 1);
        for (direction, value) in memory.directions.chunks_exact(n).zip(values) {
            memory.slopes.push(self.radius * dot(direction, &memory.slope));
            memory.bends.push(self.radius * self.radius * value.max(0.0));
        }
        memory.step.resize(n, 0.0);
        let (_, is_inside) = minimum(&memory.slopes, &memory.bends, &mut memory.step);
        for (direction, z) in memory.directions.chunks_exact(n).zip(&memory.step) {
            for (x, along) in self.proposed.iter_mut().zip(direction) {
                *x += self.radius * z * along;
            }
        }
        for (x, &periodic) in self.proposed.iter_mut().zip(periodic) {
            if !periodic {
                *x = x.clamp(0.0, 1.0);
            }
        }
        is_inside
    }

    /// Takes the components at the point that was proposed.
    pub(super) fn learn(&mut self, residuals: impl Iterator<Item = f64>, memory: &mut RootMemory) {
        memory.rest.clear();
        memory.rest.extend(residuals);
        let Some(predicted) = self.predicted else {
            return self.learn_slopes(&memory.rest);
        };
        let fits = memory.rest.len() == self.residuals.len();
        let now = if fits {
            dot(&memory.rest, &memory.rest)
        } else {
            f64::NAN
        };
        self.steps += 1;
        let moves = self.proposed.iter().zip(&self.point);
        let length: f64 = moves.map(|(x, from)| (x - from) * (x - from)).sum();
        let squares = dot(&self.residuals, &self.residuals);
        let ratio = if now.is_finite() {
            self.correct(&memory.rest, length);
            (squares - now) / predicted
        } else {
            f64::NEG_INFINITY
        };
        self.is_trusted = ratio > GOOD;
        if ratio > GOOD {
            self.radius = self.radius.max(GROWS * length.sqrt()).min(1.0);
        } else if ratio < POOR {
            self.radius = SHRINKS * length.sqrt();
            self.poor += 1;
        }
        if ratio > 0.0 {
            core::mem::swap(&mut self.point, &mut self.proposed);
            self.residuals.copy_from_slice(&memory.rest);
        }
        if self.poor == POOR_STEPS {
            self.look_again();
        }
    }

    /// Takes the slopes along the axis that was looked along; 0 where a component is not a number.
    fn learn_slopes(&mut self, residuals: &[f64]) {
        let m = residuals.len();
        let (j, is_finite) = (self.looked, dot(residuals, residuals).is_finite());
        let (Some(x), Some(slopes)) = (self.proposed.get(j), self.slopes.chunks_exact_mut(m).nth(j)) else {
            return;
        };
        self.looked += 1;
        let by = x - self.point[j];
        for ((slope, there), here) in slopes.iter_mut().zip(residuals).zip(&self.residuals) {
            *slope = if is_finite && by != 0.0 {
                (there - here) / by
            } else {
                0.0
            };
        }
    }

    /// Changes the slopes as little as the components at the proposed point ask for; `length` is the square of the step's.
    fn correct(&mut self, residuals: &[f64], length: f64) {
        let m = residuals.len();
        for (k, (there, here)) in residuals.iter().zip(&self.residuals).enumerate() {
            let moves = || self.proposed.iter().zip(&self.point).map(|(x, from)| x - from);
            let slopes = self.slopes.iter().skip(k).step_by(m);
            let predicted: f64 = moves().zip(slopes).map(|(along, slope)| along * slope).sum();
            let wrong = (there - here - predicted) / length;
            let (proposed, point) = (&self.proposed, &self.point);
            for (j, (x, from)) in proposed.iter().zip(point).enumerate() {
                self.slopes[j * m + k] += wrong * (x - from);
            }
        }
    }
}

/// Memory for one proposal after the other; nothing in it is kept.
#[derive(Debug, Default)]
pub(super) struct RootMemory {
    matrix: Vec<f64>,
    directions: Vec<f64>,
    slope: Vec<f64>,
    slopes: Vec<f64>,
    bends: Vec<f64>,
    step: Vec<f64>,
    rest: Vec<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Evaluations until all components are below the limit, from a point; `None` if the search ends before.
    fn evaluations<const M: usize>(
        components: impl Fn(&[f64]) -> [f64; M],
        start: &[f64],
        limit: f64,
    ) -> Option<usize> {
        let (mut search, mut memory) = (RootSearch::default(), RootMemory::default());
        let periodic = vec![false; start.len()];
        search.start(start.iter().copied(), components(start).into_iter(), 0.05);
        if !search.is_possible() {
            return None;
        }
        for count in 1.. {
            assert!(search.fits(start.len(), M));
            if search.propose(1e-9, &periodic, &mut memory) == Proposal::Ends {
                break;
            }
            assert!(search.proposed.iter().all(|x| (0.0..=1.0).contains(x)));
            let there = components(&search.proposed);
            if there.iter().all(|x| x.abs() < limit) {
                return Some(count);
            }
            search.learn(there.into_iter(), &mut memory);
        }
        None
    }

    /// Two looks, and steps of 0.05, 0.1, 0.2 and what is left.
    #[test]
    fn planes_are_met_once_their_slopes_are_known() {
        let planes = |x: &[f64]| [3.0 * x[0] - x[1] - 1.0, x[0] + 2.0 * x[1] - 1.5];
        let count = evaluations(planes, &[0.9, 0.1], 1e-9).unwrap();
        assert!(count <= 8, "{count}");
    }

    #[test]
    fn curved_components_are_followed_to_their_root() {
        let valley = |x: &[f64]| [100.0 * (x[1] - 0.4 * x[0] * x[0] - 0.2), x[0] - 0.8];
        let count = evaluations(valley, &[0.2, 0.9], 1e-6).unwrap();
        assert!(count <= 30, "{count}");
        // More axes than components: a circle in space.
        let circle = |x: &[f64]| [(x[0] - 0.5).hypot(x[1] - 0.5) - 0.3, x[2] - x[0] * x[1]];
        let count = evaluations(circle, &[0.6, 0.9, 0.1], 1e-6).unwrap();
        assert!(count <= 30, "{count}");
    }

    #[test]
    fn a_search_without_a_root_or_a_number_ends() {
        assert_eq!(
            evaluations(|x| [x[0] * x[0] + 0.1, x[1] - 0.5], &[0.4, 0.1], 1e-3),
            None
        );
        assert_eq!(evaluations(|_| [1.0, 2.0], &[0.4, 0.1], 1e-3), None);
        assert_eq!(evaluations(|_| [f64::NAN], &[0.4], 1e-3), None);
        assert_eq!(
            evaluations(|x| [if x[0] > 0.4 { f64::INFINITY } else { 1.0 }], &[0.4], 1e-3),
            None
        );
    }
}
