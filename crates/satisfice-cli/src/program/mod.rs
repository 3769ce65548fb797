//! `satisfice run --program` and `--worker`: the fitness is computed by other processes.
//!
//! Each of them has a thread that gives it one point at a time. The search gives out points under tickets and takes the values
//! in any order.

pub(crate) mod arguments;
mod evaluator;
mod process;
mod shell;
mod space;
mod template;

use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::Ordering;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use anyhow::{Context, anyhow, bail};
use satisfice::problem::{FnProblem, evaluated_elsewhere};
use satisfice::{Cancel, Located, Report, RunReport, Search, StopReason, Ticket, Tickets};
use satisfice_catalogue::{RunSpec, json, small_batches};
use serde_json::Value;

use crate::arguments::{DEFAULT_ENGINE, DEFAULT_TIME, ProgramArguments, RunArguments};
use crate::output::{self, Steps};
use crate::places::Places;
use crate::{interrupt, message, summary};

use evaluator::{Evaluator, Failure, Task, Way};
use space::SpaceFile;
use template::{Template, split};

/// How often the search looks for Ctrl-C and for its time while it waits for values.
const LOOK_EVERY: Duration = Duration::from_millis(20);
/// So many failures are told one by one; the report counts all of them.
const TOLD: u64 = 3;
/// If so many evaluations fail and none succeeds, the program is at fault, not the points: a program that fails in nine of ten
/// points is given up once in a thousand times.
const HOPELESS: u64 = 64;

/// What a report names instead of a problem.
pub(crate) const PROBLEM: &str = "program";

/// A problem whose values come from elsewhere.
type Problem = FnProblem<f64, fn(&[f64]) -> f64>;

/// What became of a search.
struct Driven {
    report: Report<Located<f64>>,
    /// Evaluations in batches of the size that was asked for.
    full_batches: u64,
    failed: u64,
    /// Why the last evaluation failed, if none succeeded.
    no_success: Option<String>,
}

/// A point to evaluate.
struct Job {
    ticket: Ticket,
    point: Vec<f64>,
}

pub(crate) fn run(arguments: &RunArguments) -> anyhow::Result<ExitCode> {
    let given = &arguments.program;
    check(arguments)?;
    let commands = given.program.iter().chain(&given.worker);
    Places::default()
        .reads(given.space.clone())
        .may_read(commands.flat_map(|text| split(text).unwrap_or_default()))
        .writes("--json", arguments.json.as_ref())
        .check()?;
    let path = given.space.as_deref();
    let path = path.context("--space is missing: name a TOML file")?;
    let space = SpaceFile::read(path)?;
    let threshold = given
        .threshold
        .context("--threshold is missing: a hit is a point whose value is below it")?;
    let problem = problem(&space, threshold)?;
    let engine = arguments.engine.as_deref().unwrap_or(DEFAULT_ENGINE);
    let mut spec = arguments.search.spec(engine)?;
    arguments.slices.enter(&mut spec);
    let workers = usize::from(given.workers());
    if workers > 1 && !given.ordered {
        // The engine has to know how many answers it does not wait for.
        spec.budget.parallel = spec.budget.parallel.or(Some(workers));
    }
    let search = search(&spec)?;
    let way = enter(&mut spec, given, &space)?;
    let task = Arc::new(Task {
        way,
        space,
        timeout: given.timeout,
        retries: given.retries(),
        unwanted: false.into(),
    });
    let cancel = interrupt::listen()?;
    let mut json_file = output::open(arguments.json.as_ref())?;

    let budget = spec.slice_budget(&cancel);
    let order = if given.ordered {
        Tickets::ordered
    } else {
        Tickets::eager
    };
    let tickets = order(search, problem, &budget)?;
    let deadline = spec.budget.time.and_then(|time| process::now().checked_add(time));
    let Driven {
        report,
        full_batches,
        failed,
        no_success,
    } = with_workers(&task, workers, |jobs, values| {
        drive(tickets, workers, jobs, values, &cancel, deadline)
    })?;
    let few = report.counts.evaluations < u64::from(given.workers());
    if !arguments.search.is_limited() && report.stop_reason == StopReason::Time && few {
        // The program may need more time for one evaluation than there was for all.
        message::say(format_args!(
            "note: the search ended after {DEFAULT_TIME:?}, the limit where none is given: give --time or --evaluations"
        ));
    }
    if report.hit_count() > 1 && task.space.tells_all_apart() {
        message::say(format_args!(
            "note: {} gives no separation: answers that differ in the last digit count as different hits",
            path.display()
        ));
    }
    if given.ordered
        && let Some(remark) = small_batches(&spec, report.counts.evaluations, full_batches)
    {
        message::say(format_args!("note: {remark}"));
    }
    let mut report = RunReport::of_slices(spec, &[report], serde_json::to_value)?;
    report.slices.clear();
    report.set_failed(failed);
    let mut steps = Steps::default();
    if let Some(file) = &mut json_file {
        steps.step(
            json::to_vec(&report)
                .map_err(Into::into)
                .and_then(|json| file.write(&json)),
        );
    }
    if arguments.json.as_deref() != Some(Path::new("-")) {
        let show = |solution: &Value| task.space.described(solution);
        steps.step(output::print(summary::summary_with(&report, show).as_bytes()));
    }
    steps.outcome()?;
    if let Some(says) = no_success {
        bail!("all of the {failed} evaluations failed, the last one because {says}");
    }
    Ok(summary::exit_code(&report))
}

