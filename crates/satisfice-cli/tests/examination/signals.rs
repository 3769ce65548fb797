//! Signals at random moments: what was found is kept, files are whole, and a killed run continues as if nothing had happened.

use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::thread;
use std::time::Duration;

use satisfice::SearchRng;
use serde_json::Value;

use crate::extent::{cases, figure};
use crate::process::{command, ends_within, signal, without_times};

/// Time in which an interrupted process has to end.
const END: Duration = Duration::from_secs(5);

fn json(path: &Path) -> Value {
    let bytes = fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_slice(&bytes).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Files that were begun and not finished.
fn partial_files(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name());
    names
        .map(|name| name.to_string_lossy().into_owned())
        .filter(|name| name.contains("partial"))
        .collect()
}

fn pause(rng: &mut SearchRng) {
    thread::sleep(Duration::from_millis(30 + rng.below(400) as u64));
}

/// Interrupts a long run by these signals, shortly after one another.
fn interrupted(name: &str, signals: &[&str]) {
    let count = cases(4, 100);
    for case in 0..count {
        let folder = tempfile::tempdir().unwrap();
        let mut rng = SearchRng::new(case);
        let arguments = [
            "run",
            "teapots",
            "--set",
            "samples=500",
            // The default would enumerate all pairs, and be done.
            "--engine",
            "latest-hit-qpso",
            "--time",
            "1h",
            "--json",
            "r.json",
            "--checkpoint",
            "c.json",
        ];
        let mut child = command(folder.path(), &arguments)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        pause(&mut rng);
        // The report is the place for results from the first moment on: a run that has not begun yet keeps nothing.
        while !folder.path().join("c.json").exists() {
            thread::sleep(Duration::from_millis(5));
        }
        for name in signals {
            signal(&child, name);
            thread::sleep(Duration::from_millis(rng.below(20) as u64));
        }
        assert!(
            ends_within(&mut child, END, None),
            "case {case}: deaf to {signals:?}"
        );
        let code = child.wait().unwrap().code();
        assert!(
            matches!(code, Some(0 | 1)),
            "case {case}: exit code {code:?} after {signals:?}"
        );
        let report = json(&folder.path().join("r.json"));
        assert_eq!(report["stop_reason"], "Cancelled", "case {case}");
        assert!(json(&folder.path().join("c.json")).is_object());
        assert_eq!(partial_files(folder.path()), Vec::<String>::new(), "case {case}");
    }
    figure(
        &format!("runs ended by {name}"),
        format!("{count}, every report and checkpoint whole"),
    );
}

#[test]
fn an_interrupt_keeps_the_report() {
    interrupted("SIGINT", &["INT"]);
}

#[test]
fn a_termination_keeps_the_report() {
    interrupted("SIGTERM", &["TERM"]);
}

#[test]
fn a_second_signal_within_a_second_is_the_same_wish() {
    interrupted(
        "SIGTERM twice within 20 ms, as `timeout` sends it",
        &["TERM", "TERM"],
    );
}

#[test]
fn a_killed_run_resumes_as_if_nothing_had_happened() {
    let count = cases(3, 100);
    let run = [
        "run",
        "rastrigin",
        "--evaluations",
        "400000",
        "--slices",
        "3",
        "--seed",
        "5",
    ];
    let whole = tempfile::tempdir().unwrap();
    let done = command(whole.path(), &[&run[..], &["--json", "r.json"]].concat())
        .output()
        .unwrap();
    assert!(done.status.success());
    let expected = without_times(json(&whole.path().join("r.json")));
    let mut killed = 0;
    for case in 0..count {
        let folder = tempfile::tempdir().unwrap();
        let mut rng = SearchRng::new(case);
        let mut child = command(folder.path(), &[&run[..], &["--checkpoint", "c.json"]].concat())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        while !folder.path().join("c.json").exists() {
            thread::sleep(Duration::from_millis(2));
        }
        pause(&mut rng);
        killed += u64::from(child.try_wait().unwrap().is_none());
        child.kill().unwrap();
        child.wait().unwrap();
        let resumed = command(
            folder.path(),
            &["run", "rastrigin", "--resume", "c.json", "--json", "r.json"],
        )
        .output()
        .unwrap();
        let said = String::from_utf8_lossy(&resumed.stderr).into_owned();
        assert!(resumed.status.success(), "case {case}: {said}");
        assert_eq!(
            without_times(json(&folder.path().join("r.json"))),
            expected,
            "case {case}"
        );
    }
    figure(
        "runs killed and resumed",
        format!("{count} ({killed} of them before their end), all equal to the uninterrupted run"),
    );
}

