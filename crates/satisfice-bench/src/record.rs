//! The record of a run: plain data, the `--json` contract of the command.

use satisfice::{Completeness, Counts, StopReason, TracePoint};
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
    /// Estimated number of hits not seen; 0 where completeness is proved, `null` where nothing is known.
    pub unseen_estimate: Option<f64>,
    /// Its interval.
    pub unseen_interval: Option<[f64; 2]>,
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
    /// Enters how many hits there are, and the recall that follows.
    pub fn set_reference(&mut self, reference: Option<u64>) {
        self.reference_hits = reference;
        self.recall = reference.and_then(|reference| recall(self.hits, reference));
    }
}

/// `hits / reference`, `None` for a reference of 0.
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "a share")]
pub fn recall(hits: u64, reference: u64) -> Option<f64> {
    (reference > 0).then(|| hits as f64 / reference as f64)
}
