//! Runs what is missing of a plan: runs with an evaluation budget side by side, runs with a clock one at a time.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use satisfice::{Cancel, StopReason};

use super::plan::{Plan, Planned};
use super::results::{Known, Results};
use super::row::Row;
use crate::error::Error;
use satisfice_catalogue::Instance;
use satisfice_catalogue::exact;

/// How often a count that takes long looks whether it is still wanted.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// What happens in a sweep.
#[derive(Debug)]
pub enum Event<'a> {
    /// It begins: so many runs, so many of them done earlier.
    Begun {
        /// All runs.
        runs: usize,
        /// Those that the folder has already.
        done: usize,
    },
    /// All hits of a problem are being counted, outside any clock.
    Counting(&'a str),
    /// A run has ended and is in the file.
    Finished(&'a Row),
}

/// What is left when a sweep ends.
#[derive(Debug)]
pub struct Finished {
    /// The runs of the plan, in its order; those that are missing were cancelled.
    pub rows: Vec<Row>,
    /// How many runs there should be.
    pub runs: usize,
    /// Rows of the file that are none of the plan's.
    pub foreign: usize,
}

/// Runs every run of `plan` that `folder/results.jsonl` has not, on `jobs` threads (0: as many as there are cores) where
/// no clock limits a run; then those that a clock limits, one at a time while nothing else of the program runs. Reference
/// counts come first. Once `cancel` is cancelled, runs that have not ended are dropped; those that have are kept.
///
/// # Errors
/// [`Error::File`] for a file that cannot be read or written; whatever [`Instance::run`] says.
pub fn execute(
    plan: &Plan,
    folder: &Path,
    jobs: usize,
    cancel: &Cancel,
    watch: &mut dyn FnMut(&Event<'_>),
) -> Result<Finished, Error> {
    let (mut results, old) = Results::open(folder)?;
    let known = Known::of(&old);
    let missing: Vec<&Planned> = plan.runs.iter().filter(|run| !known.contains(&run.key)).collect();
    watch(&Event::Begun {
        runs: plan.runs.len(),
        done: plan.runs.len() - missing.len(),
    });
    let references = count(plan, &missing, cancel, watch)?;
    let jobs = if jobs == 0 {
        thread::available_parallelism().map_or(1, usize::from)
    } else {
        jobs
    };
    let (timed, counted): (Vec<&Planned>, Vec<&Planned>) =
        missing.into_iter().partition(|run| run.is_timed());
    let mut new = Vec::new();
    let side = Side {
        plan,
        references: &references,
        cancel,
    };
    side.run_all(&counted, jobs, &mut results, watch, &mut new)?;
    side.run_all(&timed, 1, &mut results, watch, &mut new)?;
    let mut by_key: BTreeMap<String, Row> = old
        .into_iter()
        .chain(new)
        .map(|row| (row.key.text(), row))
        .collect();
    let rows: Vec<Row> = plan
        .runs
        .iter()
        .filter_map(|run| by_key.remove(&run.key.text()))
        .collect();
    Ok(Finished {
        rows,
        runs: plan.runs.len(),
        foreign: by_key.len(),
    })
}

/// How many hits each instance has that is still to be run; `None` for the others.
fn count(
    plan: &Plan,
    missing: &[&Planned],
    cancel: &Cancel,
    watch: &mut dyn FnMut(&Event<'_>),
) -> Result<Vec<Option<u64>>, Error> {
    let mut references = vec![None; plan.instances.len()];
    for (place, instance) in plan.instances.iter().enumerate() {
        let Some(run) = missing.iter().find(|run| run.instance == place) else {
            continue;
        };
        watch(&Event::Counting(&run.problem_label));
        let (sender, receiver) = mpsc::channel();
        let counted = Arc::clone(instance);
        let spawned = thread::Builder::new()
            .name("reference".to_owned())
            .spawn(move || {
                // Nobody listens any more where the sweep was cancelled.
                let _ = sender.send(counted.reference_hits());
            });
        spawned.map_err(|error| Error::Suite {
            place: run.problem_label.clone(),
            what: format!("no thread to count its hits on: {error}"),
        })?;
        references[place] = loop {
            match receiver.recv_timeout(LOOK_EVERY) {
                Ok(count) => break count,
                Err(RecvTimeoutError::Timeout) if !cancel.is_cancelled() => {}
                Err(_) => break None,
            }
        };
    }
    Ok(references)
}

struct Side<'a> {
    plan: &'a Plan,
    references: &'a [Option<u64>],
    cancel: &'a Cancel,
}

impl Side<'_> {
    fn run_all(
        &self,
        runs: &[&Planned],
        jobs: usize,
        results: &mut Results,
        watch: &mut dyn FnMut(&Event<'_>),
        rows: &mut Vec<Row>,
    ) -> Result<(), Error> {
        let next = AtomicUsize::new(0);
        let failed: Mutex<Option<Error>> = Mutex::new(None);
        let fail = |error: Error| {
            failed
                .lock()
                .unwrap_or_else(std::sync::PoisonError::into_inner)
                .get_or_insert(error);
            // Whoever still runs may stop.
            next.store(usize::MAX / 2, Ordering::Relaxed);
        };
        let work = |sender: &mpsc::Sender<Row>| {
            while let Some(run) = runs.get(next.fetch_add(1, Ordering::Relaxed)) {
                if self.cancel.is_cancelled() {
                    return;
                }
                match self.run(run, jobs == 1) {
                    Ok(Some(row)) => drop(sender.send(row)),
                    Ok(None) => return,
                    Err(error) => return fail(error),
                }
            }
        };
        thread::scope(|scope| {
            let (sender, receiver) = mpsc::channel();
            for _ in 0..jobs.min(runs.len()) {
                let (sender, work) = (sender.clone(), &work);
                scope.spawn(move || work(&sender));
            }
            drop(sender);
            for row in receiver {
                if let Err(error) = results.append(&row) {
                    fail(error);
                }
                watch(&Event::Finished(&row));
                rows.push(row);
            }
        });
        failed
            .into_inner()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
            .map_or(Ok(()), Err)
    }

    /// A row, or nothing where the run was cancelled.
    fn run(&self, run: &Planned, alone: bool) -> Result<Option<Row>, Error> {
        let instance: &dyn Instance = &*self.plan.instances[run.instance];
        let mut request = run.request.clone();
        request.budget = request.budget.and_until(self.cancel);
        let mut record = match exact::find(&request.engine) {
            Some(_) => instance.exact(&request)?,
            None => instance.run(&request, &mut |_| {})?,
        };
        if record.stop_reason == StopReason::Cancelled {
            return Ok(None);
        }
        record.set_reference(self.references[run.instance]);
        Ok(Some(Row::new(run, &record, alone)))
    }
}
