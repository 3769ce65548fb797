//! Reports are equal to the byte on any number of threads, for every engine; of islands too.

use crate::extent::{figure, is_full};
use crate::process::{command, without_times};

fn report(arguments: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let done = command(folder.path(), arguments).output().unwrap();
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    assert!(
        done.status.code().is_some_and(|code| code < 2),
        "{arguments:?}: {said}"
    );
    without_times(serde_json::from_slice(&done.stdout).unwrap()).to_string()
}

#[test]
fn threads_change_no_report() {
    let problems: &[&str] = if is_full() {
        &[
            "queens",
            "rastrigin",
            "sallen-key",
            "islands",
            "costas",
            "himmelblau",
            "arm",
        ]
    } else {
        &["sallen-key"]
    };
    let mut runs = 0;
    for problem in problems {
        for entry in satisfice::engine::all() {
            let engine = entry.name;
            for islands in ["1", "4"] {
                let evaluations = if entry.expensive_proposals { "100" } else { "3000" };
                let run = |threads| {
                    report(&[
                        "run",
                        problem,
                        "--engine",
                        engine,
                        "--evaluations",
                        evaluations,
                        "--islands",
                        islands,
                        "--threads",
                        threads,
                        "--json",
                        "-",
                    ])
                };
                let one = run("1");
                let others: &[&str] = if is_full() { &["2", "8"] } else { &["2"] };
                for threads in others {
                    assert_eq!(
                        run(threads),
                        one,
                        "{problem}, {engine}, {islands} islands, {threads} threads"
                    );
                    runs += 1;
                }
            }
        }
    }
    figure("reports equal to the byte over threads", runs);
}