/// Refuses options that belong to problems of the catalogue.
fn check(arguments: &RunArguments) -> anyhow::Result<()> {
    for (option, is_given) in [
        ("--set", !arguments.set.is_empty()),
        ("--checkpoint", arguments.checkpoint.is_some()),
        ("--resume", arguments.resume.is_some()),
        ("--plot", arguments.plot.is_some()),
        ("--page", arguments.page.is_some()),
        ("--reference", arguments.search.reference),
        ("--threads", arguments.search.threads() != 1),
    ] {
        if is_given {
            bail!("{option} does not apply to a program: leave it out");
        }
    }
    Ok(())
}

fn problem(space: &SpaceFile, threshold: f64) -> anyhow::Result<Problem> {
    let problem = evaluated_elsewhere(space.space()?, threshold).named(PROBLEM);
    Ok(match space.radii()? {
        None => problem.separation(0.0),
        Some(radii) => problem.separations(&radii)?,
    })
}

/// A search by the engine of a complete specification.
fn search(spec: &RunSpec) -> anyhow::Result<Search<Problem>> {
    let mut search = Search::named(&spec.engine)?;
    for (name, text) in spec.engine_parameters.texts() {
        search = search.set(&name, &text)?;
    }
    search = search.seed(spec.seed).islands(spec.islands);
    Ok(match spec.probes {
        Some(share) => search.probes(share),
        None => search,
    })
}

/// Enters the problem in the specification, for the report.
fn enter(spec: &mut RunSpec, given: &ProgramArguments, space: &SpaceFile) -> anyhow::Result<Way> {
    if spec.budget.slices != 1 {
        bail!("--slices does not apply to a program: leave it out");
    }
    PROBLEM.clone_into(&mut spec.problem);
    let (way, name, text) = match (&given.program, &given.worker) {
        (Some(text), _) => (
            Way::Program(Template::new(text, given.shell, space)?),
            "program",
            text,
        ),
        (None, Some(text)) => {
            let words = if given.shell {
                vec!["/bin/sh".to_owned(), "-c".to_owned(), text.clone()]
            } else {
                split(text)?
            };
            if words.is_empty() {
                bail!("no worker is named: give a program that reads and writes lines of JSON");
            }
            (Way::Worker(words), "worker", text)
        }
        (None, None) => bail!("give --program or --worker"),
    };
    spec.problem_parameters.set(name, text.as_str());
    spec.problem_parameters
        .set("space", serde_json::to_string(space)?);
    Ok(way)
}

/// Lets `search` give out jobs to so many threads, and ends them.
fn with_workers<T>(
    task: &Arc<Task>,
    workers: usize,
    search: impl FnOnce(&Sender<Job>, &Receiver<(Ticket, Result<f64, Failure>)>) -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    let (jobs, queue) = channel::<Job>();
    let (answers, values) = channel();
    let queue = Mutex::new(queue);
    std::thread::scope(|scope| {
        for _ in 0..workers {
            let (task, queue, answers) = (Arc::clone(task), &queue, answers.clone());
            scope.spawn(move || {
                let mut evaluator = Evaluator::new(task);
                loop {
                    let next = queue.lock().unwrap_or_else(PoisonError::into_inner).recv();
                    let Ok(Job { ticket, point }) = next else { return };
                    let value = evaluator.evaluate(ticket.number(), &point);
                    if answers.send((ticket, value)).is_err() {
                        return;
                    }
                }
            });
        }
        let found = search(&jobs, &values);
        task.unwanted.store(true, Ordering::Relaxed);
        drop(jobs);
        found
    })
}

/// Runs the search to its end.
fn drive(
    mut tickets: Tickets<Problem>,
    workers: usize,
    jobs: &Sender<Job>,
    values: &Receiver<(Ticket, Result<f64, Failure>)>,
    cancel: &Cancel,
    deadline: Option<Instant>,
) -> anyhow::Result<Driven> {
    let (mut failed, mut succeeded, mut last_failure) = (0, 0_u64, None);
    loop {
        // Asked first: then the tickets know as well that the time is over, and why they end.
        let is_late = deadline.is_some_and(|deadline| process::now() >= deadline);
        let free = workers.saturating_sub(tickets.open());
        for job in tickets.ask(free) {
            let job = Job {
                ticket: job.ticket,
                point: job.solution.coordinates,
            };
            jobs.send(job)
                .map_err(|_| anyhow!("the threads of the workers have ended"))?;
        }
        if tickets.open() == 0 {
            break;
        }
        if is_late || cancel.is_cancelled() {
            break;
        }
        let (ticket, value) = match values.recv_timeout(LOOK_EVERY) {
            Ok(answer) => answer,
            Err(RecvTimeoutError::Timeout) => continue,
            Err(RecvTimeoutError::Disconnected) => bail!("the threads of the workers have ended"),
        };
        let value = match value {
            Ok(value) => {
                succeeded += 1;
                value
            }
            Err(Failure::Unwanted) => continue,
            Err(Failure::Fatal(says)) => bail!("{says}"),
            Err(Failure::Evaluation(says)) => {
                failed += 1;
                if failed <= TOLD {
                    message::say(format_args!("evaluation {} failed: {says}", ticket.number() + 1));
                }
                last_failure = Some(says);
                f64::NAN
            }
        };
        tickets.tell(ticket, value)?;
        if succeeded == 0 && failed >= HOPELESS {
            break;
        }
    }
    if failed > TOLD {
        message::say(format_args!(
            "{failed} evaluations failed in all; they count as NaN, and nothing is proved"
        ));
    }
    let (report, search) = tickets.finish_slice();
    let why = last_failure.filter(|_| succeeded == 0);
    Ok(Driven {
        full_batches: search.in_full_batches(),
        report,
        failed,
        no_success: why,
    })
}
