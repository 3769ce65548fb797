//! A search of a function written in Python.

use pyo3::prelude::*;
use pyo3::types::PyTuple;
use satisfice::engine::ConfiguredEngine;
use satisfice::problem::{FnProblem, evaluated_elsewhere};
use satisfice::{Axis, Cancel, Located, Search, Space, Stepper};
use satisfice_catalogue::{RunReport, RunSpec, Settings};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::arguments::{Run, budget};
use crate::caller::Caller;
use crate::refused;
use crate::report::Report;
use crate::watch::Watcher;

/// A function is called by Python, never by the search.
pub(crate) type Function = FnProblem<f64, fn(&[f64]) -> f64>;

/// The space and what a hit is, as a dict.
#[derive(Clone, FromPyObject, Serialize, Deserialize)]
#[pyo3(from_item_all)]
pub(crate) struct Question {
    /// Lower and upper end of each axis, and whether it is one of integers.
    axes: Vec<(f64, f64, bool)>,
    delta: f64,
    separation: Option<Vec<f64>>,
    /// What a report says about the problem: its name, and its parameters as JSON.
    name: String,
    parameters: String,
}

impl Question {
    pub(crate) fn dimension(&self) -> usize {
        self.axes.len()
    }

    pub(crate) fn problem(&self) -> PyResult<Function> {
        let axes = self.axes.iter().map(|&(lower, upper, integer)| {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "Python has checked that they are whole and small"
            )]
            if integer {
                Axis::integer(lower as i64, upper as i64)
            } else {
                Axis::continuous(lower, upper)
            }
        });
        let space = Space::new(axes).map_err(refused)?;
        let problem = evaluated_elsewhere(space, self.delta);
        match &self.separation {
            None => Ok(problem.separation(0.0)),
            Some(radii) => problem.separations(radii).map_err(refused),
        }
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

/// Searches a function for all points with f(x) < delta. The Python function of the same name has the documentation.
#[pyfunction]
pub(crate) fn find<'py>(
    py: Python<'py>,
    function: Bound<'py, PyAny>,
    question: Question,
    run: Run,
    vectorized: bool,
    callback: Option<Py<PyAny>>,
    catch: Bound<'py, PyTuple>,
) -> PyResult<Report> {
    let mut spec = run.spec()?;
    let problem = question.problem()?;
    let mut search = search(&spec)?;
    question.enter(&mut spec)?;

    let cancel = Cancel::new();
    let mut watcher = Watcher::new(callback, cancel.clone());
    let mut caller = Caller::new(function, vectorized, catch);
    let budget = budget(&spec, &cancel);
    let stepper = search.start(&problem, &budget).map_err(refused)?;
    let (report, raised) = drive(py, stepper, &mut caller, &mut watcher, question.dimension())?;

    let spec = RunSpec { threads: 1, ..spec };
    let mut report = RunReport::of_slices(spec, &[report], serde_json::to_value).map_err(refused)?;
    report.slices.clear();
    report.failed = caller.failed;
    let report = Report::new(report);
    match raised {
        None => Ok(report),
        Some(error) => Err(with_report(py, error, report)),
    }
}

/// A search by the engine of a complete specification.
pub(crate) fn search(spec: &RunSpec) -> PyResult<Search<Function>> {
    let mut search = Search::with(engine(spec)?).seed(spec.seed).islands(spec.islands);
    if let Some(share) = spec.probes {
        search = search.probes(share);
    }
    Ok(search)
}

/// The engine of a complete specification.
pub(crate) fn engine(spec: &RunSpec) -> PyResult<ConfiguredEngine<f64>> {
    let texts = spec.engine_parameters.texts();
    ConfiguredEngine::named(&spec.engine)
        .and_then(|engine| engine.set_all(texts.iter().map(|(name, text)| (name.as_str(), text.as_str()))))
        .map_err(refused)
}

/// Runs a slice to its end, or to an exception. Engines work without the interpreter's lock.
fn drive<'py>(
    py: Python<'py>,
    mut stepper: Stepper<'_, Function>,
    caller: &mut Caller<'py>,
    watcher: &mut Watcher,
    dimension: usize,
) -> PyResult<(satisfice::Report<Located<f64>>, Option<PyErr>)> {
    let mut values = Vec::new();
    let mut asked = false;
    loop {
        let points = py
            .detach(|| {
                if asked {
                    stepper.tell_with(&values, watcher)?;
                }
                values.clear();
                let points = stepper.ask_with(watcher)?;
                let mut flat = Vec::with_capacity(points.len() * dimension);
                points
                    .iter()
                    .for_each(|point| flat.extend_from_slice(&point.coordinates));
                Ok::<_, satisfice::Error>(flat)
            })
            .map_err(refused)?;
        if let Some(error) = watcher.raised.take() {
            return Ok((stepper.finish(), Some(error)));
        }
        if points.is_empty() {
            return Ok((stepper.finish(), None));
        }
        asked = true;
        let evaluated = caller.evaluate(py, points, dimension, &mut values, || stepper.is_interrupted());
        let raised = match evaluated {
            Ok(true) => continue,
            Ok(false) => None,
            Err(error) => Some(error),
        };
        return Ok((stepper.finish_with(&values).map_err(refused)?, raised));
    }
}

/// The exception with what was found until then.
pub(crate) fn with_report(py: Python<'_>, error: PyErr, report: Report) -> PyErr {
    let attached = Py::new(py, report).and_then(|report| {
        let value = error.value(py);
        value.setattr("report", report)?;
        let note = "satisfice: what was found until then is in the attribute `report` of this exception";
        value.call_method1("add_note", (note,))
    });
    // An exception that takes no attribute is raised as it is.
    drop(attached);
    error
}
