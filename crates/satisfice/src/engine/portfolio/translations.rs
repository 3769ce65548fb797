//! Steps that have led from one hit to another, and their application to every hit.
//!
//! On a lattice they include the unit steps along each axis from the start; a flood fill around a hit is the special case of
//! these. Others are learned: where hits repeat or lie on a manifold, the difference of two hits is worth a trial from a third.

use crate::scalar::Real;
use crate::space::{Axis, Space};

/// Most steps that are kept, unit steps included; [`FEWEST`] learned ones are kept in any case.
const MOST: usize = 128;
const FEWEST: usize = 16;
/// Most coordinates of learned steps, 8 MB, where that leaves room for four steps.
const MOST_COORDINATES: usize = 1 << 20;
/// Rate of a step before it is tried.
const UNTRIED: f64 = 0.02;
/// Past trials of a step are halved at this number, so that its rate follows the search.
const MEMORY: f64 = 400.0;

/// A step and its trials.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
struct Step {
    trials: f64,
    hits: f64,
    /// The next hit to apply it to.
    cursor: usize,
    /// The rate of hits, beside the trials because it is asked for more often than they change.
    rate: f64,
}

impl Step {
    fn new(trials: f64, hits: f64) -> Self {
        Self {
            trials,
            hits,
            cursor: 0,
            rate: rate(trials, hits),
        }
    }
}

/// The rate of hits of a step; of an untried one, `UNTRIED`.
fn rate(trials: f64, hits: f64) -> f64 {
    (hits + UNTRIED) / (trials + 1.0)
}

fn integer_axes<S: Real>(space: &Space<S>) -> Vec<usize> {
    let axes = space.axes().iter().enumerate();
    axes.filter_map(|(j, axis)| axis.is_integer().then_some(j))
        .collect()
}

/// The steps, each with a cursor into the list of hits: every step meets every hit once, best steps first. Memory: O(steps),
/// not O(hits x steps).
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Translations<S> {
    /// The integer axes. Two steps for each come first, back and forth; they are not stored as vectors.
    units: Vec<usize>,
    /// The learned steps' vectors.
    vectors: Vec<S>,
    steps: Vec<Step>,
}

impl<S: Real> Translations<S> {
    /// The unit steps along the integer axes, each with a prior of one hit in two trials.
    pub(super) fn new(space: &Space<S>) -> Self {
        let units = integer_axes(space);
        let hopeful = Step::new(2.0, 1.0);
        Self {
            steps: vec![hopeful; 2 * units.len()],
            units,
            vectors: Vec::new(),
        }
    }

    /// The axis and the length of unit step `index`; `None` for a learned one.
    #[inline]
    fn unit(&self, index: usize) -> Option<(usize, S)> {
        let axis = *self.units.get(index / 2)?;
        Some((
            axis,
            if index.is_multiple_of(2) {
                -S::one()
            } else {
                S::one()
            },
        ))
    }

    /// Whether they are steps of a space with the same integer axes as this one.
    pub(super) fn fit(&self, space: &Space<S>) -> bool {
        self.units == integer_axes(space)
    }

    /// Begins a new list of hits.
    pub(super) fn begin(&mut self) {
        for step in &mut self.steps {
            step.cursor = 0;
        }
    }

    /// The step with the best rate among those that have not met all `hits`.
    /// Cost: O(steps).
    pub(super) fn best(&self, hits: usize) -> Option<usize> {
        let open = self
            .steps
            .iter()
            .enumerate()
            .filter(|(_, step)| step.cursor < hits);
        let (index, _) = open.max_by(|(_, a), (_, b)| a.rate.total_cmp(&b.rate))?;
        Some(index)
    }

    /// Writes the next hit moved by step `index`; `false` when that step has met all hits.
    #[inline]
    pub(super) fn apply(&mut self, index: usize, hits: &[S], position: &mut [S]) -> bool {
        let dimension = position.len();
        let start = self.steps[index].cursor * dimension;
        let Some(hit) = hits.get(start..start + dimension) else {
            return false;
        };
        self.steps[index].cursor += 1;
        if let Some((axis, step)) = self.unit(index) {
            position.copy_from_slice(hit);
            position[axis] = position[axis] + step;
            return true;
        }
        let learned = index - 2 * self.units.len();
        let vector = &self.vectors[learned * dimension..(learned + 1) * dimension];
        for ((x, &h), &v) in position.iter_mut().zip(hit).zip(vector) {
            *x = h + v;
        }
        true
    }

    /// Counts a trial of step `index`.
    #[inline]
    /// The number of steps.
    pub(super) fn len(&self) -> usize {
        self.steps.len()
    }

    /// Whether restored parts fit each other and a space of so many axes.
    pub(super) fn is_whole(&self, dimension: usize) -> bool {
        let learned = self.steps.len().checked_sub(2 * self.units.len());
        self.units.iter().all(|&axis| axis < dimension)
            && learned.is_some_and(|learned| Some(self.vectors.len()) == learned.checked_mul(dimension))
    }

    pub(super) fn count(&mut self, index: usize, hit: bool) {
        let step = &mut self.steps[index];
        step.trials += 1.0;
        step.hits += f64::from(u8::from(hit));
        if step.trials > MEMORY {
            step.trials *= 0.5;
            step.hits *= 0.5;
        }
        step.rate = rate(step.trials, step.hits);
    }

    /// Learns a step that has just led to a hit, and its reverse.
    pub(super) fn learn(&mut self, vector: &[S], space: &Space<S>) {
        let dimension = vector.len();
        let units = 2 * self.units.len();
        let most = MOST
            .saturating_sub(units)
            .max(FEWEST)
            .min((MOST_COORDINATES / dimension).max(4));
        // On continuous axes, equal steps between inexact hits differ a little.
        let tolerance = |axis: &Axis<S>| {
            if axis.is_integer() {
                S::of(0.5)
            } else {
                S::of(5e-4) * axis.width()
            }
        };
        let mut moved = (0..dimension).filter(|&j| vector[j].abs() > tolerance(&space.axes()[j]));
        if let (Some(j), None) = (moved.next(), moved.next())
            && space.axes()[j].is_integer()
            && vector[j].abs() == S::one()
        {
            return;
        }
        for sign in [S::one(), -S::one()] {
            let same = |known: &[S]| {
                known
                    .iter()
                    .zip(vector)
                    .zip(space.axes())
                    .all(|((&k, &v), axis)| (k - sign * v).abs() <= tolerance(axis))
            };
            if self.vectors.chunks_exact(dimension).any(same) {
                continue;
            }
            let signed = vector.iter().map(|&v| sign * v);
            let step = Step::new(1.0, 0.5);
            if self.steps.len() - units < most {
                self.vectors.extend(signed);
                self.steps.push(step);
                continue;
            }
            let learned = units..self.steps.len();
            let worst = learned.min_by(|&a, &b| self.steps[a].rate.total_cmp(&self.steps[b].rate));
            if let Some(worst) = worst {
                self.steps[worst] = step;
                for (old, new) in self.vectors[(worst - units) * dimension..].iter_mut().zip(signed) {
                    *old = new;
                }
            }
        }
    }
}
