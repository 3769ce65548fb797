//! Computing the fitness of a batch, on one thread or on several.
//!
//! Results are written by index, so that threads change nothing but the time.

use super::Ledger;
use crate::candidates::Candidates;
use crate::clock::Stopwatch;
use crate::identity::Identity;
use crate::problem::AnyProblem;
use crate::scalar::Real;
#[cfg(feature = "rayon")]
use crate::threads::Items;
use crate::threads::Threads;

/// Batches with less work than this, in nanoseconds, stay on one thread: handing them over costs more than it saves.
#[cfg(feature = "rayon")]
const WORTH_SHARING: u64 = 30_000;
/// Calls that take this long, in nanoseconds, are worth threads beyond the cores: the fitness may wait for something else.
#[cfg(feature = "rayon")]
const EXPENSIVE: u64 = 1_000_000;
/// One call in so many is timed on several threads.
#[cfg(feature = "rayon")]
const TIMED: usize = 8;

impl<T: Identity + Clone + Send + Sync> Ledger<T> {
    /// Computes the fitness of the live candidates, until time is up.
    pub(crate) fn evaluate<S: Real>(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        candidates: &mut Candidates<S, T>,
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

    /// Calls of the fitness in batches that were shared among threads.
    pub(crate) fn shared_calls(&self) -> u64 {
        self.shared_calls
    }

    fn evaluate_alone<S: Real>(&mut self, problem: &AnyProblem<'_, S, T>, candidates: &mut Candidates<S, T>) {
        while candidates.ready < candidates.live && !self.interrupted() && !self.holds() {
            let from = candidates.ready;
            let chunk = usize::try_from(self.clock.until_look()).unwrap_or(usize::MAX);
            let to = candidates.live.min(from.saturating_add(chunk));
            let is_due = self.budget.is_timed() && self.price.is_due(self.counts.evaluations);
            let stopwatch = is_due.then(Stopwatch::start);
            problem.fitness_all(&candidates.solutions[from..to], &mut candidates.fitness[from..to]);
            candidates.ready = to;
            if let Some(stopwatch) = stopwatch {
                self.price
                    .note(stopwatch.stop(), to - from, self.counts.evaluations);
            }
            self.pass(to - from);
        }
    }

    /// Whether the batch is to be saved before its evaluation continues.
    fn holds(&self) -> bool {
        self.hold.is_some_and(|hold| self.clock.seen() >= hold)
    }

    /// Shares the batch among threads if it is worth it.
    #[cfg(feature = "rayon")]
    fn evaluate_on<S: Real>(
        &mut self,
        threads: &Threads,
        problem: &AnyProblem<'_, S, T>,
        candidates: &mut Candidates<S, T>,
    ) {
        if candidates.is_complete() || self.interrupted() {
            return;
        }
        let cost = match self.fitness_cost {
            Some(cost) => cost,
            None => self.time_one(problem, candidates),
        };
        self.fitness_cost = Some(cost);
        let (ready, calls) = (candidates.ready, candidates.live - candidates.ready);
        let work = cost.saturating_mul(calls as u64);
        self.shared = calls >= 2 && work >= WORTH_SHARING && !self.interrupted();
        if self.shared {
            self.shared_calls += calls as u64;
            self.evaluate_shared(threads, problem, candidates);
            return;
        }
        let stopwatch = Stopwatch::start();
        self.evaluate_alone(problem, candidates);
        if candidates.ready > ready {
            self.fitness_cost = Some(stopwatch.stop() / (candidates.ready - ready) as u64);
        }
    }

    /// Evaluates one candidate and returns the nanoseconds that it took, so that even the first batch of an expensive
    /// fitness is shared.
    #[cfg(feature = "rayon")]
    fn time_one<S: Real>(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        candidates: &mut Candidates<S, T>,
    ) -> u64 {
        let (stopwatch, first) = (Stopwatch::start(), candidates.ready);
        candidates.fitness[first] = problem.fitness(&candidates.solutions[first]);
        candidates.ready += 1;
        self.pass(1);
        stopwatch.stop()
    }

    #[cfg(feature = "rayon")]
    fn evaluate_shared<S: Real>(
        &mut self,
        threads: &Threads,
        problem: &AnyProblem<'_, S, T>,
        candidates: &mut Candidates<S, T>,
    ) {
        use core::sync::atomic::{AtomicU64, Ordering};

        let (ready, calls) = (candidates.ready, candidates.live - candidates.ready);
        let limit = [self.budget.time, self.hold].into_iter().flatten().min();
        let deadline = limit.and_then(|limit| self.clock.deadline(limit));
        let cancel = self.budget.cancel.clone();
        let over = || {
            deadline.is_some_and(crate::clock::has_come)
                || cancel.as_ref().is_some_and(crate::Cancel::is_cancelled)
        };
        let (solutions, fitness, done) = candidates.slots();
        let slots = solutions.iter().zip(fitness).zip(done).enumerate();
        let (timed, nanoseconds) = (AtomicU64::new(0), AtomicU64::new(0));
        let length = match self.fitness_cost {
            Some(cost) if cost >= EXPENSIVE => Items::Long,
            _ => Items::Short,
        };
        threads.for_each(slots, length, |(slot, ((solution, fitness), done))| {
            if *done || over() {
                return;
            }
            let stopwatch = (slot % TIMED == ready % TIMED).then(Stopwatch::start);
            *fitness = problem.fitness(solution);
            *done = true;
            if let Some(stopwatch) = stopwatch {
                // Relaxed: the threads are joined before these are read.
                timed.fetch_add(1, Ordering::Relaxed);
                nanoseconds.fetch_add(stopwatch.stop(), Ordering::Relaxed);
            }
        });
        if let Some(cost) = nanoseconds.into_inner().checked_div(timed.into_inner()) {
            self.fitness_cost = Some(cost);
            self.price.note(cost, 1, self.counts.evaluations);
        }
        self.pass(calls);
        let _ = self.interrupted();
    }
}
