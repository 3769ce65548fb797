//! `satisfice verify`: whether a report is correct.

use std::fmt::Write;
use std::process::ExitCode;

use anyhow::{Context, anyhow, bail};
use satisfice_catalogue::{Catalogue, Mismatch, RunReport, checkpoint, input};

use crate::arguments::VerifyArguments;
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
    .with_context(|| format!("cannot read {path}: name a report that `run --json` wrote"))?;
    let wrong = || format!("{path} is not a report that `run --json` or `collide --json` wrote");
    let Kind { problem } = serde_json::from_slice(&text).with_context(wrong)?;

    // A problem may panic on a forged solution. That is caught and reported as a mismatch, so the hook stays silent.
    std::panic::set_hook(Box::new(|_| {}));
    let checked = if problem == collide::PROBLEM {
        collide::verify(&text)
    } else {
        serde_json::from_slice(&text)
            .map_err(|error| match checkpoint::spec(&text) {
                Ok(_) => anyhow!(
                    "{path} is a checkpoint, not a report: `satisfice run --resume {path} --json report.json` goes on with its run and writes one"
                ),
                Err(_) => anyhow::Error::new(error).context(wrong()),
            })
            .and_then(|report: RunReport| Ok((mismatches(&report, catalogue)?, report.hits)))
    };
    drop(std::panic::take_hook());
    let (mismatches, hits) = checked?;

    let mut said = String::new();
    if mismatches.is_empty() {
        let _ = writeln!(
            said,
            "{path} is true: {hits} hits of {problem} evaluated anew, each below the threshold and listed once; its counts agree"
        );
    } else {
        let places = match mismatches.len() {
            1 => "1 place".to_owned(),
            many => format!("{many} places"),
        };
        let _ = writeln!(said, "{path} is false in {places}");
        for mismatch in mismatches.iter().take(SHOWN) {
            let _ = writeln!(said, "  {mismatch}");
        }
        if mismatches.len() > SHOWN {
            let _ = writeln!(said, "  and {} more", mismatches.len() - SHOWN);
        }
    }
    output::print(said.as_bytes())?;
    Ok(ExitCode::from(u8::from(!mismatches.is_empty())))
}

/// The part of a report that says which command it is of.
#[derive(serde::Deserialize)]
struct Kind {
    problem: String,
}

fn mismatches(report: &RunReport, catalogue: &Catalogue) -> anyhow::Result<Vec<Mismatch>> {
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
    Ok(problem.verify(report, problem.reference_hits()))
}
