//! `run --program` and `--worker`, with programs of a shell and of awk.

#![cfg(unix)]
#![allow(clippy::unwrap_used, missing_docs)]
#![allow(clippy::disallowed_methods, reason = "what hangs is ended in time")]

mod common;

use std::fs;
use std::path::Path;
use std::time::Instant;

use common::{Done, without_times};
use serde_json::{Value, json};

/// Two axes of integers and what is near (3, 1): five points.
const SPACE: &str = "[[axis]]\nname = \"a\"\ninteger = true\nlower = 0\nupper = 9\n\
                     [[axis]]\nname = \"b\"\ninteger = true\nlower = 0\nupper = 9\n";
const NEAR: &str = "awk -v a={a} -v b={b} 'BEGIN { print (a-3)^2 + (b-1)^2 }'";

/// A worker: what it does with `$ticket`, `$a` and `$b` before it answers.
fn worker(before: &str) -> String {
    format!(
        "#!/bin/sh\nwhile read -r line; do\n\
         set -- $(echo \"$line\" | sed 's/[^0-9.]\\{{1,\\}}/ /g')\nticket=$1 a=${{2%.*}} b=${{3%.*}}\n{before}\n\
         echo \"{{\\\"ticket\\\": $ticket, \\\"value\\\": $(( (a-3)*(a-3) + (b-1)*(b-1) ))}}\"\ndone\n"
    )
}

fn folder(before: &str) -> tempfile::TempDir {
    let place = tempfile::tempdir().unwrap();
    fs::write(place.path().join("space.toml"), SPACE).unwrap();
    fs::write(place.path().join("worker"), worker(before)).unwrap();
    place
}

fn run(folder: &Path, arguments: &[&str]) -> Done {
    let mut command = common::command(
        folder,
        "run --space space.toml --threshold 2 --evaluations 150 --seed 1 --json -",
    );
    command.args(arguments).output().unwrap().into()
}

fn report(done: &Done) -> Value {
    serde_json::from_str(&done.stdout).unwrap_or_else(|error| panic!("{error}: {done:?}"))
}

/// The hits of a report, sorted.
fn hits(report: &Value) -> Vec<String> {
    let solutions = report["solutions"].as_array().unwrap().iter();
    let mut hits: Vec<String> = solutions
        .map(|hit| hit["solution"]["coordinates"].to_string())
        .collect();
    hits.sort();
    hits
}

const FIVE: [&str; 5] = ["[2.0,1.0]", "[3.0,0.0]", "[3.0,1.0]", "[3.0,2.0]", "[4.0,1.0]"];

#[test]
fn a_program_is_started_for_each_point() {
    let place = folder("");
    let done = run(place.path(), &["--program", NEAR, "--workers", "2"]);
    assert_eq!((done.code, done.stderr.as_str()), (0, ""));
    let report = report(&done);
    assert_eq!(hits(&report), FIVE);
    assert_eq!(report["problem_parameters"]["program"], NEAR);
    assert!(report.get("failed").is_none(), "nothing failed");
}

#[test]
fn workers_answer_line_by_line_and_ordered_reports_do_not_depend_on_their_number() {
    let place = folder("");
    let reports = ["1", "3"].map(|workers| {
        let done = run(
            place.path(),
            &["--worker", "sh worker", "--workers", workers, "--ordered"],
        );
        assert_eq!((done.code, done.stderr.as_str()), (0, ""));
        without_times(report(&done))
    });
    assert_eq!(hits(&reports[0]), FIVE);
    assert_eq!(reports[0], reports[1]);
    assert_eq!(reports[0]["budget"]["parallel"], Value::Null);
    // Out of order, the engine is told how many answers are awaited.
    for (arguments, parallel) in [(&[][..], 3), (&["--parallel", "2"], 2)] {
        let mut all = vec!["--worker", "sh worker", "--workers", "3"];
        all.extend(arguments);
        let eager = report(&run(place.path(), &all));
        assert_eq!(hits(&eager), FIVE);
        assert_eq!(eager["budget"]["parallel"], parallel);
    }
}

