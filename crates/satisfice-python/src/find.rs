//! A search of a function written in Python.

use pyo3::prelude::*;
use pyo3::types::PyTuple;
use satisfice::{Cancel, Search, Stepper};

use crate::arguments::{Run, engine};
use crate::caller::Caller;
use crate::question::{Function, Question};
use crate::refused;
use crate::report::Report;
use crate::saved::{Keeper, Saved, damaged};
use crate::watch::Watcher;

/// Searches a function for all points with f(x) < delta. The Python function of the same name has the documentation.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the Python function has keywords")]
pub(crate) fn find<'py>(
    py: Python<'py>,
    function: Bound<'py, PyAny>,
    question: Question,
    run: Run,
    vectorized: bool,
    callback: Option<Py<PyAny>>,
    catch: Bound<'py, PyTuple>,
    saved: Option<&[u8]>,
    save: Option<Py<PyAny>>,
) -> PyResult<Report> {
    let mut spec = run.spec()?;
    let (problem, told) = question.problem()?;
    question.enter(&mut spec)?;
    let mut caller = Caller::new(function, vectorized, catch, told.clone());
    let cancel = Cancel::new();
    let mut watcher = Watcher::new(callback, cancel.clone());
    let mut keeper = save.map(|write| Keeper::new(write, &question, &spec, &told));
    let mut search;
    let stepper = match saved {
        None => {
            search = question.search(&spec)?;
            search.start(&problem, &spec.slice_budget(&cancel))
        }
        Some(bytes) => {
            let saved = Saved::read_for(bytes, &spec, false)?;
            caller.failed = saved.failed;
            told.restore(saved.components);
            search = Search::resume(saved.checkpoint, engine(&spec)?).map_err(damaged)?;
            search.start_resumed_until(&problem, &cancel)
        }
    };
    let mut stepper = stepper.map_err(refused)?;
    let mut values = Vec::new();
    let raised = drive(
        py,
        &mut stepper,
        &mut caller,
        &mut watcher,
        question.dimension(),
        &mut values,
        &mut keeper,
    )
    .err();
    // What is known of a batch that was cut short is in the file as well.
    let raised = match &mut keeper {
        Some(keeper) => keeper
            .save(py, &mut stepper, &values, caller.failed)
            .err()
            .or(raised),
        None => raised,
    };
    let report = stepper.finish_with(&values).map_err(refused)?;

    let report = Report::of_function(spec, &report, caller.failed)?;
    match raised {
        None => Ok(report),
        Some(error) => Err(with_report(py, error, report)),
    }
}

/// Runs a slice to its end, to its pause, or to an exception. Engines work without the interpreter's lock. `values` are then what
/// is known of a batch that was cut short, which is still to be told.
pub(crate) fn drive<'py>(
    py: Python<'py>,
    stepper: &mut Stepper<'_, Function>,
    caller: &mut Caller<'py>,
    watcher: &mut Watcher,
    dimension: usize,
    values: &mut Vec<f64>,
    keeper: &mut Option<Keeper>,
) -> PyResult<()> {
    let mut asked = false;
    let told = caller.told.clone();
    loop {
        let points = py
            .detach(|| {
                if asked {
                    stepper.tell_with(values, watcher)?;
                    told.clear();
                }
                values.clear();
                let points = stepper.ask_with(watcher)?;
                let mut flat = Vec::with_capacity(points.len() * dimension);
                points
                    .iter()
                    .for_each(|point| flat.extend_from_slice(&point.coordinates));
                if !asked && !flat.is_empty() {
                    // Only a slice that was saved knows some already.
                    values.extend_from_slice(stepper.noted());
                    flat.drain(..values.len() * dimension);
                }
                Ok::<_, satisfice::Error>(flat)
            })
            .map_err(refused)?;
        if let Some(error) = watcher.raised.take() {
            return Err(error);
        }
        if points.is_empty() && values.is_empty() {
            return Ok(());
        }
        asked = true;
        let goes_on = |values: &[f64], failed: u64| {
            if let Some(keeper) = keeper
                && keeper.is_due()
            {
                keeper.save(py, stepper, values, failed)?;
            }
            Ok(!stepper.is_interrupted())
        };
        if !caller.evaluate(py, points, dimension, values, goes_on)? {
            return Ok(());
        }
        if let Some(keeper) = keeper
            && keeper.is_due()
        {
            keeper.save(py, stepper, values, caller.failed)?;
        }
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
