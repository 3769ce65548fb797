//! The search as seen by an engine that advances by itself, a point at a time.

use crate::accounting::Ledger;
use crate::batch::Outcome;
use crate::candidates::Candidates;
use crate::engine::Steps;
use crate::identity::Identity;
use crate::observer::Observer;
use crate::probes::Probes;
use crate::problem::AnyProblem;
use crate::scalar::Real;

/// What a step needs of the slice.
pub(super) struct SingleSteps<'a, S, T> {
    pub(super) problem: &'a AnyProblem<'a, S, T>,
    pub(super) ledger: &'a mut Ledger<T>,
    pub(super) candidates: &'a mut Candidates<S, T>,
    pub(super) probes: &'a Probes,
    pub(super) observer: &'a mut dyn Observer<T>,
    pub(super) deletes: bool,
    /// Evaluations after which the engine is to pause.
    pub(super) pause: u64,
    /// Whether the engine has been told that it was the last step.
    pub(super) over: bool,
}

impl<S: Real, T: Identity + Clone + Send + Sync> Steps<S> for SingleSteps<'_, S, T> {
    fn take(&mut self, position: &mut [S]) -> (Outcome<S>, bool) {
        if self.over {
            return (Outcome::NotEvaluated, false); // no budget is overrun by an engine that does not listen
        }
        assert_eq!(
            position.len(),
            self.problem.space().dimension(),
            "one number per axis"
        );
        let outcome = self.ledger.evaluate_one(
            self.problem,
            self.candidates,
            position,
            self.deletes,
            self.observer,
        );
        let evaluations = self.ledger.counts.evaluations;
        self.over = self.ledger.has_stopped() || self.probes.is_due(evaluations) || evaluations >= self.pause;
        (outcome, !self.over)
    }

    fn elapsed_share(&self) -> f64 {
        self.ledger.share()
    }

    fn is_out_of_time(&self) -> bool {
        self.ledger.is_out_of_time()
    }
}