#[test]
fn a_worker_that_dies_is_replaced_and_nothing_is_lost() {
    let place = folder("[ $ticket = 20 ] && [ ! -e died ] && { touch died; kill -9 $$; }");
    let done = run(
        place.path(),
        &["--worker", "sh worker", "--workers", "2", "--ordered"],
    );
    assert!(place.path().join("died").exists());
    let whole = run(folder("").path(), &["--worker", "sh worker", "--ordered"]);
    assert_eq!(done.stderr, "");
    assert_eq!(without_times(report(&done)), without_times(report(&whole)));
}

#[test]
fn a_worker_that_dies_of_a_point_costs_that_point_only() {
    let place = folder("[ $a$b = 32 ] && kill -9 $$");
    let done = run(
        place.path(),
        &["--worker", "sh worker", "--workers", "2", "--retries", "1"],
    );
    let report = report(&done);
    assert_eq!(
        (report["failed"].as_u64(), report["hits"].as_u64()),
        (Some(1), Some(4)),
        "{done:?}"
    );
    assert!(
        done.stderr
            .contains("the worker ended before it answered (signal: 9"),
        "{}",
        done.stderr
    );
}

#[test]
fn lines_that_are_no_answers_are_shown() {
    let place = folder("[ $a$b = 32 ] && echo loading the model");
    let done = run(place.path(), &["--worker", "sh worker", "--retries", "0"]);
    assert!(done.stderr.contains("`loading the model`"), "{}", done.stderr);
    assert_eq!(report(&done)["failed"], 1);
    let printed = "awk -v a={a} -v b={b} 'BEGIN { print a == 3 && b == 1 ? \"oops\" : 1 }'";
    let done = run(place.path(), &["--program", printed, "--retries", "0"]);
    assert!(
        done.stderr
            .contains("neither a number nor {\"value\": number}: `oops`"),
        "{}",
        done.stderr
    );
    assert_eq!(
        (report(&done)["failed"].as_u64(), report(&done)["hits"].as_u64()),
        (Some(1), Some(99))
    );
}

#[test]
fn an_evaluation_that_hangs_is_given_up() {
    let place = folder("[ $a$b = 32 ] && sleep 60");
    for way in [
        ["--worker", "sh worker"],
        ["--program", "sh -c 'test {a}{b} != 32 || sleep 60; echo 1'"],
    ] {
        let begun = Instant::now();
        let done = run(
            place.path(),
            &[way[0], way[1], "--timeout", "300ms", "--retries", "0"],
        );
        assert!(begun.elapsed().as_secs() < 30, "what it started is ended as well");
        assert!(done.stderr.contains("no answer within 300ms"), "{}", done.stderr);
        assert_eq!(report(&done)["failed"], 1);
    }
}

#[test]
fn the_time_ends_a_search_whatever_hangs() {
    let place = folder("sleep 60");
    let begun = Instant::now();
    let mut command = common::command(
        place.path(),
        "run --space space.toml --threshold 2 --time 300ms --json -",
    );
    let done: Done = command
        .args(["--worker", "sh worker", "--workers", "2"])
        .output()
        .unwrap()
        .into();
    assert!(begun.elapsed().as_secs() < 30);
    assert_eq!(
        (done.code, report(&done)["stop_reason"].as_str()),
        (1, Some("Time"))
    );
}

/// The five hits of the space are a hundred evaluations away; one that failed may be a hit, one that is NaN is none.
#[test]
fn an_evaluation_that_failed_is_no_miss() {
    let place = folder("");
    let near = |otherwise: &str| {
        format!(
            "awk -v a={{a}} -v b={{b}} 'BEGIN {{ if (a == 3 && b == 1) {{ {otherwise} }} print (a-3)^2 + (b-1)^2 }}'"
        )
    };
    for (otherwise, completeness, failed, hits) in [
        ("", "Proved", Value::Null, 5),
        ("print \"nan\"; exit", "Proved", Value::Null, 4),
        ("exit 1", "Unknown", 1.into(), 4),
    ] {
        let program = near(otherwise);
        let arguments = [
            "--program",
            &program,
            "--engine",
            "branch-and-bound",
            "--workers",
            "4",
        ];
        let report = report(&run(place.path(), &arguments));
        assert_eq!(
            (
                &report["completeness"],
                report.get("failed").unwrap_or(&Value::Null),
                &report["hits"]
            ),
            (&completeness.into(), &failed, &hits.into()),
            "{otherwise}"
        );
        assert_eq!(report["unseen_estimate"].is_null(), !failed.is_null());
        let mut command = common::command(
            place.path(),
            "run --space space.toml --threshold 2 --evaluations 150 --seed 1",
        );
        let text: Done = command.args(arguments).output().unwrap().into();
        let says = match completeness {
            "Proved" => "proved: these are all",
            _ => "unknown: the evaluation that failed may be a hit",
        };
        assert!(text.stdout.contains(says), "{}", text.stdout);
    }
}

