//! `verify` of reports of `run` that were true and then altered.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::collections::BTreeSet;
use std::fs;

use common::{refuse, satisfice_in, verify};
use serde_json::{Value, json};

#[test]
fn one_slice_of_an_engine_with_sources() {
    let folder = tempfile::tempdir().unwrap();
    let report = refuse(
        folder.path(),
        "run queens --set n=8 --evaluations 5000",
        &[
            ("/engine", "engine", json!("nonsense")),
            ("/engine_parameters", "engine_parameters", json!({})),
            ("/probes", "probes", json!(1_000_000)),
            ("/verified", "verified", json!(1_000_000)),
            ("/unseen_estimate", "unseen_estimate", json!(1e6)),
            ("/probe_hits", "probe_hits", json!([1_000_000, 0])),
            ("/stop_reason", "stop_reason", json!("Covered")),
            ("/stop_reason", "stop_reason", json!("Time")),
            ("/stop_reason", "stop_reason", json!("Hits")),
            ("/completeness", "stop_reason", json!("Proved")),
            (
                "/sources/rows/3/evaluations",
                "sources.rows[3].evaluations",
                json!(9999),
            ),
            ("/sources/rows/3/hits/0", "sources.rows[3].hits", json!(999)),
            ("/sources/rows/3/proposed", "sources.rows[3].proposed", json!([1])),
        ],
    );
    // Without a probe that hit anything new, nothing speaks for more hits.
    let mut more = report;
    more["probe_hits"] = json!([0, 0]);
    more["unseen_estimate"] = json!(1000.0);
    more["unseen_interval"] = json!([900.0, 1100.0]);
    let done = verify(folder.path(), &more);
    assert!(
        done.code == 1 && done.stdout.contains("\n  unseen_estimate: "),
        "{}",
        done.stdout
    );
}

#[test]
fn slices_add_up() {
    let folder = tempfile::tempdir().unwrap();
    refuse(
        folder.path(),
        "run roots --evaluations 3000 --slices 3",
        &[
            ("/slices", "slices", json!([])),
            ("/slices/0/hits", "slices[0].hits", json!(5000)),
            ("/slices/0/hits", "slices[0].hits", json!(0)),
            ("/slices/1/new_hits", "slices[1].new_hits", json!(5000)),
            ("/slices/1/probes", "probes", json!(2999)),
            ("/slices/1/non_finite", "non_finite", json!(1)),
            ("/slices/1/bound_calls", "bound_calls", json!(7)),
            (
                "/slices/2/stop_reason",
                "slices[2].stop_reason",
                json!("Patience"),
            ),
            ("/slices/2/elapsed_seconds", "elapsed_seconds", json!(99.0)),
        ],
    );
}

/// Every engine, islands, bounds and early ends give reports that are believed.
#[test]
fn true_reports_are_believed() {
    let folder = tempfile::tempdir().unwrap();
    let engines = satisfice::engine::all()
        .iter()
        .map(|engine| format!("queens --set n=6 --engine {}", engine.name));
    let others = [
        "queens --set n=4 --evaluations 100000",
        "rastrigin --engine branch-and-bound --evaluations 500",
        "hartmann-6 --islands 3 --slices 2",
        "branin --hits 5 --slices 4",
        "roots --patience 50",
        "periodic-points --slices 3 --islands 2",
        "small-regions --time 20ms --slices 2",
    ];
    for call in engines.chain(others.map(str::to_owned)) {
        let limit = ["--evaluations", "--time"]
            .iter()
            .all(|limit| !call.contains(limit));
        let limit = if limit { " --evaluations 200" } else { "" };
        refuse(folder.path(), &format!("run {call}{limit}"), &[]);
    }
}

/// Every key of this and below, except of what users name.
fn keys(of: &Value, all: &mut BTreeSet<String>) {
    match of {
        Value::Object(entries) => {
            for (key, value) in entries {
                all.insert(key.clone());
                let users = ["problem_parameters", "engine_parameters", "skipped", "solution"];
                if !users.contains(&key.as_str()) {
                    keys(value, all);
                }
            }
        }
        Value::Array(values) => values.iter().for_each(|value| keys(value, all)),
        _ => {}
    }
}

#[test]
fn every_key_is_explained() {
    let folder = tempfile::tempdir().unwrap();
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
    let faces = "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
    for (name, x) in [("here.obj", 0), ("there.obj", 3)] {
        let moved = corners
            .replace("v 0", &format!("v {x}"))
            .replace("v 1", &format!("v {}", x + 1));
        fs::write(folder.path().join(name), moved + faces).unwrap();
    }
    let page = include_str!("../../../docs/json.md");
    let mut all = BTreeSet::new();
    for call in [
        "run queens --set n=5 --evaluations 2000 --probes 0.1 --slices 2 --patience 500 --parallel 2",
        "collide here.obj here.obj --threshold 0.5 --solid --witnesses --pairs edge-edge",
        "collide here.obj here.obj --threshold 0.5 --method random --evaluations 300",
        "collide --from here.obj there.obj --to here.obj here.obj --threshold 0",
    ] {
        let done = satisfice_in(folder.path(), &format!("{call} --json -"));
        assert_eq!(done.code, 0, "{call}: {}", done.stderr);
        keys(&serde_json::from_str(&done.stdout).unwrap(), &mut all);
    }
    assert!(all.len() > 70, "{}", all.len());
    let unknown: Vec<_> = all
        .iter()
        .filter(|key| !page.contains(&format!("`{key}`")))
        .collect();
    assert!(unknown.is_empty(), "not in docs/json.md: {unknown:?}");
}
