//! One line of `results.jsonl`: a run, without its solutions, with what is asked of it.

use satisfice::{Completeness, Counts, StopReason};
use serde::{Deserialize, Serialize};

use super::metrics::{Metrics, Moment};
use super::plan::Planned;
use satisfice_catalogue::Settings;
use satisfice_catalogue::record::{Limits, Record};

/// What tells a run from all others; a run whose key is in the file is not run again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Key {
    /// Name of the part of the suite.
    pub part: String,
    /// Name of the problem.
    pub problem: String,
    /// All its parameters.
    pub problem_parameters: Settings,
    /// Name of the engine.
    pub engine: String,
    /// All its parameters.
    pub engine_parameters: Settings,
    /// The seed.
    pub seed: u64,
    /// What it might spend.
    pub budget: Limits,
    /// Share of uniform probes, `null` where it was left to the engine.
    pub probes: Option<f64>,
    /// Evaluations at which hits are noted.
    pub at_evaluations: Vec<u64>,
    /// Times in seconds at which hits are noted.
    pub at_seconds: Vec<f64>,
    /// Version of the program.
    pub version: String,
}

impl Key {
    /// As text, to be looked up.
    #[must_use]
    pub fn text(&self) -> String {
        // Numbers and texts only: this cannot fail.
        serde_json::to_string(self).unwrap_or_default()
    }
}

/// A finished run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// What it is.
    #[serde(flatten)]
    pub key: Key,
    /// The problem with the parameters that the suite names.
    pub problem_label: String,
    /// The engine with the parameters that the suite names.
    pub engine_label: String,
    /// Whether nothing else of the sweep ran meanwhile: only then do its times mean anything.
    pub alone: bool,
    /// Wall time in seconds.
    pub elapsed_seconds: f64,
    /// How much longer than the time budget it took, in seconds.
    pub overshoot_seconds: f64,
    /// Why it ended.
    pub stop_reason: StopReason,
    /// Distinct hits.
    pub hits: u64,
    /// How many there are, where that is known.
    pub reference_hits: Option<u64>,
    /// `hits / reference_hits`.
    pub recall: Option<f64>,
    /// Whether all hits are known to be found.
    pub completeness: Completeness,
    /// What was counted.
    pub counts: Counts,
    /// What is asked of it.
    pub metrics: Metrics,
    /// Evaluations, seconds, |C|: exact at every point, which are those of the trace and up to 200 of the hits.
    pub curve: Vec<Moment>,
}

impl Row {
    /// From a record whose reference count is entered.
    #[must_use]
    pub fn new(planned: &Planned, record: &Record, alone: bool) -> Self {
        let key = planned.key.clone();
        Self {
            metrics: Metrics::of(record, &key.at_evaluations, &key.at_seconds, alone),
            key,
            problem_label: planned.problem_label.clone(),
            engine_label: planned.engine_label.clone(),
            alone,
            elapsed_seconds: record.elapsed_seconds,
            overshoot_seconds: record.overshoot_seconds,
            stop_reason: record.stop_reason,
            hits: record.hits,
            reference_hits: record.reference_hits,
            recall: record.recall,
            completeness: record.completeness,
            counts: record.counts,
            curve: super::metrics::curve(record),
        }
    }

    /// |C| after so many evaluations, from the curve.
    #[must_use]
    pub fn hits_by_evaluation(&self, evaluations: f64) -> u64 {
        #[expect(clippy::cast_precision_loss, reason = "counts below 2^53")]
        let after = self
            .curve
            .partition_point(|moment| moment.0 as f64 <= evaluations);
        after.checked_sub(1).map_or(0, |last| self.curve[last].2)
    }

    /// |C| after so many seconds, from the curve.
    #[must_use]
    pub fn hits_by_second(&self, seconds: f64) -> u64 {
        let after = self.curve.partition_point(|moment| moment.1 <= seconds);
        after.checked_sub(1).map_or(0, |last| self.curve[last].2)
    }
}
