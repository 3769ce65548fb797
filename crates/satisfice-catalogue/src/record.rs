//! The record of a run: plain data, the `--json` contract of the command.

use satisfice::{Completeness, Counts, Method, StopReason, TracePoint, Unseen};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::settings::Settings;

/// What one run did and found: all that is needed to replay and to verify it. Everything but times is the same for the
/// same request under an evaluation budget.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Name of the problem.
    pub problem: String,
    /// All its parameters.
    pub problem_parameters: Settings,
    /// Name of the engine.
    pub engine: String,
    /// All its parameters.
    pub engine_parameters: Settings,
    /// `f32` or `f64`.
    pub scalar: String,
    /// delta: a hit is F < delta. `null` where it is infinite.
    pub threshold: Option<f64>,
    /// The seed.
    pub seed: u64,
    /// What it might spend.
    pub budget: Limits,
    /// The share of the evaluations spent on uniform probes.
    pub probe_share: f64,
    /// What was counted, summed over the slices.
    #[serde(flatten)]
    pub counts: Counts,
    /// Wall time in seconds, summed over the slices.
    pub elapsed_seconds: f64,
    /// How much longer than the time budget it took, in seconds, summed over the slices.
    pub overshoot_seconds: f64,
    /// Why the last slice ended.
    pub stop_reason: StopReason,
    /// Distinct hits, of all slices together.
    pub hits: u64,
    /// How many there are, where that is known.
    pub reference_hits: Option<u64>,
    /// `hits / reference_hits`, where that is known and not 0 / 0.
    pub recall: Option<f64>,
    /// Whether all hits are known to be listed.
    pub completeness: Completeness,
    /// Estimated number of hits not seen; 0 where completeness is proved, `null` where nothing was probed.
    pub unseen_estimate: Option<f64>,
    /// Its interval; no upper end where nothing bounds it.
    pub unseen_interval: Option<(f64, Option<f64>)>,
    /// The chance with which the interval holds the truth, at least.
    pub unseen_confidence: Option<f64>,
    /// How it was estimated.
    pub unseen_method: Option<Method>,
    /// Distinct hits against evaluations and time, over all slices.
    pub trace: Vec<TracePoint>,
    /// The slices one by one, where there are several.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub slices: Vec<Slice>,
    /// The hits, in the order found.
    pub solutions: Vec<Solution>,
    /// Version of the framework.
    pub version: String,
}

/// The budget of each slice, and how many slices.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// Seconds a slice.
    pub time_seconds: Option<f64>,
    /// Evaluations a slice.
    pub evaluations: Option<u64>,
    /// Distinct hits at which the run ends.
    pub hits: Option<u64>,
    /// Slices.
    pub slices: u64,
}

/// One slice of several.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Slice {
    /// What was counted.
    #[serde(flatten)]
    pub counts: Counts,
    /// Wall time in seconds.
    pub elapsed_seconds: f64,
    /// How much longer than the time budget it took, in seconds.
    pub overshoot_seconds: f64,
    /// Why it ended.
    pub stop_reason: StopReason,
    /// |C|: the distinct hits of this slice.
    pub hits: u64,
    /// How many of them no earlier slice had found.
    pub new_hits: u64,
    /// Whether it proved that all hits are listed.
    pub completeness: Completeness,
}

/// One hit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Solution {
    /// What was found.
    pub solution: Value,
    /// F of it.
    pub fitness: f64,
    /// The evaluation that found it, counted from 1 over all slices.
    pub evaluation: u64,
    /// When, in seconds of running time over all slices.
    pub seconds: f64,
}

impl Record {
    /// Enters what is estimated to be missing from the last C, of which `found_elsewhere` hits are listed as well.
    #[expect(clippy::cast_precision_loss, reason = "an estimate")]
    pub(crate) fn set_unseen(&mut self, unseen: Option<&Unseen>, found_elsewhere: u64) {
        // How many there are in all stays the same: what is listed beyond C is no longer missing.
        let less = |missing: f64| (missing - found_elsewhere as f64).max(0.0);
        self.unseen_estimate = unseen.map(|unseen| less(unseen.estimate));
        self.unseen_interval = unseen.map(|Unseen { interval: (a, b), .. }| (less(*a), b.map(less)));
        self.unseen_confidence = unseen.map(|unseen| unseen.confidence);
        self.unseen_method = unseen.map(|unseen| unseen.method);
    }

    /// Enters how many hits there are, and the recall that follows.
    pub fn set_reference(&mut self, reference: Option<u64>) {
        self.reference_hits = reference;
        self.recall = reference.and_then(|reference| recall(self.hits, reference));
    }
}

impl Record {
    /// Adds a run on another problem, whose solutions are all different ones, as if it had followed this one.
    pub fn append(&mut self, next: Self) {
        let (evaluations, seconds, hits) = (self.counts.evaluations, self.elapsed_seconds, self.hits);
        self.trace.extend(next.trace.into_iter().map(|point| TracePoint {
            evaluations: evaluations + point.evaluations,
            elapsed_seconds: seconds + point.elapsed_seconds,
            hits: hits + point.hits,
        }));
        self.solutions
            .extend(next.solutions.into_iter().map(|found| Solution {
                evaluation: evaluations + found.evaluation,
                seconds: seconds + found.seconds,
                ..found
            }));
        self.counts += next.counts;
        self.elapsed_seconds += next.elapsed_seconds;
        self.overshoot_seconds += next.overshoot_seconds;
        self.stop_reason = next.stop_reason;
        self.hits += next.hits;
        if next.completeness == Completeness::Unknown {
            self.completeness = Completeness::Unknown;
        }
        self.unseen_estimate = self.unseen_estimate.zip(next.unseen_estimate).map(|(a, b)| a + b);
        self.unseen_interval = self
            .unseen_interval
            .zip(next.unseen_interval)
            .map(|((a, b), (c, d))| (a + c, b.zip(d).map(|(b, d)| b + d)));
        // Both intervals hold the truth at once no less often than this.
        self.unseen_confidence = self
            .unseen_confidence
            .zip(next.unseen_confidence)
            .map(|(a, b)| (a + b - 1.0).max(0.0));
        if self.unseen_method == Some(Method::Proved) || next.unseen_method.is_none() {
            self.unseen_method = next.unseen_method;
        }
        let reference = self.reference_hits.zip(next.reference_hits).map(|(a, b)| a + b);
        self.set_reference(reference);
    }
}

/// `hits / reference`, `None` for a reference of 0.
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "a share")]
pub fn recall(hits: u64, reference: u64) -> Option<f64> {
    (reference > 0).then(|| hits as f64 / reference as f64)
}
