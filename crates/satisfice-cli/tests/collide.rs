//! `collide`, as a user calls it.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;

use common::{command, error_in, satisfice_in};
use satisfice_collision::{Placement, generate, io};
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

/// The pairs of a report with their distances, in an order of their own.
fn sorted(report: &Value) -> Vec<String> {
    let plain = |pair: &Value| json!([pair["a"], pair["b"], pair["distance"]]).to_string();
    let mut pairs: Vec<_> = pairs(report).iter().map(plain).collect();
    pairs.sort_unstable();
    pairs
}

fn pairs(report: &Value) -> &Vec<Value> {
    report["pairs"].as_array().unwrap()
}

/// Whether every pair of one report is one of the other.
fn assert_part(of: &Value, part: &Value) {
    assert!(pairs(part).iter().all(|pair| pairs(of).contains(pair)));
}

fn assert_verified(folder: &TempDir, report: &Value, call: &str) {
    fs::write(folder.path().join("report.json"), report.to_string()).unwrap();
    let verified = satisfice_in(folder.path(), "verify report.json");
    assert_eq!(verified.code, 0, "{call}: {}", verified.stdout);
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
        (&2.into(), &0.0.into()),
        "a distance for each pair; the others are decided by bounds"
    );
    assert_eq!(report["touching"], json!([[0, 1]]));
    // Strictly closer than the threshold.
    let done = satisfice_in(folder.path(), "collide triangle.obj above.obj --threshold 0.25");
    assert_eq!((done.code, done.stderr.as_str()), (1, ""));
    assert!(
        done.stdout.contains("  pairs         0\n") && done.stdout.contains("proved"),
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
        (&0.into(), &json!({"pairs of mesh neighbours": 3}))
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
    let few = report(
        &folder,
        &format!("{scene} --method random --hits 2 --time 1min --reference"),
    );
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
        let changes: [(&str, Change); 5] = [
            ("pairs[0]", |r| r["pairs"][0]["distance"] = 0.1.into()),
            ("pairs[1]", |r| r["pairs"][1]["b"]["feature"] = 77.into()),
            ("pairs[1]", |r| r["pairs"][1] = r["pairs"][0].clone()),
            ("hits", |r| r["hits"] = 4.into()),
            ("touching", |r| r["touching"] = json!([[0, 0]])),
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

/// Two balls that cross, and a pleated cloth.
fn bodies() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let ball = generate::icosphere(1.0, 2).unwrap();
    let turned = Placement::from_axis_angle([1.0, 2.0, 3.0], 0.7).unwrap();
    let other = turned.moved([1.75, 0.1, 0.2]).unwrap().place(&ball).unwrap();
    let far = Placement::from_translation([9.0, 0.0, 0.0])
        .unwrap()
        .place(&ball)
        .unwrap();
    let cloth = generate::pleats(31, 9, 3, 0.1, 0.2).unwrap();
    for (name, mesh) in [
        ("a.obj", &ball),
        ("b.obj", &other),
        ("far.obj", &far),
        ("cloth.obj", &cloth),
    ] {
        io::save_obj(mesh, folder.path().join(name)).unwrap();
    }
    folder
}

/// Every exact method, a search through bounds, and the check of the report by brute force.
#[test]
fn every_kind_of_pair_by_every_method() {
    let folder = bodies();
    for kind in [
        "vertex-vertex",
        "vertex-edge",
        "vertex-triangle",
        "edge-edge",
        "edge-triangle",
        "triangle-triangle",
    ] {
        for scene in [
            "a.obj b.obj far.obj",
            "cloth.obj --self",
            "a.obj cloth.obj --self --ring-width 2",
        ] {
            let call = format!("collide {scene} --threshold 0.12 --pairs {kind}");
            let exact = report(&folder, &call);
            assert!(exact["hits"].as_u64() > Some(0), "{call}");
            assert_eq!(exact["completeness"], "Proved");
            for method in [
                "tree",
                "brute-force",
                "exact --threads 2",
                "branch-and-bound --evaluations 1e7",
            ] {
                let other = report(&folder, &format!("{call} --method {method}"));
                assert_eq!(sorted(&other), sorted(&exact), "{call} --method {method}");
                assert_eq!(
                    (&other["recall"], &other["completeness"]),
                    (&1.0.into(), &"Proved".into())
                );
            }
            assert_verified(&folder, &exact, &call);
        }
    }
}

#[test]
fn less_than_all_pairs_may_be_asked_for() {
    let folder = bodies();
    let scene = "collide a.obj b.obj far.obj cloth.obj --threshold 0.12 --pairs edge-edge";
    let all = report(&folder, scene);
    let distances = |report: &Value| -> Vec<f64> {
        pairs(report)
            .iter()
            .map(|pair| pair["distance"].as_f64().unwrap())
            .collect()
    };
    let mut sorted = distances(&all);
    sorted.sort_by(f64::total_cmp);
    let closest = report(&folder, &format!("{scene} --closest 5"));
    assert_eq!(distances(&closest), sorted[..5]);
    assert_eq!(
        (&closest["completeness"], &closest["stop_reason"]),
        (&"Unknown".into(), &"Hits".into())
    );
    let more = report(&folder, &format!("{scene} --closest 1e6"));
    assert_eq!(
        (&more["hits"], &more["completeness"]),
        (&all["hits"], &"Proved".into())
    );
    let touching = report(&folder, &format!("{scene} --touching"));
    assert_eq!(touching["touching"], all["touching"]);
    assert_eq!(touching["hits"], all["touching"].as_array().unwrap().len());
    let first = report(&folder, &format!("{scene} --first"));
    assert_eq!(first["hits"], 1);
    for listed in [&closest, &touching, &first] {
        assert_part(&all, listed);
        assert_verified(&folder, listed, scene);
    }
    let none = report(&folder, "collide a.obj far.obj --threshold 0.1 --touching");
    assert_eq!(
        (&none["hits"], &none["completeness"]),
        (&0.into(), &"Proved".into())
    );
    // Edges are named by their ends, since files do not number them.
    assert!(all["pairs"][0]["a"]["vertices"].is_array());
}

#[test]
fn limits_keep_what_was_found() {
    let folder = bodies();
    let scene = "collide a.obj b.obj --threshold 1 --pairs triangle-triangle";
    let all = report(&folder, scene);
    let few = report(&folder, &format!("{scene} --hits 7"));
    assert_eq!(
        (
            &few["hits"],
            &few["stop_reason"],
            &few["completeness"],
            &few["recall"]
        ),
        (&7.into(), &"Hits".into(), &"Unknown".into(), &Value::Null)
    );
    assert_part(&all, &few);
    let enough = report(&folder, &format!("{scene} --hits 1e9 --time 1h"));
    assert_eq!(
        (&enough["pairs"], &enough["completeness"]),
        (&all["pairs"], &"Proved".into())
    );
    for method in ["exact", "tree", "brute-force"] {
        let none = satisfice_in(folder.path(), &format!("{scene} --method {method} --time 1ns"));
        assert!(none.code <= 1, "{}", none.stderr);
        assert!(none.stdout.contains("stopped by time") && none.stdout.contains("unknown"));
    }
}

/// Each takes seconds if not interrupted.
#[test]
fn an_interrupted_enumeration_keeps_its_pairs() {
    let folder = tempfile::tempdir().unwrap();
    let ball = generate::icosphere(1.0, 5).unwrap();
    io::save_obj(&ball, folder.path().join("ball.obj")).unwrap();
    for how in [
        "--pairs triangle-triangle",
        "--pairs triangle-triangle --method brute-force",
        "--pairs edge-edge --method brute-force --threads 2",
        "--method grid",
    ] {
        let call = format!("collide ball.obj ball.obj --threshold 1 {how} --json report.json");
        let mut child = command(folder.path(), &call)
            .stdout(std::process::Stdio::null())
            .stderr(std::process::Stdio::null())
            .spawn()
            .unwrap();
        let partial = |entry: fs::DirEntry| entry.file_name().to_string_lossy().ends_with(".partial");
        let begun = || {
            fs::read_dir(folder.path())
                .unwrap()
                .any(|entry| partial(entry.unwrap()))
        };
        // Ctrl-C is listened to before the place of the report is open.
        while !begun() {
            std::thread::yield_now();
        }
        let pid = child.id().to_string();
        let kill = std::process::Command::new("kill")
            .args(["-s", "INT", &pid])
            .status();
        assert!(kill.unwrap().success());
        let code = child.wait().unwrap().code();
        let path = folder.path().join("report.json");
        let report: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
        assert_eq!(
            (&report["stop_reason"], &report["completeness"]),
            (&"Cancelled".into(), &"Unknown".into()),
            "{how}"
        );
        assert_eq!(code, Some(i32::from(report["hits"] == 0)));
        assert_eq!(report["hits"], pairs(&report).len());
        fs::remove_file(path).unwrap();
    }
}

#[test]
fn a_picture_is_drawn() {
    let folder = bodies();
    for method in ["exact", "random --evaluations 2000"] {
        let done = satisfice_in(
            folder.path(),
            &format!(
                "collide a.obj b.obj --threshold 0.12 --pairs vertex-triangle --method {method} --picture scene.png"
            ),
        );
        assert!(done.code <= 1, "{}", done.stderr);
        let path = folder.path().join("scene.png");
        assert_eq!(&fs::read(&path).unwrap()[1..4], b"PNG");
        fs::remove_file(path).unwrap();
    }
}

/// What a page shows is tested with the pages; here, that every kind of answer becomes one, whatever bodies are called.
#[test]
fn a_page_is_written() {
    let folder = bodies();
    let hostile = "<script>alert(1)<script>.obj";
    fs::copy(folder.path().join("b.obj"), folder.path().join(hostile)).unwrap();
    for arguments in [
        "b.obj --pairs vertex-triangle --page -",
        "b.obj --pairs edge-edge --method random --evaluations 2000 --up z --page -",
        &format!("{hostile} --closest 3 --page -"),
    ] {
        let done = satisfice_in(
            folder.path(),
            &format!("collide a.obj --threshold 0.12 {arguments}"),
        );
        assert!(done.code <= 1, "{}", done.stderr);
        let text = &done.stdout;
        assert!(
            text.starts_with("<!DOCTYPE html>") && text.ends_with("</html>"),
            "{arguments}"
        );
        assert!(!text.contains("<script>alert"), "{arguments}");
    }
}

#[test]
fn slips_of_units_and_scale_are_warned_of() {
    let folder = bodies();
    for (name, scale, shift) in [
        ("millimetres.obj", 5000.0, 0.0),
        ("away.obj", 1.0, 1e6),
        ("lost.obj", 1.0, 1e13),
    ] {
        let ball = generate::icosphere(1.0, 1).unwrap();
        let moved = ball
            .vertices()
            .iter()
            .map(|&[x, y, z]| [scale * x + shift, scale * y, scale * z]);
        let mesh = ball.with_vertices(moved.collect()).unwrap();
        io::save_obj(&mesh, folder.path().join(name)).unwrap();
    }
    fs::write(folder.path().join("points.obj"), "v 0 0 0\nv 1 0 0\n").unwrap();
    let with_lines = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2\nl 2 3\n";
    fs::write(folder.path().join("lines.obj"), with_lines).unwrap();
    let lines: Vec<String> = [
        "collide a.obj b.obj --threshold 2.5",
        "collide a.obj millimetres.obj --threshold 0.1",
        "collide a.obj away.obj --threshold 0.1",
        "collide a.obj lost.obj --threshold 0.001",
        "collide a.obj points.obj --threshold 0.1 --pairs vertex-triangle",
        "collide a.obj lines.obj --threshold 0.1 --pairs triangle-triangle",
        "collide a.obj lines.obj --threshold 0.1",
        "collide a.obj b.obj --threshold 1e-320",
        "collide a.obj b.obj --threshold 0.1",
    ]
    .iter()
    .map(|arguments| {
        let done = satisfice_in(folder.path(), arguments);
        assert!(done.code <= 1, "{arguments}: {}", done.stderr);
        format!("satisfice {arguments}\n{}", done.stderr)
    })
    .collect();
    insta::assert_snapshot!("collide_warnings", lines.join(""));
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
        "collide triangle.obj above.obj --threshold 1 --pairs edge-edges",
        "collide triangle.obj above.obj --threshold 1 --evaluations 9",
        "collide triangle.obj above.obj --threshold 1 --prune",
        "collide triangle.obj above.obj --threshold 1 --reference",
        "collide triangle.obj above.obj --threshold 1 --method brute-force --hits 2",
        "collide triangle.obj above.obj --threshold 1 --method grid --pairs edge-edge",
        "collide triangle.obj above.obj --threshold 1 --method random --closest 3",
        "collide triangle.obj above.obj --threshold 1 --first --touching",
        "collide triangle.obj above.obj --threshold 1 --ring-width 2",
        "collide triangle.obj --self --threshold 1 --ring-width -2",
        "collide triangle.obj points.obj --threshold 1 --pairs triangle-triangle",
        "collide points.obj --self --threshold 1 --pairs edge-edge",
        "collide triangle.obj above.obj --threshold 1 --picture scene.jpg",
        "collide triangle.obj above.obj --threshold 1 --up x",
        "collide triangle.obj above.obj --threshold 1 --page scene.png",
        "collide triangle.obj above.obj --threshold 1 --picture scene.png --up w",
        "collide triangle.obj above.obj --threshold 1 --json - --out -",
        "collide triangle.obj above.obj --threshold 1 --method qpso --engine-set particle=3",
        "collide triangle.obj none.obj --threshold 1",
        "collide triangle.obj nan.obj --threshold 1",
        "collide triangle.obj inf.obj --threshold 1",
        "collide triangle.obj index.obj --threshold 1",
        "collide triangle.obj empty.obj --threshold 1",
        "collide triangle.obj mesh.stp --threshold 1",
        "collide . --self --threshold 1",
        "collide triangle.obj above.obj --threshold 1 --at triangle:0,0,nan",
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
