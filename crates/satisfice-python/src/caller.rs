//! Calls of the user's function.

use numpy::{PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyTuple};

use crate::told::ToldComponents;

/// The user's function, and how it is called.
pub(crate) struct Caller<'py> {
    function: Bound<'py, PyAny>,
    /// Whether it takes all points of a batch at once.
    vectorized: bool,
    /// Exceptions that count as a value of NaN.
    catch: Bound<'py, PyTuple>,
    /// How many values were lost to such exceptions.
    pub(crate) failed: u64,
    /// Where the components of the values go.
    pub(crate) told: ToldComponents,
}

impl<'py> Caller<'py> {
    pub(crate) fn new(
        function: Bound<'py, PyAny>,
        vectorized: bool,
        catch: Bound<'py, PyTuple>,
        told: ToldComponents,
    ) -> Self {
        Self {
            function,
            vectorized,
            catch,
            failed: 0,
            told,
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
        let known = Known {
            points: if self.told.count() > 0 {
                points.clone()
            } else {
                Vec::new()
            },
            dimension,
        };
        // The function may keep or change its argument: it is a fresh array.
        let points = PyArray1::from_vec(py, points).reshape([count, dimension])?;
        if self.vectorized {
            self.all(py, points.into_any(), count, &known, values)?;
            return Ok(true);
        }
        self.one_by_one(py, &points.into_any(), count, &known, values, goes_on)
    }

    fn one_by_one(
        &mut self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
        count: usize,
        known: &Known,
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
                Ok(value) => values.push(self.one(&value, &point, known.point(index))?),
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
        known: &Known,
        values: &mut Vec<f64>,
    ) -> PyResult<()> {
        py.check_signals()?;
        match self.function.call1((points,)) {
            Ok(found) => self.many(&found, count, known, values),
            Err(error) => {
                let value = self.caught(py, error, count as u64)?;
                values.resize(values.len() + count, value);
                Ok(())
            }
        }
    }

    /// The value at a point, without its components, which are kept.
    fn one(&self, found: &Bound<'py, PyAny>, point: &Bound<'py, PyAny>, at: &[f64]) -> PyResult<f64> {
        let count = self.told.count();
        if count == 0 {
            return number(found, point);
        }
        let (value, components) = self.pair(found)?;
        let (value, mut told) = (number(&value, point)?, Vec::with_capacity(count));
        let wanted = format!("with components={count} they must have shape ({count},)");
        reals(
            &components,
            &[count],
            ["f returned components", &format!(" at x = {point}")],
            &wanted,
            &mut told,
        )?;
        self.told.check(at, value, &told)?;
        self.told.keep(at, &told);
        Ok(value)
    }

    /// The values at all points of a batch, without their components, which are kept.
    fn many(
        &self,
        found: &Bound<'py, PyAny>,
        points: usize,
        known: &Known,
        values: &mut Vec<f64>,
    ) -> PyResult<()> {
        let count = self.told.count();
        if count == 0 {
            return numbers(found, points, values);
        }
        let (found, components) = self.pair(found)?;
        let (mut now, mut told) = (Vec::with_capacity(points), Vec::with_capacity(points * count));
        numbers(&found, points, &mut now)?;
        let wanted =
            format!("with components={count} and vectorized=True they must have shape ({points}, {count})");
        reals(
            &components,
            &[points, count],
            ["f returned components", &format!(" for {points} points")],
            &wanted,
            &mut told,
        )?;
        let rows = || told.chunks_exact(count).enumerate();
        rows().try_for_each(|(index, row)| self.told.check(known.point(index), now[index], row))?;
        rows().for_each(|(index, row)| self.told.keep(known.point(index), row));
        values.append(&mut now);
        Ok(())
    }

    /// The value and the components of what the function returned.
    fn pair(&self, found: &Bound<'py, PyAny>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        found.extract().map_err(|_| {
            PyTypeError::new_err(format!(
                "f returned {found} of type {}: with components={} it must return a tuple (value, components)",
                kind(found),
                self.told.count()
            ))
        })
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

/// The points of a batch, where their components are to be kept.
struct Known {
    points: Vec<f64>,
    dimension: usize,
}

impl Known {
    fn point(&self, index: usize) -> &[f64] {
        let first = index * self.dimension;
        self.points.get(first..first + self.dimension).unwrap_or_default()
    }
}

/// The name of the type of a value.
fn kind(value: &Bound<'_, PyAny>) -> String {
    value
        .get_type()
        .name()
        .map_or_else(|_| String::new(), |name| name.to_string())
}

/// One value of the function.
fn number(value: &Bound<'_, PyAny>, point: &Bound<'_, PyAny>) -> PyResult<f64> {
    // A complex number of numpy would be taken by its real part.
    let is_real = value.is_instance_of::<PyFloat>() || !is_complex(value)?;
    let number = is_real.then(|| value.extract::<f64>().ok()).flatten();
    number.ok_or_else(|| {
        let kind = kind(value);
        PyTypeError::new_err(format!(
            "f returned {value} of type {kind} at x = {point}: it must return one real number (for all points at once, pass vectorized=True)"
        ))
    })
}

fn is_complex(value: &Bound<'_, PyAny>) -> PyResult<bool> {
    let numpy = value.py().import("numpy")?;
    numpy.call_method1("iscomplexobj", (value,))?.extract()
}

/// An array with NaN where it is masked.
fn filled<'py>(found: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let masked = found.py().import("numpy")?.getattr("ma")?;
    if masked.call_method1("isMaskedArray", (found,))?.extract()? {
        found.call_method1("filled", (f64::NAN,))
    } else {
        Ok(found.clone())
    }
}

/// The values at all points of a batch, of any real type and layout.
fn numbers(found: &Bound<'_, PyAny>, count: usize, values: &mut Vec<f64>) -> PyResult<()> {
    let found = &filled(found)?;
    if let Ok(array) = found.extract::<PyReadonlyArray1<'_, f64>>()
        && let Ok(slice) = array.as_slice()
        && slice.len() == count
    {
        values.extend_from_slice(slice);
        return Ok(());
    }
    let wanted = format!("with vectorized=True it must return shape ({count},)");
    reals(
        found,
        &[count],
        ["f returned an array", &format!(" for {count} points")],
        &wanted,
        values,
    )
}

/// Appends the numbers of an array of a shape, of any real type and layout. `subject` and where it stands begin an error, what is wanted ends it.
fn reals(
    found: &Bound<'_, PyAny>,
    shape: &[usize],
    [subject, place]: [&str; 2],
    wanted: &str,
    values: &mut Vec<f64>,
) -> PyResult<()> {
    let py = found.py();
    let array = py.import("numpy")?.call_method1("asarray", (found,))?;
    let is: Vec<usize> = array.getattr("shape")?.extract()?;
    if is != shape {
        let is = PyTuple::new(py, is)?;
        return Err(PyValueError::new_err(format!(
            "{subject} of shape {is}{place}: {wanted}"
        )));
    }
    let options = PyDict::new(py);
    options.set_item("order", "C")?;
    options.set_item("casting", "same_kind")?;
    let kind = array.getattr("dtype")?;
    let array = array
        .call_method("astype", ("float64",), Some(&options))
        .map_err(|_| {
            PyTypeError::new_err(format!("{subject} of {kind}{place}: they must be real numbers"))
        })?;
    let array: PyReadonlyArray1<'_, f64> = array.call_method0("ravel")?.extract()?;
    values.extend_from_slice(array.as_slice()?);
    Ok(())
}
