//! A program with a problem of its own has the whole command. This program is its own test: with arguments of
//! the command it is the example `own_command`, without any it checks itself.

#![allow(clippy::unwrap_used, missing_docs)]

#[path = "../examples/own_command.rs"]
mod own_command;

use std::path::Path;
use std::process::{Command, ExitCode};

use serde_json::Value;

const SUBCOMMANDS: [&str; 4] = ["list", "run", "bench", "verify"];

fn main() -> ExitCode {
    let first = std::env::args().nth(1);
    if first.is_some_and(|first| SUBCOMMANDS.contains(&first.as_str())) {
        return own_command::main();
    }
    let place = tempfile::tempdir().unwrap();
    a_problem_is_listed(place.path());
    a_run_is_true_until_it_is_forged(place.path());
    a_suite_compares_engines_on_it(place.path());
    println!("own_command: all checks passed");
    ExitCode::SUCCESS
}

/// Exit code and stdout of the command.
fn call(folder: &Path, arguments: &str) -> (i32, String) {
    let done = Command::new(std::env::current_exe().unwrap())
        .args(arguments.split_whitespace())
        .current_dir(folder)
        .output()
        .unwrap();
    (
        done.status.code().unwrap(),
        String::from_utf8(done.stdout).unwrap(),
    )
}

fn a_problem_is_listed(folder: &Path) {
    let (code, text) = call(folder, "list");
    assert_eq!(code, 0);
    assert!(text.contains("\n  gear-trains: four gears"), "{text}");
    assert!(text.contains("\n  teapots: "), "{text}");
}

fn a_run_is_true_until_it_is_forged(folder: &Path) {
    let run = "run gear-trains --engine random --set ratio=0.25 --evaluations 20000 --json report.json";
    assert_eq!(call(folder, run).0, 0);
    assert_eq!(call(folder, "verify report.json").0, 0);
    let file = folder.join("report.json");
    let mut report: Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
    assert_eq!(report["problem_parameters"]["ratio"], 0.25);
    report["solutions"][0]["solution"][0] = 13.into();
    report["solutions"][0]["solution"][1] = 13.into();
    std::fs::write(&file, report.to_string()).unwrap();
    assert_eq!(call(folder, "verify report.json").0, 1);
}

fn a_suite_compares_engines_on_it(folder: &Path) {
    let suite = "seeds = \"0..2\"\n[[part]]\nengines = [\"random\", \"walk\"]\nproblems = [\"gear-trains\"]\nevaluations = 5000\n";
    std::fs::write(folder.join("mine.toml"), suite).unwrap();
    let (code, text) = call(folder, "bench mine.toml --out out");
    assert_eq!(code, 0);
    assert!(text.contains("gear-trains, 5,000 evaluations"), "{text}");
    assert!(folder.join("out/report.html").exists());
}
