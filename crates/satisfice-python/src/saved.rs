//! Searches as files: what is in them, and when they are written.

use std::time::{Duration, Instant};

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use satisfice::{Checkpoint, Located, Stepper};
use satisfice_catalogue::{RunSpec, checkpoint};
use serde::{Deserialize, Serialize};

use crate::question::{Function, Question};
use crate::refused;
use crate::told::{SavedPoint, ToldComponents};

/// The second checkpoint is written so soon, so that a path that cannot be written is noticed.
const FIRST: Duration = Duration::from_secs(1);
/// Time between the others; more where a checkpoint takes more than a tenth of it. As the command's default.
pub(crate) const EVERY: Duration = Duration::from_secs(5);

/// A saved search of a function.
#[derive(Serialize, Deserialize)]
pub(crate) struct Saved {
    pub(crate) question: Question,
    pub(crate) spec: RunSpec,
    pub(crate) failed: u64,
    /// Whether its points were given out under tickets.
    #[serde(default)]
    pub(crate) tickets: bool,
    /// Components of values that the engine has not been told yet.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) components: Vec<SavedPoint>,
    pub(crate) checkpoint: Checkpoint<Located<f64>>,
}

impl Saved {
    pub(crate) fn read(bytes: &[u8]) -> PyResult<Self> {
        serde_json::from_slice(bytes).map_err(damaged)
    }

    /// Reads the search that is to go on as `spec` says, with tickets or without.
    pub(crate) fn read_for(bytes: &[u8], spec: &RunSpec, tickets: bool) -> PyResult<Self> {
        let saved = Self::read(bytes)?;
        checkpoint::check_same(&saved.spec, spec).map_err(refused)?;
        if saved.tickets != tickets {
            let (then, now) = if tickets {
                ("without", "with")
            } else {
                ("with", "without")
            };
            return Err(PyValueError::new_err(format!(
                "the saved search ran {then} workers and cannot go on {now} them: give workers= and executor= as before"
            )));
        }
        Ok(saved)
    }

    pub(crate) fn to_bytes(&self) -> PyResult<Vec<u8>> {
        serde_json::to_vec(self).map_err(refused)
    }
}

pub(crate) fn damaged(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(format!("this is not a saved search: {error}"))
}

/// The seed of a saved search, of a function or of a problem of the catalogue.
#[pyfunction]
pub(crate) fn saved_seed(bytes: &[u8]) -> PyResult<u64> {
    #[derive(Deserialize)]
    struct OfFunction {
        spec: RunSpec,
    }
    serde_json::from_slice(bytes)
        .map(|saved: OfFunction| saved.spec)
        .or_else(|_| checkpoint::spec(bytes))
        .map(|spec| spec.seed)
        .map_err(damaged)
}

/// Writes checkpoints of a slice now and then, by a Python function that takes bytes.
pub(crate) struct Keeper {
    write: Py<PyAny>,
    question: Question,
    spec: RunSpec,
    told: ToldComponents,
    next: Instant,
    every: Duration,
}

impl Keeper {
    pub(crate) fn new(write: Py<PyAny>, question: &Question, spec: &RunSpec, told: &ToldComponents) -> Self {
        Self {
            write,
            question: question.clone(),
            spec: spec.clone(),
            told: told.clone(),
            next: now(),
            every: FIRST,
        }
    }

    pub(crate) fn is_due(&self) -> bool {
        now() >= self.next
    }

    /// Writes the slice with the values that are known of the batch that is out.
    pub(crate) fn save(
        &mut self,
        py: Python<'_>,
        stepper: &mut Stepper<'_, Function>,
        values: &[f64],
        failed: u64,
    ) -> PyResult<()> {
        let begun = now();
        stepper.note(values).map_err(refused)?;
        let (question, spec, components) = (self.question.clone(), self.spec.clone(), self.told.saved());
        let bytes = py.detach(move || {
            let saved = Saved {
                question,
                spec,
                failed,
                tickets: false,
                components,
                checkpoint: stepper.checkpoint(),
            };
            saved.to_bytes()
        })?;
        self.write.call1(py, (PyBytes::new(py, &bytes),))?;
        let end = now();
        self.next = end + self.every.max((end - begun) * 9);
        self.every = EVERY;
        Ok(())
    }
}

#[expect(
    clippy::disallowed_methods,
    reason = "when to write a file, which changes no report"
)]
fn now() -> Instant {
    Instant::now()
}
