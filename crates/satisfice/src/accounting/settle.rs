//! Settling evaluated candidates in order: counts, hits, the best, the trace.

use super::{Ledger, stale_at};
use crate::archive::{Insertion, Mark};
use crate::batch::Outcome;
use crate::best::Best;
use crate::budget::StopReason;
use crate::candidates::Candidates;
use crate::identity::Identity;
use crate::observer::Observer;
use crate::problem::AnyProblem;
use crate::report::Counts;
use crate::scalar::Real;

/// How the outcomes of a batch are decided.
#[derive(Debug, Clone, Copy)]
struct Rules {
    /// Whether found solutions are deleted from the space, as far as the engine is concerned.
    deletes: bool,
    /// Whether the batch holds uniform probes, whose hits the engine does not see.
    probing: bool,
    /// When the solutions were not in the archive, if they were looked up.
    absent: Option<Mark>,
}

impl<T: Identity + Clone + Send + Sync> Ledger<T> {
    /// Settles what was evaluated, in order.
    pub(crate) fn settle<S: Real>(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        candidates: &mut Candidates<S, T>,
        observer: &mut dyn Observer<T>,
    ) {
        let threshold = problem.threshold();
        let rules = Rules {
            deletes: candidates.deletes,
            probing: candidates.probing,
            absent: candidates.absent,
        };
        let batch = candidates.outcomes.len();
        if !candidates.probing && batch >= self.budget.parallel.unwrap_or(1) {
            self.in_full_batches += batch as u64;
        }
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
                candidates.outcomes[i] = self.judge(problem, solution, fitness, threshold, rules, observer);
            } else {
                self.counts.duplicates += 1;
            }
            self.trace_if_due();
        }
        self.look_at_limits(observer);
    }

    /// [`Candidates::prepare`], [`Ledger::evaluate`] and [`Ledger::settle`] for one point in one go, for engines that move
    /// one point at a time: lists would cost as much as everything else. Only for a slice that is not over.
    #[inline]
    pub(crate) fn evaluate_one<S: Real>(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        candidates: &mut Candidates<S, T>,
        point: &mut [S],
        deletes: bool,
        observer: &mut dyn Observer<T>,
    ) -> Outcome<S> {
        let rules = Rules {
            deletes,
            probing: false,
            absent: deletes.then(|| self.archive.mark()),
        };
        let outcome = candidates.with_one(problem, point, |solution| {
            if deletes && self.archive.contains(solution) {
                self.pass(1);
                self.counts.evaluations += 1;
                self.counts.duplicates += 1;
                return Outcome::Deleted;
            }
            let fitness = problem.fitness(solution);
            self.pass(1);
            self.counts.evaluations += 1;
            self.judge(problem, solution, fitness, problem.threshold(), rules, observer)
        });
        self.trace_if_due();
        self.look_at_limits(observer);
        outcome
    }

    /// Settles one solution whose fitness was computed elsewhere.
    pub(crate) fn settle_one<S: Real>(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        solution: &T,
        fitness: S,
        deletes: bool,
        probing: bool,
    ) -> Outcome<S> {
        let rules = Rules {
            deletes,
            probing,
            absent: None,
        };
        self.evaluated_elsewhere(1);
        self.counts.evaluations += 1;
        let outcome = self.judge(problem, solution, fitness, problem.threshold(), rules, &mut ());
        self.trace_if_due();
        self.look_at_limits(&mut ());
        outcome
    }

    /// Counts a candidate that is not evaluated because its solution is in the archive.
    pub(crate) fn settle_deleted(&mut self) {
        self.pass(1);
        self.counts.evaluations += 1;
        self.counts.duplicates += 1;
        self.trace_if_due();
        self.look_at_limits(&mut ());
    }

    /// Enters a fitness that the budget has not paid for.
    pub(crate) fn inform<S: Real>(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        solution: &T,
        fitness: S,
    ) -> Outcome<S> {
        self.counts.informed += 1;
        if !fitness.is_finite() {
            self.counts.non_finite += 1;
            return Outcome::NonFinite;
        }
        self.best.offer(solution, fitness.f64(), self.counts.evaluations);
        if fitness < problem.threshold() {
            let rules = Rules {
                deletes: true,
                probing: false,
                absent: None,
            };
            self.insert_hit(problem, solution, fitness, rules, &mut ())
        } else {
            Outcome::Miss(fitness)
        }
    }

    /// Whether no later candidate of the batch is settled: there are enough hits or too many misses, or an observer has stopped the slice. Time
    /// that runs out in the middle of a batch loses nothing that was computed.
    pub(crate) fn stops_before_more(&self) -> bool {
        matches!(
            self.stop,
            Some(StopReason::Hits | StopReason::Observer | StopReason::Patience)
        )
    }

    /// Judges an evaluated solution. Only one below the threshold is looked up in the archive.
    #[inline(always)]
    fn judge<S: Real>(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        solution: &T,
        fitness: S,
        threshold: S,
        rules: Rules,
        observer: &mut dyn Observer<T>,
    ) -> Outcome<S> {
        self.counts.fitness_calls += 1;
        if !fitness.is_finite() {
            self.counts.non_finite += 1;
            return Outcome::NonFinite;
        }
        self.best.offer(solution, fitness.f64(), self.counts.evaluations);
        if fitness < threshold {
            if self.archive.is_again(solution, self.recent) {
                self.note_rejected(problem, solution, fitness, self.recent);
                return self.known(fitness, rules);
            }
            self.insert_hit(problem, solution, fitness, rules, observer)
        } else {
            Outcome::Miss(fitness)
        }
    }

    /// Inserts a solution below the threshold into the archive, unless the same one is there.
    #[inline(never)]
    fn insert_hit<S: Real>(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        solution: &T,
        fitness: S,
        rules: Rules,
        observer: &mut dyn Observer<T>,
    ) -> Outcome<S> {
        if self
            .archive
            .contains_again(solution, rules.absent, &mut self.recent)
        {
            self.note_rejected(problem, solution, fitness, self.recent);
            return self.known(fitness, rules);
        }
        let evaluation = self.counts.evaluations;
        let (listed, its_fitness) = match self.representative(problem, solution) {
            Representative::Itself => (solution.clone(), fitness),
            Representative::Other(other, its_fitness) => (other, its_fitness),
            Representative::Known(index) => {
                self.note_rejected(problem, solution, fitness, index);
                return self.known(fitness, rules);
            }
        };
        let seconds = self.clock.elapsed().as_secs_f64();
        let its_fitness = its_fitness.f64();
        self.best.offer(&listed, its_fitness, evaluation);
        match self
            .archive
            .enter(listed, its_fitness, evaluation, seconds, rules.probing)
        {
            Insertion::New => self.notify_hit(observer),
            // New to the engine only.
            Insertion::Promoted => self.counts.duplicates += 1,
            Insertion::Known => return self.known(fitness, rules),
        }
        Outcome::Hit(fitness)
    }

    /// The solution listed for a hit.
    fn representative<S: Real>(&self, problem: &AnyProblem<'_, S, T>, solution: &T) -> Representative<S, T> {
        let Some(other) = problem.canonical(solution) else {
            return Representative::Itself;
        };
        let mut index = 0;
        if self.archive.contains_again(&other, None, &mut index) {
            return Representative::Known(index);
        }
        Self::if_hit(problem, other).map_or(Representative::Itself, |(other, fitness)| {
            Representative::Other(other, fitness)
        })
    }

    /// A representative with its fitness. One that is not a hit breaks the problem's law and is not used.
    pub(super) fn if_hit<S: Real>(problem: &AnyProblem<'_, S, T>, other: T) -> Option<(T, S)> {
        let fitness = problem.fitness(&other);
        (fitness.is_finite() && fitness < problem.threshold()).then_some((other, fitness))
    }

    /// Counts a solution that was found before.
    #[inline]
    fn known<S>(&mut self, fitness: S, rules: Rules) -> Outcome<S> {
        self.counts.duplicates += 1;
        if rules.deletes {
            Outcome::Deleted
        } else {
            Outcome::Known(fitness)
        }
    }

    /// Replaces the counts by those of several lanes, and accounts for the time that has passed meanwhile.
    pub(crate) fn sync_counts(&mut self, counts: Counts, observer: &mut dyn Observer<T>) {
        let new = counts.evaluations.saturating_sub(self.counts.evaluations);
        self.counts = counts;
        self.pass(usize::try_from(new).unwrap_or(usize::MAX));
        self.trace_up_to_now();
        self.look_at_limits(observer);
    }

    /// Inserts a hit of a lane, as of now; returns whether it was new.
    pub(crate) fn insert_from_lane(
        &mut self,
        solution: &T,
        fitness: f64,
        observer: &mut dyn Observer<T>,
    ) -> bool {
        let seconds = self.clock.elapsed().as_secs_f64();
        let evaluation = self.counts.evaluations;
        let is_new = self
            .archive
            .insert(solution.clone(), fitness, evaluation, seconds);
        if is_new {
            self.notify_hit(observer);
        }
        is_new
    }

    /// Takes the best of a lane, as of now.
    pub(crate) fn offer_from_lane(&mut self, best: &Best<T>) {
        self.best
            .offer(&best.solution, best.fitness, self.counts.evaluations);
    }

    /// Tells the observer of the latest hit, and stops the slice if there are enough.
    #[cold]
    fn notify_hit(&mut self, observer: &mut dyn Observer<T>) {
        self.stale_at = stale_at(&self.budget, &self.archive);
        let count = self.archive.len();
        if let Some(hit) = self.archive.all().last()
            && observer.hit(hit, count).is_break()
        {
            self.stop = Some(StopReason::Observer);
        }
        if self.budget.hits.is_some_and(|limit| count as u64 >= limit) {
            self.stop = Some(StopReason::Hits);
        }
    }
}

/// The solution listed for a hit.
enum Representative<S, T> {
    /// The hit itself.
    Itself,
    /// Another solution, with its fitness.
    Other(T, S),
    /// Another solution, which is the same as this hit.
    Known(usize),
}
