//! Calls of the user's function.

use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

/// The user's function, and how it is called.
pub(crate) struct Caller<'py> {
    function: Bound<'py, PyAny>,
    /// Whether it takes all points of a batch at once.
    vectorized: bool,
    /// Exceptions that count as a value of NaN.
    catch: Bound<'py, PyTuple>,
    /// How many values were lost to such exceptions.
    pub(crate) failed: u64,
}

impl<'py> Caller<'py> {
    pub(crate) fn new(function: Bound<'py, PyAny>, vectorized: bool, catch: Bound<'py, PyTuple>) -> Self {
        Self {
            function,
            vectorized,
            catch,
            failed: 0,
        }
    }

    /// Appends the values at points of so many coordinates, one after the other, to `values`; `false` if `goes_on` says so before
    /// all are known: it sees the values and the failures so far before every call but the first. An exception leaves the
    /// values that were known before.
    pub(crate) fn evaluate(
        &mut self,
        py: Python<'py>,
        points: Vec<f64>,
        dimension: usize,
        values: &mut Vec<f64>,
        goes_on: impl FnMut(&[f64], u64) -> PyResult<bool>,
    ) -> PyResult<bool> {
        let count = points.len() / dimension;
        // The function may keep or change its argument: it is a fresh array.
        let points = PyArray1::from_vec(py, points).reshape([count, dimension])?;
        if self.vectorized {
            self.all(py, points.into_any(), count, values)?;
            return Ok(true);
        }
        self.one_by_one(py, &points.into_any(), count, values, goes_on)
    }

    fn one_by_one(
        &mut self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
        count: usize,
        values: &mut Vec<f64>,
        mut goes_on: impl FnMut(&[f64], u64) -> PyResult<bool>,
    ) -> PyResult<bool> {
        for index in 0..count {
            if index > 0 && !goes_on(values, self.failed)? {
                return Ok(false);
            }
            // A function written in C looks for no signals.
            py.check_signals()?;
            let point = points.get_item(index)?;
            match self.function.call1((&point,)) {
                Ok(value) => values.push(number(&value, &point)?),
                Err(error) => values.push(self.caught(py, error, 1)?),
            }
        }
        Ok(true)
    }

    fn all(
        &mut self,
        py: Python<'py>,
        points: Bound<'py, PyAny>,
        count: usize,
        values: &mut Vec<f64>,
    ) -> PyResult<()> {
        py.check_signals()?;
        match self.function.call1((points,)) {
            Ok(found) => numbers(&found, count, values),
            Err(error) => {
                let value = self.caught(py, error, count as u64)?;
                values.resize(values.len() + count, value);
                Ok(())
            }
        }
    }

    /// NaN for an exception that is to be caught; others are passed on.
    fn caught(&mut self, py: Python<'py>, error: PyErr, values: u64) -> PyResult<f64> {
        if self.catch.is_empty() || !error.matches(py, &self.catch)? {
            return Err(error);
        }
        self.failed += values;
        Ok(f64::NAN)
    }
}

/// One value of the function.
fn number(value: &Bound<'_, PyAny>, point: &Bound<'_, PyAny>) -> PyResult<f64> {
    value.extract::<f64>().map_err(|_| {
        let kind = value.get_type().name().map_or_else(|_| String::new(), |name| name.to_string());
        PyTypeError::new_err(format!(
            "f returned {value} of type {kind} at x = {point}: it must return one real number (for all points at once, pass vectorized=True)"
        ))
    })
}

/// The values at all points of a batch, of any real type and layout.
fn numbers(found: &Bound<'_, PyAny>, count: usize, values: &mut Vec<f64>) -> PyResult<()> {
    if let Ok(array) = found.extract::<PyReadonlyArray1<'_, f64>>()
        && let Ok(slice) = array.as_slice()
        && slice.len() == count
    {
        values.extend_from_slice(slice);
        return Ok(());
    }
    let py = found.py();
    let array = py.import("numpy")?.call_method1("asarray", (found,))?;
    let shape: Vec<usize> = array.getattr("shape")?.extract()?;
    if shape != [count] {
        let shape = PyTuple::new(py, shape)?;
        return Err(PyValueError::new_err(format!(
            "f returned an array of shape {shape} for {count} points: with vectorized=True it must return shape ({count},)"
        )));
    }
    let options = PyDict::new(py);
    options.set_item("order", "C")?;
    options.set_item("casting", "same_kind")?;
    let kind = array.getattr("dtype")?;
    let array = array
        .call_method("astype", ("float64",), Some(&options))
        .map_err(|_| {
            PyTypeError::new_err(format!(
                "f returned an array of {kind}: with vectorized=True it must return real numbers"
            ))
        })?;
    let array: PyReadonlyArray1<'_, f64> = array.extract()?;
    values.extend_from_slice(array.as_slice()?);
    Ok(())
}
