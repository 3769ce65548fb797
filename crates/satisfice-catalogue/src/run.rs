//! One run: slices of a search on a problem that does not change, and their report.

use core::ops::ControlFlow;

use satisfice::{
    Archive, Checkpoint, Completeness, Counts, Identity, Observer, Real, Report, RunOptions,
    SatisficingProblem, Search, StopReason, TracePoint,
};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::checkpoint::{self, Saved, SavedRun};
use crate::control::{Progress, RunControl};
use crate::error::Error;
use crate::report::{Best, RunReport, Slice, Solution};
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
    P: SatisficingProblem,
    P::Solution: Serialize + DeserializeOwned,
{
    let spec = spec.complete()?;
    let reports = run_slices(problem, &spec, &mut control)?;
    // Threads do not change a report, and JSON does not keep them.
    write_up(problem, RunSpec { threads: 1, ..spec }, &reports)
}

fn run_slices<P>(
    problem: &P,
    spec: &RunSpec,
    control: &mut RunControl<'_>,
) -> Result<Vec<Report<P::Solution>>, Error>
where
    P: SatisficingProblem,
    P::Solution: Serialize + DeserializeOwned,
{
    let engine = spec.configured_engine()?;
    let (mut search, mut reports, mut unfinished);
    if let Some(bytes) = control.resume {
        checkpoint::check_same(&checkpoint::spec(bytes)?, spec)?;
        let saved: SavedRun<P::Solution> =
            serde_json::from_slice(bytes).map_err(|error| Error::Checkpoint(error.to_string()))?;
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
                match serde_json::to_vec(&saved) {
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
        reports.push(report?);
        unfinished = false;
    }
    failed.map_or(Ok(reports), |error| Err(error.into()))
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

/// The hits of all slices, each at the evaluation and time that found it first, counted from the start of the first slice;
/// the trace of that union; and each slice by itself.
fn unite<T: Identity + Clone>(reports: &[Report<T>]) -> (Archive<T>, Vec<TracePoint>, Vec<Slice>) {
    let (mut all, mut trace, mut slices) = (Archive::default(), Vec::new(), Vec::new());
    let (mut evaluations, mut seconds) = (0, 0.0);
    for report in reports {
        let before = all.len();
        for hit in report.hits() {
            all.insert(
                hit.solution.clone(),
                hit.fitness,
                evaluations + hit.evaluation,
                seconds + hit.seconds,
            );
        }
        trace.extend(report.trace.iter().map(|point| TracePoint {
            evaluations: evaluations + point.evaluations,
            elapsed_seconds: seconds + point.elapsed_seconds,
            hits: all.found_by(evaluations + point.evaluations) as u64,
        }));
        slices.push(Slice {
            counts: report.counts,
            elapsed_seconds: report.elapsed.as_secs_f64(),
            overshoot_seconds: report.overshoot.as_secs_f64(),
            stop_reason: report.stop_reason,
            hits: report.hit_count() as u64,
            new_hits: (all.len() - before) as u64,
            completeness: report.completeness,
        });
        evaluations += report.counts.evaluations;
        seconds += report.elapsed.as_secs_f64();
    }
    (all, trace, slices)
}

/// The least fitness of all slices, at its evaluation counted from the start of the first slice.
fn best<T: Serialize>(reports: &[Report<T>]) -> Result<Option<Best>, Error> {
    let (mut evaluations, mut least) = (0, None);
    for report in reports {
        if let Some(best) = report.best()
            && least.is_none_or(|(least, _): (&satisfice::Best<T>, u64)| best.fitness < least.fitness)
        {
            least = Some((best, evaluations + best.evaluation));
        }
        evaluations += report.counts.evaluations;
    }
    least
        .map(|(best, evaluation)| {
            Ok(Best {
                solution: serde_json::to_value(&best.solution)?,
                fitness: best.fitness,
                evaluation,
            })
        })
        .transpose()
}

fn sum(slices: &[Slice]) -> Counts {
    slices.iter().fold(Counts::default(), |mut sum, slice| {
        sum += slice.counts;
        sum
    })
}

fn write_up<P>(problem: &P, spec: RunSpec, reports: &[Report<P::Solution>]) -> Result<RunReport, Error>
where
    P: SatisficingProblem,
    P::Solution: Serialize,
{
    let (all, trace, slices) = unite(reports);
    let solutions = all
        .iter()
        .map(|hit| {
            Ok(Solution {
                solution: serde_json::to_value(hit.solution)?,
                fitness: hit.fitness,
                evaluation: hit.evaluation,
                seconds: hit.seconds,
            })
        })
        .collect::<Result<Vec<_>, Error>>()?;
    let threshold = problem.threshold().f64();
    let mut report = RunReport {
        scalar: P::Scalar::NAME.to_owned(),
        threshold: threshold.is_finite().then_some(threshold),
        counts: sum(&slices),
        elapsed_seconds: slices.iter().map(|slice| slice.elapsed_seconds).sum(),
        overshoot_seconds: slices.iter().map(|slice| slice.overshoot_seconds).sum(),
        hits: all.len() as u64,
        best: best(reports)?,
        trace,
        solutions,
        ..RunReport::new(spec)
    };
    if let Some(first) = reports.first() {
        report.probe_share = first.probe_share;
        report.version.clone_from(&first.version);
    }
    if let (Some(last), Some(slice)) = (reports.last(), slices.last()) {
        report.stop_reason = slice.stop_reason;
        // A slice that has covered the space is the last one.
        if slice.completeness == Completeness::Proved {
            report.completeness = Completeness::Proved;
        }
        report.set_unseen(last.unseen.as_ref(), report.hits - last.hit_count() as u64);
    }
    if report.spec.budget.slices > 1 {
        report.slices = slices;
    }
    Ok(report)
}
