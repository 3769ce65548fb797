//! `verify` of reports of `collide` that were true and then altered.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;

use common::{refuse, verify};
use satisfice_collision::{Placement, generate, io};
use serde_json::json;
use tempfile::TempDir;

const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    f 1 3 2\nf 1 4 3\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\n";

fn meshes() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let wedge = |z: f64| format!("v 0 0 {z}\nv 2 0 {}\nv 0 2 {z}\nf 1 2 3\n", z + 0.5);
    for (name, text) in [
        ("cube.obj", CUBE.to_owned()),
        ("floor.obj", "v -1 -1 0\nv 3 -1 0\nv -1 3 0\nf 1 2 3\n".to_owned()),
        ("above.obj", wedge(1.25)),
        ("below.obj", wedge(0.25)),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

#[test]
fn all_pairs_and_what_follows_from_them() {
    let folder = meshes();
    refuse(
        folder.path(),
        "collide cube.obj floor.obj --threshold 0.3 --pairs edge-edge --witnesses",
        &[
            ("/threshold", "threshold", json!(30.0)),
            ("/recall", "recall", json!(7.0)),
            ("/unseen_estimate", "unseen_estimate", json!(1000.0)),
            ("/unseen_interval", "unseen_interval", json!([1000.0, 2000.0])),
            ("/unseen_method", "unseen_method", json!("Chao")),
            ("/reference_hits", "reference_hits", json!(1000)),
            ("/evaluations", "evaluations", json!(0)),
            ("/unmeasured", "unmeasured", json!(999)),
            ("/overshoot_seconds", "overshoot_seconds", json!(99.0)),
            ("/stop_reason", "stop_reason", json!("Time")),
            ("/engine", "engine", json!("nonsense")),
            ("/engine_parameters", "engine_parameters", json!({"batch": 2})),
            ("/answer", "answer", json!("Unknown")),
            ("/bodies/0/vertices", "bodies[0]", json!(9)),
            ("/bodies/1/edges", "bodies[1]", json!(9)),
            ("/bodies/1/triangles", "bodies[1]", json!(9)),
            ("/bodies", "bodies", json!([])),
            ("/skipped", "skipped", json!({"nonsense": 3})),
            ("/pairs/0/a/vertices", "pairs[0].a.vertices", json!([0, 6])),
            (
                "/pairs/0/witness/point_a",
                "pairs[0].witness",
                json!([100.0, 100.0, 100.0]),
            ),
            (
                "/pairs/0/witness/normal",
                "pairs[0].witness",
                json!([0.0, 7.0, 0.0]),
            ),
            ("/pairs/0/witness/part_a", "pairs[0].witness", json!("face")),
            ("/pairs/0/witness/part_b", "pairs[0].witness", json!("vertex 9")),
        ],
    );
    let mut report = refuse(folder.path(), "collide cube.obj floor.obj --threshold 0.3", &[]);
    report["problem_parameters"]["find"] = json!("allx");
    assert_eq!(verify(folder.path(), &report).code, 2);
}

#[test]
fn no_pair_is_closer_than_the_closest() {
    let folder = meshes();
    for kind in ["vertex-vertex", "triangle-triangle"] {
        let call = format!("collide cube.obj above.obj floor.obj --closest 3 --pairs {kind}");
        let report = refuse(
            folder.path(),
            &call,
            &[
                ("/problem_parameters/closest", "answer", json!(4)),
                ("/problem_parameters/closest", "pairs", json!(2)),
                ("/stop_reason", "stop_reason", json!("Covered")),
            ],
        );
        assert_eq!(report["problem_parameters"]["closest"], 3);
        // One left out, with all counts as they should be.
        for place in 0..3 {
            let mut fewer = report.clone();
            fewer["pairs"].as_array_mut().unwrap().remove(place);
            fewer["hits"] = json!(2);
            fewer["evaluations"] = json!(2);
            let done = verify(folder.path(), &fewer);
            assert!(
                done.code == 1 && done.stdout.contains("\n  answer: "),
                "{}",
                done.stdout
            );
        }
    }
    // A far pair, at its true distance, in place of the closest.
    let mut report = refuse(folder.path(), "collide cube.obj above.obj --closest 1", &[]);
    report["pairs"][0]["a"]["feature"] = json!(0);
    report["pairs"][0]["b"]["feature"] = json!(0);
    report["pairs"][0]["distance"] = json!(1.25);
    let done = verify(folder.path(), &report);
    assert!(
        done.code == 1 && done.stdout.contains("\n  answer: "),
        "{}",
        done.stdout
    );
    // Of all pairs that there are, fewer than asked for.
    refuse(folder.path(), "collide above.obj below.obj --closest 20", &[]);
    refuse(
        folder.path(),
        "collide cube.obj --self --closest 100 --threshold 1.5",
        &[],
    );
}

#[test]
fn no_other_bodies_touch() {
    let folder = meshes();
    let call =
        "collide cube.obj floor.obj below.obj above.obj --touching --threshold 0.1 --pairs triangle-triangle";
    let mut report = refuse(folder.path(), call, &[]);
    let (mut last, pairs) = (json!(null), report["pairs"].as_array_mut().unwrap());
    assert!(pairs.len() > 1);
    let gone = pairs.pop().unwrap();
    let left = pairs.len();
    for key in ["hits", "evaluations"] {
        report[key] = json!(left);
    }
    let touching = report["touching"].as_array_mut().unwrap();
    touching.retain(|bodies| {
        let is_gone = bodies == &json!([gone["a"]["body"], gone["b"]["body"]]);
        if is_gone {
            last = bodies.clone();
        }
        !is_gone
    });
    assert!(last.is_array());
    let done = verify(folder.path(), &report);
    assert!(
        done.code == 1 && done.stdout.contains("\n  answer: "),
        "{}",
        done.stdout
    );
}

#[test]
fn what_an_engine_found() {
    let folder = meshes();
    refuse(
        folder.path(),
        "collide cube.obj floor.obj --threshold 0.6 --pairs vertex-triangle --method random --evaluations 300 --reference",
        &[
            ("/evaluations", "evaluations", json!(301)),
            ("/engine", "engine", json!("nonsense")),
            ("/engine_parameters/batch", "engine_parameters", json!("x")),
            ("/best/fitness", "best.fitness", json!(0.55)),
            ("/best/evaluation", "best.evaluation", json!(1000)),
            ("/pairs/0/evaluation", "pairs[0].evaluation", json!(1000)),
            ("/pairs/0/seconds", "pairs[0].seconds", json!(1000.0)),
            ("/answer", "answer", json!("Proved")),
            ("/recall", "recall", json!(0.01)),
            ("/stop_reason", "stop_reason", json!("Patience")),
        ],
    );
}

#[test]
fn how_deep_solids_overlap() {
    let folder = meshes();
    refuse(
        folder.path(),
        "collide cube.obj cube.obj --at 1:0.5,0.2,0.1 --solid --threshold 0.01 --pairs triangle-triangle",
        &[
            ("/overlaps/0/depth_at_most", "overlaps[0]", json!(50.0)),
            ("/overlaps/0/depth_at_least", "overlaps[0]", json!(0.0)),
            (
                "/overlaps/0/direction",
                "overlaps[0].direction",
                json!([0.0, 0.0, 9.0]),
            ),
            (
                "/overlaps/0/direction",
                "overlaps[0].direction",
                json!([0.0, 1.0, 0.0]),
            ),
            ("/overlaps", "overlaps", json!([])),
        ],
    );
}

#[test]
fn impacts_of_a_motion() {
    let folder = meshes();
    let call = "collide --from above.obj floor.obj --to below.obj floor.obj --threshold 0.4";
    refuse(
        folder.path(),
        call,
        &[
            ("/recall", "recall", json!(7.0)),
            ("/unmeasured", "unmeasured", json!(999)),
            ("/unseen_estimate", "unseen_estimate", json!(1000.0)),
            ("/evaluations", "evaluations", json!(0)),
            ("/threshold", "threshold", json!(0.5)),
            ("/engine", "engine", json!("tree")),
            ("/bodies/0/vertices", "bodies[0]", json!(9)),
            ("/first_impact", "first_impact", json!(null)),
            ("/first_impact/time", "first_impact", json!([0.0, 0.1])),
            ("/pairs/0/at_start", "pairs[0].at_start", json!(true)),
            (
                "/pairs/0/point_a",
                "pairs[0].point_a",
                json!([100.0, 100.0, 100.0]),
            ),
            ("/pairs/0/point_b", "pairs[0].point_b", json!([0.5, 0.5, 0.0])),
            ("/pairs/0/normal", "pairs[0].normal", json!([0.0, 0.0, 5.0])),
            ("/pairs/0/normal", "pairs[0].normal", json!([0.0, 0.0, 1.0])),
            ("/pairs/0/time", "pairs[0]", json!(null)),
        ],
    );
    refuse(
        folder.path(),
        &format!("{call} --first"),
        &[("/answer", "answer", json!("Unknown"))],
    );
    refuse(
        folder.path(),
        &format!("{call} --pairs edge-edge"),
        &[("/pairs/0/a/vertices", "pairs[0].a.vertices", json!([7, 1]))],
    );
}

/// The checks must not refuse what is only rounded: bodies far from the origin, and deep ones.
#[test]
fn true_reports_of_round_bodies_far_away_are_believed() {
    let folder = tempfile::tempdir().unwrap();
    let ball = generate::icosphere(1.0, 2).unwrap();
    for (name, x, z) in [("a.obj", 0.0, 0.0), ("b.obj", 1.3, 0.4), ("c.obj", 1.9, 2.0)] {
        let there = Placement::from_translation([1e5 + x, -3e4, z]).unwrap();
        io::save_obj(&there.place(&ball).unwrap(), folder.path().join(name)).unwrap();
    }
    for call in [
        "collide a.obj b.obj --solid --threshold 0.05 --pairs edge-triangle --witnesses",
        "collide a.obj b.obj c.obj --self --threshold 0.2 --pairs vertex-edge --witnesses",
        "collide a.obj b.obj c.obj --closest 5 --pairs edge-edge --witnesses",
        "collide a.obj c.obj --closest 1 --pairs triangle-triangle --witnesses",
        "collide --from a.obj b.obj --to c.obj b.obj --threshold 0.01",
        "collide --from a.obj c.obj --to b.obj c.obj --threshold 0 --first",
    ] {
        refuse(folder.path(), call, &[]);
    }
}
