//! Mistakes in calls get one line that says what to do.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::path::Path;

use common::{error_in, satisfice_in};

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const SPACE: &str = "[[axis]]\nlower = 0\nupper = 1\n";

/// Each call has to fail with one line that has this in it.
fn say(folder: &Path, calls: &[(&str, &str)]) {
    for (arguments, says) in calls {
        let line = error_in(folder, arguments);
        assert!(line.contains(says), "{arguments}: {line}");
    }
}

#[test]
fn numbers_say_their_bounds() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("space.toml"), SPACE).unwrap();
    let workers = "for '--workers <N>': must be a whole number from 1 to 1024";
    let calls = [
        ("--workers 1e9", workers),
        ("--workers 0", workers),
        ("--workers -1", workers),
        ("--workers many", workers),
        (
            "--retries 1e12",
            "for '--retries <N>': must be a whole number from 0 to 4294967295",
        ),
    ];
    for (option, says) in calls {
        let call = format!("run --program echo{{x}} --space space.toml --threshold 1 {option}");
        say(folder.path(), &[(&call, says)]);
    }
}

#[test]
fn what_is_given_twice_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.obj", "b.obj"] {
        fs::write(folder.path().join(name), TRIANGLE).unwrap();
    }
    say(
        folder.path(),
        &[
            (
                "run queens --set n=6 --set n=7",
                "--set n=7: n is set to 6 before: set it once",
            ),
            (
                "run queens --engine qpso --engine-set particles=6 --engine-set particles=7",
                "--engine-set particles=7: particles is set to 6 before",
            ),
            (
                "collide a.obj b.obj --threshold 1 --at a:0,0,1 --at 0:0,0,2",
                "--at 0: this body is placed before: place it once",
            ),
        ],
    );
}

#[test]
fn files_of_another_kind_are_called_so() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("a.obj"), TRIANGLE).unwrap();
    fs::create_dir(at("d.obj")).unwrap();
    let done = satisfice_in(
        folder.path(),
        "run queens --set n=4 --evaluations 300 --checkpoint k.json",
    );
    assert_eq!(done.code, 0, "{}", done.stderr);
    say(
        folder.path(),
        &[
            (
                "collide d.obj a.obj --threshold 1",
                "cannot read d.obj: it is a folder: name the mesh files in it",
            ),
            (
                "verify k.json",
                "k.json is a checkpoint, not a report: `satisfice run --resume k.json --json report.json`",
            ),
            (
                "bench experiment-one-smoke --out a.obj",
                "a.obj: it is a file, but results need a folder",
            ),
            (
                "bench experiment-one-smoke --out a.obj/results",
                "a.obj: it is a file, but results need a folder",
            ),
            (
                "bench experiment-one-smoke --shard 1/2 --out a.obj",
                "a.obj: it is a file, but results need a folder",
            ),
        ],
    );
}

/// An engine in the wrong place gets the option that chooses it.
#[test]
fn an_engine_has_its_option() {
    let folder = tempfile::tempdir().unwrap();
    let collide = "error: collide chooses an engine by --method: --method ";
    for (call, says) in [
        (
            "run portfolio",
            "error: `portfolio` is an engine: run PROBLEM --engine portfolio",
        ),
        (
            "run queens portfolio",
            "error: `portfolio` is an engine: --engine portfolio",
        ),
        (
            "collide a.obj b.obj --threshold 1 --engine portfolio",
            &format!("{collide}portfolio"),
        ),
        (
            "collide a.obj b.obj --threshold 1 --engine=qpso --time 1s",
            &format!("{collide}qpso"),
        ),
        (
            "collide a.obj b.obj --threshold 1 --engine",
            &format!("{collide}NAME"),
        ),
    ] {
        assert_eq!(error_in(folder.path(), call), says, "{call}");
    }
}

#[test]
fn words_that_an_option_does_not_take_are_told_like_other_names() {
    let folder = tempfile::tempdir().unwrap();
    say(
        folder.path(),
        &[
            (
                "collide a.obj b.obj --threshold 1 --pairs edge-trinagle",
                "unknown value of `--pairs` `edge-trinagle`, did you mean `edge-triangle`?; known: vertex-vertex, ",
            ),
            (
                "collide a.obj b.obj --threshold 1 --up w",
                "unknown value of `--up` `w`; known: x, y, z",
            ),
            (
                "completions zhs",
                "unknown shell `zhs`, did you mean `zsh`?; known: bash, ",
            ),
            (
                "run cec2006 --set problem=g7",
                "unknown value of `problem` `g7`; known: ",
            ),
            (
                "bench regret --engines portfolo",
                "unknown engine `portfolo`, did you mean `portfolio`?; known: ",
            ),
        ],
    );
}

#[test]
fn files_of_problems_that_are_missing_are_told() {
    let folder = tempfile::tempdir().unwrap();
    say(
        folder.path(),
        &[
            (
                "run cec2013 --set problem=12",
                "data is missing: problem 12 needs the folder `data` of https://github.com/mikeagn/CEC2013; set data=DIR",
            ),
            (
                "run sat --set file=nosuch.cnf",
                "error: cannot read nosuch.cnf: No such file or directory",
            ),
            (
                "verify nosuch.json",
                "cannot read nosuch.json: name a report that `run --json` or `collide --json` wrote: No such file",
            ),
        ],
    );
}

#[test]
fn a_body_that_is_not_there_gets_a_number_and_a_name() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["a.obj", "b.obj"] {
        fs::write(folder.path().join(name), TRIANGLE).unwrap();
    }
    say(
        folder.path(),
        &[(
            "collide a.obj b.obj --threshold 1 --at X:0,0,5",
            "--at X: there is no such body: give a number from 0 to 1, or a name such as a",
        )],
    );
}

#[test]
fn times_of_animations_begin_at_zero() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.obj"), TRIANGLE).unwrap();
    say(
        folder.path(),
        &[(
            "collide a.obj --self --threshold 1 --from=-1s --to 1s",
            "-1s: an animation begins at 0s",
        )],
    );
}
