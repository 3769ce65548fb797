//! A slice that has begun: driven to its end by the search, or by hand.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use super::Search;
use super::checkpoint::Checkpoint;
use super::lane::RunningLane;
use super::lanes::Exchange;
use super::options::{Keeper, RunOptions, message_of};
use super::running::{Running, Turn};
use super::stage::Stage;
use crate::budget::StopReason;
use crate::error::Error;
use crate::observer::Observer;
use crate::problem::SatisficingProblem;
use crate::report::Report;
use crate::threads::Threads;

/// A slice that has begun, to be driven by hand: [`ask`](Stepper::ask), evaluate, [`tell`](Stepper::tell) until `ask` gives
/// nothing, then [`finish`](Stepper::finish).
///
/// It borrows the search and the problem, so that neither can change before the slice is finished. Dropped before, the slice
/// is forgotten: the next one starts from the hits of the slice before.
///
/// ```
/// use satisfice::{from_fn, Budget, SatisficingProblem, Search, Space};
///
/// let problem = from_fn(Space::lattice(2, 50)?, 3.0, |x: &[f64]| x[0] + x[1]);
/// let mut search = Search::new();
/// let mut slice = search.start(&problem, &Budget::evaluations(5000))?;
/// loop {
///     let candidates = slice.ask()?;
///     if candidates.is_empty() {
///         break;
///     }
///     // On a cluster, in a simulator, in another language:
///     let fitness: Vec<f64> = candidates.iter().map(|c| problem.fitness(c)).collect();
///     slice.tell(&fitness)?;
/// }
/// assert_eq!(slice.finish().hit_count(), 6);
/// # Ok::<(), satisfice::Error>(())
/// ```
pub struct Stepper<'a, P: SatisficingProblem + ?Sized> {
    pub(super) search: &'a mut Search<P>,
    pub(super) problem: &'a P,
    /// Taken by `finish`.
    pub(super) running: Option<Running<P::Scalar, P::Solution>>,
    /// The batch that is out.
    pub(super) turn: Turn,
}

impl<P: SatisficingProblem + ?Sized> core::fmt::Debug for Stepper<'_, P> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Stepper")
            .field("turn", &self.turn)
            .finish_non_exhaustive()
    }
}

impl<'a, P: SatisficingProblem + ?Sized> Stepper<'a, P> {
    pub(super) fn new(
        search: &'a mut Search<P>,
        problem: &'a P,
        running: Running<P::Scalar, P::Solution>,
    ) -> Self {
        Self {
            search,
            problem,
            running: Some(running),
            turn: Turn::Over,
        }
    }

    /// The next solutions to evaluate, none of them in the archive; none at all once the slice is over.
    ///
    /// # Errors
    /// [`Error::Tell`] if the last ones have not been told.
    pub fn ask(&mut self) -> Result<&[P::Solution], Error> {
        self.ask_with(&mut ())
    }

    /// [`Stepper::ask`] with an observer, which is told of hits and progress and may end the slice.
    ///
    /// # Errors
    /// As [`Stepper::ask`].
    pub fn ask_with(&mut self, observer: &mut dyn Observer<P::Solution>) -> Result<&[P::Solution], Error> {
        let Some(running) = &mut self.running else {
            return Ok(&[]);
        };
        if let Some(slice) = running.slice_at(self.turn) {
            return Err(Error::Tell {
                wanted: slice.candidates.live().len(),
                got: 0,
            });
        }
        let previous = Arc::clone(&self.search.previous);
        loop {
            let turn = running.propose(self.problem, &previous, observer);
            match running.slice_at(turn) {
                None => return Ok(&[]),
                Some(slice) if !slice.candidates.live().is_empty() => {
                    if let Stage::Settle(from) = slice.stage {
                        slice.stage = Stage::Asked(from);
                    }
                    self.turn = turn;
                    break;
                }
                // All of them are in the archive: there is nothing to evaluate, but time passes.
                Some(slice) => {
                    slice.ledger.evaluated_elsewhere(slice.candidates.outcomes.len());
                    running.settle(turn, self.problem, &previous, observer);
                }
            }
        }
        Ok(match running.slice_at(self.turn) {
            Some(slice) => slice.candidates.live(),
            None => &[],
        })
    }

    /// Tells the fitness of what [`ask`](Stepper::ask) gave, in its order.
    ///
    /// # Errors
    /// [`Error::Tell`] if nothing was asked, or for another number of values; then the batch is still to be told.
    pub fn tell(&mut self, fitness: &[P::Scalar]) -> Result<(), Error> {
        self.tell_with(fitness, &mut ())
    }

