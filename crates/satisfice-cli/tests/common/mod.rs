//! Runs the command, for every test of it.

#![allow(dead_code, reason = "each test file makes use of a part")]

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// What the command did.
#[derive(Debug)]
pub(crate) struct Done {
    pub(crate) code: i32,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl From<Output> for Done {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code().unwrap_or(-1),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }
}

/// The command with these arguments, separated by spaces, in this folder.
pub(crate) fn command(folder: &Path, arguments: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_satisfice"));
    // the width of help
    command
        .args(arguments.split_whitespace())
        .current_dir(folder)
        .env_remove("COLUMNS");
    command
}

/// Runs the command to its end.
pub(crate) fn satisfice_in(folder: &Path, arguments: &str) -> Done {
    command(folder, arguments).output().unwrap().into()
}

/// The same in a folder that does not matter.
pub(crate) fn satisfice(arguments: &str) -> Done {
    satisfice_in(Path::new(env!("CARGO_MANIFEST_DIR")), arguments)
}

/// Runs the command, which has to fail with exit code 2 and one line on stderr; returns the line.
pub(crate) fn error_in(folder: &Path, arguments: &str) -> String {
    let done = satisfice_in(folder, arguments);
    assert_eq!(done.code, 2, "{arguments}: {done:?}");
    assert_eq!(done.stdout, "", "{arguments}");
    let line = done.stderr.strip_suffix('\n').unwrap_or_default();
    assert!(
        line.starts_with("error: ") && !line.contains('\n'),
        "{arguments}: {}",
        done.stderr
    );
    line.to_owned()
}

/// The same in a folder that does not matter.
pub(crate) fn error(arguments: &str) -> String {
    error_in(Path::new(env!("CARGO_MANIFEST_DIR")), arguments)
}

/// Runs the command, whose stdout has to be JSON.
pub(crate) fn report(arguments: &str) -> Value {
    let done = satisfice(arguments);
    assert!(done.code <= 1, "{arguments}: {}", done.stderr);
    serde_json::from_str(&done.stdout).unwrap()
}

/// Sets every time in a report to zero.
pub(crate) fn without_times(mut report: Value) -> Value {
    fn visit(value: &mut Value) {
        match value {
            Value::Object(map) => {
                for (key, value) in map {
                    if ["elapsed_seconds", "overshoot_seconds", "seconds"].contains(&key.as_str()) {
                        *value = 0.into();
                    } else {
                        visit(value);
                    }
                }
            }
            Value::Array(list) => list.iter_mut().for_each(visit),
            _ => {}
        }
    }
    visit(&mut report);
    report
}

/// What `verify` says of a report.
pub(crate) fn verify(folder: &Path, report: &Value) -> Done {
    std::fs::write(folder.join("report.json"), report.to_string()).unwrap();
    satisfice_in(folder, "verify report.json")
}

/// Makes a report, which has to be true, and changes a value of it at a time: each change has to be found where it was made.
pub(crate) fn refuse(folder: &Path, call: &str, changes: &[(&str, &str, Value)]) -> Value {
    let done = satisfice_in(folder, &format!("{call} --json -"));
    assert!(done.code <= 1, "{call}: {}", done.stderr);
    let report: Value = serde_json::from_str(&done.stdout).unwrap();
    let verified = verify(folder, &report);
    assert_eq!(verified.code, 0, "{call}: {}", verified.stdout);
    for (key, place, value) in changes {
        let mut altered = report.clone();
        let there = altered
            .pointer_mut(key)
            .unwrap_or_else(|| panic!("{call}: no {key}"));
        assert_ne!(there, value, "{call}: {key} is so already");
        *there = value.clone();
        let refused = verify(folder, &altered);
        assert!(
            refused.code == 1 && refused.stdout.contains(&format!("\n  {place}: ")),
            "{call}: {key} = {value}: {}",
            refused.stdout
        );
    }
    report
}

/// Writes a box between two corners as an OBJ file.
pub(crate) fn write_box(folder: &Path, name: &str, low: [f64; 3], high: [f64; 3]) {
    let corner = |i: usize| {
        let at = |k: usize| if i >> k & 1 == 1 { high[k] } else { low[k] };
        format!("v {} {} {}\n", at(0), at(1), at(2))
    };
    let corners: String = (0..8).map(corner).collect();
    let faces = "f 1 2 4 3\nf 5 6 8 7\nf 1 2 6 5\nf 3 4 8 7\nf 1 3 7 5\nf 2 4 8 6\n";
    std::fs::write(folder.join(name), corners + faces).unwrap();
}
