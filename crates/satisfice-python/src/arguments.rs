//! What Python says about a run.

use std::time::Duration;

use pyo3::prelude::*;
use satisfice::engine::ConfiguredEngine;
use satisfice_catalogue::{RunSpec, quantity};

use crate::refused;

/// Engine, seed and budget of a run, as a dict.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Run {
    engine: String,
    options: Vec<(String, String)>,
    seed: u64,
    time: Option<f64>,
    evaluations: Option<u64>,
    hits: Option<u64>,
    patience: Option<u64>,
    slices: u64,
    probes: Option<f64>,
    islands: usize,
    threads: usize,
    parallel: Option<usize>,
}

impl Run {
    /// The specification of the run, with every parameter of its engine.
    pub(crate) fn spec(&self) -> PyResult<RunSpec> {
        let mut spec = RunSpec::new(&self.engine).seed(self.seed).slices(self.slices);
        for (name, text) in &self.options {
            spec = spec.set(name, text);
        }
        spec.budget.time = match self.time {
            Some(seconds) => Some(Duration::try_from_secs_f64(seconds).map_err(|_| {
                refused(format!(
                    "time = {seconds} is not allowed: a positive number of seconds"
                ))
            })?),
            None => None,
        };
        spec.budget.evaluations = self.evaluations;
        spec.budget.hits = self.hits;
        spec.budget.patience = self.patience;
        spec.budget.parallel = self.parallel;
        spec.probes = self.probes;
        spec.islands = self.islands;
        spec.threads = checked_threads(self.threads)?;
        spec.complete().map_err(refused)
    }
}

/// A number of threads, within the limit that the command has.
pub(crate) fn checked_threads(threads: usize) -> PyResult<usize> {
    quantity::checked_threads(threads)
        .map_err(|allowed| refused(format!("threads = {threads} is not allowed: it {allowed}")))
}

/// The engine of a complete specification.
pub(crate) fn engine(spec: &RunSpec) -> PyResult<ConfiguredEngine<f64>> {
    let texts = spec.engine_parameters.texts();
    ConfiguredEngine::named(&spec.engine)
        .and_then(|engine| engine.set_all(texts.iter().map(|(name, text)| (name.as_str(), text.as_str()))))
        .map_err(refused)
}
