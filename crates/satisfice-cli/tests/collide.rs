//! `collide`, as a user calls it.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;

use common::{error_in, satisfice_in};
use serde_json::{Value, json};
use tempfile::TempDir;

/// A folder with meshes, good and bad.
fn meshes() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [
        ("triangle.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("above.obj", "v 0 0 0.25\nv 1 0 0.75\nv 0 1 0.25\nf 1 2 3\n"),
        ("points.obj", "v 0 0 0\nv 3 4 0\np 1 2\n"),
        ("nan.obj", "v 0 0 0\nv 1 nan 0\n"),
        ("inf.obj", "v 0 0 0\nv 1 0 1e999\n"),
        ("index.obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n"),
        ("empty.obj", "# nothing\n"),
        ("mesh.stp", "solid\n"),
        ("broken.ply", "ply\nformat ascii 1.0\nelement vertex 2\n"),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

fn report(folder: &TempDir, arguments: &str) -> Value {
    let done = satisfice_in(folder.path(), &format!("{arguments} --json -"));
    assert!(done.code <= 1, "{arguments}: {}", done.stderr);
    serde_json::from_str(&done.stdout).unwrap()
}

#[test]
fn single_triangles_collide() {
    let folder = meshes();
    let report = report(&folder, "collide triangle.obj above.obj --threshold 0.5");
    let pair =
        |i: u32| json!({"a": {"body": 0, "feature": i}, "b": {"body": 1, "feature": i}, "distance": 0.25});
    assert_eq!(report["pairs"], json!([pair(0), pair(2)]));
    assert_eq!(
        (&report["completeness"], &report["hits"]),
        (&"Proved".into(), &2.into())
    );
    assert_eq!(
        (&report["evaluations"], &report["unseen_estimate"]),
        (&9.into(), &0.0.into())
    );
    // Strictly closer than the threshold.
    let done = satisfice_in(folder.path(), "collide triangle.obj above.obj --threshold 0.25");
    assert_eq!((done.code, done.stderr.as_str()), (1, ""));
    assert!(
        done.stdout.contains("hits          0 of 0") && done.stdout.contains("proved"),
        "{}",
        done.stdout
    );
}

#[test]
fn pairs_within_a_body_leave_out_its_edges() {
    let folder = meshes();
    let alone = report(&folder, "collide triangle.obj --self --threshold 9");
    assert_eq!(
        (&alone["hits"], &alone["skipped"]),
        (&0.into(), &json!({"vertices of one body that an edge joins": 3}))
    );
    let points = report(&folder, "collide points.obj --self --threshold 5.1");
    assert_eq!(
        points["pairs"],
        json!([{"a": {"body": 0, "feature": 0}, "b": {"body": 0, "feature": 1}, "distance": 5.0}])
    );
    // Three bodies: three pairs of bodies, and three bodies with themselves.
    let three = report(
        &folder,
        "collide triangle.obj above.obj points.obj --self --threshold 100",
    );
    assert_eq!(three["hits"], 9 + 6 + 6 + 1);
    assert_eq!(three["evaluations"], 9 + 6 + 6 + 1);
}

#[test]
fn engines_find_what_the_exact_method_finds() {
    let folder = meshes();
    let sorted = |report: &Value| {
        let mut pairs: Vec<_> = report["pairs"]
            .as_array()
            .unwrap()
            .iter()
            .map(Value::to_string)
            .collect();
        pairs.sort_unstable();
        pairs
    };
    let scene = "collide triangle.obj above.obj points.obj --self --threshold 1.1";
    let exact = report(&folder, scene);
    let random = report(
        &folder,
        &format!("{scene} --method random --evaluations 6000 --seed 4"),
    );
    assert_eq!(sorted(&random), sorted(&exact));
    assert_eq!(
        (
            &random["reference_hits"],
            &random["completeness"],
            &random["evaluations"]
        ),
        (&exact["hits"], &"Unknown".into(), &6000.into())
    );
    let few = report(&folder, &format!("{scene} --method random --hits 2 --time 1min"));
    assert_eq!((&few["hits"], &few["stop_reason"]), (&2.into(), &"Hits".into()));
}

#[test]
fn reports_are_verified_and_pairs_written_as_csv() {
    let folder = meshes();
    for method in ["exact", "random --evaluations 500"] {
        let scene = "collide triangle.obj above.obj --self --threshold 0.9";
        let done = satisfice_in(
            folder.path(),
            &format!("{scene} --method {method} --json report.json --out pairs.csv"),
        );
        assert_eq!((done.code, done.stderr.as_str()), (0, ""), "{method}");
        let csv = fs::read_to_string(folder.path().join("pairs.csv")).unwrap();
        assert!(
            csv.starts_with("a_body,a_feature,b_body,b_feature,distance\n"),
            "{csv}"
        );
        assert!(
            csv.contains("\n0,0,1,0,0.25\n") && csv.contains("\n0,1,1,1,0.75\n"),
            "{csv}"
        );
        assert_eq!(csv.lines().count(), 4);

        let verify = || satisfice_in(folder.path(), "verify report.json");
        assert_eq!(verify().code, 0, "{}", verify().stdout);
        let path = folder.path().join("report.json");
        let report: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
        type Change = fn(&mut Value);
        let changes: [(&str, Change); 4] = [
            ("pairs[0]", |r| r["pairs"][0]["distance"] = 0.1.into()),
            ("solutions[0].fitness", |r| {
                r["solutions"][0]["fitness"] = 0.1.into();
            }),
            ("solutions[1].solution", |r| {
                r["solutions"][1]["solution"]["b"]["feature"] = 77.into();
            }),
            ("solutions[1].solution", |r| {
                r["solutions"][1]["solution"] = r["solutions"][0]["solution"].clone();
            }),
        ];
        for (place, change) in changes {
            let mut false_one = report.clone();
            change(&mut false_one);
            fs::write(&path, false_one.to_string()).unwrap();
            assert_eq!(verify().code, 1, "{place}");
            assert!(
                verify().stdout.contains(&format!("\n  {place}: ")),
                "{place}: {}",
                verify().stdout
            );
        }
    }
}

#[test]
fn mistakes_are_told_in_one_line() {
    let folder = meshes();
    let lines: Vec<String> = [
        "collide",
        "collide triangle.obj --threshold 1",
        "collide triangle.obj above.obj",
        "collide triangle.obj above.obj --threshold 0",
        "collide triangle.obj above.obj --threshold -1",
        "collide triangle.obj above.obj --threshold NaN",
        "collide triangle.obj above.obj --threshold 1 --pairs edge-edge",
        "collide triangle.obj above.obj --threshold 1 --time 1s",
        "collide triangle.obj above.obj --threshold 1 --method qpso --engine-set particle=3",
        "collide triangle.obj none.obj --threshold 1",
        "collide triangle.obj nan.obj --threshold 1",
        "collide triangle.obj inf.obj --threshold 1",
        "collide triangle.obj index.obj --threshold 1",
        "collide triangle.obj empty.obj --threshold 1",
        "collide triangle.obj mesh.stp --threshold 1",
        "collide triangle.obj broken.ply --threshold 1",
        "collide triangle.obj above.obj --threshold 1 --out no/such/folder/pairs.csv",
    ]
    .iter()
    .map(|arguments| {
        format!(
            "satisfice {arguments}\n    {}",
            error_in(folder.path(), arguments)
        )
    })
    .collect();
    insta::assert_snapshot!("collide_mistakes", lines.join("\n"));
    let line = error_in(
        folder.path(),
        "collide triangle.obj above.obj --threshold 1 --method exat",
    );
    assert!(
        line.starts_with("error: unknown method `exat`, did you mean `exact`?; known: exact, "),
        "{line}"
    );
}
