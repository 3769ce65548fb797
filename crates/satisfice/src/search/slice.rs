//! What a slice holds between its beginning and its end, and the stage it is at.

use super::stage::{BatchSource, Pending, Stage};
use crate::accounting::{Ledger, Reached, next_count};
use crate::archive::Archive;
use crate::batch::Batch;
use crate::budget::Budget;
use crate::candidates::Candidates;
use crate::engine::Ask;
use crate::identity::Identity;
use crate::probes::Probes;
use crate::problem::AnyProblem;
use crate::report::{Counts, SourceCount, SourceTrace};
use crate::scalar::Real;
use crate::view::{Calls, Scratches, View};

/// Hits of the slice before are verified in batches of this size.
const VERIFY_BATCH: usize = 64;

/// A slice that has begun.
pub(super) struct Slice<S, T> {
    pub(super) ledger: Ledger<T>,
    pub(super) batch: Batch<S>,
    pub(super) candidates: Candidates<S, T>,
    pub(super) probes: Probes,
    pub(super) stage: Stage<S>,
    /// What the engine's last `ask` said.
    pub(super) last: Ask,
    /// Which hits of the slice before are still to be verified, by index.
    pub(super) to_verify: core::ops::Range<usize>,
    /// Positions that are still to be evaluated before the engine is asked, one after the other.
    pub(super) starts: Vec<S>,
    /// Evaluations after which nothing is proposed for the time being.
    pub(super) pause: u64,
    /// What the engine's sources proposed and found, and the evaluations at which the next row is due.
    pub(super) sources: SourceTrace,
    pub(super) next_row: u64,
    pub(super) calls: Calls,
    pub(super) scratches: Scratches<S, T>,
}

impl<S: Real, T: Identity + Clone + Send + Sync> Slice<S, T> {
    /// A slice in a space of so many axes that begins now, or continues from what it had reached.
    pub(super) fn begin(
        budget: &Budget,
        dimension: usize,
        probes: Probes,
        to_verify: core::ops::Range<usize>,
        reached: Reached<T>,
    ) -> Self {
        let calls = Calls::default();
        calls.neighbours.set(reached.counts.neighbour_calls);
        calls.bounds.set(reached.counts.bound_calls);
        let mut ledger = Ledger::open(budget, reached);
        ledger.probe_share = probes.share();
        Self {
            ledger,
            batch: Batch::new(dimension),
            candidates: Candidates::default(),
            probes,
            stage: Stage::Propose,
            last: Ask::More,
            to_verify,
            starts: Vec::new(),
            pause: u64::MAX,
            sources: SourceTrace::default(),
            next_row: 1,
            calls,
            scratches: Scratches::default(),
        }
    }

    /// Writes down what the sources of the engines have proposed and found, if that is due.
    #[inline]
    pub(super) fn record_sources(&mut self, engines: impl Iterator<Item = Vec<SourceCount>>) {
        let evaluations = self.ledger.counts.evaluations;
        if evaluations >= self.next_row {
            self.sources.record(evaluations, engines);
            self.next_row = next_count(evaluations);
        }
    }

