//! The accounting of one slice: what was counted, what was found, when it has to stop.
//!
//! [`evaluate`](Ledger::evaluate) computes the fitness of a batch on any number of threads;
//! [`settle`](Ledger::settle) enters the results in order. So the number of threads changes nothing but the time.

mod evaluate;
mod price;
mod settle;
mod unlisted;

use core::time::Duration;

use self::price::Price;
pub(crate) use self::unlisted::Unlisted;
use crate::archive::KnownHits;
use crate::best::BestSoFar;
use crate::budget::{Budget, StopReason};
use crate::clock::{Alarm, Clock, Stopwatch};
use crate::observer::Observer;
use crate::report::{Counts, TracePoint};

/// Observers are told of progress at most this often.
const PROGRESS_EVERY: Duration = Duration::from_millis(10);

/// The accounts of one slice.
#[derive(Debug)]
pub(crate) struct Ledger<T> {
    pub(crate) budget: Budget,
    pub(crate) counts: Counts,
    pub(crate) archive: KnownHits<T>,
    pub(crate) best: BestSoFar<T>,
    pub(crate) trace: Vec<TracePoint>,
    pub(crate) stop: Option<StopReason>,
    pub(crate) clock: Clock,
    /// Nanoseconds that a call of the fitness took lately; `None` before the first.
    #[cfg(feature = "rayon")]
    fitness_cost: Option<u64>,
    /// What a call of the fitness costs, where only time is limited.
    price: Price,
    /// Since when a batch is out, where only time is limited.
    out_since: Option<Stopwatch>,
    /// Whether the last batch was shared among threads.
    shared: bool,
    /// Calls of the fitness in batches that were.
    shared_calls: u64,
    /// Proposals in batches of at least [`Budget::parallel`] points, probes aside.
    pub(crate) in_full_batches: u64,
    alarm: Option<Alarm>,
    /// Time since the start at which an evaluation of a batch returns early, so that it can be saved.
    pub(crate) hold: Option<Duration>,
    /// How many evaluations go on at once as far as the search knows, beside what the budget says.
    pub(crate) at_once: usize,
    /// How many islands share the evaluations that the search has planned.
    pub(crate) islands: usize,
    /// The share of those evaluations that are probes.
    pub(crate) probe_share: f64,
    /// Whether the engine is told one answer at a time, in any order.
    pub(crate) in_any_order: bool,
    /// When the next points of the trace are due, by evaluations and by time.
    next_count: u64,
    /// The evaluation that ends the slice unless there is a new hit before.
    stale_at: u64,
    /// The first evaluation at which either is to be looked at.
    next_event: u64,
    next_time: Duration,
    next_progress: Duration,
    /// Whether `next_time` or `next_progress` has come, as of the last look at the clock.
    tick_is_due: bool,
    /// The hit that was found again last.
    recent: usize,
    /// In one lane of several: what the others do not know.
    pub(crate) unlisted: Option<Unlisted<T>>,
}

/// The progress of a saved slice.
#[derive(Debug)]
pub(crate) struct Reached<T> {
    pub(crate) counts: Counts,
    pub(crate) archive: KnownHits<T>,
    pub(crate) best: BestSoFar<T>,
    pub(crate) trace: Vec<TracePoint>,
    pub(crate) stop: Option<StopReason>,
    pub(crate) elapsed: Duration,
}

impl<T> Default for Reached<T> {
    fn default() -> Self {
        Self {
            counts: Counts::default(),
            archive: KnownHits::default(),
            best: BestSoFar::default(),
            trace: Vec::new(),
            stop: None,
            elapsed: Duration::ZERO,
        }
    }
}

