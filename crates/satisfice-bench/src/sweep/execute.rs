//! Runs what is missing of a plan: runs with an evaluation budget side by side, runs with a clock one at a time.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use satisfice::{Cancel, StopReason};
use satisfice_catalogue::RunControl;

use super::plan::{Cell, Plan, Planned};
use super::results::Results;
use super::row::Row;
use super::shard::Shard;
use crate::error::Error;

/// How often a long count checks whether it is still wanted.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// An event of a sweep.
#[derive(Debug)]
pub enum Event<'a> {
    /// It begins.
    Begun {
        /// The number of all runs.
        runs: u64,
        /// The number of those that the folder already has.
        done: u64,
    },
    /// All hits of a problem are being counted, outside any clock.
    Counting(&'a str),
    /// A run has ended and is in the file.
    Finished(&'a Row),
}

/// The outcome of a sweep.
#[derive(Debug)]
pub struct Finished {
    /// The runs of the plan, in its order; those that are missing were cancelled.
    pub rows: Vec<Row>,
    /// The number of all runs.
    pub runs: u64,
    /// The number of rows in the file that do not belong to the plan.
    pub foreign: usize,
}

impl Finished {
    /// The number of runs that are missing.
    #[must_use]
    pub fn missing(&self) -> u64 {
        self.runs - self.rows.len() as u64
    }
}

/// Runs every run of `plan` that `folder/results.jsonl` lacks, on `jobs` threads (0: one per core) where no clock limits a
/// run; then those that a clock limits, one at a time while nothing else of the program runs. Reference counts come first.
/// Once `cancel` is cancelled, runs that have not ended are dropped; those that have are kept. With a shard, only its runs count.
///
/// Memory: O(finished runs).
///
/// # Errors
/// [`Error::File`] for a file that cannot be read or written; any error of
/// [`Instance::run`](satisfice_catalogue::Instance::run).
pub fn execute(
    plan: &Plan,
    folder: &Path,
    jobs: usize,
    shard: Option<Shard>,
    cancel: &Cancel,
    watch: &mut dyn FnMut(&Event<'_>),
) -> Result<Finished, Error> {
    let is_wanted = |run: &Planned<'_>| shard.is_none_or(|shard| shard.has(run));
    let runs = plan.runs().filter(is_wanted).count() as u64;
    let (results, old) = Results::open(folder)?;
    let mut known: BTreeMap<u64, Row> = BTreeMap::new();
    let mut foreign = 0;
    for row in old {
        match plan.find(&row).filter(is_wanted).map(|run| run.number()) {
            Some(number) => drop(known.insert(number, row)),
            None => foreign += 1,
        }
    }
    watch(&Event::Begun {
        runs,
        done: known.len() as u64,
    });
    let references = count(plan, &known, shard, cancel, watch)?;
    let jobs = match jobs {
        0 => thread::available_parallelism().map_or(1, usize::from),
        jobs => jobs,
    };
    let mut sweep = Sweep {
        plan,
        shard,
        references,
        cancel,
        results,
        known,
    };
    sweep.run_all(false, jobs, watch)?;
    sweep.run_all(true, 1, watch)?;
    let mut known = sweep.known;
    let rows = plan.runs().filter_map(|run| known.remove(&run.number()));
    Ok(Finished {
        rows: rows.collect(),
        runs,
        foreign,
    })
}

/// The number of hits of each problem that is still to be run; `None` for the others.
fn count(
    plan: &Plan,
    known: &BTreeMap<u64, Row>,
    shard: Option<Shard>,
    cancel: &Cancel,
    watch: &mut dyn FnMut(&Event<'_>),
) -> Result<Vec<Option<u64>>, Error> {
    let mut references = vec![None; plan.instances.len()];
    let is_missing = |cell: &Cell| {
        let mut runs = cell.seeds.clone().map(|seed| Planned { cell, seed });
        runs.any(|run| shard.is_none_or(|shard| shard.has(&run)) && !known.contains_key(&run.number()))
    };
    for (place, instance) in plan.instances.iter().enumerate() {
        let mut cells = plan.cells.iter().filter(|cell| cell.instance == place);
        let Some(cell) = cells.find(|cell| is_missing(cell)) else {
            continue;
        };
        watch(&Event::Counting(&cell.problem_label));
        let (sender, receiver) = mpsc::channel();
        let counted = Arc::clone(instance);
        let spawned = thread::Builder::new()
            .name("reference".to_owned())
            .spawn(move || {
                // Fails where the sweep was cancelled meanwhile.
                let _ = sender.send(counted.reference_hits());
            });
        spawned.map_err(|error| Error::Suite {
            place: cell.problem_label.clone(),
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

struct Sweep<'a> {
    plan: &'a Plan,
    shard: Option<Shard>,
    references: Vec<Option<u64>>,
    cancel: &'a Cancel,
    results: Results,
    known: BTreeMap<u64, Row>,
}

impl Sweep<'_> {
    /// Runs all that is missing and is, or is not, limited by a clock.
    fn run_all(&mut self, timed: bool, jobs: usize, watch: &mut dyn FnMut(&Event<'_>)) -> Result<(), Error> {
        let Self {
            plan,
            shard,
            references,
            cancel,
            results,
            known,
        } = self;
        let done: &BTreeMap<u64, Row> = known;
        let missing = plan
            .runs()
            .filter(|run| shard.is_none_or(|shard| shard.has(run)))
            .filter(|run| run.cell.is_timed() == timed && !done.contains_key(&run.number()));
        let missing = Mutex::new(missing.fuse());
        let failed: Mutex<Option<Error>> = Mutex::new(None);
        let lock = || failed.lock().unwrap_or_else(PoisonError::into_inner);
        let next = || match (cancel.is_cancelled(), lock().is_some()) {
            (false, false) => missing.lock().unwrap_or_else(PoisonError::into_inner).next(),
            _ => None,
        };
        let work = |sender: &mpsc::Sender<(u64, Row)>| {
            while let Some(planned) = next() {
                match run(plan, planned, references, cancel, jobs == 1) {
                    Ok(Some(row)) => drop(sender.send((planned.number(), row))),
                    Ok(None) => return,
                    Err(error) => {
                        lock().get_or_insert(error);
                        return;
                    }
                }
            }
        };
        let mut new = Vec::new();
        thread::scope(|scope| {
            let (sender, receiver) = mpsc::channel();
            for _ in 0..jobs {
                let (sender, work) = (sender.clone(), &work);
                scope.spawn(move || work(&sender));
            }
            drop(sender);
            for (number, row) in receiver {
                if let Err(error) = results.append(&row) {
                    lock().get_or_insert(error);
                }
                watch(&Event::Finished(&row));
                new.push((number, row));
            }
        });
        drop(missing);
        let failed = failed.into_inner().unwrap_or_else(PoisonError::into_inner);
        known.extend(new);
        failed.map_or(Ok(()), Err)
    }
}

/// The row of a run, or nothing where it was cancelled.
fn run(
    plan: &Plan,
    planned: Planned<'_>,
    references: &[Option<u64>],
    cancel: &Cancel,
    alone: bool,
) -> Result<Option<Row>, Error> {
    let instance = planned.cell.instance;
    let mut report = plan.instances[instance].run(&planned.spec(), RunControl::until(cancel))?;
    if report.stop_reason == StopReason::Cancelled {
        return Ok(None);
    }
    report.set_reference(references[instance]);
    Ok(Some(Row::new(plan, planned, report, alone)))
}
