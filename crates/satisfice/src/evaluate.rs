//! The ledger: what reaches it is counted, evaluated, compared with the threshold, stamped and told in order.
//!
//! Numbers of a batch are computed on any number of threads, but written by index and settled in order, so that threads change
//! nothing but the time.

use core::time::Duration;

use num_traits::Float;

use crate::archive::{Archive, Entered};
use crate::batch::Outcome;
use crate::budget::{Budget, StopReason};
use crate::candidates::Candidates;
#[cfg(feature = "rayon")]
use crate::clock::Stopwatch;
use crate::clock::{Alarm, Clock};
use crate::observer::Observer;
use crate::problem::SatisficingProblem;
use crate::report::{Counts, TracePoint};
use crate::threads::Threads;

/// Progress is reported to observers at most this often.
const PROGRESS_EVERY: Duration = Duration::from_millis(10);

/// How a batch is judged.
#[derive(Debug, Clone, Copy)]
struct Rules {
    /// Whether found solutions are deleted from the space, as far as the engine is concerned.
    deletes: bool,
    /// Whether they are uniform probes, whose hits the engine does not see.
    probing: bool,
}

/// The books of one slice.
#[derive(Debug)]
pub(crate) struct Ledger {
    pub(crate) budget: Budget,
    pub(crate) counts: Counts,
    pub(crate) trace: Vec<TracePoint>,
    pub(crate) stop: Option<StopReason>,
    pub(crate) clock: Clock,
    /// Nanoseconds that a call of the fitness took lately; `None` before the first.
    #[cfg(feature = "rayon")]
    fitness_cost: Option<u64>,
    /// Whether the last batch was shared among threads.
    shared: bool,
    alarm: Option<Alarm>,
    next_count: u64,
    next_time: Duration,
    next_progress: Duration,
    /// The hit that was found again last.
    recent: usize,
    /// Whether one of these has come, as of the last look at the clock.
    tick_is_due: bool,
}

impl Ledger {
    /// Opens the books; time runs from here.
    pub(crate) fn open(budget: &Budget) -> Self {
        Self {
            budget: budget.clone(),
            counts: Counts::default(),
            trace: Vec::new(),
            stop: None,
            clock: Clock::start(Duration::ZERO),
            #[cfg(feature = "rayon")]
            fitness_cost: None,
            shared: false,
            alarm: budget.time.map(Alarm::set),
            next_count: 1,
            next_time: budget.time.map_or(Duration::MAX, |time| time / 100),
            next_progress: PROGRESS_EVERY,
            tick_is_due: false,
            recent: 0,
        }
    }

    /// Opens the books of a slice that was saved after `elapsed`.
    pub(crate) fn reopen(
        budget: &Budget,
        counts: Counts,
        trace: Vec<TracePoint>,
        stop: Option<StopReason>,
        elapsed: Duration,
    ) -> Self {
        let mut next = 1;
        while next <= counts.evaluations {
            next = next_count(next);
        }
        // Time points of the trace that have passed.
        let step = budget
            .time
            .map_or(Duration::MAX, |time| (time / 100).max(Duration::from_nanos(1)));
        let passed = u32::try_from(elapsed.as_nanos() / step.as_nanos()).unwrap_or(u32::MAX);
        Self {
            budget: budget.clone(),
            counts,
            trace,
            stop,
            clock: Clock::start(elapsed),
            #[cfg(feature = "rayon")]
            fitness_cost: None,
            shared: false,
            alarm: budget.time.map(|time| Alarm::set(time.saturating_sub(elapsed))),
            next_count: next,
            next_time: step.saturating_mul(passed.saturating_add(1)),
            next_progress: elapsed + PROGRESS_EVERY,
            tick_is_due: false,
            recent: 0,
        }
    }

    /// How many more evaluations the budget allows; calls of bounds count as such.
    #[inline]
    pub(crate) fn remaining(&self) -> usize {
        let limit = self.budget.evaluations.unwrap_or(u64::MAX);
        usize::try_from(limit.saturating_sub(self.spent())).unwrap_or(usize::MAX)
    }