/// A program may need more than a second: then whoever gave no limit learns that there is one.
#[test]
fn a_limit_that_nobody_gave_is_told() {
    let place = folder("");
    for (program, limit, is_told) in [
        ("sh -c 'sleep 60 # {x}'", "", true),
        ("echo {a}", "", false),
        ("sh -c 'sleep 60 # {x}'", " --time 100ms", false),
    ] {
        let line = format!("run --space space.toml --threshold 2{limit} --program");
        let done: Done = common::command(place.path(), &line)
            .arg(program)
            .output()
            .unwrap()
            .into();
        let says =
            "note: the search ended after 1s, the limit where none is given: give --time or --evaluations\n";
        assert_eq!(done.stderr, if is_told { says } else { "" }, "{program}{limit}");
    }
}

#[test]
fn failures_are_tried_again() {
    let place = folder("");
    let fails_once = "sh -c 'test -e {a}-{b} && echo {a} || { touch {a}-{b}; exit 3; }'";
    let done = run(place.path(), &["--program", fails_once, "--retries", "1"]);
    assert_eq!(done.stderr, "");
    assert_eq!(report(&done)["hits"], 20);
    let shell = run(place.path(), &["--program", "echo {a} | cat", "--shell"]);
    assert_eq!(report(&shell)["hits"], 20);
}

#[test]
fn a_shell_reads_categories_as_they_are() {
    let place = tempfile::tempdir().unwrap();
    let space = "[[axis]]\nname = \"metal\"\ncategories = [\"a b\", \"it's\", \"$x\", \"c\"]\n";
    fs::write(place.path().join("space.toml"), space).unwrap();
    for program in [
        "printf '%s\\n' {metal} >> told; echo 1",
        "printf '%s\\n' \"{metal}\" >> told; echo 1",
    ] {
        let done = run(place.path(), &["--program", program, "--shell"]);
        assert_eq!((done.stderr.as_str(), &report(&done)["hits"]), ("", &4.into()));
        let told = fs::read_to_string(place.path().join("told")).unwrap();
        let mut told: Vec<&str> = told.lines().collect();
        told.sort_unstable();
        assert_eq!(told, ["$x", "a b", "c", "it's"]);
        fs::remove_file(place.path().join("told")).unwrap();
    }
}

/// An engine that goes point by point leaves workers idle where values are entered in order; whoever asked for more is told.
#[test]
fn an_engine_that_proposes_fewer_points_is_told() {
    let place = folder("");
    let all = [
        "--program",
        "echo {a}",
        "--ordered",
        "--parallel",
        "4",
        "--workers",
        "4",
    ];
    let run = |engine: &str| run(place.path(), &[&all[..], &["--engine", engine]].concat()).stderr;
    let says = "note: walk proposed 0 of 150 points at least 4 at a time, as --parallel asks";
    assert!(run("walk").starts_with(says), "{}", run("walk"));
    assert_eq!(run("random"), "");
    let catalogue =
        |line: &str| common::satisfice(&format!("run himmelblau --evaluations 300 --parallel {line}")).stderr;
    assert!(catalogue("8 --engine walk").starts_with("note: walk proposed 0 of 300 points"));
    assert!(catalogue("100 --engine random").starts_with("note: random proposed 0 of 300 points"));
    // The first swarm of thirty is one batch, then particles move one by one.
    assert!(catalogue("8 --engine pso").starts_with("note: pso proposed 30 of 300 points"));
    for line in [
        "8",
        "2 --engine walk --islands 2",
        "1 --engine walk",
        "64 --engine random",
    ] {
        assert_eq!(catalogue(line), "", "{line}");
    }
}

