//! One line of `results.jsonl`: the report of a run without its solutions, and what a sweep asks of it.

use satisfice_catalogue::RunReport;
use serde::{Deserialize, Serialize};

use super::metrics::{self, Metrics, Moment};
use super::plan::{Plan, Planned, key, seconds};

/// A finished run. The run of a plan that it is of is not run again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Name of the part of the suite.
    pub part: String,
    /// The problem with the parameters that the suite sets.
    pub problem_label: String,
    /// The engine with the parameters that the suite sets.
    pub engine_label: String,
    /// Whether nothing else of the sweep ran meanwhile: only then do its times mean anything.
    pub alone: bool,
    /// Evaluations at which hits are counted.
    pub at_evaluations: Vec<u64>,
    /// Times in seconds at which hits are counted.
    pub at_seconds: Vec<f64>,
    /// The report, without solutions and trace.
    #[serde(flatten)]
    pub report: RunReport,
    /// The metrics of the run.
    pub metrics: Metrics,
    /// Evaluations, seconds and hits: exact at every point, which are those of the trace and up to 200 of the hits.
    pub curve: Vec<Moment>,
}

impl Row {
    /// From a report with its reference count.
    #[must_use]
    pub fn new(plan: &Plan, planned: Planned<'_>, report: RunReport, alone: bool) -> Self {
        let cell = planned.cell;
        let part = &plan.suite.parts[cell.part];
        let at_seconds = seconds(&part.at_times);
        Self {
            part: part.name.clone(),
            problem_label: cell.problem_label.clone(),
            engine_label: cell.engine_label.clone(),
            alone,
            at_evaluations: part.at_evaluations.clone(),
            metrics: Metrics::of(&report, &part.at_evaluations, &at_seconds, alone),
            at_seconds,
            curve: metrics::curve(&report),
            report: RunReport {
                solutions: Vec::new(),
                trace: Vec::new(),
                ..report
            },
        }
    }

    /// The number of hits after so many evaluations, from the curve.
    #[must_use]
    pub fn hits_by_evaluation(&self, evaluations: f64) -> u64 {
        #[expect(clippy::cast_precision_loss, reason = "counts below 2^53")]
        let after = self
            .curve
            .partition_point(|moment| moment.0 as f64 <= evaluations);
        after.checked_sub(1).map_or(0, |last| self.curve[last].2)
    }

    /// The number of hits after so many seconds, from the curve.
    #[must_use]
    pub fn hits_by_second(&self, seconds: f64) -> u64 {
        let after = self.curve.partition_point(|moment| moment.1 <= seconds);
        after.checked_sub(1).map_or(0, |last| self.curve[last].2)
    }
}

impl Plan {
    /// The run of the plan that a row is of, if any.
    #[must_use]
    pub fn find(&self, row: &Row) -> Option<Planned<'_>> {
        let spec = row.report.spec.clone().seed(0);
        let version = &row.report.version;
        let key = key(&row.part, &spec, &row.at_evaluations, &row.at_seconds, version);
        let cell = &self.cells[*self.places.get(&key)?];
        let seed = row.report.spec.seed;
        cell.seeds.contains(&seed).then_some(Planned { cell, seed })
    }
}
