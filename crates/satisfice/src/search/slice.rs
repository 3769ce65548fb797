//! What a slice holds between its beginning and its end.

use crate::archive::Archive;
use crate::batch::Batch;
use crate::budget::Budget;
use crate::candidates::Candidates;
use crate::engine::{Ask, Origin};
use crate::evaluate::Ledger;
use crate::identity::Identity;
use crate::probes::Probes;
use crate::problem::SatisficingProblem;
use crate::scalar::Real;
use crate::view::{Calls, Scratches, View};

use super::checkpoint::Pending;

/// Hits of the slice before are verified in batches of this size.
const VERIFY_BATCH: usize = 64;

/// A slice that has begun.
pub(super) struct Slice<S, T> {
    pub(super) ledger: Ledger,
    pub(super) archive: Archive<T>,
    pub(super) batch: Batch<S>,
    pub(super) candidates: Candidates<S, T>,
    pub(super) probes: Probes,
    pub(super) origin: Origin,
    /// How many hits of the slice before have been verified, or all of them where none is to be.
    pub(super) verified: usize,
    /// Where the verification of these ends, however many there are.
    pub(super) verify_to: usize,
    /// What the engine's last `ask` said.
    pub(super) last: Ask,
    pub(super) calls: Calls,
    pub(super) scratches: Scratches<S, T>,
    pub(super) outstanding: bool,
    /// Whether a batch is proposed and not settled.
    pub(super) pending: bool,
    /// Evaluations after which nothing is proposed for the time being.
    pub(super) pause: u64,
    /// A batch that was pending when the slice was saved.
    pub(super) resumed: Option<Pending<S>>,
}

impl<S: Real, T: Identity + Clone + Send + Sync> Slice<S, T> {
    /// A slice that begins now, in a space of so many axes, with an empty C.
    pub(super) fn begin(budget: &Budget, dimension: usize, probes: Probes) -> Self {
        Self {
            ledger: Ledger::open(budget),
            archive: Archive::default(),
            batch: Batch::new(dimension),
            candidates: Candidates::default(),
            probes,
            origin: Origin::Engine,
            verified: 0,
            verify_to: usize::MAX,
            last: Ask::More,
            calls: Calls::default(),
            scratches: Scratches::default(),
            outstanding: false,
            pending: false,
            pause: u64::MAX,
            resumed: None,
        }
    }

    /// Whether hits of the slice before wait for their verification.
    #[inline]
    pub(super) fn is_verifying(&self, previous: &Archive<T>) -> bool {
        self.verified < previous.len().min(self.verify_to)
    }

    #[inline]
    pub(super) fn view<'a, P>(&'a self, problem: &'a P, previous: &'a Archive<T>) -> View<'a, P>
    where
        P: SatisficingProblem<Scalar = S, Solution = T>,
    {
        View {
            problem,
            archive: &self.archive,
            previous,
            ledger: &self.ledger,
            calls: &self.calls,
            scratches: &self.scratches,
        }
    }

    /// Prepares the candidates of the batch, as many as the budget has room for.
    pub(super) fn prepare<P>(&mut self, problem: &P, deletes: bool)
    where
        P: SatisficingProblem<Scalar = S, Solution = T>,
    {
        let limit = self.ledger.remaining();
        self.candidates
            .prepare(problem, &self.archive, &mut self.batch, limit, deletes);
    }

    /// The next hits of the slice before, to be evaluated anew.
    pub(super) fn propose_previous<P>(&mut self, problem: &P, previous: &Archive<T>, limit: usize)
    where
        P: SatisficingProblem<Scalar = S, Solution = T>,
    {
        let space = problem.space();
        let next = &previous.solutions()[self.verified..previous.len().min(self.verify_to)];
        let next = &next[..next.len().min(VERIFY_BATCH).min(limit)];
        self.batch.clear();
        for solution in next {
            let mut encoded = true;
            self.batch.push_with(|position| {
                encoded = problem.encode(solution, position);
                space.positions(position);
            });
            if !encoded {
                self.batch.clear();
                break;
            }
        }
        self.origin = Origin::WarmStart;
        self.verified += next.len();
        self.candidates
            .prepare_solutions(next.iter(), &self.archive, limit);
    }
}
