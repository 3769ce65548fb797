//! One run: slices of a search on a problem that does not change, and their report.

use core::ops::ControlFlow;

use satisfice::{
    Checkpoint, Observer, Report, RunOptions, SatisficingProblem, Search, StopReason, TracePoint,
};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::checkpoint::{self, Saved, SavedRun};
use crate::control::{Progress, RunControl};
use crate::error::Error;
use crate::report::RunReport;
use crate::spec::RunSpec;

/// Runs `spec` on `problem`, whatever problem `spec` names; for problems with a name see
/// [`Instance::run`](crate::Instance::run). The reference count is left open: [`RunReport::set_reference`].
///
/// # Errors
/// [`Error::Search`] for an unknown engine, a parameter out of range or a budget that cannot be used; [`Error::NoSlices`];
/// [`Error::Json`] for a solution that JSON cannot represent; [`Error::Checkpoint`] and [`Error::Differs`] for
/// checkpoints.
pub fn run<P>(problem: &P, spec: RunSpec, mut control: RunControl<'_>) -> Result<RunReport, Error>
where
    P: SatisficingProblem + ?Sized,
    P::Solution: Serialize + DeserializeOwned,
{
    let spec = spec.complete()?;
    let reports = run_slices(problem, &spec, &mut control)?;
    // Threads do not change a report, and JSON does not keep them.
    let spec = RunSpec { threads: 1, ..spec };
    let mut report = RunReport::of_slices(spec, &reports, serde_json::to_value)?;
    if report.spec.budget.slices == 1 {
        report.slices.clear();
    }
    Ok(report)
}

fn run_slices<P>(
    problem: &P,
    spec: &RunSpec,
    control: &mut RunControl<'_>,
) -> Result<Vec<Report<P::Solution>>, Error>
where
    P: SatisficingProblem + ?Sized,
    P::Solution: Serialize + DeserializeOwned,
{
    let engine = spec.configured_engine()?;
    let (mut search, mut reports, mut unfinished);
    if let Some(bytes) = control.resume {
        checkpoint::check_same(&checkpoint::spec(bytes)?, spec)?;
        let saved: SavedRun<P::Solution> = checkpoint::read(bytes)?;
        unfinished = saved.search.contents.unfinished.is_some();
        search = Search::resume(saved.search, engine)?;
        reports = saved.reports;
    } else {
        search = Search::with(engine).seed(spec.seed).islands(spec.islands);
        if let Some(share) = spec.probes {
            search = search.probes(share);
        }
        (reports, unfinished) = (Vec::new(), false);
    }
    search = search.threads(spec.threads);
    let cancel = control.cancel.clone();
    let budget = spec.slice_budget(&cancel);
    let mut failed = None;
    let (mut calls, mut shared) = (0, 0);
    while unfinished || goes_on(&reports, spec) {
        let every = control.every;
        let mut save = control.save.take();
        let mut watcher = Watcher::new(&reports, control);
        let report = if save.is_none() && !unfinished {
            search.run_with(problem, &budget, RunOptions::new().observer(&mut watcher))
        } else {
            let mut write = |state: &Checkpoint<P::Solution>| {
                let Some(save) = save.as_deref_mut() else { return };
                let saved = Saved {
                    spec,
                    reports: &reports,
                    search: state,
                };
                match checkpoint::write(&saved) {
                    Ok(bytes) => save(&bytes),
                    Err(error) => failed = Some(error),
                }
            };
            let options = RunOptions::new()
                .observer(&mut watcher)
                .checkpoints(every, &mut write);
            if unfinished {
                search.run_resumed(problem, options.cancel(&cancel))
            } else {
                search.run_with(problem, &budget, options)
            }
        };
        control.save = save;
        let report = report?;
        calls += report.counts.fitness_calls;
        shared += search.shared_calls();
        reports.push(report);
        unfinished = false;
    }
    if let (Some(remark), Some(text)) = (&mut control.remark, idle_threads(spec, calls, shared)) {
        remark(&text);
    }
    failed.map_or(Ok(reports), |error| Err(error.into()))
}

/// The note for runs in which several threads had little to share.
fn idle_threads(spec: &RunSpec, calls: u64, shared: u64) -> Option<String> {
    let idle = spec.threads != 1 && spec.islands == 1 && calls > 0 && shared < calls / 2;
    idle.then(|| {
        format!(
            "threads shared {shared} of {calls} calls of the fitness: the batches of {} are too small for them, or the fitness \
             is too cheap; islands run several engines side by side",
            spec.engine
        )
    })
}

/// Whether there is another slice to run.
fn goes_on<T>(reports: &[Report<T>], spec: &RunSpec) -> bool {
    let over = reports.last().is_some_and(|report| {
        matches!(
            report.stop_reason,
            StopReason::Cancelled | StopReason::Covered | StopReason::Hits
        )
    });
    !over && (reports.len() as u64) < spec.budget.slices
}

/// Passes progress on, without the type of the solutions.
struct Watcher<'a, 'b> {
    slice: u64,
    watch: Option<&'a mut (dyn FnMut(&Progress) + 'b)>,
}

impl<'a, 'b> Watcher<'a, 'b> {
    fn new<T>(reports: &[Report<T>], control: &'a mut RunControl<'b>) -> Self {
        Self {
            slice: reports.len() as u64,
            watch: control.watch.as_deref_mut(),
        }
    }
}

impl<T> Observer<T> for Watcher<'_, '_> {
    fn progress(&mut self, now: TracePoint, share: f64) -> ControlFlow<()> {
        if let Some(watch) = &mut self.watch {
            watch(&Progress {
                slice: self.slice,
                now,
                share,
            });
        }
        ControlFlow::Continue(())
    }
}
