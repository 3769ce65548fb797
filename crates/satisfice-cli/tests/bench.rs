//! `bench`, as a user calls it.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::path::Path;

use common::{command, error, error_in, satisfice_in};
use serde_json::Value;

const SUITE: &str = r#"
    title = "Two engines"
    seeds = "0..3"
    [[part]]
    name = "counted"
    engines = ["random", { name = "descent-flood" }]
    problems = [{ name = "teapots", samples = 300, delta = [0.03, 0.06] }]
    evaluations = 4000
    at-evaluations = [1000, 4000]
    [[part]]
    name = "timed"
    engines = ["random"]
    problems = ["islands"]
    time = "5ms"
    at-times = ["1ms", "5ms"]
"#;

/// The lines of a sweep's file, without times, sorted.
fn rows(folder: &Path) -> Vec<Value> {
    let text = fs::read_to_string(folder.join("results.jsonl")).unwrap();
    let mut rows: Vec<Value> = text
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    rows.sort_by_key(|row| {
        [
            &row["part"],
            &row["problem_label"],
            &row["engine_label"],
            &row["seed"],
        ]
        .map(Value::to_string)
    });
    rows
}

fn hits(rows: &[Value]) -> Vec<(String, u64)> {
    rows.iter()
        .filter(|row| row["part"] == "counted")
        .map(|row| (row["engine_label"].to_string(), row["hits"].as_u64().unwrap()))
        .collect()
}

#[test]
fn a_sweep_runs_goes_on_and_repeats_itself() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    fs::write(folder.join("mine.toml"), SUITE).unwrap();
    let done = satisfice_in(folder, "bench mine.toml --out out --jobs 2");
    assert_eq!(done.code, 0, "{}", done.stderr);
    assert!(done.stderr.contains("15 runs"), "{}", done.stderr);
    assert!(
        done.stdout
            .contains("counted: teapots samples=300 delta=0.06, 4,000 evaluations"),
        "{}",
        done.stdout
    );
    let all = rows(&folder.join("out"));
    assert_eq!(all.len(), 15);
    for row in &all {
        let alone = row["part"] == "timed";
        assert_eq!(row["alone"], alone);
        assert_eq!(
            row["metrics"]["at_seconds"].as_array().unwrap().len(),
            if alone { 2 } else { 0 }
        );
        assert!(row["hits"].as_u64() <= row["reference_hits"].as_u64());
    }

    // Cut short within a line, and with a run missing: both are run again, nothing else is.
    let file = folder.join("out/results.jsonl");
    let text = fs::read_to_string(&file).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    fs::write(
        &file,
        format!("{}\n{}", lines[1..14].join("\n"), &lines[14][..40]),
    )
    .unwrap();
    let again = satisfice_in(folder, "bench mine.toml --out out --jobs 1");
    assert!(
        again.stderr.contains("13 of them are in out already"),
        "{}",
        again.stderr
    );
    assert!(
        fs::read_to_string(&file)
            .unwrap()
            .starts_with(&lines[1..14].join("\n"))
    );
    assert_eq!(hits(&rows(&folder.join("out"))), hits(&all));

    let summary: Value =
        serde_json::from_str(&fs::read_to_string(folder.join("out/summary.json")).unwrap()).unwrap();
    let line = &summary[0]["lines"][1];
    assert_eq!(
        (line["runs"].as_u64(), line["engine"].as_str()),
        (Some(3), Some("descent-flood"))
    );
    let paired = &line["paired"];
    assert_eq!(
        paired["wins"].as_u64().unwrap()
            + paired["losses"].as_u64().unwrap()
            + paired["ties"].as_u64().unwrap(),
        3
    );

    // Runs in the format of IOHanalyzer: all that its readers ask for, as many headers as runs, values that only rise.
    let ioh = folder.join("out/ioh/descent-flood");
    let header: Value = fs::read_dir(&ioh)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .find(|path| path.extension().is_some_and(|e| e == "json"))
        .map(|path| serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap())
        .unwrap();
    let scenario = &header["scenarios"][0];
    assert_eq!(scenario["runs"].as_array().unwrap().len(), 3);
    let asked = [
        "/version",
        "/suite",
        "/function_id",
        "/function_name",
        "/maximization",
        "/algorithm/name",
        "/algorithm/info",
        "/attributes/1",
        "/scenarios/0/dimension",
        "/scenarios/0/runs/2/instance",
        "/scenarios/0/runs/2/evals",
        "/scenarios/0/runs/2/best/evals",
        "/scenarios/0/runs/2/best/y",
        "/scenarios/0/runs/2/best/x",
    ];
    asked
        .iter()
        .for_each(|place| assert!(header.pointer(place).is_some(), "{place}"));
    let data = fs::read_to_string(ioh.join(scenario["path"].as_str().unwrap())).unwrap();
    let runs: Vec<&str> = data.split("evaluations raw_y\n").skip(1).collect();
    assert_eq!(runs.len(), 3);
    for (run, told) in runs.iter().zip(scenario["runs"].as_array().unwrap()) {
        let points: Vec<(u64, f64)> = run
            .lines()
            .map(|line| line.split_once(' ').unwrap())
            .map(|(evaluations, y)| (evaluations.parse().unwrap(), y.parse().unwrap()))
            .collect();
        assert!(points.is_sorted_by(|a, b| a.0 < b.0 && a.1 < b.1));
        assert_eq!(points.last().unwrap().1, told["best"]["y"].as_f64().unwrap());
    }

    let one = satisfice_in(
        folder,
        "bench mine.toml --out two --engines portfolio --seeds 7..8",
    );
    assert_eq!(one.code, 0, "{}", one.stderr);
    assert!(
        rows(&folder.join("two"))
            .iter()
            .all(|row| row["engine"] == "portfolio" && row["seed"] == 7)
    );
}