#[test]
fn a_killed_sweep_goes_on_where_it_was() {
    let count = cases(3, 100);
    let suite = "seeds = \"0..40\"\n[[part]]\nengines = [\"walk\"]\nproblems = [\"sallen-key\"]\nevaluations = 20000\n";
    let results = |folder: &Path| {
        let text = fs::read_to_string(folder.join("out").join("results.jsonl")).unwrap();
        let mut lines: Vec<String> = text
            .lines()
            .map(|line| without_times(serde_json::from_str(line).unwrap()))
            .map(|line| line["report"].to_string())
            .collect();
        lines.sort_unstable();
        lines
    };
    let bench = ["bench", "s.toml", "--out", "out"];
    let mut expected = Vec::new();
    let mut killed = 0;
    for case in 0..=count {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("s.toml"), suite).unwrap();
        if case > 0 {
            let mut rng = SearchRng::new(case);
            let mut child = command(folder.path(), &bench)
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .spawn()
                .unwrap();
            pause(&mut rng);
            killed += u64::from(child.try_wait().unwrap().is_none());
            child.kill().unwrap();
            child.wait().unwrap();
        }
        let done = command(folder.path(), &bench).output().unwrap();
        let said = String::from_utf8_lossy(&done.stderr).into_owned();
        assert_eq!(done.status.code(), Some(0), "case {case}: {said}");
        if case == 0 {
            expected = results(folder.path());
            assert_eq!(expected.len(), 40);
        }
        assert_eq!(results(folder.path()), expected, "case {case}");
    }
    figure(
        "sweeps killed and begun again",
        format!("{count} ({killed} of them before their end), all equal to the uninterrupted sweep"),
    );
}

#[test]
fn a_killed_or_interrupted_collision_leaves_no_half_file() {
    let place = tempfile::tempdir().unwrap();
    let points = |shift: f64| {
        let at = |k: u32| format!("v {} {} 0\n", f64::from(k % 60) + shift, f64::from(k / 60));
        (0..3600).map(at).collect::<String>()
    };
    fs::write(place.path().join("a.obj"), points(0.0)).unwrap();
    fs::write(place.path().join("b.obj"), points(0.5)).unwrap();
    let (count, mut whole, mut cut) = (cases(4, 100), 0, 0);
    for case in 0..2 * count {
        let name = ["KILL", "INT"][case as usize % 2];
        let csv = place.path().join(format!("{case}.csv"));
        let file = csv.to_string_lossy();
        let call = ["collide", "a.obj", "b.obj", "--threshold", "6", "--out", &file];
        let mut child = command(place.path(), &call)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        pause(&mut SearchRng::new(case));
        signal(&child, name);
        assert!(ends_within(&mut child, END, None), "case {case}: deaf to {name}");
        let code = child.wait().unwrap().code();
        match fs::read_to_string(&csv) {
            // A list that ended early is a list: its last line is one, and the exit code is that of an answer.
            Ok(text) => {
                whole += 1;
                assert!(matches!(code, Some(0 | 1) | None), "case {case}: {code:?}");
                assert!(text.ends_with('\n'), "case {case}");
                assert!(
                    text.lines().all(|line| line.split(',').count() == 5),
                    "case {case}"
                );
            }
            Err(_) => {
                cut += 1;
                // Before it listened, or by a signal that cannot be heard.
                assert!(code.is_none(), "case {case}: no file, exit code {code:?}");
            }
        }
    }
    figure(
        "collisions ended by SIGKILL and SIGINT",
        format!(
            "{}: {whole} whole files, {cut} without a file, no half one",
            2 * count
        ),
    );
}

#[test]
fn two_processes_do_not_share_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("s.toml"),
        "seeds = \"0..4\"\n[[part]]\nengines = [\"random\"]\nproblems = [\"queens\"]\ntime = \"500ms\"\n",
    )
    .unwrap();
    let mut first = command(folder.path(), &["bench", "s.toml", "--out", "out"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    while !folder.path().join("out").join("results.jsonl").exists() {
        thread::sleep(Duration::from_millis(5));
    }
    let second = command(folder.path(), &["bench", "s.toml", "--out", "out"])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&second.stderr).into_owned();
    assert_eq!(second.status.code(), Some(2), "{said}");
    assert!(said.contains("out"), "{said}");
    assert!(ends_within(&mut first, Duration::from_secs(30), None));
    assert_eq!(first.wait().unwrap().code(), Some(0));
}
