//! Signals and the user's callback, while a search runs.

use core::ops::ControlFlow;

use pyo3::prelude::*;
use satisfice::{Cancel, Observer, TracePoint};

/// Looks for signals and calls the user's callback, at most about a hundred times a second.
pub(crate) struct Watcher {
    callback: Option<Py<PyAny>>,
    /// Ends the search when a signal or the callback has raised an exception.
    cancel: Cancel,
    /// That exception.
    pub(crate) raised: Option<PyErr>,
}

impl Watcher {
    pub(crate) fn new(callback: Option<Py<PyAny>>, cancel: Cancel) -> Self {
        Self {
            callback,
            cancel,
            raised: None,
        }
    }

    /// Looks and calls once, on the thread of the caller; `Break` if the callback wants the search to end.
    pub(crate) fn look(&mut self, py: Python<'_>, now: TracePoint, share: f64) -> ControlFlow<()> {
        match py.check_signals().and_then(|()| self.call(py, now, share)) {
            Ok(false) => ControlFlow::Continue(()),
            Ok(true) => ControlFlow::Break(()),
            Err(error) => {
                self.raised = Some(error);
                self.cancel.cancel();
                ControlFlow::Continue(())
            }
        }
    }

    fn call(&self, py: Python<'_>, now: TracePoint, share: f64) -> PyResult<bool> {
        let Some(callback) = &self.callback else {
            return Ok(false);
        };
        let said = callback.call1(py, (now.evaluations, now.hits, now.elapsed_seconds, share))?;
        said.is_truthy(py)
    }
}

impl<T> Observer<T> for Watcher {
    fn progress(&mut self, now: TracePoint, share: f64) -> ControlFlow<()> {
        Python::attach(|py| self.look(py, now, share))
    }
}