    /// [`Stepper::tell`] with an observer, which is told of hits and progress and may end the slice.
    ///
    /// # Errors
    /// As [`Stepper::tell`].
    pub fn tell_with(
        &mut self,
        fitness: &[P::Scalar],
        observer: &mut dyn Observer<P::Solution>,
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
            running.settle(turn, self.problem, &self.search.previous, observer);
        }
        Ok(())
    }

    /// Enters the fitness of the first of the candidates that [`ask`](Stepper::ask) gave, as far as they are evaluated, so that a
    /// [checkpoint](Stepper::checkpoint) keeps it. All of the batch is still to be told.
    ///
    /// # Errors
    /// [`Error::Tell`] for more values than candidates.
    pub fn note(&mut self, fitness: &[P::Scalar]) -> Result<(), Error> {
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

    /// The fitness of the first of the candidates that [`ask`](Stepper::ask) gave, where it was [noted](Stepper::note) before the
    /// slice was saved. After [`start_resumed`](Search::start_resumed) only the others need to be evaluated.
    ///
    /// ```
    /// use satisfice::{engine, from_fn, Budget, SatisficingProblem, Search, Space};
    /// let problem = from_fn(Space::lattice(2, 50)?, 3.0, |x: &[f64]| x[0] + x[1]);
    /// let mut search = Search::named("random")?;
    /// let mut slice = search.start(&problem, &Budget::evaluations(5000))?;
    /// slice.ask()?;
    /// slice.note(&[81.0, 7.0])?; // that took an hour
    /// let saved = slice.checkpoint();
    ///
    /// let mut search = Search::resume(saved, engine::Random::default())?;
    /// let mut slice = search.start_resumed(&problem)?;
    /// let batch = slice.ask()?.to_vec();
    /// let mut fitness = slice.noted().to_vec();
    /// assert_eq!(fitness, [81.0, 7.0]);
    /// fitness.extend(batch[2..].iter().map(|candidate| problem.fitness(candidate)));
    /// slice.tell(&fitness)?;
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    #[must_use]
    pub fn noted(&self) -> &[P::Scalar] {
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

    /// Whether the time is up or the slice is cancelled. To be asked between the evaluations of a batch, which
    /// [`finish_with`](Stepper::finish_with) can end early.
    pub fn is_interrupted(&mut self) -> bool {
        let turn = self.turn;
        let slice = self.running.as_mut().and_then(|running| running.slice_at(turn));
        slice.is_some_and(|slice| slice.ledger.has_stopped())
    }

    /// Ends the slice in the middle of a batch and reports: `fitness` is that of the first of the candidates that
    /// [`ask`](Stepper::ask) gave, as far as they are evaluated. The others are not counted.
    ///
    /// ```
    /// use satisfice::{from_fn, Budget, Search, Space, StopReason};
    /// let problem = from_fn(Space::lattice(2, 50)?, 3.0, |x: &[f64]| x[0] + x[1]);
    /// let mut search = Search::named("random")?;
    /// let mut slice = search.start(&problem, &Budget::evaluations(5000))?;
    /// assert!(slice.ask()?.len() > 3);
    /// let report = slice.finish_with(&[1.0, 7.0, 2.0])?; // and then the power failed
    /// assert_eq!((report.hit_count(), report.counts.evaluations), (2, 3));
    /// assert_eq!(report.stop_reason, StopReason::Cancelled);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Tell`] for more values than candidates.
    pub fn finish_with(mut self, fitness: &[P::Scalar]) -> Result<Report<P::Solution>, Error> {
        self.end_with(fitness)?;
        Ok(self.finish())
    }

    /// Ends the slice in the middle of a batch as [`finish_with`](Stepper::finish_with) does, without the report yet.
    pub(super) fn end_with(&mut self, fitness: &[P::Scalar]) -> Result<(), Error> {
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
        running.settle(turn, self.problem, &self.search.previous, &mut ());
        let searching = running.exchange.as_ref().is_some_and(Exchange::is_searching);
        if searching || (running.exchange.is_some() && turn != Turn::Over) {
            let reason = running.slice_at(turn).and_then(|slice| slice.ledger.stop);
            running.end(reason.unwrap_or(StopReason::Cancelled));
        }
        Ok(())
    }

    /// The search and the slice as they are now; a batch that is out is asked for again after resuming. Cost: a copy of the
    /// archive and of the engines' state.
    #[must_use]
    pub fn checkpoint(&self) -> Checkpoint<P::Solution> {
        self.search.save(self.running.as_ref())
    }

    /// Ends the slice and reports. One that is not over counts as cancelled.
    #[must_use]
    pub fn finish(mut self) -> Report<P::Solution> {
        let running = self.running.take();
        match running {
            Some(running) => self.search.report(self.problem, running),
            None => unreachable!("a slice is finished once"),
        }
    }

    /// Runs the slice to its end.
    pub(super) fn drive(
        mut self,
        options: RunOptions<'_, P::Solution>,
    ) -> Result<Report<P::Solution>, Error> {
        let threads = match self.search.pool.take() {
            Some(threads) => threads,
            None => Threads::new(self.search.threads)?,
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
            let run = AssertUnwindSafe(|| self.drive_on(&threads, observer, &mut keeper));
            if let Err(panic) = catch_unwind(run) {
                self.end_after_panic();
                // Threads may still hold what the panic has left.
                self.search.pool = None;
                let mut report = self.finish_without_lanes();
                report.panic = Some(message_of(panic.as_ref()));
                return Ok(report);
            }
        } else {
            self.drive_on(&threads, observer, &mut keeper);
        }
        self.search.pool = Some(threads);
        if let Some(keeper) = keeper {
            keeper.save_end(|| self.checkpoint());
        }
        Ok(self.finish())
    }

    fn drive_on(
        &mut self,
        threads: &Threads,
        observer: &mut dyn Observer<P::Solution>,
        keeper: &mut Option<Keeper<'_, P::Solution>>,
    ) {
        let previous = Arc::clone(&self.search.previous);
        let several = self
            .running
            .as_ref()
            .is_some_and(|running| running.exchange.is_some());
        if several {
            self.drive_lanes(threads, &previous, observer, keeper);
        } else {
            self.drive_alone(threads, &previous, observer, keeper);
        }
    }

    fn drive_alone(
        &mut self,
        threads: &Threads,
        previous: &crate::archive::Archive<P::Solution>,
        observer: &mut dyn Observer<P::Solution>,
        keeper: &mut Option<Keeper<'_, P::Solution>>,
    ) {
        // While an engine advances by itself, no checkpoint can be taken.
        let advance = keeper.is_none();
        loop {
            let Some(lane) = self
                .running
                .as_mut()
                .and_then(|running| running.lanes.first_mut())
            else {
                return;
            };
            let alone: Option<&mut dyn Observer<P::Solution>> =
                if advance { Some(&mut *observer) } else { None };
            if !lane.propose(self.problem, previous, alone) {
                return;
            }
            self.evaluate(Turn::Lane(0), threads, keeper);
            let Some(lane) = self
                .running
                .as_mut()
                .and_then(|running| running.lanes.first_mut())
            else {
                return;
            };
            lane.settle(self.problem, previous, observer);
            if lane.slice.ledger.has_shared() {
                threads.wake();
            }
        }
    }

    fn drive_lanes(
        &mut self,
        threads: &Threads,
        previous: &crate::archive::Archive<P::Solution>,
        observer: &mut dyn Observer<P::Solution>,
        keeper: &mut Option<Keeper<'_, P::Solution>>,
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
                exchange.run_round(lanes, self.problem, previous, threads, keep);
                self.save_if_due(Turn::Over, keeper);
                let Some(Running {
                    lanes,
                    exchange: Some(exchange),
                }) = &mut self.running
                else {
                    return;
                };
                for lane in &mut *lanes {
                    lane.settle(self.problem, previous, &mut ());
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
            } else if exchange.propose_probes(self.problem) {
                self.evaluate(Turn::Probes, threads, keeper);
                if let Some(running) = &mut self.running {
                    running.settle(Turn::Probes, self.problem, previous, observer);
                }
            } else {
                return;
            }
        }
    }

    /// Evaluates the batch that is out, and saves it if a checkpoint comes due meanwhile.
    #[inline]
    fn evaluate(&mut self, turn: Turn, threads: &Threads, keeper: &mut Option<Keeper<'_, P::Solution>>) {
        loop {
            let Some(slice) = self.running.as_mut().and_then(|running| running.slice_at(turn)) else {
                return;
            };
            slice.ledger.hold = keeper.as_ref().map(Keeper::next);
            slice
                .ledger
                .evaluate(self.problem, &mut slice.candidates, threads);
            let complete = slice.ledger.stop.is_some() || slice.candidates.is_complete();
            self.save_if_due(turn, keeper);
            if complete {
                return;
            }
        }
    }

    /// Saves a batch that a cancellation has cut short before it is settled, so that it can be completed; and now and then.
    #[inline]
    fn save_if_due(&mut self, turn: Turn, keeper: &mut Option<Keeper<'_, P::Solution>>) {
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
            keeper.save(&self.search.save(Some(running)), cancelled, begun, clock);
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
    fn finish_without_lanes(mut self) -> Report<P::Solution> {
        let running = self.running.take();
        let Some(running) = running else {
            unreachable!("a slice is finished once")
        };
        let report = self.search.report(self.problem, running);
        self.search.lanes.clear();
        report
    }
}

impl<P: SatisficingProblem + ?Sized> Drop for Stepper<'_, P> {
    /// Gives the engines back, for the next slice; after a panic they are rebuilt.
    fn drop(&mut self) {
        if let Some(running) = self.running.take()
            && !std::thread::panicking()
        {
            self.search.lanes = running.into_parts().1;
        }
    }
}
