//! Islands that run in other processes, round by round: `python/satisfice/_islands.py` sends them there.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use numpy::{IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};
use satisfice::{Cancel, IslandRound, StopReason};
use satisfice_catalogue::RunSpec;
use serde::{Deserialize, Serialize};

use crate::arguments::{Run, engine};
use crate::caller::Caller;
use crate::find::drive;
use crate::question::{Function, Question};
use crate::refused;
use crate::report::Report;
use crate::saved::{Saved, damaged};
use crate::watch::Watcher;

/// What a worker has to know of a search, the same for all rounds.
#[derive(Clone, Serialize, Deserialize)]
struct Plan {
    question: Question,
    spec: RunSpec,
}

struct RoundsState {
    /// Taken by `report`.
    rounds: Option<satisfice::Rounds<Function>>,
    /// The islands that have to run until the next exchange.
    due: Vec<IslandRound<satisfice::Located<f64>>>,
    failed: u64,
}

/// A search whose islands run elsewhere.
#[pyclass(frozen, module = "satisfice")]
pub(crate) struct Rounds {
    inner: Mutex<RoundsState>,
    plan: Plan,
}

impl Rounds {
    fn lock(&self) -> MutexGuard<'_, RoundsState> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn with<T: Send>(
        &self,
        py: Python<'_>,
        act: impl FnOnce(&mut RoundsState, &mut satisfice::Rounds<Function>) -> PyResult<T> + Send,
    ) -> PyResult<T> {
        py.detach(|| {
            let mut inner = self.lock();
            let rounds = inner.rounds.take();
            let mut rounds = rounds.ok_or_else(|| PyRuntimeError::new_err("the search is reported"))?;
            let answer = act(&mut inner, &mut rounds);
            inner.rounds = Some(rounds);
            answer
        })
    }
}

#[pymethods]
impl Rounds {
    #[new]
    fn new(py: Python<'_>, question: Question, run: Run, saved: Option<&[u8]>) -> PyResult<Self> {
        let mut spec = run.spec()?;
        let (problem, _) = question.problem()?;
        question.enter(&mut spec)?;
        let (rounds, failed) = match saved {
            None => {
                let (search, budget) = (question.search(&spec)?, spec.slice_budget(&Cancel::new()));
                let rounds = py.detach(|| satisfice::Rounds::begin(search, problem, &budget));
                (rounds.map_err(refused)?, 0)
            }
            Some(bytes) => {
                let saved = Saved::read_for(bytes, &spec, false)?;
                let rounds = satisfice::Rounds::resume(saved.checkpoint, engine(&spec)?, problem);
                (rounds.map_err(damaged)?, saved.failed)
            }
        };
        let inner = RoundsState {
            rounds: Some(rounds),
            due: Vec::new(),
            failed,
        };
        Ok(Self {
            inner: Mutex::new(inner),
            plan: Plan { question, spec },
        })
    }

    /// What workers have to know.
    fn plan<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = serde_json::to_vec(&self.plan).map_err(refused)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Exchanges hits if all islands are there for it; returns those that have to run next.
    fn round(&self, py: Python<'_>) -> PyResult<Vec<usize>> {
        self.with(py, |inner, rounds| {
            inner.due.clear(); // what they hold of all hits would be copied
            inner.due = rounds.round(&mut ());
            Ok(inner.due.iter().map(IslandRound::island).collect())
        })
    }