    #[inline]
    pub(super) fn view<'a>(
        &'a self,
        problem: &'a AnyProblem<'a, S, T>,
        previous: &'a Archive<T>,
    ) -> View<'a, S, T> {
        View {
            problem,
            previous,
            ledger: &self.ledger,
            calls: &self.calls,
            scratches: &self.scratches,
        }
    }

    /// What was counted, calls of neighbours and bounds included.
    pub(super) fn counts(&self) -> Counts {
        Counts {
            neighbour_calls: self.calls.neighbours.get(),
            bound_calls: self.calls.bounds.get(),
            ..self.ledger.counts
        }
    }

    /// Prepares the candidates of the batch, as many as the budget has room for.
    #[inline]
    pub(super) fn prepare(&mut self, problem: &AnyProblem<'_, S, T>, from: BatchSource, deletes: bool) {
        let limit = self.ledger.remaining();
        self.candidates.probing = from == BatchSource::Probes;
        let ledger = &self.ledger;
        self.candidates
            .prepare(problem, &ledger.archive, &mut self.batch, limit, deletes, || {
                ledger.is_interrupted()
            });
        self.stage = Stage::Settle(from);
    }

    /// Proposes the next hits of the slice before, to be evaluated again.
    pub(super) fn propose_previous(&mut self, problem: &AnyProblem<'_, S, T>, previous: &Archive<T>) {
        let (space, limit) = (problem.space(), self.ledger.remaining());
        let next = &previous.solutions()[self.to_verify.clone()];
        let next = &next[..next.len().min(VERIFY_BATCH).min(limit)];
        let encoding = problem.encoding();
        self.batch.clear();
        for solution in next {
            let mut encoded = true;
            self.batch.push_with(|position| {
                encoded = encoding.is_some_and(|encoding| encoding.encode(solution, position));
                space.positions(position);
            });
            if !encoded {
                self.batch.clear();
                break;
            }
        }
        self.to_verify.start += next.len();
        self.candidates.probing = false;
        self.candidates
            .prepare_solutions(next.iter(), &self.ledger.archive, limit);
        self.stage = Stage::Settle(BatchSource::WarmStart);
    }

    /// Takes the points that the user has given. They are kept in the reverse order, so that the next ones are at the end.
    pub(super) fn set_starts(&mut self, starts: &[Vec<S>]) {
        self.starts = starts.iter().rev().flatten().copied().collect();
    }

    /// The next of these points, at most so many.
    pub(super) fn next_starts(&mut self, most: usize, dimension: usize) -> Vec<S> {
        let rest = self.starts.len().saturating_sub(most * dimension);
        let last = self.starts.split_off(rest);
        last.rchunks_exact(dimension).flatten().copied().collect()
    }

    /// Proposes the next points that the user has given.
    pub(super) fn propose_starts(&mut self, problem: &AnyProblem<'_, S, T>, deletes: bool) {
        let dimension = self.batch.dimension();
        self.batch.clear();
        for position in self.next_starts(VERIFY_BATCH, dimension).chunks_exact(dimension) {
            self.batch.push(position);
        }
        self.prepare(problem, BatchSource::Starts, deletes);
    }

    /// Proposes the next uniform probes, at most so many.
    pub(super) fn propose_probes(&mut self, problem: &AnyProblem<'_, S, T>, most: usize) {
        self.probes.propose(problem, &mut self.batch);
        self.batch.truncate(most);
        self.prepare(problem, BatchSource::Probes, true);
    }

    /// Prepares a batch again that was out when the slice was saved.
    pub(super) fn propose_again(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        previous: &Archive<T>,
        pending: Pending<S>,
        deletes: bool,
    ) {
        if pending.from == BatchSource::WarmStart {
            self.propose_previous(problem, previous);
        } else {
            let dimension = self.batch.dimension();
            if let Some(batch) = Batch::from_positions(pending.positions, dimension) {
                self.batch = batch;
            }
            self.prepare(
                problem,
                pending.from,
                deletes || pending.from == BatchSource::Probes,
            );
        }
        self.candidates.resume(&pending.computed);
    }

    /// The batch that is out, to be saved.
    pub(super) fn pending(&self) -> Option<Pending<S>> {
        let from = match &self.stage {
            Stage::Propose => return None,
            Stage::Repeat(pending) => return Some(pending.clone()),
            Stage::Settle(from) | Stage::Asked(from) => *from,
        };
        Some(Pending {
            from,
            positions: self.batch.positions().to_vec(),
            computed: self.candidates.computed(),
        })
    }

    /// Where the verification continues once a pending batch is proposed again.
    pub(super) fn verified_before_pending(&self) -> usize {
        match self.stage {
            Stage::Settle(BatchSource::WarmStart) | Stage::Asked(BatchSource::WarmStart) => {
                self.to_verify.start - self.candidates.outcomes.len()
            }
            _ => self.to_verify.start,
        }
    }

    /// Settles a batch of probes.
    pub(super) fn settle_probes(&mut self, problem: &AnyProblem<'_, S, T>) {
        self.probes.take(
            problem,
            &self.batch,
            &self.candidates.outcomes,
            self.ledger.archive.all(),
        );
        self.ledger.counts.probes = self.probes.count();
    }
}
