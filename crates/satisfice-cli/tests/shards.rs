//! `bench --shard` and `bench merge`.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::path::Path;

use common::{error_in, satisfice_in};
use serde_json::Value;

const SUITE: &str = r#"
    seeds = "0..5"
    [[part]]
    name = "roots"
    engines = ["random", "descent-flood"]
    problems = [{ name = "teapots", samples = 300, delta = [0.03, 0.06] }]
    evaluations = 2000
    at-evaluations = [1000, 2000]
"#;

fn place() -> tempfile::TempDir {
    let place = tempfile::tempdir().unwrap();
    fs::write(place.path().join("mine.toml"), SUITE).unwrap();
    place
}

fn run(folder: &Path, arguments: &str) {
    let done = satisfice_in(folder, arguments);
    assert_eq!(done.code, 0, "{arguments}: {}", done.stderr);
}

/// The rows of a folder without what differs from run to run, in the order of the plan or sorted.
fn rows(folder: &Path) -> Vec<String> {
    let text = fs::read_to_string(folder.join("results.jsonl")).unwrap();
    let row = |line: &str| {
        let mut row: Value = serde_json::from_str(line).unwrap();
        let kept = row.as_object_mut().unwrap();
        for key in ["checksum", "elapsed_seconds", "overshoot_seconds"] {
            kept.remove(key);
        }
        for moment in row["curve"].as_array_mut().unwrap() {
            moment[1] = 0.into();
        }
        row.to_string()
    };
    text.lines().map(row).collect()
}

#[test]
fn shards_together_are_the_whole_sweep() {
    let place = place();
    let folder = place.path();
    run(folder, "bench mine.toml --jobs 2 --out whole");
    for shard in [2, 1, 3] {
        run(
            folder,
            &format!("bench mine.toml --jobs 2 --shard {shard}/3 --out part-{shard}"),
        );
    }
    // Once more: nothing is left to be run.
    let again = satisfice_in(folder, "bench mine.toml --jobs 2 --shard 2/3 --out part-2");
    assert!(again.stderr.contains("7 of 7 runs"), "{}", again.stderr);
    run(folder, "bench merge part-3 part-1 part-2 --out merged");

    let parts = [1, 2, 3].map(|shard| rows(&folder.join(format!("part-{shard}"))));
    assert_eq!(parts.each_ref().map(Vec::len), [7, 7, 6]);
    let mut all = parts.concat();
    let mut whole = rows(&folder.join("whole"));
    let mut merged = rows(&folder.join("merged"));
    for rows in [&mut all, &mut whole, &mut merged] {
        rows.sort();
    }
    assert!(all == whole && merged == whole);
    let read = |name: &str| fs::read_to_string(folder.join(name).join("summary.json")).unwrap();
    assert_eq!(read("merged"), read("whole"));
    assert!(folder.join("merged/report.html").exists());
}

#[test]
fn gaps_and_overlaps_are_refused_by_name() {
    let place = place();
    let folder = place.path();
    for shard in [1, 2] {
        run(
            folder,
            &format!("bench mine.toml --seeds 0..2 --shard {shard}/2 --out part-{shard}"),
        );
    }
    let refused = |arguments: &str, says: &str| {
        let error = error_in(folder, arguments);
        assert!(error.contains(says), "{arguments}: {error}");
    };
    refused("bench merge part-1 --out m", "missing shards: 2/2");
    refused("bench merge part-1 part-1 --out m", "part-1");
    refused(
        "bench merge part-1 whole --out m",
        "name folders that `bench --shard` wrote",
    );
    refused("bench mine.toml --shard 3/2 --out m", "3/2 is no shard");
    refused(
        "bench mine.toml --seeds 0..2 --shard 2/2 --out part-1",
        "choose another folder",
    );

    run(folder, "bench mine.toml --seeds 0..3 --shard 2/2 --out other");
    refused(
        "bench merge part-1 other --out m",
        "its seeds, engines, problems or budgets",
    );
    run(folder, "bench mine.toml --seeds 0..2 --shard 2/3 --out third");
    refused("bench merge part-1 third --out m", "it is shard 2/3");

    let file = folder.join("part-2/results.jsonl");
    let (one, two) = (
        fs::read_to_string(folder.join("part-1/results.jsonl")).unwrap(),
        fs::read_to_string(&file).unwrap(),
    );
    fs::write(
        &file,
        two.lines()
            .skip(1)
            .map(|line| format!("{line}\n"))
            .collect::<String>(),
    )
    .unwrap();
    refused("bench merge part-1 part-2 --out m", "shard 2/2 lacks");
    fs::write(&file, format!("{two}{}\n", one.lines().next().unwrap())).unwrap();
    refused(
        "bench merge part-1 part-2 --out m",
        "does not belong to shard 2/2",
    );
    fs::write(&file, two).unwrap();
    run(folder, "bench merge part-1 part-2 --out m");
    refused("bench merge part-1 part-2 --out m", "has runs already");
}