#[test]
fn a_program_that_always_fails_is_given_up() {
    let place = folder("");
    let done = run(place.path(), &["--program", "false {x}"]);
    assert_eq!(done.code, 2, "{done:?}");
    let report: Value = serde_json::from_str(&done.stdout).unwrap();
    assert_eq!((&report["failed"], &report["hits"]), (&json!(64), &json!(0)));
    let says = "error: all of the 64 evaluations failed, the last one because ";
    assert!(done.stderr.contains(says), "{}", done.stderr);
}

#[test]
fn mistakes_are_errors() {
    let place = folder("");
    for (arguments, says) in [
        (&["--program", "./nothing {x}"][..], "cannot start `./nothing`"),
        (&["--worker", "true"], "3 times in a row"),
        (&["--program", "echo 1"], "no coordinate"),
        (&["--program", "echo {c}"], "{c} names no axis"),
        (
            &["--program", "echo {x}", "--worker", "cat"],
            "cannot be used with",
        ),
        (&["queens", "--program", "echo {x}"], "cannot be used with"),
        (&["--program", "echo {x}", "--set", "n=1"], "--set"),
        (
            &["--program", "echo {x}", "--checkpoint", "c.json"],
            "--checkpoint",
        ),
        (&["--program", "echo {x}", "--workers", "0"], "--workers"),
    ] {
        let done = run(place.path(), arguments);
        assert_eq!(
            (done.code, done.stdout.as_str()),
            (2, ""),
            "{arguments:?}: {done:?}"
        );
        assert!(done.stderr.contains(says), "{arguments:?}: {}", done.stderr);
    }
    let error = common::error_in(place.path(), "run");
    assert!(
        error.contains("or give --program, --worker or --resume"),
        "{error}"
    );
    let error = common::error_in(place.path(), "run --program ./x --threshold 1");
    assert!(error.contains("--space"), "{error}");
    let error = common::error_in(
        place.path(),
        "run --program ./x{x} --space nowhere.toml --threshold 1",
    );
    assert!(error.contains("nowhere.toml"), "{error}");
}

/// A problem of the catalogue has its own space and delta: nothing that is given is ignored.
#[test]
fn options_of_programs_are_refused_without_one() {
    let place = folder("");
    for option in [
        "--threshold 3",
        "--space space.toml",
        "--workers 2",
        "--timeout 1s",
        "--retries 2",
        "--shell",
        "--ordered",
    ] {
        let error = common::error_in(place.path(), &format!("run queens --evaluations 20 {option}"));
        let name = option.split(' ').next().unwrap();
        let says = format!("error: {name} is for --program and --worker: leave it out");
        assert_eq!(error, says, "{option}");
    }
    for (problem, own) in [
        ("teapots", "delta=0.5"),
        ("rastrigin --set dimension=3", "threshold=0.5"),
    ] {
        let error = common::error_in(place.path(), &format!("run {problem} --threshold 0.5"));
        let says = format!(", or set that of the problem: --set {own}");
        assert!(error.ends_with(&says), "{problem}: {error}");
    }
    let error = common::error_in(place.path(), "run --space space.toml --threshold 3");
    assert!(error.contains("or give --program"), "{error}");
}

#[test]
fn hits_without_a_separation_are_remarked() {
    let place = folder("");
    let says = "note: wide.toml gives no separation: answers that differ in the last digit count as different hits\n";
    let wide = SPACE.replace("integer = true\n", "");
    for (separation, says) in [("", says), ("separation = 0.1\n", ""), ("separation = 0\n", "")] {
        fs::write(place.path().join("wide.toml"), format!("{separation}{wide}")).unwrap();
        let mut command = common::command(
            place.path(),
            "run --space wide.toml --threshold 20 --evaluations 8 --program",
        );
        let done: Done = command.arg(NEAR).output().unwrap().into();
        assert_eq!((done.code, done.stderr.as_str()), (0, says), "{separation}");
    }
}

#[test]
fn a_report_of_a_program_says_that_it_cannot_be_verified() {
    let place = folder("");
    let done = run(place.path(), &["--worker", "sh worker"]);
    assert_eq!(hits(&report(&done)), FIVE);
    fs::write(place.path().join("report.json"), &done.stdout).unwrap();
    let error = common::error_in(place.path(), "verify report.json");
    assert!(error.contains("another run of the program"), "{error}");
}
