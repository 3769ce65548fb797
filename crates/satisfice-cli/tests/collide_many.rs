//! Scenes of many bodies by an engine: only bodies that come near are searched, in memory and budget that follow from them.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use common::satisfice_in;
use satisfice_collision::{generate, io};
use serde_json::Value;
use tempfile::TempDir;

const APART: &str = "body pairs whose inflated boxes are apart";

fn json_of(folder: &Path, arguments: &str) -> Value {
    let done = satisfice_in(folder, &format!("{arguments} --json -"));
    assert!(done.code <= 1, "{arguments}: {}", done.stderr);
    serde_json::from_str(&done.stdout).unwrap()
}

/// So many balls in rows of twenty, in which each touches the next.
fn rows(balls: usize, depth: u32) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let ball = generate::icosphere(0.52, depth).unwrap();
    io::save_obj(&ball, folder.path().join("ball.obj")).unwrap();
    let mut list = String::new();
    for k in 0..balls {
        let [x, y] = [k % 20, k / 20].map(|n| n as f64);
        writeln!(
            list,
            "[[bodies]]\nmesh = \"ball.obj\"\nat = [{x:?}, {:?}, {:?}]\nrotate = [{x:?}, {:?}, 7.0]\n",
            2.0 * y,
            0.01 * x,
            13.0 * x * y
        )
        .unwrap();
    }
    fs::write(folder.path().join("rows.toml"), list).unwrap();
    folder
}

/// The pairs without when they were found, sorted.
fn pairs(report: &Value) -> Vec<String> {
    let pairs = report["pairs"].as_array().unwrap();
    let mut pairs: Vec<_> = pairs
        .iter()
        .map(|pair| format!("{} {} {}", pair["a"], pair["b"], pair["distance"]))
        .collect();
    pairs.sort_unstable();
    pairs
}

/// 80,000 couples of which at most 380 come near. A problem for each takes more than ten times this memory.
#[cfg(unix)]
#[test]
fn an_engine_searches_the_couples_that_come_near_in_little_memory() {
    let folder = rows(400, 0);
    let scene = "collide rows.toml --threshold 0.05 --pairs triangle-triangle";
    let exact = json_of(folder.path(), scene);
    let method = "--method branch-and-bound --evaluations 10000000 --json report.json";
    let done = std::process::Command::new("sh")
        .arg("-c")
        .arg(format!(
            "ulimit -v 150000; exec {} {scene} {method}",
            env!("CARGO_BIN_EXE_satisfice")
        ))
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(
        done.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&done.stderr)
    );
    let report = fs::read(folder.path().join("report.json")).unwrap();
    let report: Value = serde_json::from_slice(&report).unwrap();
    assert_eq!(report["completeness"], "Proved");
    assert!(pairs(&exact).len() > 400);
    assert_eq!(pairs(&report), pairs(&exact));
    let [apart, by_exact] = [&report, &exact].map(|report| report["skipped"][APART].as_u64().unwrap());
    assert!(
        apart >= by_exact && by_exact >= 400 * 399 / 2 - 380,
        "{apart} {by_exact}"
    );
    let verified = satisfice_in(folder.path(), "verify report.json");
    assert_eq!(verified.code, 0, "{}", verified.stdout);
}

#[test]
fn the_budget_is_shared_by_the_couples_that_come_near() {
    let folder = rows(100, 0);
    let scene = "collide rows.toml --threshold 0.05 --pairs triangle-triangle --method random --seed 3";
    for evaluations in [3_u64, 5_000] {
        let report = json_of(folder.path(), &format!("{scene} --evaluations {evaluations}"));
        assert_eq!(report["evaluations"], evaluations);
        assert_eq!(report["stop_reason"], "Evaluations");
        assert!(evaluations < 100 || report["hits"].as_u64().unwrap() > 0);
        fs::write(folder.path().join("report.json"), report.to_string()).unwrap();
        let verified = satisfice_in(folder.path(), "verify report.json");
        assert_eq!(verified.code, 0, "{}", verified.stdout);
    }
}

