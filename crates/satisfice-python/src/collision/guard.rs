//! When a query on meshes ends early: its time, its limit, Ctrl-C.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::thread::ThreadId;
use std::time::{Duration, Instant};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::ThreadPool;

use crate::arguments::checked_threads;
use crate::refused;

/// How often signals are looked for.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// Time that is kept for measuring each pair that is found before a deadline.
const MEASURING: Duration = Duration::from_nanos(500);
/// So long after the deadline pairs are still measured, where that was not enough.
const MEASURED_LATE: Duration = Duration::from_millis(30);

/// Says when to stop, from any thread.
pub(super) struct Guard {
    begun: Instant,
    deadline: Option<Instant>,
    limit: usize,
    /// The only thread on which Python handles signals.
    caller: ThreadId,
    /// Milliseconds since the beginning at which signals are to be looked for next.
    next_look: AtomicU64,
    interrupted: AtomicBool,
    raised: Mutex<Option<PyErr>>,
}

impl Guard {
    /// A guard of a query that begins now, on the calling thread.
    pub(super) fn new(time: Option<f64>, limit: Option<usize>) -> PyResult<Self> {
        let begun = now();
        let deadline = time.map(|seconds| {
            Duration::try_from_secs_f64(seconds)
                .ok()
                .and_then(|time| begun.checked_add(time))
                .ok_or_else(|| {
                    refused(format!(
                        "time = {seconds} is not allowed: a positive number of seconds"
                    ))
                })
        });
        Ok(Self {
            begun,
            deadline: deadline.transpose()?,
            limit: limit.unwrap_or(usize::MAX),
            caller: std::thread::current().id(),
            next_look: AtomicU64::new(LOOK_EVERY.as_millis() as u64),
            interrupted: AtomicBool::new(false),
            raised: Mutex::new(None),
        })
    }

    /// Whether to stop, with so many pairs found.
    pub(super) fn stops(&self, found: usize) -> bool {
        found >= self.limit || self.stops_at(self.deadline)
    }

    /// Whether to stop at this moment, or by Ctrl-C.
    pub(super) fn stops_at(&self, deadline: Option<Instant>) -> bool {
        if self.interrupted.load(Ordering::Relaxed) {
            return true;
        }
        let now = now();
        if deadline.is_some_and(|deadline| now >= deadline) {
            return true;
        }
        let passed = (now - self.begun).as_millis() as u64;
        if passed >= self.next_look.load(Ordering::Relaxed) && std::thread::current().id() == self.caller {
            self.next_look
                .store(passed + LOOK_EVERY.as_millis() as u64, Ordering::Relaxed);
            Python::attach(|py| self.look(py));
        }
        self.interrupted.load(Ordering::Relaxed)
    }

    /// Whether to stop a query that finds pairs, so that those found can still be measured in time.
    pub(super) fn stops_before_measuring(&self, found: usize) -> bool {
        if self.stops(found) {
            return true;
        }
        let measuring = MEASURING.saturating_mul(u32::try_from(found).unwrap_or(u32::MAX));
        self.deadline
            .is_some_and(|deadline| now().checked_add(measuring).is_none_or(|end| end >= deadline))
    }

    /// Until when to measure what was found, asked when the query itself has ended: a little after the deadline, or after now
    /// where that has passed.
    pub(super) fn measuring_until(&self) -> Option<Instant> {
        let deadline = self.deadline?.max(now());
        deadline.checked_add(MEASURED_LATE)
    }

    fn look(&self, py: Python<'_>) {
        if let Err(error) = py.check_signals() {
            *self
                .raised
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner) = Some(error);
            self.interrupted.store(true, Ordering::Relaxed);
        }
    }

    /// Runs a query without the interpreter's lock, on the pool if there is one. A signal ends it and is raised.
    pub(super) fn run<T: Send>(
        &self,
        py: Python<'_>,
        pool: Option<&ThreadPool>,
        query: impl FnOnce() -> Result<T, satisfice_collision::Error> + Send,
    ) -> PyResult<T> {
        let answer = match pool {
            None => py.detach(query),
            Some(pool) => std::thread::scope(|scope| {
                let working = scope.spawn(|| pool.install(query));
                while !working.is_finished() {
                    py.detach(|| std::thread::sleep(Duration::from_micros(200)));
                    self.stops(0);
                }
                working.join()
            })
            .map_err(|_| PyRuntimeError::new_err("a thread panicked"))?,
        };
        let raised = self
            .raised
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
            .take();
        match raised {
            Some(error) => Err(error),
            None => answer.map_err(refused),
        }
    }
}

/// A pool of so many threads, 0 for one per core; none for the calling thread alone.
pub(super) fn pool(threads: usize) -> PyResult<Option<ThreadPool>> {
    if threads == 1 {
        return Ok(None);
    }
    pool_of(threads).map(Some)
}

/// A pool of so many threads, 0 for one per core.
pub(super) fn pool_of(threads: usize) -> PyResult<ThreadPool> {
    let threads = checked_threads(threads)?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|error| refused(format!("cannot start {threads} threads: {error}")))
}

#[expect(
    clippy::disallowed_methods,
    reason = "the limit of a query on meshes, which is no budget of a search"
)]
fn now() -> Instant {
    Instant::now()
}
