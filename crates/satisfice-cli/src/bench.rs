//! `satisfice bench`: a sweep, from its suite to its report.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use satisfice::Cancel;
use satisfice_bench::studies;
use satisfice_bench::sweep::{self, Event, Plan, Row, Selection, ShardOf, Suite};
use satisfice_catalogue::Catalogue;
use satisfice_catalogue::quantity::shown;

use crate::arguments::{BenchArguments, BenchSubcommands, MergeArguments};
use crate::places::Places;
use crate::progress::{Counting, Runs};
use crate::{interrupt, message, output};

pub(crate) fn bench(
    arguments: &BenchArguments,
    catalogue: &Catalogue,
    given: &[OsString],
) -> anyhow::Result<ExitCode> {
    if let Some(BenchSubcommands::Merge(arguments)) = &arguments.merge {
        return merge(arguments, catalogue, given);
    }
    let suite = Suite::open(arguments.suite.as_deref().unwrap_or_default())?;
    let selection = Selection {
        seeds: arguments.seeds.clone(),
        engines: arguments.engines.clone(),
        problems: arguments.problems.clone(),
        budgets: arguments.budgets.clone(),
    };
    let part = arguments
        .shard
        .map(|shard| ShardOf::new(shard, &suite, &selection));
    let suite = selection.apply(suite)?;
    let folder = arguments.out.clone().unwrap_or_else(|| {
        let shard = arguments
            .shard
            .map(|shard| format!("-{}", shard.to_string().replace('/', "-of-")));
        PathBuf::from(format!("bench-{}{}", suite.name, shard.unwrap_or_default()))
    });
    let plan = Plan::new(suite, catalogue)?;
    let read = plan.instances.iter().flat_map(|problem| problem.files());
    let written = sweep::replaced(&folder);
    let places = Places::default().may_read(arguments.suite.clone()).reads(read);
    let writes = |places: Places, path| places.writes("--out", Some(path));
    written.iter().fold(places, writes).check()?;
    if let Some(part) = &part {
        part.claim(&folder)?;
    }
    let cancel = interrupt::listen()?;

    let mut runs = None;
    let mut watch = |event: &Event<'_>| match event {
        Event::Begun { runs: all, done } => {
            #[expect(clippy::cast_precision_loss, reason = "an estimate")]
            let share = arguments.shard.map_or(1.0, |shard| 1.0 / shard.count() as f64);
            let timed = plan.timed_seconds() * share;
            let clock = if timed > 0.0 {
                format!(", {} of them by the clock", shown::seconds(timed))
            } else {
                String::new()
            };
            message::say(format_args!(
                "{all} runs{clock}; {done} of them are in {} already",
                folder.display()
            ));
            runs = Some(Runs::new(*all, *done));
        }
        Event::Counting(problem) => runs
            .iter()
            .for_each(|runs| runs.say(&format!("counting all hits of {problem}"))),
        Event::Finished(row) => {
            let (engine, problem, seed) = (&row.engine_label, &row.problem_label, row.report.spec.seed);
            let what = format!("{} hits by {engine} on {problem}, seed {seed}", row.report.hits);
            runs.iter_mut().for_each(|runs| runs.finished(&what));
        }
    };
    let finished = sweep::execute(
        &plan,
        &folder,
        arguments.jobs,
        arguments.shard,
        &cancel,
        &mut watch,
    )?;
    drop(runs);
    if let Some(shard) = arguments.shard {
        message::say(format_args!(
            "shard {shard}: {} of {} runs are in {}; bench merge puts the shards together",
            finished.rows.len(),
            finished.runs,
            folder.display()
        ));
        return Ok(ExitCode::SUCCESS);
    }
    let text = publish(&plan, &finished.rows, &folder, given, &cancel)?;
    output::print(text.as_bytes())?;
    if finished.foreign > 0 {
        message::say(format_args!(
            "{} runs in the folder are not of this suite and seeds; they are left out of its tables",
            finished.foreign
        ));
    }
    if finished.missing() > 0 {
        message::say(format_args!(
            "interrupted: {} of {} runs are missing; the same command continues from here",
            finished.missing(),
            finished.runs
        ));
    }
    message::say(format_args!("look at {}", folder.join("report.html").display()));
    Ok(ExitCode::SUCCESS)
}

/// Puts shards together.
fn merge(arguments: &MergeArguments, catalogue: &Catalogue, given: &[OsString]) -> anyhow::Result<ExitCode> {
    let (plan, rows) = sweep::merge(&arguments.folders, catalogue)?;
    let folder = arguments
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("bench-{}", plan.suite.name)));
    let cancel = interrupt::listen()?;
    sweep::write_all(&folder, &rows)?;
    let text = publish(&plan, &rows, &folder, given, &cancel)?;
    output::print(text.as_bytes())?;
    message::say(format_args!("look at {}", folder.join("report.html").display()));
    Ok(ExitCode::SUCCESS)
}

/// Runs the studies of a suite and writes its report; returns its tables.
fn publish(
    plan: &Plan,
    rows: &[Row],
    folder: &Path,
    given: &[OsString],
    cancel: &Cancel,
) -> anyhow::Result<String> {
    let mut findings = Vec::new();
    for name in &plan.suite.studies {
        if cancel.is_cancelled() {
            break;
        }
        let seeds = plan
            .suite
            .parts
            .iter()
            .map(|part| part.seeds.end - part.seeds.start)
            .max()
            .unwrap_or(1);
        let doing = Counting::new();
        let mut tell = |what: &str| doing.say(format!("study {name}: {what}"));
        findings.extend((studies::find(name)?.run)(seeds, cancel, &mut tell)?);
    }
    let groups = sweep::publish(folder, plan, rows, &findings, &command(given))?;
    // A suite that compares has too many tables to read.
    let mut text = sweep::regret::finding(plan, &groups, rows)
        .map_or_else(|| sweep::table(&groups), |finding| finding.table());
    findings
        .iter()
        .for_each(|finding| text.push_str(&finding.table()));
    if findings.len() < plan.suite.studies.len() {
        message::say(format_args!(
            "interrupted: a study is missing; the same command runs it"
        ));
    }
    Ok(text)
}

/// The command line, to be given again.
fn command(given: &[OsString]) -> String {
    let plain = |text: &str| {
        text.chars()
            .all(|c| c.is_ascii_alphanumeric() || "-_./,=".contains(c))
    };
    let quoted = |text: String| {
        if plain(&text) {
            text
        } else {
            format!("'{}'", text.replace('\'', "'\\''"))
        }
    };
    std::iter::once("satisfice".to_owned())
        .chain(
            given
                .iter()
                .skip(1)
                .map(|text| quoted(text.to_string_lossy().into_owned())),
        )
        .collect::<Vec<_>>()
        .join(" ")
}
