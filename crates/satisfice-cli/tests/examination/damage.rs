//! Flipped bits in checkpoints and results: refused, or without any effect.

use std::fs;

use satisfice::SearchRng;

use crate::extent::{cases, figure};
use crate::process::{command, run, without_times};

#[test]
fn a_flipped_bit_in_a_checkpoint_is_refused_or_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let begun = [
        "run",
        "queens",
        "--set",
        "n=6",
        "--evaluations",
        "3000",
        "--slices",
        "2",
        "--checkpoint",
        "c.json",
        "--hits",
        "3",
    ];
    assert!(
        command(place, &begun)
            .output()
            .unwrap()
            .status
            .code()
            .is_some_and(|code| code < 2)
    );
    let resume = ["run", "queens", "--resume", "c.json", "--json", "-"];
    let expected = run(place, &resume);
    assert!(expected.fault().is_none(), "{expected:?}");
    let whole = fs::read(place.join("c.json")).unwrap();
    let count = cases(60, 2_000);
    let (mut refused, mut wrong) = (0, Vec::new());
    for case in 0..count {
        let mut rng = SearchRng::new(case);
        let mut bytes = whole.clone();
        let at = rng.below(bytes.len());
        bytes[at] ^= 1 << rng.below(7);
        fs::write(place.join("c.json"), &bytes).unwrap();
        let outcome = run(place, &resume);
        if let Some(fault) = outcome.fault() {
            wrong.push(format!("case {case}, byte {at}: {fault}"));
        } else if outcome.code == Some(2) {
            refused += 1;
        } else if result(&outcome.stdout) != result(&expected.stdout) {
            let around = String::from_utf8_lossy(&bytes[at.saturating_sub(40)..(at + 40).min(bytes.len())])
                .into_owned();
            wrong.push(format!(
                "case {case}, byte {at}: accepted, another report; around it: {around}"
            ));
        }
    }
    figure(
        "flipped bits in a checkpoint",
        format!("{count}: {refused} refused, the others without effect"),
    );
    assert!(
        wrong.is_empty(),
        "{} of {count}:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

/// What a report says, times aside.
fn result(stdout: &[u8]) -> serde_json::Value {
    without_times(serde_json::from_slice(stdout).unwrap())
}

#[test]
fn a_line_cut_inside_a_character_is_dropped_and_run_again() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    let suite = "title = \"ü\"\nseeds = \"0..3\"\n[[part]]\nname = \"größe\"\nengines = [\"random\"]\nproblems = [\"queens\"]\nevaluations = 50\n";
    fs::write(place.join("s.toml"), suite).unwrap();
    let bench = ["bench", "s.toml", "--out", "out"];
    assert_eq!(command(place, &bench).output().unwrap().status.code(), Some(0));
    let results = place.join("out").join("results.jsonl");
    let whole = fs::read(&results).unwrap();
    let inside = whole.windows(2).rposition(|two| two == "ö".as_bytes()).unwrap() + 1;
    fs::write(&results, &whole[..inside]).unwrap();
    let again = command(place, &bench).output().unwrap();
    assert_eq!(
        again.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&again.stderr)
    );
    let lines = fs::read_to_string(&results).unwrap().lines().count();
    assert_eq!(lines, whole.iter().filter(|&&byte| byte == b'\n').count());
}
