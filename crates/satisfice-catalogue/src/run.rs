//! One run: slices of a search on a problem that does not move, written up as a record.

use core::ops::ControlFlow;

use satisfice::{
    Archive, Budget, Checkpoint, Completeness, Counts, Identity, Islands, Observer, Real, Report,
    SatisficingProblem, Saving, Search, StopReason, TracePoint, engine,
};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::Error;
use crate::record::{Limits, Record, Slice, Solution};
use crate::resume::{Keeping, Saved, SavedRun};
use crate::settings::Settings;

/// What to run: engine, seed, threads, budget of a slice, slices.
#[derive(Debug, Clone)]
pub struct Request {
    /// Name of the engine.
    pub engine: String,
    /// Its parameters as `(name, text)`, the others at their defaults.
    pub engine_settings: Vec<(String, String)>,
    /// The seed.
    pub seed: u64,
    /// Threads that evaluate, 0 for as many as there are cores.
    pub threads: usize,
    /// Engines side by side that share their hits; 1 is a plain search.
    pub islands: usize,
    /// Share of the evaluations spent on uniform probes, by which unseen hits are estimated, from 0 to 0.5; `None` leaves it
    /// to the engine.
    pub probes: Option<f64>,
    /// What each slice may spend; its cancellation ends the whole run.
    pub budget: Budget,
    /// How many slices, each warm from the one before. Fewer are run once the space is covered, enough hits are found, or
    /// somebody cancels.
    pub slices: u64,
}

impl Request {
    /// One slice of an engine with its default parameters, seed 0, one thread.
    #[must_use]
    pub fn new(engine: &str, budget: Budget) -> Self {
        Self {
            engine: engine.to_owned(),
            engine_settings: Vec::new(),
            seed: 0,
            threads: 1,
            islands: 1,
            probes: None,
            budget,
            slices: 1,
        }
    }
    /// Another seed.
    #[must_use]
    pub fn seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }
    /// A parameter of the engine.
    #[must_use]
    pub fn set(mut self, name: &str, text: &str) -> Self {
        self.engine_settings.push((name.to_owned(), text.to_owned()));
        self
    }
}

/// How far a run is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// The slice that is running, from 0.
    pub slice: u64,
    /// Evaluations, time and hits of this slice.
    pub now: TracePoint,
    /// Used share of this slice's budget, in `[0, 1]`.
    pub share: f64,
}

/// Runs `request` on `problem` and writes it up; `watch` is told of progress about a hundred times a second at most. The
/// reference count is left open: [`Record::set_reference`].
///
/// # Errors
/// [`Error::Search`] for an unknown engine, a parameter out of range or a budget that is not usable, [`Error::NoSlices`],
/// [`Error::Json`] for a solution that is not representable.
pub fn search<P>(problem: &P, request: &Request, watch: &mut dyn FnMut(&Progress)) -> Result<Record, Error>
where
    P: SatisficingProblem,
    P::Solution: Serialize,
{
    if request.slices == 0 {
        return Err(Error::NoSlices);
    }
    let entry = engine::find(&request.engine)?;
    let settings = request
        .engine_settings
        .iter()
        .map(|(name, text)| (name.as_str(), text.as_str()));
    let build = || entry.configure(settings.clone());
    type Run<'a, T> = dyn FnMut(&mut Watcher<'_>) -> Result<Report<T>, satisfice::Error> + 'a;
    let mut run: Box<Run<'_, P::Solution>> = if request.islands > 1 {
        let mut islands = Islands::new(request.islands, build)?
            .seed(request.seed)
            .threads(request.threads);
        if let Some(share) = request.probes {
            islands = islands.probes(share);
        }
        Box::new(move |watcher| islands.run_observed(problem, &request.budget, watcher))
    } else {
        let mut search = Search::new(build()?).seed(request.seed).threads(request.threads);
        if let Some(share) = request.probes {
            search = search.probes(share);
        }
        Box::new(move |watcher| search.run_observed(problem, &request.budget, watcher))
    };
    let mut reports = Vec::new();
    while goes_on(&reports, request) {
        let slice = reports.len() as u64;
        reports.push(run(&mut Watcher { slice, watch })?);
    }
    let (all, trace, slices) = unite(&reports);
    write_up(
        problem,
        request,
        entry.parameters(),
        &reports,
        &all,
        trace,
        slices,
    )
}