    /// What an island has to do, as bytes for `run_island`.
    fn island<'py>(&self, py: Python<'py>, island: usize) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = self.with(py, |inner, rounds| {
            let due = inner.due.iter().find(|round| round.island() == island);
            let due =
                due.ok_or_else(|| PyValueError::new_err(format!("island {island} has nothing to do")))?;
            let elapsed = Duration::try_from_secs_f64(rounds.progress().elapsed_seconds).map_err(refused)?;
            serde_json::to_vec(&due.clone().at(elapsed)).map_err(refused)
        })?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Enters what `run_island` returned.
    fn take(&self, py: Python<'_>, done: &[u8], failed: u64) -> PyResult<()> {
        self.with(py, |inner, rounds| {
            let done: IslandRound<satisfice::Located<f64>> = serde_json::from_slice(done).map_err(damaged)?;
            inner.failed += failed;
            rounds.take(done).map_err(refused)
        })
    }

    /// Probes to evaluate when the islands have ended; none when the search is over.
    fn probes(&self, py: Python<'_>) -> PyResult<Py<PyArray2<f64>>> {
        let dimension = self.plan.question.dimension();
        let flat: Vec<f64> = self.with(py, |_, rounds| {
            let probes = rounds.ask_probes().iter();
            Ok(probes
                .flat_map(|probe| probe.coordinates.iter().copied())
                .collect())
        })?;
        let count = flat.len() / dimension;
        Ok(flat.into_pyarray(py).reshape([count, dimension])?.unbind())
    }

    fn tell_probes(&self, py: Python<'_>, values: PyReadonlyArray1<'_, f64>, failed: u64) -> PyResult<()> {
        let values = values.as_slice()?.to_vec();
        self.with(py, |inner, rounds| {
            inner.failed += failed;
            rounds.tell_probes(&values).map_err(refused)
        })
    }

    /// Ends the search before its budget is spent.
    fn end(&self, py: Python<'_>, reason: &str) -> PyResult<()> {
        let reason = match reason {
            "time" => StopReason::Time,
            "observer" => StopReason::Observer,
            _ => StopReason::Cancelled,
        };
        self.with(py, |_, rounds| {
            rounds.end(reason);
            Ok(())
        })
    }

    /// Evaluations, hits and seconds so far.
    fn progress(&self, py: Python<'_>) -> PyResult<(u64, u64, f64)> {
        self.with(py, |_, rounds| {
            let now = rounds.progress();
            Ok((now.evaluations, now.hits, now.elapsed_seconds))
        })
    }

    fn save<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = self.with(py, |inner, rounds| {
            let saved = Saved {
                question: self.plan.question.clone(),
                spec: self.plan.spec.clone(),
                failed: inner.failed,
                tickets: false,
                components: Vec::new(), // those of a round are known where it runs
                checkpoint: rounds.checkpoint(),
            };
            saved.to_bytes()
        })?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Ends the search and reports.
    fn report(&self, py: Python<'_>) -> PyResult<Report> {
        py.detach(|| {
            let mut inner = self.lock();
            let rounds = inner.rounds.take();
            let rounds = rounds.ok_or_else(|| PyRuntimeError::new_err("the search is reported"))?;
            Report::of_function(self.plan.spec.clone(), &rounds.finish(), inner.failed)
        })
    }
}

/// Runs an island for a round: what it then is, and how many values were lost to exceptions that were caught.
#[pyfunction]
pub(crate) fn run_island<'py>(
    py: Python<'py>,
    function: Bound<'py, PyAny>,
    plan: &[u8],
    island: &[u8],
    vectorized: bool,
    catch: Bound<'py, PyTuple>,
) -> PyResult<(Bound<'py, PyBytes>, u64)> {
    let plan: Plan = serde_json::from_slice(plan).map_err(damaged)?;
    let round: IslandRound<satisfice::Located<f64>> = serde_json::from_slice(island).map_err(damaged)?;
    let (problem, told) = plan.question.problem()?;
    let mut search = round.search::<Function>(engine(&plan.spec)?).map_err(damaged)?;
    let cancel = Cancel::new();
    let mut stepper = search.start_resumed_until(&problem, &cancel).map_err(damaged)?;
    let mut caller = Caller::new(function, vectorized, catch, told);
    let (mut watcher, mut values) = (Watcher::new(None, cancel), Vec::new());
    let dimension = plan.question.dimension();
    drive(
        py,
        &mut stepper,
        &mut caller,
        &mut watcher,
        dimension,
        &mut values,
        &mut None,
    )?;
    let done = py.detach(|| {
        let done = round.done(stepper, &values).map_err(refused)?;
        serde_json::to_vec(&done).map_err(refused)
    })?;
    Ok((PyBytes::new(py, &done), caller.failed))
}
