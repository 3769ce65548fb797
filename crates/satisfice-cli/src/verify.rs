//! `satisfice verify`: whether a report is correct.

use std::fmt::Write;
use std::process::ExitCode;

use anyhow::{Context, anyhow, bail};
use satisfice::Completeness;
use satisfice_catalogue::{Catalogue, Mismatch, RunReport, checkpoint, input};

use crate::arguments::VerifyArguments;
use crate::progress::Counting;
use crate::{collide, output, program};

/// The number of mismatches shown.
const SHOWN: usize = 20;

pub(crate) fn verify(arguments: &VerifyArguments, catalogue: &Catalogue) -> anyhow::Result<ExitCode> {
    let path = arguments.report.display();
    let text = if arguments.report.as_os_str() == "-" {
        input::read_stream(std::io::stdin())
    } else {
        input::read(&arguments.report)
    }
    .with_context(|| {
        format!("cannot read {path}: name a report that `run --json` or `collide --json` wrote")
    })?;
    let wrong = || format!("{path} is not a report that `run --json` or `collide --json` wrote");
    let Kind { problem } = serde_json::from_slice(&text).with_context(wrong)?;

    // A problem may panic on a forged solution. That is caught and reported as a mismatch, so the hook stays silent.
    std::panic::set_hook(Box::new(|_| {}));
    let counting = Counting::new();
    let checked = if problem == collide::PROBLEM {
        collide::verify(&text, &counting)
    } else {
        serde_json::from_slice(&text)
            .map_err(|error| match checkpoint::spec(&text) {
                Ok(_) => anyhow!(
                    "{path} is a checkpoint, not a report: `satisfice run --resume {path} --json report.json` goes on with its run and writes one"
                ),
                Err(_) => anyhow::Error::new(error).context(wrong()),
            })
            .and_then(|report: RunReport| of_run(&report, catalogue, &counting))
    };
    drop(counting);
    drop(std::panic::take_hook());
    let Checked {
        wrong,
        hits,
        others,
        unchecked,
    } = checked?;

    let mut said = String::new();
    if wrong.is_empty() {
        let _ = writeln!(
            said,
            "{path} is true: {hits} hits of {problem} evaluated anew, each below the threshold and listed once; {others}; its counts \
             agree with each other"
        );
        let _ = writeln!(said, "not checked, as only the same search could: {unchecked}");
    } else {
        let places = match wrong.len() {
            1 => "1 place".to_owned(),
            many => format!("{many} places"),
        };
        let _ = writeln!(said, "{path} is false in {places}");
        for mismatch in wrong.iter().take(SHOWN) {
            let _ = writeln!(said, "  {mismatch}");
        }
        if wrong.len() > SHOWN {
            let _ = writeln!(said, "  and {} more", wrong.len() - SHOWN);
        }
    }
    output::print(said.as_bytes())?;
    Ok(ExitCode::from(u8::from(!wrong.is_empty())))
}

/// The part of a report that says which command it is of.
#[derive(serde::Deserialize)]
struct Kind {
    problem: String,
}

/// What came out of a check.
pub(crate) struct Checked {
    pub(crate) wrong: Vec<Mismatch>,
    /// How many hits are listed.
    pub(crate) hits: u64,
    /// What was done about hits that are not listed.
    pub(crate) others: &'static str,
    /// What a report alone does not tell.
    pub(crate) unchecked: &'static str,
}

fn of_run(report: &RunReport, catalogue: &Catalogue, counting: &Counting) -> anyhow::Result<Checked> {
    if report.spec.problem == program::PROBLEM {
        bail!(
            "the report is of a program, which computed its values: only another run of the program can check them"
        );
    }
    let texts = report.spec.problem_parameters.texts();
    let settings = texts.iter().map(|(name, value)| (name.as_str(), value.as_str()));
    let problem = catalogue
        .find(&report.spec.problem)
        .and_then(|entry| entry.build(settings))
        .context("the problem of the report cannot be built")?;
    counting.say(format!("evaluating {} hits", report.hits));
    let reference = problem.reference_hits();
    let mut wrong = problem.verify(report, reference);
    wrong.extend(engine_of(report));
    Ok(Checked {
        wrong,
        hits: report.hits,
        others: match (reference, report.completeness) {
            (Some(_), _) => "the number of all hits is known, and what it says of it holds",
            (None, Completeness::Proved) => "whether others are missing was not checked",
            (None, Completeness::Unknown) => "it does not say that there are no others",
        },
        unchecked: "times, the end by them, calls of neighbours and bounds, and estimates of hits not seen",
    })
}

/// The engine and its parameters must be known ones.
fn engine_of(report: &RunReport) -> Option<Mismatch> {
    match report.spec.clone().complete() {
        Err(error) => Some(Mismatch::new("engine", &report.spec.engine, error)),
        Ok(spec) if spec.engine_parameters != report.spec.engine_parameters => Some(Mismatch::new(
            "engine_parameters",
            serde_json::json!(report.spec.engine_parameters),
            serde_json::json!(spec.engine_parameters),
        )),
        Ok(_) => None,
    }
}