    #[inline]
    fn spent(&self) -> u64 {
        self.counts.evaluations + self.counts.bound_calls
    }

    /// Enters the calls of bounds so far: each counts like an evaluation, and takes time.
    #[inline]
    pub(crate) fn count_bounds(&mut self, calls: u64) {
        let new = calls - self.counts.bound_calls;
        if new > 0 {
            self.counts.bound_calls = calls;
            self.pass(usize::try_from(new).unwrap_or(usize::MAX));
        }
    }

    /// Whether nothing more may be proposed.
    #[inline]
    pub(crate) fn is_over(&mut self) -> bool {
        if self.stop.is_none() && !self.interrupted() && self.remaining() == 0 {
            self.stop = Some(StopReason::Evaluations);
        }
        self.stop.is_some()
    }

    /// The same right after an evaluation, which has looked at the budget.
    #[inline]
    pub(crate) fn has_stopped(&mut self) -> bool {
        self.stop.is_some() || self.interrupted()
    }

    /// Share of the budget used, as of the last look at the clock.
    #[inline]
    pub(crate) fn share(&self) -> f64 {
        self.budget.share(self.spent(), self.clock.seen())
    }

    /// Looks whether somebody has ended the slice from outside.
    #[inline]
    fn interrupted(&mut self) -> bool {
        if self.alarm.as_ref().is_some_and(Alarm::has_rung) {
            self.stop = Some(StopReason::Time);
        } else if self
            .budget
            .cancel
            .as_ref()
            .is_some_and(crate::Cancel::is_cancelled)
        {
            self.stop = Some(StopReason::Cancelled);
        }
        self.stop.is_some()
    }

    #[inline]
    fn pass(&mut self, evaluations: usize) {
        if let Some(elapsed) = self.clock.pass(evaluations as u64) {
            self.tick_is_due |= elapsed >= self.next_time || elapsed >= self.next_progress;
            if self.budget.time.is_some_and(|limit| elapsed >= limit) {
                self.stop = Some(StopReason::Time);
            }
        }
    }

    /// Looks at limits after an evaluation that happened elsewhere.
    pub(crate) fn evaluated_elsewhere(&mut self, evaluations: usize) {
        self.pass(evaluations);
        let _ = self.interrupted();
    }

    /// Computes the fitness of what is live, until time is up.
    pub(crate) fn evaluate<P: SatisficingProblem>(
        &mut self,
        problem: &P,
        candidates: &mut Candidates<P::Scalar, P::Solution>,
        threads: &Threads,
    ) {
        // Proposals that need no evaluation take time as well.
        if candidates.outcomes.len() > candidates.live {
            self.pass(candidates.outcomes.len() - candidates.live);
        }
        #[cfg(feature = "rayon")]
        if threads.count() > 1 {
            self.evaluate_on(threads, problem, candidates);
            return;
        }
        let _ = threads;
        self.evaluate_alone(problem, candidates);
    }

    /// Whether the last batch was worth several threads.
    pub(crate) fn has_shared(&self) -> bool {
        self.shared
    }

    fn evaluate_alone<P: SatisficingProblem>(
        &mut self,
        problem: &P,
        candidates: &mut Candidates<P::Scalar, P::Solution>,
    ) {
        while candidates.ready < candidates.live && !self.interrupted() {
            let from = candidates.ready;
            let chunk = usize::try_from(self.clock.until_look()).unwrap_or(usize::MAX);
            let to = candidates.live.min(from.saturating_add(chunk));
            problem.fitness_all(&candidates.solutions[from..to], &mut candidates.fitness[from..to]);
            candidates.ready = to;
            self.pass(to - from);
        }
    }

