//! One lane of a search: an engine, its random numbers, and its slice.

use super::slice::Slice;
use super::stage::{BatchSource, Stage};
use super::steps::SingleSteps;
use crate::archive::Archive;
use crate::batch::Outcome;
use crate::budget::StopReason;
use crate::engine::{Ask, Engine, Origin};
use crate::identity::Identity;
use crate::observer::Observer;
use crate::problem::AnyProblem;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::threads::Threads;
use crate::view::View;

/// An engine that asks for more this often without proposing anything has nothing to propose.
pub(super) const EMPTY_ASKS: usize = 1000;

/// What a lane keeps from slice to slice.
pub(super) struct Lane<S> {
    pub(super) engine: Box<dyn Engine<S>>,
    pub(super) rng: SearchRng,
}

/// A lane within a slice.
pub(super) struct RunningLane<S, T> {
    pub(super) lane: Lane<S>,
    pub(super) slice: Slice<S, T>,
}

impl<S: Real, T: Identity + Clone + Send + Sync> RunningLane<S, T> {
    /// Whether the slice was cancelled.
    pub(super) fn is_cancelled(&self) -> bool {
        self.slice.ledger.stop == Some(StopReason::Cancelled)
    }

    /// Fills the batch and prepares its candidates; `false` if the slice is over or pauses. With an observer, an engine that
    /// can advances by itself on the way.
    #[inline]
    pub(super) fn propose(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        previous: &Archive<T>,
        mut alone: Option<&mut dyn Observer<T>>,
    ) -> bool {
        let Self { lane, slice } = self;
        let deletes = lane.engine.deletes();
        if let Stage::Repeat(_) = slice.stage {
            if let Stage::Repeat(pending) = core::mem::replace(&mut slice.stage, Stage::Propose) {
                slice.propose_again(problem, previous, pending, deletes);
            }
            return true;
        }
        let mut idle = 0;
        loop {
            if slice.ledger.is_over() || slice.ledger.counts.evaluations >= slice.pause {
                return false;
            }
            if !slice.to_verify.is_empty() {
                slice.propose_previous(problem, previous);
                return true;
            }
            if !slice.starts.is_empty() {
                slice.propose_starts(problem, deletes);
                return true;
            }
            if slice.probes.is_due(slice.ledger.counts.evaluations) {
                slice.propose_probes(problem, usize::MAX);
                return true;
            }
            if slice.last != Ask::More || idle >= EMPTY_ASKS {
                let covered = slice.last == Ask::Covered;
                slice.ledger.stop = Some(if covered {
                    StopReason::Covered
                } else {
                    StopReason::Exhausted
                });
                return false;
            }
            if let Some(observer) = &mut alone {
                let mut steps = SingleSteps {
                    problem,
                    ledger: &mut slice.ledger,
                    candidates: &mut slice.candidates,
                    probes: &slice.probes,
                    observer: *observer,
                    deletes,
                    pause: slice.pause,
                    over: false,
                };
                if lane.engine.advance(&mut lane.rng, &mut steps) {
                    idle = 0;
                    continue;
                }
            }
            slice.batch.clear();
            // Not by `Slice::view`: the batch is borrowed beside it.
            let view = View {
                problem,
                previous,
                ledger: &slice.ledger,
                calls: &slice.calls,
                scratches: &slice.scratches,
            };
            slice.last = lane.engine.ask(&view, &mut lane.rng, &mut slice.batch);
            let bounds = slice.calls.bounds.get();
            let works = bounds > slice.ledger.counts.bound_calls;
            if works {
                slice.ledger.count_bounds(bounds);
            }
            if !slice.batch.is_empty() {
                slice.prepare(problem, BatchSource::Engine, deletes);
                return true;
            }
            // An engine that works on bounds has not come to its end.
            idle = if works { 0 } else { idle + 1 };
        }
    }

    /// Settles the batch and tells the engine.
    #[inline]
    pub(super) fn settle(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        previous: &Archive<T>,
        observer: &mut dyn Observer<T>,
    ) {
        let Self { lane, slice } = self;
        let (Stage::Settle(from) | Stage::Asked(from)) = slice.stage else {
            return;
        };
        slice.stage = Stage::Propose;
        slice.ledger.settle(problem, &mut slice.candidates, observer);
        let origin = match from {
            BatchSource::Probes => return slice.settle_probes(problem),
            BatchSource::WarmStart => {
                let outcomes = slice.candidates.outcomes.iter();
                let verified = outcomes.filter(|outcome| **outcome != Outcome::NotEvaluated);
                slice.ledger.counts.verified += verified.count() as u64;
                if slice.batch.is_empty() {
                    return; // a problem without an encoding: the engine has nothing to see
                }
                Origin::WarmStart
            }
            BatchSource::Starts => Origin::Start,
            BatchSource::Engine => {
                if slice.last == Ask::Covered && !slice.candidates.outcomes.contains(&Outcome::NotEvaluated) {
                    // That was the last of the space, even if the budget ends with it.
                    slice.ledger.stop = Some(StopReason::Covered);
                }
                Origin::Engine
            }
        };
        let view = slice.view(problem, previous);
        lane.engine
            .tell(&view, &slice.batch, &slice.candidates.outcomes, origin);
        slice.record_sources(core::iter::once_with(|| lane.engine.sources()));
    }

    /// Runs until the slice is over or pauses. `keep` is given if a checkpoint may be wanted: then a batch that a
    /// cancellation has cut short is left as it is, and the lane returns early once `keep` has passed.
    pub(super) fn advance(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        previous: &Archive<T>,
        keep: Option<core::time::Duration>,
    ) {
        let threads = Threads::default();
        loop {
            let mut silent = ();
            let alone: Option<&mut dyn Observer<T>> = match keep {
                None => Some(&mut silent),
                Some(_) => None,
            };
            if !self.propose(problem, previous, alone) {
                return;
            }
            self.slice
                .ledger
                .evaluate(problem, &mut self.slice.candidates, &threads);
            if keep.is_some() && self.slice.ledger.stop == Some(StopReason::Cancelled) {
                return;
            }
            self.settle(problem, previous, &mut ());
            if keep.is_some_and(|keep| self.slice.ledger.clock.seen() >= keep) {
                return;
            }
        }
    }
}
