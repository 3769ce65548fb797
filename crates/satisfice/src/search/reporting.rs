//! The end of a slice: what it found becomes a report.

use core::time::Duration;
use std::sync::Arc;

use super::contradiction::is_contradicted;
use super::kept::KeptSearch;
use super::running::Running;
use super::slice::Slice;
use crate::budget::StopReason;
use crate::catalogue::Description;
use crate::identity::Identity;
use crate::problem::AnyProblem;
use crate::report::{Completeness, Report};
use crate::scalar::Real;
use crate::unseen::Unseen;

impl<S: Real, T: Identity + Clone + Send + Sync> KeptSearch<S, T> {
    /// Name and parameters of the engine.
    pub(super) fn description(&self) -> Description {
        Description {
            name: self.engine.name().to_owned(),
            parameters: self.engine.parameters(),
        }
    }

    /// Ends the slice and writes the report.
    pub(super) fn report(&mut self, problem: &AnyProblem<'_, S, T>, running: Running<S, T>) -> Report<T> {
        let (mut slice, lanes) = running.into_parts();
        let evaluations = slice.ledger.counts.evaluations;
        let engines = lanes.iter().map(|lane| lane.engine.sources());
        slice.sources.record(evaluations, engines);
        self.lanes = lanes;
        let times = slice.ledger.close();
        self.shared_calls = slice.ledger.shared_calls();
        self.in_full_batches = slice.ledger.in_full_batches;
        let mut report = self.describe(problem, &slice, times);
        let mut archive = slice.ledger.archive.into_all();
        archive.rest();
        self.previous = Arc::new(archive);
        report.archive = Arc::clone(&self.previous);
        self.slices += 1;
        report
    }

    /// The report of the slice as it is, without its hits; with the time it took and its overshoot.
    pub(super) fn describe(
        &self,
        problem: &AnyProblem<'_, S, T>,
        slice: &Slice<S, T>,
        (elapsed, overshoot): (Duration, Duration),
    ) -> Report<T> {
        let stop_reason = slice.ledger.stopped_by();
        let counts = slice.counts();
        // A hit that only a probe found contradicts an engine that says it has covered everything; so does a bound above F.
        let calls = counts.bound_calls;
        let proved = stop_reason == StopReason::Covered
            && slice.ledger.archive.all().probe_only() == 0
            && !(calls > 0 && is_contradicted(problem, &slice.ledger, calls));
        let unseen = if proved {
            Some(Unseen::nothing(slice.probes.count()))
        } else {
            slice.probes.estimate(problem, slice.ledger.archive.all())
        };
        Report {
            problem: problem.description(),
            engine: self.description(),
            scalar: S::NAME.to_owned(),
            seed: self.seed,
            islands: self.islands,
            slice: self.slices,
            budget: slice.ledger.budget.clone(),
            threshold: Some(problem.threshold().f64()).filter(|threshold| threshold.is_finite()),
            requested_probe_share: self.probes,
            probe_share: slice.probes.share(),
            stop_reason,
            panic: None,
            counts,
            elapsed,
            overshoot,
            completeness: if proved {
                Completeness::Proved
            } else {
                Completeness::Unknown
            },
            unseen,
            best: slice.ledger.best.get().cloned(),
            trace: slice.ledger.trace.clone(),
            sources: slice.sources.clone(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            archive: Arc::default(),
        }
    }
}
