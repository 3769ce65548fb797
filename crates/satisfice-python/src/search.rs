//! A search that is asked for points and told their values: `satisfice.Search` is written around it.

use std::sync::{Mutex, MutexGuard, PoisonError};

use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyType};
use satisfice::{Cancel, Order, Ticket, Tickets, TracePoint};
use satisfice_catalogue::RunSpec;

use crate::arguments::{Run, engine};
use crate::question::{Function, Question};
use crate::refused;
use crate::report::Report;
use crate::saved::{Saved, damaged};
use crate::told::ToldComponents;

/// What is asked and told, and what it takes to write a report.
struct SearchState {
    tickets: Tickets<Function>,
    /// Values lost to exceptions and to workers.
    failed: u64,
}

/// A search by tickets.
#[pyclass(frozen, module = "satisfice")]
pub(crate) struct Search {
    inner: Mutex<SearchState>,
    question: Question,
    spec: RunSpec,
    told: ToldComponents,
}

impl Search {
    fn lock(&self) -> MutexGuard<'_, SearchState> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The components of so many values, one row for each; empty where the function has none.
    fn rows(&self, components: Option<PyReadonlyArray2<'_, f64>>, values: usize) -> PyResult<Vec<f64>> {
        let count = self.told.count();
        match components {
            None if count == 0 => Ok(Vec::new()),
            Some(components) if count > 0 && components.as_array().shape() == [values, count] => {
                Ok(components.as_slice()?.to_vec())
            }
            None => Err(PyValueError::new_err(format!(
                "the search has components={count}: tell them with the values, shape ({values}, {count})"
            ))),
            Some(_) if count == 0 => Err(PyValueError::new_err(
                "the search has no components: give Search their number, components=",
            )),
            Some(components) => Err(PyValueError::new_err(format!(
                "components have shape {:?}: for {values} values they must have shape ({values}, {count})",
                components.as_array().shape()
            ))),
        }
    }

    /// Keeps the components of values at points, after a look at all of them; those without a point are dropped.
    fn take<'a>(
        &self,
        points: impl Iterator<Item = Option<&'a [f64]>> + Clone,
        values: &[f64],
        components: &[f64],
    ) -> PyResult<()> {
        let rows = components.chunks_exact(self.told.count().max(1));
        let known = points.zip(values).zip(rows);
        let known = known.filter_map(|((point, &value), row)| Some((point?, value, row)));
        known
            .clone()
            .try_for_each(|(point, value, row)| self.told.check(point, value, row))?;
        known.for_each(|(point, _, row)| self.told.keep(point, row));
        Ok(())
    }

    fn flat(&self, points: &[Vec<f64>], py: Python<'_>) -> PyResult<Py<PyArray2<f64>>> {
        let dimension = self.question.dimension();
        let flat: Vec<f64> = points.concat();
        Ok(flat.into_pyarray(py).reshape([points.len(), dimension])?.unbind())
    }
}

/// Tickets and points as arrays.
type Asked = (Py<PyArray1<u64>>, Py<PyArray2<f64>>);

#[pymethods]
impl Search {
    #[new]
    fn new(py: Python<'_>, question: Question, run: Run, ordered: bool) -> PyResult<Self> {
        let mut spec = run.spec()?;
        let (problem, told) = question.problem()?;
        let search = question.search(&spec)?;
        question.enter(&mut spec)?;
        let order = if ordered { Order::Ordered } else { Order::Eager };
        let budget = spec.slice_budget(&Cancel::new());
        let tickets = py
            .detach(|| Tickets::begin(search, problem, &budget, order))
            .map_err(refused)?;
        let inner = Mutex::new(SearchState { tickets, failed: 0 });
        Ok(Self {
            inner,
            question,
            spec,
            told,
        })
    }

    fn ask(&self, py: Python<'_>, count: usize) -> PyResult<Asked> {
        let asked = py.detach(|| self.lock().tickets.ask(count));
        let numbers: Vec<u64> = asked.iter().map(|asked| asked.ticket.number()).collect();
        let points: Vec<Vec<f64>> = asked
            .into_iter()
            .map(|asked| asked.solution.coordinates)
            .collect();
        Ok((numbers.into_pyarray(py).unbind(), self.flat(&points, py)?))
    }

    fn tell(
        &self,
        py: Python<'_>,
        tickets: PyReadonlyArray1<'_, u64>,
        values: PyReadonlyArray1<'_, f64>,
        components: Option<PyReadonlyArray2<'_, f64>>,
    ) -> PyResult<()> {
        let (tickets, values) = (tickets.as_slice()?.to_vec(), values.as_slice()?.to_vec());
        if tickets.len() != values.len() {
            let what = format!(
                "{} values for {} tickets: give one for each",
                values.len(),
                tickets.len()
            );
            return Err(PyValueError::new_err(what));
        }
        let components = self.rows(components, values.len())?;
        py.detach(|| {
            let mut inner = self.lock();
            let known = |ticket: u64| inner.tickets.solution(Ticket::from(ticket));
            // A ticket that is told already is told nothing.
            let points = tickets
                .iter()
                .map(|&ticket| Some(&known(ticket)?.coordinates[..]));
            self.take(points, &values, &components)?;
            tickets
                .iter()
                .zip(values)
                .try_for_each(|(&ticket, value)| inner.tickets.tell(Ticket::from(ticket), value).map(drop))
                .map_err(refused)
        })
    }

