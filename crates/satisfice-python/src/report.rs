//! Reports as Python sees them.

use numpy::{IntoPyArray, PyArray1, PyArrayMethods};
use pyo3::exceptions::{PyImportError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyType};
use satisfice_catalogue::report::FoundSolution;
use satisfice_catalogue::{RunReport, RunSpec, json};
use serde_json::Value;

use crate::refused;

/// What a search did and found.
#[pyclass(frozen, module = "satisfice")]
pub(crate) struct Report {
    report: RunReport,
    x: PyOnceLock<Py<PyAny>>,
    fun: PyOnceLock<Py<PyArray1<f64>>>,
    evaluation: PyOnceLock<Py<PyArray1<u64>>>,
    time: PyOnceLock<Py<PyArray1<f64>>>,
}

/// The candidate with the least value.
#[pyclass(frozen, get_all, module = "satisfice")]
pub(crate) struct Best {
    /// Its coordinates, or the solution where the problem's solutions are no points.
    x: Py<PyAny>,
    /// Its value.
    fun: f64,
    /// The evaluation that found it, counted from 1.
    evaluation: u64,
}

#[pymethods]
impl Best {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let x = self.x.bind(py).repr()?;
        Ok(format!(
            "Best(x={x}, fun={:?}, evaluation={})",
            self.fun, self.evaluation
        ))
    }
}

impl Report {
    pub(crate) fn new(report: RunReport) -> Self {
        Self {
            report,
            x: PyOnceLock::new(),
            fun: PyOnceLock::new(),
            evaluation: PyOnceLock::new(),
            time: PyOnceLock::new(),
        }
    }

    /// The report of a search of a function, in one slice.
    pub(crate) fn of_function(
        spec: RunSpec,
        report: &satisfice::Report<satisfice::Located<f64>>,
        failed: u64,
    ) -> PyResult<Self> {
        // Threads do not change a report, and JSON does not keep them.
        let spec = RunSpec { threads: 1, ..spec };
        let reports = core::slice::from_ref(report);
        let mut report = RunReport::of_slices(spec, reports, serde_json::to_value).map_err(refused)?;
        report.slices.clear();
        report.set_failed(failed);
        Ok(Self::new(report))
    }

    fn column<T: numpy::Element>(
        &self,
        py: Python<'_>,
        cell: &PyOnceLock<Py<PyArray1<T>>>,
        value: impl Fn(&FoundSolution) -> T,
    ) -> Py<PyArray1<T>> {
        let array = || {
            let column: Vec<T> = self.report.solutions.iter().map(value).collect();
            column.into_pyarray(py).unbind()
        };
        cell.get_or_init(py, array).clone_ref(py)
    }
}

/// The coordinates of a solution, if it is a point or a list of numbers.
fn coordinates(solution: &Value) -> Option<Vec<f64>> {
    let list = match solution {
        Value::Object(point) => point.get("coordinates")?,
        other => other,
    };
    list.as_array()?.iter().map(Value::as_f64).collect()
}

/// A value of JSON as Python has it.
fn python<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (text,))
}

#[pymethods]
impl Report {
    /// A report from the JSON that `to_json` or the command wrote.
    #[classmethod]
    fn from_json(_: &Bound<'_, PyType>, text: &str) -> PyResult<Self> {
        let report = serde_json::from_str(text)
            .map_err(|error| PyValueError::new_err(format!("this is not the JSON of a report: {error}")))?;
        Ok(Self::new(report))
    }

    /// The report as JSON; with a path, written to that file.
    #[pyo3(signature = (path=None))]
    fn to_json(&self, path: Option<std::path::PathBuf>) -> PyResult<Option<String>> {
        let text = json::to_vec(&self.report).map_err(refused)?;
        match path {
            Some(path) => {
                std::fs::write(path, text)?;
                Ok(None)
            }
            None => String::from_utf8(text).map(Some).map_err(refused),
        }
    }

