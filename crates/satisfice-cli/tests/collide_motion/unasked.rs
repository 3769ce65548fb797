//! What an answer does not cover, and impacts at the end of a step.

use std::fs;

use serde_json::{Value, json};
use tempfile::TempDir;

use super::{FALL, fall, folder, pairs, report};
use crate::common::{satisfice_in, write_box};

fn cube(folder: &TempDir, name: &str, x: f64) {
    write_box(folder.path(), name, [x, 0.0, 0.0], [x + 1.0, 1.0, 1.0]);
}

/// One cube rests, another one comes from afar and ends just within it.
#[test]
fn the_first_impact_may_be_at_the_end() {
    let folder = folder();
    cube(&folder, "rests.obj", 0.0);
    cube(&folder, "far.obj", 3.0);
    for (end, hits) in [(0.999_999_9, true), (1.0, true), (1.000_000_1, false)] {
        cube(&folder, "near.obj", end);
        let call = "collide --from far.obj rests.obj --to near.obj rests.obj --threshold 0";
        let all = report(&folder, call);
        let mut first = report(&folder, &format!("{call} --first"));
        assert_eq!(pairs(&all).is_empty(), !hits, "{end}");
        assert_eq!(pairs(&first).is_empty(), !hits, "{end}");
        assert_eq!(first["answer"], "Proved", "{end}");
        if hits {
            // what a search that misses it would report
            first["pairs"] = json!([]);
            first["hits"] = json!(0);
            first["completeness"] = json!("Proved");
            first["stop_reason"] = json!("Covered");
            first["reference_hits"] = json!(0);
            first["touching"] = json!([]);
            first["first_impact"]["time"] = json!([1.0, 1.0]);
            fs::write(folder.path().join("report.json"), first.to_string()).unwrap();
            let verified = satisfice_in(folder.path(), "verify report.json");
            assert_eq!(verified.code, 1);
            assert!(verified.stdout.contains("first_impact"), "{}", verified.stdout);
        }
    }
}

#[test]
fn it_is_said_what_was_not_asked() {
    let folder = folder();
    let vertices = satisfice_in(
        folder.path(),
        &format!("{FALL} --threshold 0 --pairs vertex-vertex"),
    );
    assert_eq!(vertices.code, 1);
    for (text, part) in [
        (
            &vertices.stdout,
            "none: no vertex-vertex pair comes that near, that is proved",
        ),
        (&vertices.stderr, "note: only vertex-vertex pairs were compared"),
    ] {
        assert!(text.contains(part), "{text}");
    }
    // So few candidates are decided before anybody asks whether there are enough.
    for (name, z) in [("low.obj", -1.0), ("flat.obj", 0.0), ("high.obj", 1.0)] {
        let triangle = format!("v 0 0 {z}\nv 1 0 {z}\nv 0 1 {z}\nf 1 2 3\n");
        fs::write(folder.path().join(name), triangle).unwrap();
    }
    let call =
        "collide --from high.obj flat.obj --to low.obj flat.obj --threshold 0 --pairs edge-edge --hits 2";
    let some = satisfice_in(folder.path(), call);
    assert!(
        some.stdout
            .contains("all are counted, but --hits asks for so many only, which need not be the earliest"),
        "{}",
        some.stdout
    );
    let some = report(&folder, call);
    assert_eq!((&some["stop_reason"], &some["hits"]), (&json!("Hits"), &json!(2)));
}

/// Down to below the floor and back within one step: the step itself moves nothing.
#[test]
fn an_animation_that_bends_within_a_step_is_warned_of() {
    let folder = folder();
    fall(folder.path(), "bent.gltf", &["dive"]);
    let path = folder.path().join("bent.gltf");
    let mut document: Value = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
    let numbers: Vec<f32> = [
        &[0.0, 1.0, 2.0][..],
        &[0.0, 0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.875],
    ]
    .concat();
    let bytes: Vec<u8> = numbers.iter().flat_map(|c| c.to_le_bytes()).collect();
    fs::write(folder.path().join("dive.bin"), &bytes).unwrap();
    let add = |list: &mut Value, entry: Value| list.as_array_mut().unwrap().push(entry);
    add(
        &mut document["buffers"],
        json!({ "byteLength": bytes.len(), "uri": "dive.bin" }),
    );
    add(
        &mut document["bufferViews"],
        json!({ "buffer": 1, "byteLength": bytes.len() }),
    );
    document["accessors"][1] =
        json!({ "bufferView": 1, "componentType": 5126, "count": 3, "type": "SCALAR" });
    document["accessors"][2] =
        json!({ "bufferView": 1, "byteOffset": 12, "componentType": 5126, "count": 3, "type": "VEC3" });
    fs::write(&path, document.to_string()).unwrap();
    let whole = satisfice_in(
        folder.path(),
        "collide bent.gltf --from 0s --to 2s --threshold 0 --first",
    );
    assert_eq!(whole.code, 1);
    assert!(
        whole
            .stderr
            .starts_with("warning: the bodies do not move straight: at 1 s lid is 1.9375 from where"),
        "{}",
        whole.stderr
    );
    assert!(
        whole.stdout.contains("none: the straight step is free"),
        "{}",
        whole.stdout
    );
    let half = satisfice_in(
        folder.path(),
        "collide bent.gltf --from 0s --to 1s --threshold 0 --first",
    );
    assert_eq!((half.code, half.stderr.as_str()), (0, ""));
}
