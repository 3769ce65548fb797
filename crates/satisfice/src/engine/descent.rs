//! Greedy descent over neighbours, restarted.

use super::{Ask, Engine, Origin};
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::error::Error;
use crate::parameter::{Parameter, Values};
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::{Boundary, Space};
use crate::state::{Part, Reader, State};

/// The row for the first compass step.
pub(super) const STEP: Parameter = Parameter::real(
    "step",
    "first step on continuous axes, as a share of each",
    0.25,
    1e-12,
    1.0,
);

/// The row for the last compass step.
pub(super) const SHORTEST: Parameter = Parameter::real(
    "shortest",
    "shortest step on continuous axes, as a share of each",
    1e-6,
    1e-15,
    1.0,
);

pub(super) const PARAMETERS: &[Parameter] = &[STEP, SHORTEST];

/// From a uniform point to its best neighbour, as long as that is better; then from a new uniform point.
///
/// Neighbours are the problem's own, or else the next lattice points, and on continuous axes the points a step away in both
/// directions of each axis (compass search, Kolda, Lewis, Torczon 2003, doi 10.1137/S003614450242889). Where none is
/// better, the step is halved. A descent ends at a hit, at its shortest step, where it has no better neighbour on a
/// lattice, or where it has none and touches a found solution. Hits are deleted.
///
/// After the descent of feature pairs in Guy, Debunne 2004 (INRIA RR-5136) and Kimmerle, Nesme, Faure 2004 (VMV). Differs
/// from them in that it moves to the best neighbour of all.
#[derive(Debug)]
pub(super) struct Descent<S> {
    first_step: S,
    shortest: S,
    /// Empty before a start point has been told.
    point: Vec<S>,
    fitness: S,
    step: S,
    /// Whether a neighbour was left out because it is in C.
    touches: bool,
}

impl<S: Real> Descent<S> {
    /// A descent by the rows [`STEP`] and [`SHORTEST`].
    pub(super) fn new(values: &Values) -> Self {
        Self {
            first_step: S::of(values.real("step")),
            shortest: S::of(values.real("shortest")),
            point: Vec::new(),
            fitness: S::infinity(),
            step: S::zero(),
            touches: false,
        }
    }

    /// Ends the descent; the next one starts at a uniform point.
    pub(super) fn restart(&mut self) {
        self.point.clear();
    }

    /// Proposes the neighbours, or a uniform point.
    pub(super) fn propose(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) {
        // A restored point may be of another space.
        if self.point.len() == out.dimension() {
            let mut touches = false;
            let mut propose = |position: &[S]| {
                if context.is_deleted(position) {
                    touches = true;
                } else {
                    out.push(position);
                }
            };
            let _ = context.neighbours(&self.point, &mut propose);
            // The compass moves the point and puts it back.
            compass(context.space(), &mut self.point, self.step, &mut propose);
            self.touches = touches;
        }
        if out.is_empty() {
            self.restart();
            out.push_with(|position| rng.position(context.space(), position));
        }
    }

    /// Goes on from what became of the proposals.
    pub(super) fn learn(&mut self, space: &Space<S>, batch: &Batch<S>, outcomes: &[Outcome<S>]) {
        if outcomes.iter().any(|outcome| outcome.is_hit()) {
            return self.restart();
        }
        if self.point.is_empty() {
            if outcomes[0].fitness() < S::infinity() {
                self.point.extend_from_slice(batch.point(0));
                self.fitness = outcomes[0].fitness();
                self.step = self.first_step;
            }
            return;
        }
        let mut better = None;
        for (i, outcome) in outcomes.iter().enumerate() {
            if outcome.fitness() < self.fitness {
                self.fitness = outcome.fitness();
                better = Some(i);
            }
        }
        if let Some(i) = better {
            self.point.copy_from_slice(batch.point(i));
        } else {
            self.step = self.step / S::of(2.0);
            if self.touches || self.step < self.shortest || !has_compass(space) {
                self.restart();
            }
        }
    }
}

/// Whether any axis has compass steps.
fn has_compass<S: Real>(space: &Space<S>) -> bool {
    space
        .axes()
        .iter()
        .any(|axis| !axis.is_integer() && axis.width() > S::zero())
}

/// Visits the points a `step` (a share of the axis) away from `point` on each continuous axis; beyond a bound, the bound.
fn compass<S: Real>(space: &Space<S>, point: &mut [S], step: S, visit: &mut dyn FnMut(&[S])) {
    let periodic = space.boundary() == Boundary::Wrap;
    for (j, axis) in space.axes().iter().enumerate() {
        if axis.is_integer() {
            continue;
        }
        let here = point[j];
        let length = step * axis.width();
        for there in [here - length, here + length] {
            let there = if periodic {
                there
            } else {
                there.max(axis.lower()).min(axis.upper())
            };
            if there != here {
                point[j] = there;
                visit(point);
            }
        }
        point[j] = here;
    }
}

impl<S: Real> Part for Descent<S> {
    crate::saved_fields!(point, fitness, step, touches);
}

pub(super) fn build<S: Real>(values: &Values) -> Result<Box<dyn Engine<S>>, Error> {
    Ok(Box::new(Descent::new(values)))
}

impl<S: Real> Engine<S> for Descent<S> {
    fn begin(&mut self, _: &dyn Context<S>) {
        self.restart();
    }

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        self.propose(context, rng, out);
        Ask::More
    }

    fn tell(&mut self, context: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        if origin == Origin::Engine {
            self.learn(context.space(), batch, outcomes);
        }
    }

    fn save(&self, state: &mut State) {
        Part::save(self, state);
    }

    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        Part::restore(self, from)
    }
}