#[test]
fn bodies_that_are_all_apart_are_proved_to_have_no_pair() {
    let folder = rows(100, 0);
    let apart: String = fs::read_to_string(folder.path().join("rows.toml"))
        .unwrap()
        .replace("[[bodies]]\n", "[[bodies]]\nscale = 0.5\n");
    fs::write(folder.path().join("apart.toml"), apart).unwrap();
    let report = json_of(
        folder.path(),
        "collide apart.toml --threshold 0.05 --method random --evaluations 900",
    );
    assert_eq!(
        (
            &report["evaluations"],
            &report["completeness"],
            &report["stop_reason"]
        ),
        (&0.into(), &"Proved".into(), &"Covered".into())
    );
    assert_eq!(report["skipped"][APART], 100 * 99 / 2);
    fs::write(folder.path().join("report.json"), report.to_string()).unwrap();
    let verified = satisfice_in(folder.path(), "verify report.json");
    assert_eq!(verified.code, 0, "{}", verified.stdout);
}

/// Two of three couples need few evaluations, the third more than a third of all.
#[test]
fn what_a_couple_does_not_use_goes_to_later_ones() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("point.obj"), "v 0.9 0 0\n").unwrap();
    let ball = generate::icosphere(1.0, 2).unwrap();
    io::save_obj(&ball, folder.path().join("ball.obj")).unwrap();
    let scene =
        "collide point.obj ball.obj ball.obj --at 2:0.03,0.02,0.01 --threshold 0.1 --method branch-and-bound";
    let alone = json_of(
        folder.path(),
        &scene.replace("point.obj ", "").replace("2:", "1:"),
    );
    assert_eq!(alone["completeness"], "Proved");
    let needed = alone["evaluations"].as_u64().unwrap();
    let whole = json_of(
        folder.path(),
        &format!("{scene} --evaluations {}", needed + needed / 4),
    );
    assert_eq!(whole["completeness"], "Proved", "{needed}");
}

/// Putting 327,680 triangles in order takes far longer than the first look at the clock is away.
#[test]
fn a_time_limit_covers_what_is_made_before_a_search() {
    let folder = tempfile::tempdir().unwrap();
    let ball = generate::icosphere(1.0, 7).unwrap();
    io::save_obj(&ball, folder.path().join("ball.obj")).unwrap();
    let scene = "collide ball.obj ball.obj --pairs triangle-triangle --threshold 0.001 --method random --time 100us --json -";
    let done = satisfice_in(folder.path(), scene);
    assert!(
        done.code == 1 && done.stderr.contains("no pair was compared"),
        "{}",
        done.stderr
    );
    let report: Value = serde_json::from_str(&done.stdout).unwrap();
    assert_eq!(
        (
            &report["stop_reason"],
            &report["completeness"],
            &report["evaluations"]
        ),
        (&"Time".into(), &"Unknown".into(), &0.into())
    );
}

/// Two bars that cross between their vertices, and a third one beside the end of the first.
#[test]
fn bodies_that_touch_are_those_with_pairs_of_the_kind_that_is_compared() {
    let folder = tempfile::tempdir().unwrap();
    let bar = |name: &str, low, high| common::write_box(folder.path(), name, low, high);
    bar("along.obj", [-5.0, -0.5, -0.5], [5.0, 0.5, 0.5]);
    bar("across.obj", [-0.5, -5.0, -0.25], [0.5, 5.0, 0.25]);
    bar("beside.obj", [5.05, -0.5, -0.5], [6.0, 0.5, 0.5]);
    let call = "collide along.obj across.obj beside.obj --threshold 0.1 --touching";
    let surfaces = satisfice_in(folder.path(), &format!("{call} --pairs triangle-triangle"));
    assert_eq!((surfaces.code, surfaces.stderr.as_str()), (0, ""));
    assert!(
        surfaces.stdout.contains("surfaces closer than the threshold")
            && surfaces.stdout.contains("along.obj - across.obj"),
        "{}",
        surfaces.stdout
    );
    for (pairs, said) in [
        ("vertex-vertex", "which means: vertices closer than the threshold"),
        (
            "vertex-triangle",
            "which means: a vertex and a triangle closer than the threshold",
        ),
    ] {
        let done = satisfice_in(folder.path(), &format!("{call} --pairs {pairs}"));
        assert!(done.code == 0 && done.stdout.contains(said), "{}", done.stdout);
        assert!(
            done.stderr.contains(
                "the surfaces of along.obj and across.obj may be closer than the threshold all the same"
            ),
            "{pairs}: {}",
            done.stderr
        );
    }
    let closest = satisfice_in(folder.path(), "collide along.obj across.obj --closest 1");
    assert!(
        closest
            .stderr
            .starts_with("note: only vertices were compared; surfaces may be closer than that"),
        "{}",
        closest.stderr
    );
}