    /// The report as a dict.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        python(py, &serde_json::to_string(&self.report).map_err(refused)?)
    }

    /// The hits as a pandas data frame.
    fn to_pandas<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let pandas = py.import("pandas").map_err(|error| {
            PyImportError::new_err(format!("to_pandas needs pandas (pip install pandas): {error}"))
        })?;
        let columns = PyDict::new(py);
        if let Some(points) = self.points() {
            let dimension = points.first().map_or_else(|| self.dimension(), Vec::len);
            for axis in 0..dimension {
                let column: Vec<f64> = points.iter().map(|point| point[axis]).collect();
                columns.set_item(format!("x{axis}"), column.into_pyarray(py))?;
            }
        } else {
            columns.set_item("solution", self.solutions(py)?)?;
        }
        columns.set_item("fun", self.fun(py))?;
        columns.set_item("evaluation", self.evaluation(py))?;
        columns.set_item("time", self.time(py))?;
        pandas.call_method1("DataFrame", (columns,))
    }

    fn __reduce__(slf: &Bound<'_, Self>) -> PyResult<(Py<PyAny>, (Option<String>,))> {
        let make = slf.get_type().getattr("from_json")?.unbind();
        Ok((make, (slf.get().to_json(None)?,)))
    }

    fn __len__(&self) -> usize {
        self.report.solutions.len()
    }

    fn __repr__(&self) -> String {
        let report = &self.report;
        format!(
            "<satisfice.Report {} hits in {} evaluations and {:.3} s by {} on {}, seed {}; {}, completeness {:?}>",
            report.hits,
            report.counts.evaluations,
            report.elapsed_seconds,
            report.spec.engine,
            report.spec.problem,
            report.spec.seed,
            report.stop_reason,
            report.completeness
        )
    }

    /// Coordinates of the hits, in the order found.
    #[getter]
    fn x(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let array = || {
            let points = self.points().ok_or_else(|| {
                PyValueError::new_err(format!(
                    "the solutions of {} are no points: see `solutions`",
                    self.report.spec.problem
                ))
            })?;
            let count = points.len();
            let dimension = match points.first() {
                Some(point) => point.len(),
                None => self.dimension(),
            };
            let flat: Vec<f64> = points.into_iter().flatten().collect();
            let array = flat.into_pyarray(py).reshape([count, dimension])?;
            Ok::<_, PyErr>(array.into_any().unbind())
        };
        Ok(self.x.get_or_try_init(py, array)?.clone_ref(py))
    }

    /// Values of the hits.
    #[getter]
    fn fun(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        self.column(py, &self.fun, |hit| hit.fitness)
    }

    /// The evaluation that found each hit.
    #[getter]
    fn evaluation(&self, py: Python<'_>) -> Py<PyArray1<u64>> {
        self.column(py, &self.evaluation, |hit| hit.evaluation)
    }

    /// When each hit was found.
    #[getter]
    fn time(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        self.column(py, &self.time, |hit| hit.seconds)
    }

    /// The hits as plain Python values.
    #[getter]
    fn solutions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let values: Vec<&Value> = self.report.solutions.iter().map(|hit| &hit.solution).collect();
        python(py, &serde_json::to_string(&values).map_err(refused)?)
    }

    /// The candidate with the least value.
    #[getter]
    fn best(&self, py: Python<'_>) -> PyResult<Option<Best>> {
        let Some(best) = &self.report.best else {
            return Ok(None);
        };
        let x = match coordinates(&best.solution) {
            Some(point) => point.into_pyarray(py).into_any().unbind(),
            None => python(py, &best.solution.to_string())?.unbind(),
        };
        Ok(Some(Best {
            x,
            fun: best.fitness,
            evaluation: best.evaluation,
        }))
    }

    /// Distinct hits against evaluations and seconds.
    #[getter]
    fn trace<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let trace = &self.report.trace;
        let columns = PyDict::new(py);
        let evaluations: Vec<u64> = trace.iter().map(|point| point.evaluations).collect();
        let seconds: Vec<f64> = trace.iter().map(|point| point.elapsed_seconds).collect();
        let hits: Vec<u64> = trace.iter().map(|point| point.hits).collect();
        columns.set_item("evaluations", evaluations.into_pyarray(py))?;
        columns.set_item("time", seconds.into_pyarray(py))?;
        columns.set_item("hits", hits.into_pyarray(py))?;
        Ok(columns)
    }

    /// The number of distinct hits.
    #[getter]
    fn hits(&self) -> u64 {
        self.report.hits
    }

    /// Candidates that used up the budget, those that were known included.
    #[getter]
    fn evaluations(&self) -> u64 {
        self.report.counts.evaluations
    }

    /// Calls of the function.
    #[getter]
    fn nfev(&self) -> u64 {
        self.report.counts.fitness_calls
    }

    /// Candidates that were known already.
    #[getter]
    fn duplicates(&self) -> u64 {
        self.report.counts.duplicates
    }

    /// Values that were NaN or infinite.
    #[getter]
    fn non_finite(&self) -> u64 {
        self.report.counts.non_finite
    }

    /// Evaluations that gave no value: exceptions that were caught, tickets that failed.
    #[getter]
    fn failed(&self) -> u64 {
        self.report.failed
    }

    /// The seed.
    #[getter]
    fn seed(&self) -> u64 {
        self.report.spec.seed
    }

    /// Name of the engine.
    #[getter]
    fn engine(&self) -> &str {
        &self.report.spec.engine
    }

    /// Name of the problem.
    #[getter]
    fn problem(&self) -> &str {
        &self.report.spec.problem
    }

    /// delta.
    #[getter]
    fn delta(&self) -> f64 {
        self.report.threshold.unwrap_or(f64::INFINITY)
    }

    /// Wall time in seconds.
    #[getter]
    fn elapsed(&self) -> f64 {
        self.report.elapsed_seconds
    }

    /// Why the search ended.
    #[getter]
    fn stop_reason(&self) -> String {
        format!("{:?}", self.report.stop_reason)
    }

    /// Whether all hits are known to be listed.
    #[getter]
    fn completeness(&self) -> String {
        format!("{:?}", self.report.completeness)
    }

    /// The estimated number of hits not seen.
    #[getter]
    fn unseen_estimate(&self) -> Option<f64> {
        self.report.unseen_estimate
    }

    /// The interval of that estimate.
    #[getter]
    fn unseen_interval(&self) -> Option<(f64, Option<f64>)> {
        self.report.unseen_interval
    }

    /// The number of all hits, where it is known and was asked for.
    #[getter]
    fn reference_hits(&self) -> Option<u64> {
        self.report.reference_hits
    }

    /// The share of them that was found.
    #[getter]
    fn recall(&self) -> Option<f64> {
        self.report.recall
    }
}

impl Report {
    /// The hits as points, if they are points with the same number of coordinates.
    fn points(&self) -> Option<Vec<Vec<f64>>> {
        let points: Vec<Vec<f64>> = self
            .report
            .solutions
            .iter()
            .map(|hit| coordinates(&hit.solution))
            .collect::<Option<_>>()?;
        let dimension = points.first().map(Vec::len);
        points
            .iter()
            .all(|point| Some(point.len()) == dimension)
            .then_some(points)
    }

    /// The number of axes where no hit says it.
    fn dimension(&self) -> usize {
        let bounds = self.report.spec.problem_parameters.get("bounds");
        let best = self.report.best.as_ref();
        bounds
            .and_then(Value::as_array)
            .map(Vec::len)
            .or_else(|| {
                best.and_then(|best| coordinates(&best.solution))
                    .map(|point| point.len())
            })
            .unwrap_or(0)
    }
}