    /// The same on several threads, where that pays.
    #[cfg(feature = "rayon")]
    fn evaluate_on<P: SatisficingProblem>(
        &mut self,
        threads: &Threads,
        problem: &P,
        candidates: &mut Candidates<P::Scalar, P::Solution>,
    ) {
        use core::sync::atomic::{AtomicU64, Ordering};

        /// Below this much work in nanoseconds, handing it to threads costs more than it saves.
        const WORTH: u64 = 30_000;
        /// One call in so many is timed: what handing over costs is no reason to go on with it.
        const TIMED: usize = 8;

        if candidates.ready == candidates.live || self.interrupted() {
            return;
        }
        let cost = if let Some(cost) = self.fitness_cost {
            cost
        } else {
            // nobody knows yet: one call tells, so that not even the first batch of a dear fitness waits for one thread
            let (stopwatch, first) = (Stopwatch::start(), candidates.ready);
            candidates.fitness[first] = problem.fitness(&candidates.solutions[first]);
            candidates.ready += 1;
            self.pass(1);
            stopwatch.stop()
        };
        self.fitness_cost = Some(cost);
        let (ready, calls) = (candidates.ready, candidates.live - candidates.ready);
        let work = cost.saturating_mul(calls as u64);
        self.shared = calls >= 2 && work >= WORTH && !self.interrupted();
        if !self.shared {
            let stopwatch = Stopwatch::start();
            self.evaluate_alone(problem, candidates);
            if candidates.ready > ready {
                self.fitness_cost = Some(stopwatch.stop() / (candidates.ready - ready) as u64);
            }
            return;
        }
        let deadline = self.budget.time.and_then(|limit| self.clock.deadline(limit));
        let cancel = self.budget.cancel.clone();
        let over = || {
            deadline.is_some_and(crate::clock::has_come)
                || cancel.as_ref().is_some_and(crate::Cancel::is_cancelled)
        };
        let (solutions, fitness, done) = candidates.slots();
        let slots = solutions.iter().zip(fitness).zip(done).enumerate();
        let (timed, nanoseconds) = (AtomicU64::new(0), AtomicU64::new(0));
        threads.for_each(slots, |(slot, ((solution, fitness), done))| {
            if *done || over() {
                return;
            }
            let stopwatch = (slot % TIMED == ready % TIMED).then(Stopwatch::start);
            *fitness = problem.fitness(solution);
            *done = true;
            if let Some(stopwatch) = stopwatch {
                // whoever reads them has joined the threads
                timed.fetch_add(1, Ordering::Relaxed);
                nanoseconds.fetch_add(stopwatch.stop(), Ordering::Relaxed);
            }
        });
        if let Some(cost) = nanoseconds.into_inner().checked_div(timed.into_inner()) {
            self.fitness_cost = Some(cost);
        }
        self.pass(calls);
        let _ = self.interrupted();
    }

    /// Enters what was computed, in order: counts, hits, trace, limits.
    pub(crate) fn settle<P: SatisficingProblem>(
        &mut self,
        problem: &P,
        candidates: &mut Candidates<P::Scalar, P::Solution>,
        archive: &mut Archive<P::Solution>,
        observer: &mut dyn Observer<P::Solution>,
    ) {
        let threshold = problem.threshold();
        let rules = Rules {
            deletes: candidates.deletes,
            probing: candidates.probing,
        };
        let mut next = 0; // of the live ones
        for i in 0..candidates.outcomes.len() {
            let before = candidates.outcomes[i];
            let is_live = before != Outcome::Deleted;
            let slot = next;
            next += usize::from(is_live);
            if is_live && slot >= candidates.live {
                continue; // beyond the budget
            }
            if self.stops_before_more() || (is_live && !candidates.is_done(slot)) {
                candidates.outcomes[i] = Outcome::NotEvaluated;
                continue;
            }
            self.counts.evaluations += 1;
            if is_live {
                let (solution, fitness) = (&candidates.solutions[slot], candidates.fitness[slot]);
                candidates.outcomes[i] =
                    self.judge(problem, solution, fitness, threshold, rules, archive, observer);
            } else {
                self.counts.duplicates += 1;
            }
            self.trace_if_due(archive.len());
        }
        self.look_at_limits(archive.len(), observer);
    }

