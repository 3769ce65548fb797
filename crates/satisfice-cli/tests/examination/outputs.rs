//! Places that cannot be written: full disks, closed pipes, paths that are not folders. Results never depend on messages.

use std::fs;

use crate::process::{command, limited};

const RUN: [&str; 6] = ["run", "queens", "--evaluations", "20000", "--seed", "1"];

#[test]
fn unwritable_messages_lose_no_result() {
    let folder = tempfile::tempdir().unwrap();
    let done = limited(
        folder.path(),
        "exec 2>/dev/full;",
        &[&RUN[..], &["--json", "r.json"]].concat(),
    )
    .output()
    .unwrap();
    assert_eq!(done.status.code(), Some(0));
    assert!(folder.path().join("r.json").exists());
    let closed = limited(
        folder.path(),
        "exec 2>&-;",
        &[&RUN[..], &["--json", "s.json"]].concat(),
    )
    .output()
    .unwrap();
    assert_eq!(closed.status.code(), Some(0));
    assert!(folder.path().join("s.json").exists());
}

#[test]
fn a_reader_that_has_seen_enough_is_no_error() {
    let head = std::process::Command::new("sh")
        .arg("-c")
        .arg("{ \"$0\" list; echo code $? >&2; } | head -n 1")
        .arg(env!("CARGO_BIN_EXE_satisfice"))
        .output()
        .unwrap();
    assert_eq!(String::from_utf8_lossy(&head.stderr), "code 0\n");
}

#[test]
fn a_full_disk_is_one_line() {
    let folder = tempfile::tempdir().unwrap();
    for (name, arguments) in [
        ("report", [&RUN[..], &["--json", "r.json"]].concat()),
        ("checkpoint", [&RUN[..], &["--checkpoint", "c.json"]].concat()),
        ("plot", [&RUN[..], &["--plot", "p.svg"]].concat()),
    ] {
        // No file may grow beyond 512 bytes.
        let done = limited(folder.path(), "trap '' XFSZ; ulimit -f 1;", &arguments)
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&done.stderr).into_owned();
        assert_eq!(done.status.code(), Some(2), "{name}: {said}");
        assert_eq!(
            said.lines().filter(|line| line.starts_with("error: ")).count(),
            1,
            "{name}: {said}"
        );
        assert!(!said.contains("partial"), "{name} names a temporary file: {said}");
        // What can be written is: the summary has the hits.
        let summary = String::from_utf8_lossy(&done.stdout).into_owned();
        assert!(summary.contains("  hits          "), "{name}: {summary}");
        let left: Vec<_> = fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name())
            .collect();
        assert!(
            left.iter()
                .all(|name| !name.to_string_lossy().contains("partial")),
            "{name} leaves {left:?}"
        );
    }
}

#[test]
fn a_place_that_is_no_folder_is_refused_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("file"), "").unwrap();
    for option in ["--json", "--checkpoint", "--plot"] {
        let place = if option == "--plot" {
            "file/x.svg"
        } else {
            "file/x.json"
        };
        let done = command(
            folder.path(),
            &["run", "queens", "--time", "300ms", option, place],
        )
        .output()
        .unwrap();
        assert_eq!(done.status.code(), Some(2), "{option}");
    }
}

#[test]
fn one_name_for_two_outputs_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let done = command(
        folder.path(),
        &[
            "run",
            "queens",
            "--time",
            "300ms",
            "--json",
            "x",
            "--checkpoint",
            "x",
        ],
    )
    .output()
    .unwrap();
    assert_eq!(done.status.code(), Some(2));
    let plot = command(
        folder.path(),
        &[
            "run", "queens", "--time", "300ms", "--json", "x.svg", "--plot", "./x.svg",
        ],
    )
    .output()
    .unwrap();
    assert_eq!(plot.status.code(), Some(2));
}