/// Whatever is wrong with a suite is said in one line before anything runs.
#[test]
fn mistakes_are_told_before_anything_runs() {
    let place = tempfile::tempdir().unwrap();
    for (from, to, says) in [
        (
            "random\", {",
            "randon\", {",
            "part 1 `counted`: unknown engine `randon`, did you mean `random`?",
        ),
        (
            "\"islands\"",
            "\"ilsands\"",
            "part 2 `timed`: unknown problem `ilsands`, did you mean `islands`?",
        ),
        (
            "delta =",
            "dleta =",
            "unknown parameter of `teapots` `dleta`, did you mean `delta`?",
        ),
        ("0.03", "-0.03", "delta = -0.03 is not allowed"),
        (
            "engines = [\"random\"]",
            "engins = [\"random\"]",
            "part 2 `timed`: unknown key of a part `engins`, did you mean `engines`?",
        ),
        (
            "title",
            "titel",
            "unknown key of a suite `titel`, did you mean `title`?",
        ),
        ("\"0..3\"", "\"3..0\"", "seeds = 3..0 is not allowed: write A..B"),
        (
            "evaluations = 4000",
            "",
            "part 1 `counted`: no budget: give evaluations",
        ),
        (
            "4000",
            "-4000",
            "evaluations = -4000 is not allowed: must be a whole number of at least 1",
        ),
        ("5ms", "5", "time = 5 is not allowed: a time needs a unit"),
        ("\"timed\"", "\"counted\"", "two parts named `counted`"),
        ("[0.03, 0.06]", "[0.03, 0.030]", "is listed twice"),
        (
            "[0.03, 0.06]",
            "[]",
            "teapots: delta is an empty list: give a value",
        ),
        (
            "problems = [\"islands\"]",
            "",
            "problems are missing: write problems =",
        ),
        ("title = ", "title = = ", "mine.toml, line 2: "),
        (
            "\"Two engines\"",
            "5",
            "mine.toml: title: invalid type: integer `5`, expected a string",
        ),
        (
            "\"random\", {",
            "7, {",
            "part 1: engines, entry 1: invalid type: integer `7`, expected \"NAME\" or { name",
        ),
        (
            "\"0..3\"",
            "\"0..9223372036854775808\"",
            "9,223,372,036,854,775,808 seeds of 4 engines, problems and budgets are more than 10,000,000 runs: give fewer",
        ),
    ] {
        assert!(SUITE.contains(from), "{from}");
        fs::write(place.path().join("mine.toml"), SUITE.replacen(from, to, 1)).unwrap();
        let line = error_in(place.path(), "bench mine.toml --out out");
        assert!(line.contains(says), "{from} -> {to}: {line}");
        assert!(!place.path().join("out").exists());
    }
    assert!(
        error("bench experiment-on")
            .contains("unknown suite (or file.toml) `experiment-on`, did you mean `experiment-one`?")
    );
    assert!(error("bench none.toml").contains("none.toml: cannot read this suite"));
    fs::write(place.path().join("mine.toml"), SUITE).unwrap();
    fs::write(place.path().join("file"), "").unwrap();
    let line = error_in(place.path(), "bench mine.toml --out file");
    assert!(
        line.contains("file: it is a file, but results need a folder; choose another one"),
        "{line}"
    );
    fs::create_dir(place.path().join("bad")).unwrap();
    fs::write(place.path().join("bad/results.jsonl"), "{}\n").unwrap();
    assert!(error_in(place.path(), "bench mine.toml --out bad").contains("line 1 is not a finished run"));
}

/// A list in the place of one budget runs all its values, each in a table of its own.
#[test]
fn all_values_of_a_list_are_run() {
    let place = tempfile::tempdir().unwrap();
    let suite = SUITE.replace("evaluations = 4000", "evaluations = [100, 4000]");
    fs::write(place.path().join("mine.toml"), suite).unwrap();
    let done = satisfice_in(place.path(), "bench mine.toml --out out --seeds 0..1");
    assert_eq!(done.code, 0, "{}", done.stderr);
    assert!(done.stderr.contains("9 runs"), "{}", done.stderr);
    for budget in ["100 evaluations", "4,000 evaluations"] {
        let heading = format!("counted: teapots samples=300 delta=0.03, {budget}; all hits: ");
        assert!(done.stdout.contains(&heading), "{}", done.stdout);
    }
    let rows = rows(&place.path().join("out"));
    let spent = |evaluations: u64| {
        rows.iter()
            .filter(|row| row["evaluations"] == evaluations)
            .count()
    };
    assert_eq!((spent(100), spent(4000)), (4, 4));
}

/// Ctrl-C keeps the runs that have ended, and the same command continues.
#[test]
#[cfg(unix)]
fn an_interrupted_sweep_keeps_its_runs() {
    let place = tempfile::tempdir().unwrap();
    let suite = SUITE.replace("5ms", "300ms").replace("0..3", "0..200");
    fs::write(place.path().join("mine.toml"), suite).unwrap();
    let mut child = command(place.path(), "bench mine.toml --out out")
        .stderr(std::process::Stdio::piped())
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let file = place.path().join("out/results.jsonl");
    while fs::read_to_string(&file).map_or(0, |text| text.lines().count()) < 3 {
        assert!(child.try_wait().unwrap().is_none());
        std::thread::yield_now();
    }
    let kill = std::process::Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(kill.unwrap().success());
    let done = child.wait_with_output().unwrap();
    assert_eq!(done.status.code(), Some(0));
    assert!(String::from_utf8(done.stderr).unwrap().contains("interrupted: "));
    let kept = rows(&place.path().join("out")).len();
    assert!((3..1000).contains(&kept), "{kept}");
}