    /// Tells that an evaluation gave no value.
    fn fail(&self, py: Python<'_>, ticket: u64) -> PyResult<()> {
        py.detach(|| {
            let mut inner = self.lock();
            inner.failed += 1;
            inner.tickets.tell(Ticket::from(ticket), f64::NAN).map(drop)
        })
        .map_err(refused)
    }

    fn forget(&self, py: Python<'_>, tickets: PyReadonlyArray1<'_, u64>) -> PyResult<()> {
        let tickets = tickets.as_slice()?.to_vec();
        py.detach(|| {
            let mut inner = self.lock();
            tickets
                .iter()
                .try_for_each(|&ticket| inner.tickets.forget(Ticket::from(ticket)).map(drop))
        })
        .map_err(refused)
    }

    fn inform(
        &self,
        py: Python<'_>,
        points: PyReadonlyArray2<'_, f64>,
        values: PyReadonlyArray1<'_, f64>,
        components: Option<PyReadonlyArray2<'_, f64>>,
    ) -> PyResult<()> {
        let dimension = self.question.dimension();
        let (points, values) = (points.as_slice()?.to_vec(), values.as_slice()?.to_vec());
        if points.len() != values.len() * dimension {
            return Err(PyValueError::new_err(format!(
                "{} coordinates for {} values: give a point of {dimension} coordinates for each",
                points.len(),
                values.len()
            )));
        }
        let components = self.rows(components, values.len())?;
        py.detach(|| {
            let mut inner = self.lock();
            let points = points.chunks_exact(dimension);
            self.take(points.clone().map(Some), &values, &components)?;
            for (point, &value) in points.zip(&values) {
                let solution = satisfice::SatisficingProblem::decode(inner.tickets.problem(), point);
                inner.tickets.inform(&solution, value).map_err(refused)?;
            }
            Ok(())
        })
    }

    fn open(&self, py: Python<'_>) -> usize {
        py.detach(|| self.lock().tickets.open())
    }

    fn pending(&self, py: Python<'_>) -> PyResult<Asked> {
        let pending = py.detach(|| {
            let inner = self.lock();
            let tickets = inner.tickets.pending().into_iter();
            tickets
                .filter_map(|ticket| {
                    Some((
                        ticket.number(),
                        inner.tickets.solution(ticket)?.coordinates.clone(),
                    ))
                })
                .collect::<Vec<_>>()
        });
        let (numbers, points): (Vec<u64>, Vec<Vec<f64>>) = pending.into_iter().unzip();
        Ok((numbers.into_pyarray(py).unbind(), self.flat(&points, py)?))
    }

    fn hits(&self, py: Python<'_>) -> usize {
        py.detach(|| self.lock().tickets.hits().len())
    }

    fn evaluations(&self, py: Python<'_>) -> u64 {
        py.detach(|| self.lock().tickets.counts().evaluations)
    }

    fn ticket_counts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let counts = py.detach(|| self.lock().tickets.ticket_counts());
        let dict = PyDict::new(py);
        for (name, count) in [
            ("asked", counts.asked),
            ("taken", counts.taken),
            ("unused", counts.unused),
            ("again", counts.again),
            ("late", counts.late),
            ("over", counts.over),
            ("forgotten", counts.forgotten),
        ] {
            dict.set_item(name, count)?;
        }
        Ok(dict)
    }

    fn report(&self, py: Python<'_>) -> PyResult<Report> {
        py.detach(|| {
            let inner = self.lock();
            let mut report = inner.tickets.report();
            // As at the end of a slice, whether or not this is it.
            let evaluations = report.counts.evaluations;
            if report
                .trace
                .last()
                .is_none_or(|last| last.evaluations < evaluations)
            {
                report.trace.push(TracePoint {
                    evaluations,
                    elapsed_seconds: report.elapsed.as_secs_f64(),
                    hits: report.hit_count() as u64,
                });
            }
            Report::of_function(self.spec.clone(), &report, inner.failed)
        })
    }

    fn dimension(&self) -> usize {
        self.question.dimension()
    }

    fn components(&self) -> usize {
        self.told.count()
    }

    fn save<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| {
            let inner = self.lock();
            let saved = Saved {
                question: self.question.clone(),
                spec: self.spec.clone(),
                failed: inner.failed,
                tickets: true,
                components: self.told.saved(),
                checkpoint: inner.tickets.checkpoint(),
            };
            saved.to_bytes()
        });
        Ok(PyBytes::new(py, &bytes?))
    }

    #[classmethod]
    fn load(_: &Bound<'_, PyType>, py: Python<'_>, bytes: &[u8]) -> PyResult<Self> {
        py.detach(|| {
            let saved = Saved::read(bytes)?;
            if !saved.tickets {
                return Err(PyValueError::new_err(
                    "this search has no tickets: `find` saved it, and goes on with it by checkpoint= and the same arguments",
                ));
            }
            Self::resume(saved)
        })
    }

    /// The saved search, which must be the same as this one.
    fn load_same(&self, py: Python<'_>, bytes: &[u8]) -> PyResult<Self> {
        py.detach(|| Self::resume(Saved::read_for(bytes, &self.spec, true)?))
    }
}

impl Search {
    fn resume(saved: Saved) -> PyResult<Self> {
        let (problem, told) = saved.question.problem()?;
        told.restore(saved.components);
        let tickets = Tickets::resume(saved.checkpoint, engine(&saved.spec)?, problem).map_err(damaged)?;
        Ok(Self {
            inner: Mutex::new(SearchState {
                tickets,
                failed: saved.failed,
            }),
            question: saved.question,
            spec: saved.spec,
            told,
        })
    }
}
