//! The extent of the examination (a short form for every test run, the full one on demand), and where the figures of the full one go.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::process::Command;
use std::sync::Mutex;

/// The page of the full examination.
const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/results/reliability.md");
const HEADING: &str = "# Reliability\n\n\
    What the standing examination found: each line is a test that fails on one panic, abort, half file or difference. Written by the \
    examination itself, a line when its test has passed:\n\n\
    ```text\n\
    SATISFICE_EXAMINE=full cargo test --release -p satisfice-cli --test examination\n\
    SATISFICE_EXAMINE=full cargo test --release -p satisfice --test library allocation\n\
    ```\n\n\
    A damaged file has one to four flipped bits, other bytes, cuts, repetitions or hostile words. On each, the command has to end within 10 s, after an \
    interrupt at the latest, with exit code 0, 1 or 2, in 1.5 GB of address space, and with one error line if it refuses the file.\n\n";

/// How the command was built.
const BUILD: &str = if cfg!(debug_assertions) { "dev" } else { "release" };

/// Whether the full examination was asked for.
pub(crate) fn is_full() -> bool {
    std::env::var("SATISFICE_EXAMINE").is_ok_and(|extent| extent == "full")
}

/// `short` cases, or `full` ones in the full examination.
pub(crate) fn cases(short: u64, full: u64) -> u64 {
    if is_full() { full } else { short }
}

/// Reports a figure of the examination: in the full one, as a line of the page.
pub(crate) fn figure(what: &str, value: impl core::fmt::Display) {
    static WRITING: Mutex<()> = Mutex::new(());
    println!("| {what} | {value} |");
    if !is_full() {
        return;
    }
    let _writing = WRITING.lock();
    let known = fs::read_to_string(PAGE).unwrap_or_default();
    let rows = known.lines().filter_map(|line| {
        let (what, rest) = line.strip_prefix("| ")?.split_once(" | ")?;
        let is_row = what != "examined";
        is_row.then(|| (what.to_owned(), rest.trim_end_matches(" |").to_owned()))
    });
    let mut rows: BTreeMap<String, String> = rows.collect();
    rows.insert(what.to_owned(), format!("{value} | {BUILD} | {}", day()));
    let mut page = format!("{HEADING}| examined | result | build | day |\n|---|---|---|---|\n");
    for (what, rest) in rows {
        let _ = writeln!(page, "| {what} | {rest} |");
    }
    fs::write(PAGE, page).unwrap();
}

fn day() -> String {
    let day = Command::new("date").arg("+%F").output();
    day.map(|day| String::from_utf8_lossy(&day.stdout).trim().to_owned())
        .unwrap_or_default()
}