    /// [`Candidates::prepare`], [`Ledger::evaluate`] and [`Ledger::settle`] for one point in one go, for engines that move
    /// one point at a time: the way over lists would cost as much as all the rest. Only for a slice that is not over.
    #[inline]
    pub(crate) fn evaluate_one<P: SatisficingProblem>(
        &mut self,
        problem: &P,
        candidates: &mut Candidates<P::Scalar, P::Solution>,
        point: &mut [P::Scalar],
        deletes: bool,
        archive: &mut Archive<P::Solution>,
        observer: &mut dyn Observer<P::Solution>,
    ) -> Outcome<P::Scalar> {
        let rules = Rules {
            deletes,
            probing: false,
        };
        let outcome = candidates.with_one(problem, point, |solution| {
            if deletes && archive.contains(solution) {
                self.pass(1);
                self.counts.evaluations += 1;
                self.counts.duplicates += 1;
                return Outcome::Deleted;
            }
            let fitness = problem.fitness(solution);
            self.pass(1);
            self.counts.evaluations += 1;
            self.judge(
                problem,
                solution,
                fitness,
                problem.threshold(),
                rules,
                archive,
                observer,
            )
        });
        self.trace_if_due(archive.len());
        self.look_at_limits(archive.len(), observer);
        outcome
    }

    #[inline]
    fn trace_if_due(&mut self, hits: usize) {
        if self.counts.evaluations == self.next_count {
            self.record(hits);
            self.next_count = next_count(self.next_count);
        }
    }

    /// What is looked at once a batch.
    #[inline]
    fn look_at_limits<T>(&mut self, hits: usize, observer: &mut dyn Observer<T>) {
        if self.remaining() == 0 && self.stop.is_none() {
            self.stop = Some(StopReason::Evaluations);
        }
        if self.tick_is_due {
            self.tick_is_due = false;
            self.tick(self.clock.seen(), hits, observer);
        }
    }

    /// Enough hits, or an observer's word: what comes later in the batch is not entered. Time that ran out in the middle of
    /// a batch loses nothing that was computed.
    fn stops_before_more(&self) -> bool {
        matches!(self.stop, Some(StopReason::Hits | StopReason::Observer))
    }

