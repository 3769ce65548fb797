//! Continuous collision: time and error of queries, frames, first impacts and deadlines.
//!
//! `cargo bench --bench continuous` runs everything and writes `docs/results/continuous.md`; started as a test it runs a little of it on
//! generated scenes and writes nothing. `SATISFICE_DATA` names a folder with `cloth_ball92.ply`, `cloth_ball93.ply` and `ccd/` (queries with
//! exact answers), `SATISFICE_PYTHON` an interpreter with `ipctk`, which `peers.py` beside this file then measures. A word
//! after `--` runs the parts whose names contain it, and writes nothing.

#[path = "../machine.rs"]
mod machine;
#[path = "../page.rs"]
mod page;

mod data;
mod deadline;
mod families;
mod frames;
mod queries;

use std::path::PathBuf;
use std::process::Command;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&String> = arguments
        .iter()
        .filter(|argument| !argument.starts_with("--"))
        .collect();
    let mut report = Report {
        full: arguments.iter().any(|argument| argument == "--bench"),
        text: String::new(),
    };
    report.line("# Continuous collision: time and error");
    report.line("");
    report.line(&machine::line());
    report.line("");
    report.line(INTRODUCTION);
    let parts: [(&str, Part); 4] = [
        ("queries", queries::run),
        ("frames", frames::run),
        ("deadline", deadline::run),
        ("peers", peers),
    ];
    for (name, run) in parts {
        if words.iter().all(|word| name.contains(word.as_str())) {
            run(&mut report);
        }
    }
    if report.full && words.is_empty() {
        report.save();
    }
}

const INTRODUCTION: &str = "One thread unless a row says otherwise. A time a query is the mean over the queries of a row; the largest is the \
    least of five runs of the slowest query, in processor time. Other times are medians of runs in turns. *Integers* counts the queries that floating point \
    leaves open. Written by `cargo bench --bench continuous`.";

/// Measures a part of the report.
type Part = fn(&mut Report);

/// What is printed, and kept for the file.
pub(crate) struct Report {
    /// Whether everything is measured.
    pub(crate) full: bool,
    text: String,
}

impl Report {
    pub(crate) fn line(&mut self, line: &str) {
        println!("{line}");
        self.text.push_str(line);
        self.text.push('\n');
    }

    pub(crate) fn heading(&mut self, title: &str) {
        self.line(&format!("\n## {title}\n"));
    }

    fn save(&self) {
        page::save("continuous.md", &self.text);
    }
}

/// The interpreter with the peer, if it is named.
pub(crate) fn python() -> Option<PathBuf> {
    std::env::var_os("SATISFICE_PYTHON").map(PathBuf::from)
}

/// What the script of the peer prints, asked for one of its parts.
pub(crate) fn ask_peer(part: &str) -> Option<String> {
    let script = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("continuous/peers.py");
    let run = Command::new(python()?)
        .arg(script)
        .arg(data::folder()?)
        .arg(part)
        .output();
    let output = match run {
        Ok(output) if output.status.success() => output,
        Ok(output) => {
            eprintln!("peers.py {part}: {}", String::from_utf8_lossy(&output.stderr));
            return None;
        }
        Err(error) => {
            eprintln!("peers.py {part}: {error}");
            return None;
        }
    };
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

fn peers(report: &mut Report) {
    if !report.full {
        return;
    }
    report.heading("The same by ipctk");
    let parts = ["version", "queries", "candidates"].map(ask_peer);
    let [Some(version), Some(queries), Some(candidates)] = parts else {
        report.line("Not measured: `SATISFICE_DATA` or `SATISFICE_PYTHON` is not set.");
        return;
    };
    report.line(&format!(
        "ipctk {}, processor time of one thread; the cost of a call from Python, measured on features that are far apart, is subtracted. TI is \
         Tight Inclusion, ACCD additive CCD; \"tuned\" is a conservative rescaling of 0.9999999.\n",
        version.trim()
    ));
    report.line(queries.trim_end());
    report.line("\nWhole frames: the broad phase, and the narrow phase from a sample of its candidates.\n");
    report.line(candidates.trim_end());
}