/// The same while checkpoints of what was `asked` are kept, or from one on.
pub(crate) fn search_keeping<P>(
    problem: &P,
    request: &Request,
    watch: &mut dyn FnMut(&Progress),
    asked: Saved,
    keeping: Keeping<'_>,
) -> Result<Record, Error>
where
    P: SatisficingProblem,
    P::Solution: Serialize + DeserializeOwned,
{
    if request.slices == 0 {
        return Err(Error::NoSlices);
    }
    let entry = engine::find(&request.engine)?;
    let settings = request
        .engine_settings
        .iter()
        .map(|(name, text)| (name.as_str(), text.as_str()));
    let engine = entry.configure(settings)?;
    let (mut search, mut reports, mut unfinished);
    if let Some(bytes) = keeping.resume {
        Saved::read(bytes)?.agrees(&asked)?;
        let saved: SavedRun<P::Solution> =
            serde_json::from_slice(bytes).map_err(|error| Error::Checkpoint(error.to_string()))?;
        unfinished = saved.search.slice.is_some();
        search = Search::resume(saved.search, engine)?;
        reports = saved.reports;
    } else {
        search = Search::new(engine).seed(request.seed);
        if let Some(share) = request.probes {
            search = search.probes(share);
        }
        (reports, unfinished) = (Vec::new(), false);
    }
    search = search.threads(request.threads);
    let (mut save, mut failed) = (keeping.save, None);
    let mut saved = SavedRun {
        asked,
        reports: Vec::new(),
        search: search.checkpoint(),
    };
    while unfinished || goes_on(&reports, request) {
        let slice = reports.len() as u64;
        let mut watcher = Watcher { slice, watch };
        saved.reports.clone_from(&reports);
        let mut write = |checkpoint: &Checkpoint<P::Solution>| {
            saved.search = checkpoint.clone();
            match serde_json::to_vec(&saved) {
                Ok(bytes) => save.iter_mut().for_each(|save| save(&bytes)),
                Err(error) => failed = Some(error),
            }
        };
        let saving = Saving::every(keeping.every, &mut write);
        let report = if unfinished {
            search.run_resumed(
                problem,
                request.budget.cancel.as_ref(),
                &mut watcher,
                Some(saving),
            )
        } else {
            search.run_saving(problem, &request.budget, &mut watcher, saving)
        };
        reports.push(report?);
        unfinished = false;
    }
    if let Some(error) = failed {
        return Err(error.into());
    }
    let (all, trace, slices) = unite(&reports);
    write_up(
        problem,
        request,
        entry.parameters(),
        &reports,
        &all,
        trace,
        slices,
    )
}

/// Whether there is another slice to run.
fn goes_on<T>(reports: &[Report<T>], request: &Request) -> bool {
    let over = reports.last().is_some_and(|report| {
        matches!(
            report.stop_reason,
            StopReason::Cancelled | StopReason::Covered | StopReason::Hits
        )
    });
    !over && (reports.len() as u64) < request.slices
}

/// Passes progress on, without the type of the solutions.
struct Watcher<'a> {
    slice: u64,
    watch: &'a mut dyn FnMut(&Progress),
}

impl<T> Observer<T> for Watcher<'_> {
    fn progress(&mut self, now: TracePoint, share: f64) -> ControlFlow<()> {
        (self.watch)(&Progress {
            slice: self.slice,
            now,
            share,
        });
        ControlFlow::Continue(())
    }
}

/// The hits of all slices, each at the evaluation and time that found it first, counted from the beginning of the first
/// slice; the trace of that union; what each slice did.
fn unite<T: Identity + Clone>(reports: &[Report<T>]) -> (Archive<T>, Vec<TracePoint>, Vec<Slice>) {
    let (mut all, mut trace, mut slices) = (Archive::default(), Vec::new(), Vec::new());
    let (mut evaluations, mut seconds) = (0, 0.0);
    for report in reports {
        let before = all.len();
        for hit in report.hits() {
            all.insert(
                hit.solution.clone(),
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

fn sum(slices: &[Slice]) -> Counts {
    slices.iter().fold(Counts::default(), |mut sum, slice| {
        sum += slice.counts;
        sum
    })
}

fn write_up<P>(
    problem: &P,
    request: &Request,
    table: &[satisfice::catalogue::Parameter],
    reports: &[Report<P::Solution>],
    all: &Archive<P::Solution>,
    trace: Vec<TracePoint>,
    slices: Vec<Slice>,
) -> Result<Record, Error>
where
    P: SatisficingProblem,
    P::Solution: Serialize,
{
    let solutions = all
        .iter()
        .map(|hit| {
            Ok(Solution {
                solution: serde_json::to_value(hit.solution)?,
                fitness: problem.fitness(hit.solution).f64(),
                evaluation: hit.evaluation,
                seconds: hit.seconds,
            })
        })
        .collect::<Result<Vec<_>, Error>>()?;
    let proved = slices
        .last()
        .is_some_and(|slice| slice.completeness == Completeness::Proved);
    let description = problem.description();
    let threshold = problem.threshold().f64();
    let mut record = Record {
        problem: description.name,
        problem_parameters: Settings::typed(&description.parameters, &[]),
        engine: request.engine.clone(),
        engine_parameters: reports
            .first()
            .map(|report| Settings::typed(&report.engine.parameters, table))
            .unwrap_or_default(),
        scalar: P::Scalar::NAME.to_owned(),
        threshold: threshold.is_finite().then_some(threshold),
        seed: request.seed,
        budget: Limits {
            time_seconds: request.budget.time.map(|time| time.as_secs_f64()),
            evaluations: request.budget.evaluations,
            hits: request.budget.hits,
            slices: request.slices,
        },
        probe_share: reports.first().map_or(0.0, |report| report.probe_share),
        counts: sum(&slices),
        elapsed_seconds: slices.iter().map(|slice| slice.elapsed_seconds).sum(),
        overshoot_seconds: slices.iter().map(|slice| slice.overshoot_seconds).sum(),
        stop_reason: slices
            .last()
            .map_or(StopReason::Exhausted, |slice| slice.stop_reason),
        hits: all.len() as u64,
        reference_hits: None,
        recall: None,
        completeness: if proved {
            Completeness::Proved
        } else {
            Completeness::Unknown
        },
        unseen_estimate: None,
        unseen_interval: None,
        unseen_confidence: None,
        unseen_method: None,
        trace,
        slices: if request.slices > 1 { slices } else { Vec::new() },
        solutions,
        version: reports
            .first()
            .map(|report| report.version.clone())
            .unwrap_or_default(),
    };
    // A slice that has covered the space is the last one.
    if let Some(last) = reports.last() {
        record.set_unseen(last.unseen.as_ref(), record.hits - last.hit_count() as u64);
    }
    Ok(record)
}