    /// Judges a solution that is evaluated. Only one below the threshold is looked up in C.
    #[inline]
    #[expect(
        clippy::too_many_arguments,
        reason = "one step of `settle` and of `evaluate_one`"
    )]
    fn judge<P: SatisficingProblem>(
        &mut self,
        problem: &P,
        solution: &P::Solution,
        fitness: P::Scalar,
        threshold: P::Scalar,
        rules: Rules,
        archive: &mut Archive<P::Solution>,
        observer: &mut dyn Observer<P::Solution>,
    ) -> Outcome<P::Scalar> {
        self.counts.fitness_calls += 1;
        if !fitness.is_finite() {
            self.counts.non_finite += 1;
            Outcome::NonFinite
        } else if fitness < threshold {
            if archive.is_again(solution, self.recent) {
                return self.known(fitness, rules);
            }
            self.welcome(problem, solution, fitness, rules, archive, observer)
        } else {
            Outcome::Miss(fitness)
        }
    }

    /// Enters a solution below the threshold into C, unless one that is the same is there.
    #[inline(never)]
    fn welcome<P: SatisficingProblem>(
        &mut self,
        problem: &P,
        solution: &P::Solution,
        fitness: P::Scalar,
        rules: Rules,
        archive: &mut Archive<P::Solution>,
        observer: &mut dyn Observer<P::Solution>,
    ) -> Outcome<P::Scalar> {
        if archive.contains_again(solution, &mut self.recent) {
            return self.known(fitness, rules);
        }
        let solution = problem.canonical(solution.clone());
        let seconds = self.clock.elapsed().as_secs_f64();
        match archive.enter(solution, self.counts.evaluations, seconds, rules.probing) {
            Entered::New => self.greet(archive, observer),
            // News to the engine only.
            Entered::Revealed => self.counts.duplicates += 1,
            // Its representative is known.
            Entered::Known => return self.known(fitness, rules),
        }
        Outcome::Hit(fitness)
    }

    /// What has been found before.
    #[inline]
    fn known<S>(&mut self, fitness: S, rules: Rules) -> Outcome<S> {
        self.counts.duplicates += 1;
        if rules.deletes {
            Outcome::Deleted
        } else {
            Outcome::Known(fitness)
        }
    }

    /// Takes over what others have done so far: their counts, and time that has passed meanwhile.
    pub(crate) fn take_over<T>(
        &mut self,
        counts: Counts,
        archive: &Archive<T>,
        observer: &mut dyn Observer<T>,
    ) {
        let new = counts.evaluations.saturating_sub(self.counts.evaluations);
        self.counts = counts;
        self.pass(usize::try_from(new).unwrap_or(usize::MAX));
        if self.counts.evaluations >= self.next_count {
            self.record(archive.len());
            while self.next_count <= self.counts.evaluations {
                self.next_count = next_count(self.next_count);
            }
        }
        self.look_at_limits(archive.len(), observer);
    }

    /// Whether enough hits are found, or an observer has said so.
    pub(crate) fn is_closed_to_hits(&self) -> bool {
        self.stops_before_more()
    }

    /// Enters a hit that others have found, as of now.
    pub(crate) fn enter<T: crate::Identity + Clone>(
        &mut self,
        solution: &T,
        archive: &mut Archive<T>,
        observer: &mut dyn Observer<T>,
    ) -> bool {
        let seconds = self.clock.elapsed().as_secs_f64();
        let entered = archive.enter(solution.clone(), self.counts.evaluations, seconds, false);
        if entered == Entered::New {
            self.greet(archive, observer);
        } else {
            self.counts.duplicates += 1;
        }
        entered == Entered::New
    }

    #[cold]
    fn greet<T>(&mut self, archive: &Archive<T>, observer: &mut dyn Observer<T>) {
        let count = archive.len();
        if let Some(hit) = archive.get(count - 1)
            && observer.hit(hit, count).is_break()
        {
            self.stop = Some(StopReason::Observer);
        }
        if self.budget.hits.is_some_and(|limit| count as u64 >= limit) {
            self.stop = Some(StopReason::Hits);
        }
    }

    #[cold]
    fn tick<T>(&mut self, seen: Duration, hits: usize, observer: &mut dyn Observer<T>) {
        if seen >= self.next_time {
            self.record(hits);
            let step = self.budget.time.unwrap_or(Duration::MAX) / 100;
            while self.next_time <= seen {
                self.next_time += step.max(Duration::from_nanos(1));
            }
        }
        if seen >= self.next_progress {
            self.next_progress = seen + PROGRESS_EVERY;
            let now = self.point(seen, hits);
            if observer.progress(now, self.share()).is_break() {
                self.stop.get_or_insert(StopReason::Observer);
            }
        }
    }

    fn point(&self, elapsed: Duration, hits: usize) -> TracePoint {
        TracePoint {
            evaluations: self.counts.evaluations,
            elapsed_seconds: elapsed.as_secs_f64(),
            hits: hits as u64,
        }
    }

    #[cold]
    fn record(&mut self, hits: usize) {
        let point = self.point(self.clock.elapsed(), hits);
        self.trace.push(point);
    }

    /// Closes the books: the last point of the trace, the time taken and the overshoot.
    pub(crate) fn close(&mut self, hits: usize) -> (Duration, Duration) {
        self.alarm = None;
        let elapsed = self.clock.elapsed();
        if self
            .trace
            .last()
            .is_none_or(|last| last.evaluations < self.counts.evaluations)
        {
            let point = self.point(elapsed, hits);
            self.trace.push(point);
        }
        (
            elapsed,
            self.budget
                .time
                .map_or(Duration::ZERO, |limit| elapsed.saturating_sub(limit)),
        )
    }
}

/// The next evaluation count of the trace: 1, 2, 3, …, 10, 12, 15, 19, 24, …, some ten a decade and the same in every run.
fn next_count(count: u64) -> u64 {
    count + (count / 4).max(1)
}
