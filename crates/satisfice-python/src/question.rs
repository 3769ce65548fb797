//! A function of Python as a problem: its space and what a hit is.

use pyo3::prelude::*;
use satisfice::Search;
use satisfice::problem::{FnProblem, evaluated_elsewhere};
use satisfice_catalogue::axes::{self, AxisEntry};
use satisfice_catalogue::{RunSpec, Settings};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::arguments::engine;
use crate::refused;
use crate::told::ToldComponents;

/// A function is called by Python, never by the search.
pub(crate) type Function = FnProblem<f64, fn(&[f64]) -> f64>;

/// The space and what a hit is, as a dict.
#[derive(Clone, FromPyObject, Serialize, Deserialize)]
#[pyo3(from_item_all)]
pub(crate) struct Question {
    /// The axes and permutations, as JSON.
    #[pyo3(from_py_with = entries)]
    axes: Vec<AxisEntry>,
    delta: f64,
    separation: Option<Vec<f64>>,
    /// Number of components that the function tells beside its value.
    #[serde(default)]
    components: usize,
    /// Points to evaluate first.
    starts: Vec<Vec<f64>>,
    /// What a report says about the problem: its name, and its parameters as JSON.
    name: String,
    parameters: String,
}

impl Question {
    pub(crate) fn dimension(&self) -> usize {
        self.axes.iter().map(AxisEntry::len).sum()
    }

    /// The problem, and where to tell the components of its values.
    pub(crate) fn problem(&self) -> PyResult<(Function, ToldComponents)> {
        let space = axes::space(&self.axes).map_err(refused)?;
        let told = ToldComponents::new(self.components, self.delta);
        let by_point = told.clone();
        let problem = evaluated_elsewhere(space, self.delta)
            .components(self.components, move |point, out| by_point.write(point, out));
        let problem = match &self.separation {
            None => problem.separation(0.0),
            Some(radii) => problem.separations(radii).map_err(refused)?,
        };
        Ok((problem, told))
    }

    /// A search by the engine of a complete specification.
    pub(crate) fn search(&self, spec: &RunSpec) -> PyResult<Search<Function>> {
        let mut search = Search::with(engine(spec)?).seed(spec.seed).islands(spec.islands);
        if let Some(share) = spec.probes {
            search = search.probes(share);
        }
        Ok(search.start_from(&self.starts))
    }

    /// Enters the problem in a specification.
    pub(crate) fn enter(&self, spec: &mut RunSpec) -> PyResult<()> {
        spec.problem.clone_from(&self.name);
        let parameters: Value = serde_json::from_str(&self.parameters).map_err(refused)?;
        let mut settings = Settings::default();
        for (name, value) in parameters.as_object().into_iter().flatten() {
            settings.set(name, value.clone());
        }
        spec.problem_parameters = settings;
        Ok(())
    }
}

fn entries(axes: &Bound<'_, PyAny>) -> PyResult<Vec<AxisEntry>> {
    serde_json::from_str(axes.extract()?).map_err(refused)
}
