//! A slice that is driven. Compiled once for each type of solution.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use super::checkpoint::Checkpoint;
use super::kept::KeptSearch;
use super::lane::RunningLane;
use super::lanes::Exchange;
use super::options::{Keeper, RunOptions, message_of};
use super::running::{Running, Turn, first_lane};
use super::stage::Stage;
use crate::budget::StopReason;
use crate::error::Error;
use crate::identity::Identity;
use crate::observer::Observer;
use crate::problem::AnyProblem;
use crate::report::Report;
use crate::scalar::Real;
use crate::threads::Threads;

/// A slice that has begun, whatever the type of its problem.
pub(super) struct Driven<'a, S: Real, T: Identity + Clone + Send + Sync> {
    pub(super) kept: &'a mut KeptSearch<S, T>,
    /// Taken by `finish`.
    pub(super) running: Option<Running<S, T>>,
    /// The batch that is out.
    pub(super) turn: Turn,
}

impl<S: Real, T: Identity + Clone + Send + Sync> Driven<'_, S, T> {
    /// The next solutions to evaluate; none once the slice is over.
    pub(super) fn ask(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        observer: &mut dyn Observer<T>,
    ) -> Result<&[T], Error> {
        let Some(running) = &mut self.running else {
            return Ok(&[]);
        };
        if let Some(slice) = running.slice_at(self.turn) {
            return Err(Error::Tell {
                wanted: slice.candidates.live().len(),
                got: 0,
            });
        }
        let previous = Arc::clone(&self.kept.previous);
        loop {
            let turn = running.propose(problem, &previous, observer);
            match running.slice_at(turn) {
                None => return Ok(&[]),
                Some(slice) if !slice.candidates.live().is_empty() => {
                    if let Stage::Settle(from) = slice.stage {
                        slice.stage = Stage::Asked(from);
                        slice.ledger.goes_out();
                    }
                    self.turn = turn;
                    break;
                }
                // All of them are in the archive: there is nothing to evaluate, but time passes.
                Some(slice) => {
                    slice.ledger.evaluated_elsewhere(slice.candidates.outcomes.len());
                    running.settle(turn, problem, &previous, observer);
                }
            }
        }
        Ok(match running.slice_at(self.turn) {
            Some(slice) => slice.candidates.live(),
            None => &[],
        })
    }

    /// Takes the fitness of all that is out.
    pub(super) fn tell(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        fitness: &[S],
        observer: &mut dyn Observer<T>,
    ) -> Result<(), Error> {
        let turn = self.turn;
        let slice = self.running.as_mut().and_then(|running| running.slice_at(turn));
        let Some(slice) = slice else {
            return Err(Error::Tell {
                wanted: 0,
                got: fitness.len(),
            });
        };
        slice.candidates.take_fitness(fitness)?;
        slice.ledger.evaluated_elsewhere(fitness.len());
        self.turn = Turn::Over;
        if let Some(running) = &mut self.running {
            running.settle(turn, problem, &self.kept.previous, observer);
        }
        Ok(())
    }

    /// Takes the fitness of the first candidates that are out.
    pub(super) fn note(&mut self, fitness: &[S]) -> Result<(), Error> {
        let turn = self.turn;
        match self.running.as_mut().and_then(|running| running.slice_at(turn)) {
            Some(slice) => slice.candidates.take_first(fitness),
            None if fitness.is_empty() => Ok(()),
            None => Err(Error::Tell {
                wanted: 0,
                got: fitness.len(),
            }),
        }
    }

    /// The fitness of the first candidates that are out, as far as it is known.
    pub(super) fn noted(&self) -> &[S] {
        let slice = self.running.as_ref().and_then(|running| match self.turn {
            Turn::Lane(lane) => running.lanes.get(lane).map(|lane| &lane.slice),
            Turn::Probes => running.exchange.as_ref().map(|exchange| &exchange.common),
            Turn::Over => None,
        });
        slice.map_or(&[], |slice| {
            let known = slice.candidates.ready.min(slice.candidates.live);
            &slice.candidates.fitness[..known]
        })
    }

    /// Whether the time is up or the slice is cancelled.
    pub(super) fn is_interrupted(&mut self) -> bool {
        let turn = self.turn;
        let slice = self.running.as_mut().and_then(|running| running.slice_at(turn));
        slice.is_some_and(|slice| slice.ledger.has_stopped())
    }

    /// Ends the slice in the middle of a batch, with the fitness of its first candidates.
    pub(super) fn end_with(&mut self, problem: &AnyProblem<'_, S, T>, fitness: &[S]) -> Result<(), Error> {
        let turn = core::mem::replace(&mut self.turn, Turn::Over);
        let Some(running) = &mut self.running else {
            return Ok(());
        };
        match running.slice_at(turn) {
            Some(slice) => {
                if let Err(error) = slice.candidates.take_first(fitness) {
                    self.turn = turn;
                    return Err(error);
                }
                slice.ledger.evaluated_elsewhere(fitness.len());
                slice.ledger.give_up();
            }
            None if fitness.is_empty() => {}
            None => {
                return Err(Error::Tell {
                    wanted: 0,
                    got: fitness.len(),
                });
            }
        }
        running.settle(turn, problem, &self.kept.previous, &mut ());
        let searching = running.exchange.as_ref().is_some_and(Exchange::is_searching);
        if searching || (running.exchange.is_some() && turn != Turn::Over) {
            let reason = running.slice_at(turn).and_then(|slice| slice.ledger.stop);
            running.end(reason.unwrap_or(StopReason::Cancelled));
        }
        Ok(())
    }

    /// The search and the slice as they are now.
    pub(super) fn checkpoint(&self) -> Checkpoint<T> {
        self.kept.save(self.running.as_ref())
    }

    /// Ends the slice and reports.
    pub(super) fn finish(mut self, problem: &AnyProblem<'_, S, T>) -> Report<T> {
        let running = self.running.take();
        match running {
            Some(running) => self.kept.report(problem, running),
            None => unreachable!("a slice is finished once"),
        }
    }

    /// Runs the slice to its end.
    pub(super) fn drive(
        mut self,
        problem: &AnyProblem<'_, S, T>,
        options: RunOptions<'_, T>,
    ) -> Result<Report<T>, Error> {
        let threads = match self.kept.pool.take() {
            Some(threads) => threads,
            None => Threads::new(self.kept.threads)?,
        };
        let mut silent = ();
        let RunOptions {
            observer,
            mut keeper,
            catches_panics,
            ..
        } = options;
        let observer = observer.unwrap_or(&mut silent);
        if catches_panics {
            let run = AssertUnwindSafe(|| self.drive_on(problem, &threads, observer, &mut keeper));
            if let Err(panic) = catch_unwind(run) {
                self.end_after_panic();
                // Threads may still hold what the panic has left.
                self.kept.pool = None;
                let mut report = self.finish_without_lanes(problem);
                report.panic = Some(message_of(panic.as_ref()));
                return Ok(report);
            }
        } else {
            self.drive_on(problem, &threads, observer, &mut keeper);
        }
        self.kept.pool = Some(threads);
        if let Some(keeper) = keeper {
            keeper.save_end(|| self.checkpoint());
        }
        Ok(self.finish(problem))
    }

    fn drive_on(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        threads: &Threads,
        observer: &mut dyn Observer<T>,
        keeper: &mut Option<Keeper<'_, T>>,
    ) {
        let previous = Arc::clone(&self.kept.previous);
        let several = self
            .running
            .as_ref()
            .is_some_and(|running| running.exchange.is_some());
        if several {
            self.drive_lanes(problem, threads, &previous, observer, keeper);
        } else {
            self.drive_alone(problem, threads, &previous, observer, keeper);
        }
    }

    fn drive_alone(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        threads: &Threads,
        previous: &crate::archive::Archive<T>,
        observer: &mut dyn Observer<T>,
        keeper: &mut Option<Keeper<'_, T>>,
    ) {
        // While an engine advances by itself, no checkpoint can be taken.
        let advance = keeper.is_none();
        loop {
            let Some(lane) = first_lane(&mut self.running) else {
                return;
            };
            let alone: Option<&mut dyn Observer<T>> = if advance { Some(&mut *observer) } else { None };
            if !lane.propose(problem, previous, alone) {
                return;
            }
            self.evaluate(problem, Turn::Lane(0), threads, keeper);
            let Some(lane) = first_lane(&mut self.running) else {
                return;
            };
            lane.settle(problem, previous, observer);
            if lane.slice.ledger.has_shared() {
                threads.wake();
            }
        }
    }

    fn drive_lanes(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        threads: &Threads,
        previous: &crate::archive::Archive<T>,
        observer: &mut dyn Observer<T>,
        keeper: &mut Option<Keeper<'_, T>>,
    ) {
        loop {
            let Some(Running {
                lanes,
                exchange: Some(exchange),
            }) = &mut self.running
            else {
                return;
            };
            if exchange.is_searching() {
                let keep = keeper.as_ref().map(Keeper::next);
                exchange.run_round(lanes, problem, previous, threads, keep);
                self.save_if_due(Turn::Over, keeper);
                let Some(Running {
                    lanes,
                    exchange: Some(exchange),
                }) = &mut self.running
                else {
                    return;
                };
                for lane in &mut *lanes {
                    lane.settle(problem, previous, &mut ());
                }
                // A lane that is cancelled ends all of them: what was saved is the round before its exchange.
                if lanes.iter().any(RunningLane::is_cancelled) {
                    for lane in lanes.iter_mut() {
                        lane.slice.ledger.stop.get_or_insert(StopReason::Cancelled);
                    }
                }
                if exchange.is_due(lanes) {
                    exchange.between_rounds(lanes, observer);
                }
            } else if exchange.propose_probes(problem) {
                self.evaluate(problem, Turn::Probes, threads, keeper);
                if let Some(running) = &mut self.running {
                    running.settle(Turn::Probes, problem, previous, observer);
                }
            } else {
                return;
            }
        }
    }

    /// Evaluates the batch that is out, and saves it if a checkpoint comes due meanwhile.
    #[inline]
    fn evaluate(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        turn: Turn,
        threads: &Threads,
        keeper: &mut Option<Keeper<'_, T>>,
    ) {
        loop {
            let Some(slice) = self.running.as_mut().and_then(|running| running.slice_at(turn)) else {
                return;
            };
            slice.ledger.hold = keeper.as_ref().map(Keeper::next);
            slice.ledger.evaluate(problem, &mut slice.candidates, threads);
            let complete = slice.ledger.stop.is_some() || slice.candidates.is_complete();
            self.save_if_due(turn, keeper);
            if complete {
                return;
            }
        }
    }

    /// Saves a batch that a cancellation has cut short before it is settled, so that it can be completed; and now and then.
    #[inline]
    fn save_if_due(&mut self, turn: Turn, keeper: &mut Option<Keeper<'_, T>>) {
        let (Some(keeper), Some(running)) = (keeper, &mut self.running) else {
            return;
        };
        let (stop, now) = match running.slice_at(turn) {
            Some(slice) => (slice.ledger.stop, slice.ledger.clock.seen()),
            None => {
                let cancelled = running.lanes.iter().any(RunningLane::is_cancelled);
                let elapsed = running.reported().ledger.clock.elapsed();
                (cancelled.then_some(StopReason::Cancelled), elapsed)
            }
        };
        let cancelled = stop == Some(StopReason::Cancelled);
        if cancelled || (stop.is_none() && now >= keeper.next()) {
            let clock = || running.reported().ledger.clock.elapsed();
            let begun = clock();
            keeper.save(&self.kept.save(Some(running)), cancelled, begun, clock);
        }
    }

    /// Ends the slice with what its archives hold.
    fn end_after_panic(&mut self) {
        if let Some(running) = &mut self.running {
            running.end(StopReason::Panicked);
        }
    }

    /// [`Stepper::finish`], but the engines, which a panic may have left in the middle of something, are rebuilt for the
    /// next slice.
    fn finish_without_lanes(mut self, problem: &AnyProblem<'_, S, T>) -> Report<T> {
        let running = self.running.take();
        let Some(running) = running else {
            unreachable!("a slice is finished once")
        };
        let report = self.kept.report(problem, running);
        self.kept.lanes.clear();
        report
    }
}

impl<S: Real, T: Identity + Clone + Send + Sync> Drop for Driven<'_, S, T> {
    /// Gives the engines back, for the next slice; after a panic they are rebuilt.
    fn drop(&mut self) {
        if let Some(running) = self.running.take()
            && !std::thread::panicking()
        {
            self.kept.lanes = running.into_parts().1;
        }
    }
}
