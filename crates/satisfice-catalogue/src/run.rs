//! One run: slices of a search on a problem that does not change, and their report.

use core::ops::ControlFlow;
use core::time::Duration;
use std::time::Instant;

use satisfice::{
    Checkpoint, Identity, Observer, Report, RunOptions, SatisficingProblem, Search, StopReason, TracePoint,
};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::checkpoint::{self, Saved, SavedRun};
use crate::control::{Progress, RunControl, Save};
use crate::error::Error;
use crate::remarks::{idle_threads, small_batches};
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
    let (mut calls, mut shared, mut full) = (0, 0, 0);
    let mut pace = Pace::new(control.every);
    let mut left_out = None;
    while unfinished || goes_on(&reports, spec) {
        let every = control.every;
        let mut save = control.save.take();
        let mut watcher = Watcher::new(&reports, control);
        let report = if save.is_none() && !unfinished {
            search.run_with(problem, &budget, RunOptions::new().observer(&mut watcher))
        } else {
            let mut keep = |state: &Checkpoint<P::Solution>| {
                let Some(save) = save.as_deref_mut() else { return };
                let is_last = reports.len() as u64 + 1 >= spec.budget.slices || cancel.is_cancelled();
                if !is_last && !pace.is_due() {
                    left_out = Some(state.clone());
                    return;
                }
                left_out = None;
                pace.time(|| failed = write(spec, &reports, state, save).err().or(failed.take()));
            };
            let options = RunOptions::new()
                .observer(&mut watcher)
                .checkpoints(every, &mut keep);
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
        full += search.in_full_batches();
        reports.push(report);
        unfinished = false;
    }
    // A slice that nothing was saved of was the last one after all.
    if let (Some(state), Some(save), [before @ .., _]) = (left_out, control.save.as_deref_mut(), &reports[..])
    {
        failed = write(spec, before, &state, save).err().or(failed);
    }
    if let Some(remark) = &mut control.remark {
        let evaluations = reports.iter().map(|report| report.counts.evaluations).sum();
        // Of a resumed run, the larger part may have been before.
        let batches = small_batches(spec, evaluations, full).filter(|_| control.resume.is_none());
        let remarks = [idle_threads(spec, calls, shared), batches];
        remarks.iter().flatten().for_each(|text| remark(text));
    }
    failed.map_or(Ok(reports), |error| Err(error.into()))
}

fn write<T: Serialize + DeserializeOwned + Identity>(
    spec: &RunSpec,
    reports: &[Report<T>],
    search: &Checkpoint<T>,
    save: &mut Save<'_>,
) -> serde_json::Result<()> {
    let saved = Saved {
        spec,
        reports,
        search,
    };
    checkpoint::write(&saved).map(|bytes| save(&bytes))
}

/// When short slices are saved: each of them has a beginning and an end.
struct Pace {
    /// The least time between two checkpoints of different slices.
    least: Duration,
    /// When the next one is due, once there is one.
    next: Option<Instant>,
}

impl Pace {
    fn new(every: Duration) -> Self {
        Self {
            // Half of what the search keeps to within a slice.
            least: every.min(Duration::from_secs(1)) / 2,
            next: None,
        }
    }

    fn is_due(&self) -> bool {
        self.next.is_none_or(|next| now() >= next)
    }

    /// Saves; the next time comes after nine times as long.
    fn time(&mut self, save: impl FnOnce()) {
        let begun = now();
        save();
        let end = now();
        self.next = end.checked_add(self.least.max(9 * (end - begun)));
    }
}

#[expect(
    clippy::disallowed_methods,
    reason = "the time of a checkpoint changes no result"
)]
fn now() -> Instant {
    Instant::now()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::catalogue;

    fn times_of_slices_aside(report: &RunReport) -> (u64, Vec<u64>, StopReason) {
        let slices = report.slices.iter().map(|slice| slice.hits).collect();
        (report.hits, slices, report.stop_reason)
    }

    /// Each slice was saved twice: 200 short ones took 5 s instead of .2 s.
    #[test]
    fn short_slices_are_not_all_saved_but_the_last_one_is() {
        let problem = catalogue::find("queens").unwrap().build([("n", "6")]).unwrap();
        for (hits, least_slices) in [(None, 200), (Some(2), 2)] {
            let mut spec = RunSpec::new("random").evaluations(200).seed(3);
            spec.budget.slices = 200;
            spec.budget.hits = hits;
            let (mut saves, mut last) = (0, Vec::new());
            let mut save = |bytes: &[u8]| {
                saves += 1;
                last = bytes.to_vec();
            };
            let control = RunControl {
                save: Some(&mut save),
                every: Duration::from_secs(5),
                ..RunControl::default()
            };
            let report = problem.run(&spec, control).unwrap();
            assert!(report.slices.len() >= least_slices, "{}", report.slices.len());
            assert!((2..100).contains(&saves), "{saves}");
            let control = RunControl {
                resume: Some(&last),
                ..RunControl::default()
            };
            let resumed = problem.run(&spec, control).unwrap();
            assert_eq!(times_of_slices_aside(&resumed), times_of_slices_aside(&report));
        }
    }
}
