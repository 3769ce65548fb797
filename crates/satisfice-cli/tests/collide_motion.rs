//! `collide --from A --to B`, as a user calls it.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;
#[path = "collide_motion/unasked.rs"]
mod unasked;

use std::fs;
use std::path::Path;

use common::{error_in, satisfice_in};
use satisfice_collision::{Mesh, Placement, generate, io};
use serde_json::{Value, json};
use tempfile::TempDir;

fn save(folder: &Path, name: &str, mesh: &Mesh) {
    io::save_obj(mesh, folder.join(name)).unwrap();
}

fn placed(mesh: &Mesh, at: [f64; 3]) -> Mesh {
    Placement::from_translation(at).unwrap().place(mesh).unwrap()
}

/// A scene of two triangles: in each of the animations, one falls from z = 1 through the other one to z = -1 in two seconds.
fn fall(folder: &Path, name: &str, animations: &[&str]) {
    let triangle = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let places = [0.0, 0.0, 1.0, 0.0, 0.0, -1.0];
    let numbers: Vec<f32> = [&triangle[..], &[0.0, 2.0], &places].concat();
    let bytes: Vec<u8> = numbers.iter().flat_map(|c| c.to_le_bytes()).collect();
    fs::write(folder.join("falling.bin"), bytes).unwrap();
    let channel = json!({ "sampler": 0, "target": { "node": 1, "path": "translation" } });
    let animations = animations.iter().map(
        |name| json!({ "name": name, "channels": [channel], "samplers": [{ "input": 1, "output": 2 }] }),
    );
    let document = json!({
        "asset": { "version": "2.0" },
        "nodes": [{ "name": "floor", "mesh": 0 }, { "name": "lid", "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "animations": animations.collect::<Vec<_>>(),
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" },
            { "bufferView": 0, "byteOffset": 36, "componentType": 5126, "count": 2, "type": "SCALAR" },
            { "bufferView": 0, "byteOffset": 44, "componentType": 5126, "count": 2, "type": "VEC3" },
        ],
        "bufferViews": [{ "buffer": 0, "byteLength": 68 }],
        "buffers": [{ "byteLength": 68, "uri": "falling.bin" }],
    });
    fs::write(folder.join(name), document.to_string()).unwrap();
}

/// A ball that falls through a sheet at z = 0, and files that do not fit.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let ball = generate::icosphere(0.25, 2).unwrap();
    save(folder.path(), "ball0.obj", &placed(&ball, [0.1, 0.2, 1.25]));
    save(folder.path(), "ball1.obj", &placed(&ball, [0.1, 0.2, -0.75]));
    let beside = placed(&ball, [9.0, 0.0, 0.0]);
    save(folder.path(), "beside.obj", &beside);
    save(
        folder.path(),
        "sheet.obj",
        &generate::cloth(2.0, 2.0, 12, 12).unwrap(),
    );
    for (name, text) in [
        (
            "tet.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n",
        ),
        (
            "tet-turned.obj",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\n",
        ),
        ("tet-short.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n"),
        ("nan.obj", "v 0 0 0\nv 1 nan 0\n"),
        ("point0.obj", "v 0.25 0.25 1\np 1\n"),
        ("point1.obj", "v 0.25 0.25 -3\np 1\n"),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

const FALL: &str = "collide --from ball0.obj sheet.obj --to ball1.obj sheet.obj";

fn report(folder: &TempDir, arguments: &str) -> Value {
    let done = satisfice_in(folder.path(), &format!("{arguments} --json -"));
    assert!(done.code <= 1, "{arguments}: {}", done.stderr);
    let report = serde_json::from_str(&done.stdout).unwrap();
    fs::write(folder.path().join("report.json"), &done.stdout).unwrap();
    let verified = satisfice_in(folder.path(), "verify report.json");
    assert_eq!(verified.code, 0, "{arguments}: {}", verified.stdout);
    report
}

fn pairs(report: &Value) -> &Vec<Value> {
    report["pairs"].as_array().unwrap()
}

fn bounds(value: &Value) -> [f64; 2] {
    serde_json::from_value(value.clone()).unwrap()
}

#[test]
fn a_page_is_written() {
    let folder = folder();
    for arguments in ["--page -", "--first --up x --page -"] {
        let done = satisfice_in(folder.path(), &format!("{FALL} --threshold 0.01 {arguments}"));
        assert!(done.code == 0, "{}", done.stderr);
        assert!(done.stdout.starts_with("<!DOCTYPE html>") && done.stdout.ends_with("</html>"));
    }
}

#[test]
fn a_threshold_may_be_longer_than_single_precision_can_say() {
    let folder = folder();
    for (pairs, hits) in [("vertex-vertex", 16), ("vertex-triangle", 16), ("edge-edge", 25)] {
        for threshold in ["1e39", "1e300"] {
            let fall = format!(
                "collide --from tet.obj tet.obj --to tet.obj tet.obj --threshold {threshold} --pairs {pairs}"
            );
            assert_eq!(report(&folder, &fall)["hits"], json!(hits), "{fall}");
            let first = report(&folder, &format!("{fall} --first"));
            assert_eq!(first["first_impact"]["proved"], json!(true), "{fall} --first");
            assert_eq!(first["first_impact"]["time"], json!([0.0, 0.0]), "{fall} --first");
        }
    }
}

#[test]
fn the_time_is_over_within_a_decision_that_takes_long() {
    let folder = folder();
    for (name, vertices) in [
        (
            "a0.obj",
            "v -3e300 1e-300 -1e-300\nv 0 3e-300 3e-300\nv 0 0 1e-300\n",
        ),
        (
            "a1.obj",
            "v 1.5e300 0 0\nv -3e300 1e-300 -1e300\nv 3e-300 0 3e300\n",
        ),
        (
            "b0.obj",
            "v 0 1e300 1e300\nv 1e300 3e-300 -1.5e300\nv 1e-300 1.5e300 0\n",
        ),
        (
            "b1.obj",
            "v 1e300 -1e-300 0\nv 0 0 -1e300\nv 3e300 1.5e-300 -1e-300\n",
        ),
    ] {
        fs::write(folder.path().join(name), format!("{vertices}f 1 2 3\n")).unwrap();
    }
    let done = satisfice_in(
        folder.path(),
        "collide --from a0.obj b0.obj --to a1.obj b1.obj --threshold 1 --pairs edge-edge --time 5ms --json -",
    );
    let report: Value = serde_json::from_str(&done.stdout).unwrap();
    assert_ne!(report["completeness"], json!("Proved"), "{}", done.stderr);
}

#[test]
fn a_point_falls_through_a_triangle() {
    let folder = folder();
    let report = report(
        &folder,
        "collide --from point0.obj tet.obj --to point1.obj tet.obj --threshold 0 --pairs vertex-triangle",
    );
    assert_eq!(
        (&report["hits"], &report["completeness"]),
        (&json!(1), &json!("Proved"))
    );
    let pair = &pairs(&report)[0];
    assert_eq!(
        (&pair["kind"], &pair["a"], &pair["b"]),
        (
            &json!("vertex-triangle"),
            &json!({"body": 0, "feature": 0}),
            &json!({"body": 1, "feature": 0})
        )
    );
    let [low, high] = bounds(&pair["time"]);
    assert!(low <= 0.25 && 0.25 <= high && high - low <= 1e-6, "{low} {high}");
    let normal: [f64; 3] = serde_json::from_value(pair["normal"].clone()).unwrap();
    assert!(
        normal[2] < -0.999,
        "from the point down to the triangle: {normal:?}"
    );
    let point: [f64; 3] = serde_json::from_value(pair["point_b"].clone()).unwrap();
    assert!(
        (point[0] - 0.25).abs() < 1e-5 && point[2].abs() < 1e-5,
        "{point:?}"
    );
    assert_eq!(pair["at_start"], json!(false));
}

#[test]
fn all_pairs_and_the_earliest_agree() {
    let folder = folder();
    for threshold in ["0", "0.05"] {
        let all = report(&folder, &format!("{FALL} --threshold {threshold}"));
        let first = report(&folder, &format!("{FALL} --threshold {threshold} --first"));
        assert!(all["hits"].as_u64() > Some(10) && first["hits"] == 1);
        assert_eq!(all["reference_hits"], all["hits"]);
        assert_eq!(all["touching"], json!([[0, 1]]));
        // The lowest point of the ball starts 1 above the sheet and falls by 2.
        let when = 0.5 * (1.0 - threshold.parse::<f64>().unwrap());
        for report in [&all, &first] {
            let [low, high] = bounds(&report["first_impact"]["time"]);
            assert!(
                low <= when + 0.01 && when - 1e-9 <= high && high - low <= 1e-6,
                "{low} {high} {when}"
            );
            assert_eq!(report["first_impact"]["proved"], json!(true));
        }
        let times: Vec<f64> = pairs(&all).iter().map(|pair| bounds(&pair["time"])[0]).collect();
        assert!(times.is_sorted(), "the earliest is listed first");
        let kinds: Vec<_> = pairs(&all).iter().map(|pair| pair["kind"].clone()).collect();
        assert!(kinds.contains(&json!("edge-edge")) && kinds.contains(&json!("vertex-triangle")));
        let two_threads = report(&folder, &format!("{FALL} --threshold {threshold} --threads 2"));
        assert_eq!(two_threads["pairs"], all["pairs"]);
    }
    let free = report(
        &folder,
        "collide --from ball0.obj beside.obj --to ball1.obj beside.obj --threshold 1 --first",
    );
    assert_eq!(
        (&free["hits"], &free["completeness"], &free["first_impact"]),
        (
            &json!(0),
            &json!("Proved"),
            &json!({"time": [1.0, 1.0], "proved": true})
        )
    );
}

#[test]
fn limits_keep_bounds_that_are_true() {
    let folder = folder();
    let first = report(&folder, &format!("{FALL} --threshold 0 --first --time 1ns"));
    let [low, high] = bounds(&first["first_impact"]["time"]);
    assert!(
        low <= 0.5 && 0.5 <= high && first["stop_reason"] == "Time",
        "{low} {high}"
    );
    let all = report(&folder, &format!("{FALL} --threshold 0 --time 1ns"));
    assert_eq!(
        (&all["reference_hits"], &all["completeness"]),
        (&Value::Null, &json!("Unknown"))
    );
    let cut = report(&folder, &format!("{FALL} --threshold 0 --max-pairs 3"));
    assert!(pairs(&cut).len() == 3 && cut["reference_hits"].as_u64() > Some(3));
    let enough = report(&folder, &format!("{FALL} --threshold 0 --hits 4"));
    assert_eq!(
        (&enough["hits"], &enough["stop_reason"]),
        (&json!(4), &json!("Hits"))
    );
}

#[test]
fn a_false_report_is_found_out() {
    let folder = folder();
    let mut report = report(&folder, &format!("{FALL} --threshold 0"));
    report["pairs"][0]["time"] = json!([0.1, 0.1]);
    report["pairs"][1]["a"]["feature"] = json!(4_000_000_000_u32);
    fs::write(folder.path().join("report.json"), report.to_string()).unwrap();
    let verified = satisfice_in(folder.path(), "verify report.json");
    assert_eq!(verified.code, 1);
    assert!(verified.stdout.contains("pairs[0]") && verified.stdout.contains("pairs[1]"));
}

#[test]
fn impacts_are_written_as_csv_and_told() {
    let folder = folder();
    let done = satisfice_in(folder.path(), &format!("{FALL} --threshold 0 --out impacts.csv"));
    assert_eq!((done.code, done.stderr.as_str()), (0, ""));
    for line in [
        "pairs that touch during the step",
        "first impact  between 0.4",
        "proved: these are all",
    ] {
        assert!(done.stdout.contains(line), "{}", done.stdout);
    }
    let csv = fs::read_to_string(folder.path().join("impacts.csv")).unwrap();
    let head = csv.lines().next().unwrap();
    assert!(
        head.starts_with("kind,a_body,a_feature,b_body,b_feature,time_low,time_high,at_start,ax"),
        "{head}"
    );
    let fields = head.split(',').count();
    assert!(csv.lines().all(|line| line.split(',').count() == fields));
    let cut = satisfice_in(folder.path(), &format!("{FALL} --threshold 0 --max-pairs 3"));
    assert!(
        cut.stdout
            .contains("first impact  not known: an earlier pair may not be listed; --first finds it\n"),
        "{}",
        cut.stdout
    );
    let rest = satisfice_in(
        folder.path(),
        "collide --from ball0.obj sheet.obj --to ball0.obj sheet.obj --threshold 0",
    );
    assert_eq!(rest.code, 1);
    assert!(rest.stderr.starts_with("warning: no vertex moves") && rest.stdout.contains("the step is free"));
}

#[test]
fn two_times_of_an_animation_are_a_step() {
    let folder = folder();
    fall(folder.path(), "scene.gltf", &["fall"]);
    fs::write(
        folder.path().join("below.obj"),
        "v 0 0 -0.25\nv 1 0 -0.25\nv 0 1 -0.25\nf 1 2 3\n",
    )
    .unwrap();
    for (call, time, seconds) in [
        ("scene.gltf --from 0.5s --to 1.5s --threshold 0", 0.5, 1.0),
        ("--from 500ms --to 2s scene.gltf --threshold 0", 1.0 / 3.0, 1.0),
        (
            "scene.gltf --from 0 --to 2s --threshold 0.25 --animation fall",
            0.375,
            0.75,
        ),
        (
            "scene.gltf below.obj --from 1.25s --to 2s --threshold 0 --at lid:0,0,0.125",
            1.0 / 6.0,
            1.375,
        ),
        // Backwards, from below.
        ("scene.gltf --from 1.5s --to 0.5s --threshold 0", 0.5, 1.0),
    ] {
        let report = report(&folder, &format!("collide {call} --first"));
        let [low, high] = bounds(&report["first_impact"]["time"]);
        assert!(
            low <= time + 1e-9 && time - 1e-9 <= high && high - low <= 1e-6,
            "{call}: {low} {high}"
        );
        let [early, late] = bounds(&report["first_impact"]["seconds"]);
        assert!(
            (early - seconds).abs() < 3e-6 && (late - seconds).abs() < 3e-6,
            "{call}: {early} s {late} s"
        );
        assert_eq!(report["bodies"][1]["name"], "lid", "{call}");
    }
    let call = "collide scene.gltf --from 0.5s --to 1.5s --threshold 0";
    let done = satisfice_in(folder.path(), call);
    assert!(
        done.stdout
            .contains("  step          from 0.5 s to 1.5 s of the animation\n")
            && done
                .stdout
                .contains(" of the step, at 1 s of the animation, that is proved\n")
            && done.stdout.contains("at 0.5 (1 s)\n")
            && done.stdout.contains("  bodies        floor - lid\n"),
        "{}",
        done.stdout
    );
    let free = satisfice_in(
        folder.path(),
        "collide scene.gltf --from 0s --to 0.875s --threshold 0.125 --json -",
    );
    assert_eq!(free.code, 1, "it ends at a distance of 0.125: {}", free.stdout);
}

#[test]
fn mistakes_about_motions_are_told_in_one_line() {
    let folder = folder();
    fall(folder.path(), "scene.gltf", &["fall"]);
    fall(folder.path(), "two.gltf", &["fall", "plunge"]);
    let lines: Vec<String> = [
        "collide --from ball0.obj sheet.obj --threshold 0",
        "collide ball0.obj --from ball0.obj --to ball1.obj --threshold 0",
        "collide --from ball0.obj sheet.obj --to ball1.obj --threshold 0",
        "collide --from ball0.obj --to ball1.obj --threshold 0",
        "collide --from ball0.obj sheet.obj --to sheet.obj ball1.obj --threshold 0",
        "collide --from tet.obj --to tet-turned.obj --self --threshold 0",
        "collide --from tet.obj --to tet-short.obj --self --threshold 0",
        "collide --from tet.obj --to nan.obj --self --threshold 0",
        "collide --from tet.obj --to tet.obj --self --threshold -1",
        "collide --from tet.obj --to tet.obj --self --threshold inf",
        "collide --from tet.obj --to tet.obj --self --threshold 0 --pairs triangle-triangle",
        "collide --from point0.obj --to point1.obj --self --threshold 0 --pairs edge-edge",
        "collide --from tet.obj --to tet.obj --self --threshold 0 --closest 3",
        "collide --from tet.obj --to tet.obj --self --threshold 0 --weld 0",
        "collide --from tet.obj --to tet.obj --self --threshold 0 --seed 3",
        "collide --from tet.obj --to tet.obj --self --threshold 0 --method random",
        "collide --from tet.obj --to tet.obj --self --threshold 0 --out tet.obj",
        "collide --from - --to - --format obj --self --threshold 0",
        "collide scene.gltf --from 0s --to 2.1s --threshold 0",
        "collide scene.gltf --from 0s --to 1 --threshold 0",
        "collide scene.gltf --from 0s --to scene.gltf --threshold 0",
        "collide scene.gltf --from 0s --to 1s --animation walk --threshold 0",
        "collide two.gltf --from 0s --to 1s --threshold 0",
        "collide tet.obj ball0.obj --from 0s --to 1s --threshold 0",
        "collide --from tet.obj --to tet.obj --animation walk --self --threshold 0",
    ]
    .iter()
    .map(|arguments| {
        format!(
            "satisfice {arguments}\n    {}",
            error_in(folder.path(), arguments)
        )
    })
    .collect();
    insta::assert_snapshot!("motion_mistakes", lines.join("\n"));
}
