//! `--checkpoint`, `--resume`, and what branch and bound proves, as a user calls them.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::process::Stdio;

use common::{command, error_in, report, satisfice_in, without_times};
use serde_json::Value;

fn read(path: &std::path::Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

/// Takes a few seconds if not interrupted.
const LONG: &str = "run falsification --engine latest-hit-qpso --evaluations 1000000 --seed 3";

#[cfg(unix)]
#[test]
fn a_run_that_ctrl_c_has_interrupted_goes_on_as_if_nothing_had_been() {
    interrupted_and_resumed("");
}

#[cfg(unix)]
#[test]
fn so_do_islands() {
    interrupted_and_resumed(" --islands 3");
}

/// Interrupts a long run with `more` options, resumes it, and compares the report with that of a whole run.
#[cfg(unix)]
fn interrupted_and_resumed(more: &str) {
    let folder = tempfile::tempdir().unwrap();
    let checkpoint = folder.path().join("run.json");
    let mut child = command(
        folder.path(),
        &format!("{LONG}{more} --checkpoint run.json --json part.json"),
    )
    .stdout(Stdio::null())
    .spawn()
    .unwrap();
    // The first checkpoint is that of the beginning.
    while !checkpoint.exists() {
        std::thread::yield_now();
    }
    let kill = std::process::Command::new("kill")
        .args(["-s", "INT", &child.id().to_string()])
        .status();
    assert!(kill.unwrap().success());
    child.wait().unwrap();
    let part = read(&folder.path().join("part.json"));
    assert_eq!(part["stop_reason"], "Cancelled");
    assert!(part["evaluations"].as_u64().unwrap() < 1_000_000);

    // What is not given is taken from the checkpoint.
    let done = satisfice_in(
        folder.path(),
        "run falsification --resume run.json --threads 2 --json rest.json",
    );
    // That two threads had little to share is all there may be to say.
    assert!(
        done.code == 0 && (done.stderr.is_empty() || done.stderr.starts_with("note: threads shared")),
        "{}",
        done.stderr
    );
    let whole = satisfice_in(
        folder.path(),
        &format!("{LONG}{more} --json whole.json --checkpoint end.json"),
    );
    assert_eq!(whole.code, 0);
    let [rest, whole] = ["rest.json", "whole.json"].map(|name| read(&folder.path().join(name)));
    assert!(whole["hits"].as_u64().unwrap() > 100);
    assert_eq!(without_times(rest), without_times(whole.clone()));
    assert_eq!(satisfice_in(folder.path(), "verify rest.json").code, 0);
    // The checkpoint of the end gives the same report once more. It knows the problem.
    let again = satisfice_in(folder.path(), "run --resume end.json --json again.json");
    assert_eq!(again.code, 0);
    assert_eq!(
        without_times(read(&folder.path().join("again.json"))),
        without_times(whole)
    );
}

#[test]
fn a_checkpoint_of_another_run_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let begun = "run queens --set n=6 --engine random --evaluations 200 --slices 2 --checkpoint run.json";
    assert_ne!(satisfice_in(folder.path(), begun).code, 2);
    for (arguments, says) in [
        ("queens --seed 5", "the checkpoint's seed is 0, not 5"),
        (
            "queens --engine walk",
            "the checkpoint's engine is \"random\", not \"walk\"",
        ),
        (
            "queens --engine-set batch=3",
            "the checkpoint's engine_parameters.batch is",
        ),
        (
            "queens --set n=7",
            "the checkpoint's problem_parameters.n is 6, not 7",
        ),
        (
            "queens --evaluations 300",
            "the checkpoint's budget.evaluations is 200, not 300",
        ),
        ("queens --slices 3", "the checkpoint's budget.slices is 2, not 3"),
        ("shell", "is of queens, not of shell"),
    ] {
        let line = error_in(folder.path(), &format!("run {arguments} --resume run.json"));
        assert!(line.contains(says), "{line}");
    }
    fs::write(folder.path().join("other.json"), "{}").unwrap();
    for (file, says) in [
        ("none.json", "cannot read none.json"),
        ("other.json", "other.json is not a checkpoint"),
    ] {
        let line = error_in(folder.path(), &format!("run queens --resume {file}"));
        assert!(line.contains(says), "{line}");
    }
    let line = error_in(folder.path(), "run queens --checkpoint -");
    assert!(line.contains("name a file"), "{line}");
    let line = error_in(folder.path(), "run queens --checkpoint no/such/folder/run.json");
    assert!(line.contains("cannot write"), "{line}");
}

#[test]
fn branch_and_bound_proves_the_reference_count() {
    for problem in ["himmelblau", "shell", "islands", "rastrigin"] {
        let report = report(&format!(
            "run {problem} --engine branch-and-bound --evaluations 2e6 --json -"
        ));
        assert_eq!(report["completeness"], "Proved", "{problem}");
        assert_eq!(report["hits"], report["reference_hits"], "{problem}");
        assert!(
            report["reference_hits"].as_u64().unwrap() > 0 && report["bound_calls"].as_u64().unwrap() > 0
        );
    }
}
