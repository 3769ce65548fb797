//! Problems of the catalogue, with their parameters set.

use core::time::Duration;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use satisfice::{Cancel, TracePoint};
use satisfice_catalogue::{Instance, Progress, RunControl, RunReport, catalogue};

use crate::arguments::Run;
use crate::find::with_report;
use crate::refused;
use crate::report::Report;
use crate::saved::EVERY;
use crate::watch::Watcher;

/// How often the calling thread looks for signals while another one works.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// Waits without the interpreter's lock.
fn wait<T: Send>(py: Python<'_>, receiver: &mut Receiver<T>) -> Result<T, RecvTimeoutError> {
    py.detach(move || receiver.recv_timeout(LOOK_EVERY))
}

/// A problem of the catalogue. The Python function `problem` makes it.
#[pyclass(frozen, module = "satisfice")]
pub(crate) struct Problem {
    instance: Arc<dyn Instance>,
    /// The parameters that were given.
    given: Vec<(String, String)>,
}

#[pymethods]
impl Problem {
    #[new]
    fn new(name: &str, given: Vec<(String, String)>) -> PyResult<Self> {
        let settings = given.iter().map(|(name, value)| (name.as_str(), value.as_str()));
        let instance = catalogue::find(name).and_then(|problem| problem.build(settings));
        Ok(Self {
            instance: instance.map_err(refused)?.into(),
            given,
        })
    }

    fn __reduce__(slf: &Bound<'_, Self>) -> (Py<PyAny>, (String, Vec<(String, String)>)) {
        let this = slf.get();
        let name = this.instance.name().to_owned();
        (slf.get_type().into_any().unbind(), (name, this.given.clone()))
    }

    fn __repr__(&self) -> String {
        let parameters = self.instance.parameters();
        let settings: Vec<String> = parameters
            .iter()
            .map(|(name, value)| format!("{name}={value}"))
            .collect();
        format!(
            "<satisfice.Problem {} {}>",
            self.instance.name(),
            settings.join(" ")
        )
    }

    /// Its name in the catalogue.
    #[getter]
    fn name(&self) -> &'static str {
        self.instance.name()
    }

    /// All its parameters, as JSON.
    fn _parameters(&self) -> PyResult<String> {
        serde_json::to_string(self.instance.parameters()).map_err(refused)
    }

    /// The number of all hits, where it is known. May take long.
    fn reference_hits(&self, py: Python<'_>) -> PyResult<Option<u64>> {
        let counted = Arc::clone(&self.instance);
        let (sender, mut receiver) = channel();
        // After Ctrl-C nobody waits for the count, which cannot be ended.
        std::thread::spawn(move || sender.send(counted.reference_hits()));
        loop {
            match wait(py, &mut receiver) {
                Ok(count) => return Ok(count),
                Err(RecvTimeoutError::Timeout) => py.check_signals()?,
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(PyRuntimeError::new_err("the count of all hits panicked"));
                }
            }
        }
    }

    fn _run(
        &self,
        py: Python<'_>,
        run: Run,
        callback: Option<Py<PyAny>>,
        reference: bool,
        saved: Option<&[u8]>,
        save: Option<Py<PyAny>>,
    ) -> PyResult<Report> {
        let spec = run.spec()?;
        let cancel = Cancel::new();
        let mut watcher = Watcher::new(callback, cancel.clone());
        let (sender, mut receiver) = channel();
        let unwritten = Mutex::new(None);
        let run = std::thread::scope(|scope| {
            let running = scope.spawn(|| {
                let mut watch = move |progress: &Progress| {
                    // The receiver is there as long as this thread.
                    let _ = sender.send((progress.now, progress.share));
                };
                let mut write = |bytes: &[u8]| {
                    let Some(save) = &save else { return };
                    let written = Python::attach(|py| save.call1(py, (PyBytes::new(py, bytes),)).map(drop));
                    if let Err(error) = written {
                        *unwritten.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
                        cancel.cancel();
                    }
                };
                let mut control = RunControl {
                    watch: Some(&mut watch),
                    resume: saved,
                    every: EVERY,
                    ..RunControl::until(&cancel)
                };
                if save.is_some() {
                    control.save = Some(&mut write);
                }
                self.instance.run(&spec, control)
            });
            let mut seen = (
                TracePoint {
                    evaluations: 0,
                    elapsed_seconds: 0.0,
                    hits: 0,
                },
                0.0,
            );
            loop {
                match wait(py, &mut receiver) {
                    Ok(now) => seen = now,
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => break,
                }
                if watcher.raised.is_none() && watcher.look(py, seen.0, seen.1).is_break() {
                    cancel.cancel();
                }
            }
            py.detach(|| running.join())
        });
        let report: Result<RunReport, _> =
            run.map_err(|_| PyRuntimeError::new_err("the problem panicked"))?;
        let mut report = report.map_err(refused)?;
        let unwritten = unwritten.into_inner().unwrap_or_else(PoisonError::into_inner);
        if let Some(error) = watcher.raised.or(unwritten) {
            return Err(with_report(py, error, Report::new(report)));
        }
        if reference {
            report.set_reference(self.reference_hits(py)?);
        }
        Ok(Report::new(report))
    }
}