impl<T> Ledger<T> {
    /// Opens the accounts of a slice that begins or continues now.
    pub(crate) fn open(budget: &Budget, reached: Reached<T>) -> Self {
        let Reached { counts, elapsed, .. } = reached;
        let mut next = 1;
        while next <= counts.evaluations {
            next = next_count(next);
        }
        let stale_at = stale_at(budget, &reached.archive);
        Self {
            budget: budget.clone(),
            counts,
            archive: reached.archive,
            best: reached.best,
            trace: reached.trace,
            stop: reached.stop,
            clock: Clock::start(elapsed),
            #[cfg(feature = "rayon")]
            fitness_cost: None,
            price: Price::default(),
            out_since: None,
            shared: false,
            shared_calls: 0,
            in_full_batches: 0,
            alarm: budget.time.map(|time| Alarm::set(time.saturating_sub(elapsed))),
            hold: None,
            at_once: 1,
            islands: 1,
            probe_share: 0.0,
            in_any_order: false,
            next_count: next,
            stale_at,
            next_event: next.min(stale_at),
            next_time: next_time(budget, elapsed),
            next_progress: elapsed.saturating_add(PROGRESS_EVERY),
            tick_is_due: false,
            recent: 0,
            unlisted: None,
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
        self.counts.evaluations.saturating_add(self.counts.bound_calls)
    }

    /// Enters the calls of bounds so far: each counts like an evaluation, and takes time.
    #[inline]
    pub(crate) fn count_bounds(&mut self, calls: u64) {
        let new = calls.saturating_sub(self.counts.bound_calls);
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

    /// [`Ledger::is_over`] right after an evaluation, which has checked the budget.
    #[inline]
    pub(crate) fn has_stopped(&mut self) -> bool {
        self.stop.is_some() || self.interrupted()
    }

    /// Seconds that a call of the fitness takes, if that is known; where answers come one by one, in any order, the time of the slice by its
    /// evaluations.
    pub(crate) fn seconds_an_evaluation(&self) -> Option<f64> {
        if !self.in_any_order {
            return self.price.seconds();
        }
        let made = self.counts.evaluations;
        (made > 0).then(|| self.clock.seen().as_secs_f64() / made as f64)
    }

    /// Share of the budget used, as of the last look at the clock.
    #[inline]
    pub(crate) fn share(&self) -> f64 {
        self.budget.share(self.spent(), self.clock.seen())
    }

    /// Whether the slice has been ended from outside, by its alarm or its cancellation, or has ended before.
    #[inline]
    fn interrupted(&mut self) -> bool {
        if let Some(reason) = self.interruption() {
            self.stop = Some(reason);
        }
        self.stop.is_some()
    }

    /// [`Ledger::interrupted`] without taking note of it.
    pub(crate) fn is_interrupted(&self) -> bool {
        self.stop.is_some() || self.interruption().is_some()
    }

    /// Whether the time is over, so far as the alarm says.
    pub(crate) fn is_out_of_time(&self) -> bool {
        self.alarm.as_ref().is_some_and(Alarm::has_rung)
    }

    /// What ends the slice from outside.
    #[inline]
    fn interruption(&self) -> Option<StopReason> {
        if self.is_out_of_time() {
            return Some(StopReason::Time);
        }
        let cancel = self.budget.cancel.as_ref();
        cancel
            .is_some_and(crate::Cancel::is_cancelled)
            .then_some(StopReason::Cancelled)
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

    /// Why the slice has ended; if it has not, why it would if whoever evaluates gave up now: for want of time if that is over, even before
    /// the alarm has said so.
    pub(crate) fn stopped_by(&self) -> StopReason {
        self.stop.unwrap_or_else(|| {
            let limit = self.budget.time;
            if limit.is_some_and(|limit| self.clock.elapsed() >= limit) {
                StopReason::Time
            } else {
                StopReason::Cancelled
            }
        })
    }

    /// Ends the slice because whoever evaluates has given up.
    pub(crate) fn give_up(&mut self) {
        self.stop = Some(self.stopped_by());
    }

    /// Notes that a batch goes out, to be evaluated elsewhere.
    pub(crate) fn goes_out(&mut self) {
        self.out_since = self.budget.is_timed().then(Stopwatch::start);
    }

    /// Checks the limits after evaluations that happened elsewhere.
    pub(crate) fn evaluated_elsewhere(&mut self, evaluations: usize) {
        if let Some(stopwatch) = self.out_since.take()
            && evaluations > 0
        {
            let nanoseconds = stopwatch.stop();
            self.price.note(nanoseconds, evaluations, self.counts.evaluations);
        }
        self.pass(evaluations);
        let _ = self.interrupted();
    }

    #[inline]
    fn trace_if_due(&mut self) {
        if self.counts.evaluations >= self.next_event {
            self.trace_up_to_now();
            self.stop_if_stale();
        }
    }

    /// Enters the point of the trace that is due, if one is.
    #[cold]
    fn trace_up_to_now(&mut self) {
        if self.counts.evaluations >= self.next_count {
            self.record();
            while self.next_count <= self.counts.evaluations {
                self.next_count = next_count(self.next_count);
            }
        }
        self.next_event = self.next_count.min(self.stale_at);
    }

    /// Ends the slice if too many evaluations have brought no new hit.
    pub(crate) fn stop_if_stale(&mut self) {
        if self.counts.evaluations >= self.stale_at {
            self.stop.get_or_insert(StopReason::Patience);
        }
    }

    /// Checks the limits that are checked once a batch.
    #[inline]
    fn look_at_limits(&mut self, observer: &mut dyn Observer<T>) {
        if self.remaining() == 0 && self.stop.is_none() {
            self.stop = Some(StopReason::Evaluations);
        }
        if self.tick_is_due {
            self.tick_is_due = false;
            self.tick(self.clock.seen(), observer);
        }
    }

    #[cold]
    fn tick(&mut self, seen: Duration, observer: &mut dyn Observer<T>) {
        if seen >= self.next_time {
            self.record();
            self.next_time = next_time(&self.budget, seen);
        }
        if seen >= self.next_progress {
            self.next_progress = seen.saturating_add(PROGRESS_EVERY);
            let now = self.point(seen);
            if observer.progress(now, self.share()).is_break() {
                self.stop.get_or_insert(StopReason::Observer);
            }
        }
    }

    fn point(&self, elapsed: Duration) -> TracePoint {
        TracePoint {
            evaluations: self.counts.evaluations,
            elapsed_seconds: elapsed.as_secs_f64(),
            hits: self.archive.len() as u64,
        }
    }

    #[cold]
    fn record(&mut self) {
        let point = self.point(self.clock.elapsed());
        self.trace.push(point);
    }

    /// Enters into the last point of the trace the hits that were inserted after it at the same evaluation, by an exchange.
    pub(crate) fn correct_trace(&mut self) {
        if let Some(last) = self.trace.last_mut()
            && last.evaluations == self.counts.evaluations
        {
            last.hits = self.archive.len() as u64;
        }
    }

    /// Closes the accounts with a last point of the trace; returns the time taken and the overshoot.
    pub(crate) fn close(&mut self) -> (Duration, Duration) {
        self.alarm = None;
        let elapsed = self.clock.elapsed();
        let traced = self.trace.last().map(|last| last.evaluations);
        if traced.is_none_or(|traced| traced < self.counts.evaluations) {
            let point = self.point(elapsed);
            self.trace.push(point);
        }
        self.times(elapsed)
    }

    /// A time taken and by how much it exceeds the budget.
    fn times(&self, elapsed: Duration) -> (Duration, Duration) {
        let limit = self.budget.time.unwrap_or(Duration::MAX);
        (elapsed, elapsed.saturating_sub(limit))
    }

    /// The time taken so far and by how much it exceeds the budget.
    pub(crate) fn times_so_far(&self) -> (Duration, Duration) {
        self.times(self.clock.elapsed())
    }
}

/// The next evaluation count of the trace: 1, 2, 3, …, 10, 12, 15, 19, 24, …: about ten a decade, the same in every run.
pub(crate) fn next_count(count: u64) -> u64 {
    count.saturating_add((count / 4).max(1))
}

/// The evaluation that ends a slice unless there is a new hit before.
fn stale_at<T>(budget: &Budget, hits: &KnownHits<T>) -> u64 {
    let last = hits.all().last().map_or(0, |hit| hit.evaluation);
    budget
        .patience
        .map_or(u64::MAX, |evaluations| last.saturating_add(evaluations))
}

/// The first hundredth of the time budget after `elapsed`.
fn next_time(budget: &Budget, elapsed: Duration) -> Duration {
    let Some(time) = budget.time else {
        return Duration::MAX;
    };
    let step = (time / 100).max(Duration::from_nanos(1));
    let passed = u32::try_from(elapsed.as_nanos() / step.as_nanos()).unwrap_or(u32::MAX);
    step.saturating_mul(passed.saturating_add(1))
}
