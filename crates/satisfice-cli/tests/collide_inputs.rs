//! What `collide` reads: scenes, standard input, placements, welding; and what it refuses to overwrite.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::Stdio;

use common::{Done, command, error_in, satisfice_in};
use satisfice_collision::{Placement, generate, io};
use serde_json::{Value, json};
use tempfile::TempDir;

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("triangle.obj"), TRIANGLE).unwrap();
    fs::write(
        folder.path().join("above.obj"),
        TRIANGLE.replace(" 0\n", " 0.25\n"),
    )
    .unwrap();
    folder
}

fn json_of(folder: &Path, arguments: &str) -> Value {
    let done = satisfice_in(folder, &format!("{arguments} --json -"));
    assert!(done.code <= 1, "{arguments}: {}", done.stderr);
    serde_json::from_str(&done.stdout).unwrap()
}

fn from_stdin(folder: &Path, arguments: &str, input: &[u8]) -> Done {
    let mut child = command(folder, arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(input).unwrap();
    child.wait_with_output().unwrap().into()
}

/// A document of two triangles as nodes, one of them far away, and a third node that touches the first.
fn gltf() -> String {
    json!({
        "asset": { "version": "2.0" },
        "nodes": [
            { "name": "left, \"front\"", "mesh": 0 },
            { "name": "far", "mesh": 0, "translation": [9, 0, 0] },
            { "name": "lid", "mesh": 0, "translation": [0, 0, 0.125] },
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }],
        "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
        "buffers": [{ "byteLength": 36, "uri": "triangle.bin" }],
    })
    .to_string()
}

#[test]
fn scenes_name_their_nodes() {
    let folder = folder();
    let mut bytes = Vec::new();
    for c in [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        bytes.extend(c.to_le_bytes());
    }
    fs::write(folder.path().join("triangle.bin"), bytes).unwrap();
    fs::write(folder.path().join("scene.gltf"), gltf()).unwrap();
    fs::write(
        folder.path().join("scene.toml"),
        "[[bodies]]\nmesh = \"triangle.obj\"\nname = \"left, \\\"front\\\"\"\n\n[[bodies]]\nmesh = \"triangle.obj\"\nname = \"far\"\n\
         at = [9, 0, 0]\n\n[[bodies]]\nmesh = \"triangle.obj\"\nname = \"lid\"\nat = [0, 0, 0.125]\n",
    )
    .unwrap();
    for scene in ["scene.gltf", "scene.toml"] {
        let call = format!("collide {scene} --threshold 0.2 --pairs triangle-triangle --touching");
        let done = satisfice_in(folder.path(), &call);
        assert_eq!(done.code, 0, "{}", done.stderr);
        assert!(
            done.stdout.contains("  bodies        left, \"front\" - lid\n"),
            "{}",
            done.stdout
        );
        let report = json_of(folder.path(), &call);
        assert_eq!(report["touching"], json!([[0, 2]]));
        assert_eq!(report["bodies"][2]["name"], "lid");
        assert_eq!(report["pairs"][0]["distance"], 0.125);

        let done = satisfice_in(
            folder.path(),
            &format!("{call} --out pairs.csv --json report.json"),
        );
        assert_eq!(done.code, 0, "{}", done.stderr);
        assert_eq!(
            fs::read_to_string(folder.path().join("pairs.csv")).unwrap(),
            "a_body,a_feature,b_body,b_feature,distance,a_name,b_name\n0,0,2,0,0.125,\"left, \"\"front\"\"\",lid\n"
        );
        let verified = satisfice_in(folder.path(), "verify report.json");
        assert_eq!(verified.code, 0, "{}{}", verified.stdout, verified.stderr);
    }
    fs::remove_file(folder.path().join("triangle.bin")).unwrap();
    let line = error_in(folder.path(), "collide scene.gltf --threshold 1");
    assert!(
        line.contains("left, \"front\": cannot read triangle.bin"),
        "{line}"
    );
}

#[test]
fn a_mesh_may_come_from_standard_input() {
    let folder = folder();
    let call = "collide - above.obj --format obj --threshold 0.3 --json -";
    let done = from_stdin(folder.path(), call, TRIANGLE.as_bytes());
    let report: Value = serde_json::from_str(&done.stdout).unwrap();
    assert_eq!(
        (&report["hits"], &report["bodies"][0]["name"]),
        (&3.into(), &"stdin".into())
    );

    let without = from_stdin(folder.path(), "collide - above.obj --threshold 0.3", b"");
    assert!(
        without.code == 2 && without.stderr.contains("--format"),
        "{}",
        without.stderr
    );
    for (arguments, reason) in [
        ("collide - - --format obj --threshold 1", "read once only"),
        (
            "collide triangle.obj above.obj --format obj --threshold 1",
            "name it as `-`",
        ),
        (
            "collide - above.obj --format step --threshold 1",
            "the known extensions are obj",
        ),
    ] {
        let line = error_in(folder.path(), arguments);
        assert!(line.contains(reason), "{line}");
    }
}

#[test]
fn a_concave_face_does_not_reach_beyond_its_corners() {
    let folder = tempfile::tempdir().unwrap();
    let corners = "v 0 0 0\nv 2 0 0\nv 0.5 0.5 0\nv 0 2 0\n";
    for (name, text) in [
        ("notched.obj", format!("{corners}f 2 3 4 1\n")),
        (
            "beside.obj",
            "v 1.4 0.55 0\nv 1.4 0.55 1\nv 1.5 0.4 1\nf 1 2 3\n".to_owned(),
        ),
        (
            "through.obj",
            "v 0.4 0.4 -1\nv 0.4 0.4 1\nv 0.3 0.4 1\nf 1 2 3\n".to_owned(),
        ),
    ] {
        fs::write(folder.path().join(name), text).unwrap();
    }
    for (other, are_any) in [("beside.obj", false), ("through.obj", true)] {
        let arguments = format!("collide notched.obj {other} --threshold 1e-9 --pairs triangle-triangle");
        let report = json_of(folder.path(), &arguments);
        assert_eq!(report["hits"].as_u64().unwrap() > 0, are_any, "{report}");
    }
}

#[test]
fn bodies_can_be_placed() {
    let folder = folder();
    let distance = |at: &str| {
        let call = format!("collide triangle.obj above.obj --threshold 50 --pairs triangle-triangle {at}");
        json_of(folder.path(), &call)["pairs"][0]["distance"]
            .as_f64()
            .unwrap()
    };
    assert_eq!(distance(""), 0.25);
    assert_eq!(distance("--at 1:0,0,-2.25"), 2.0);
    assert_eq!(distance("--at above:0,0,2 --at triangle.obj:0,0,1"), 1.25);
    // Twice as high, then turned upside down.
    assert!((distance("--at above:0,0,0,180,0,0,2") - 0.5).abs() < 1e-12);
    let line = error_in(
        folder.path(),
        "collide triangle.obj above.obj --threshold 1 --at lid:0,0,0",
    );
    assert!(
        line.contains("--at lid: there is no such body: give a number from 0 to 1"),
        "{line}"
    );

    let call = "collide triangle.obj above.obj --threshold 50 --at above:0,0,1,90,0,0 --weld 0.001 --json report.json";
    assert_eq!(satisfice_in(folder.path(), call).code, 0);
    let verified = satisfice_in(folder.path(), "verify report.json");
    assert_eq!(verified.code, 0, "{}{}", verified.stdout, verified.stderr);
}

#[test]
fn seams_are_warned_of_and_can_be_welded() {
    let folder = folder();
    // Two squares that share an edge, each with its own vertices there.
    let square = |x: f64| format!("v {x} 0 0\nv {} 0 0\nv {} 1 0\nv {x} 1 0\n", x + 1.0, x + 1.0);
    let text = format!("{}{}f 1 2 3 4\nf 5 6 7 8\n", square(0.0), square(1.0));
    fs::write(folder.path().join("seam.obj"), text).unwrap();
    let done = satisfice_in(folder.path(), "collide seam.obj --self --threshold 0.1");
    assert!(done.stdout.contains("  pairs         2\n"), "{}", done.stdout);
    assert_eq!(
        done.stderr,
        "warning: seam.obj has 2 vertices that lie on others, as at seams: the features on both sides make pairs; --weld 2e-9 joins them\n"
    );
    for weld in ["0", "2e-9", "0.01"] {
        let done = satisfice_in(
            folder.path(),
            &format!("collide seam.obj --self --threshold 0.1 --weld {weld}"),
        );
        let note = format!("note: --weld {weld} merged 2 of 8 vertices with others\n");
        assert_eq!((done.code, done.stderr), (1, note), "{}", done.stdout);
    }
}

#[test]
fn a_weld_that_turns_triangles_into_points_is_warned_of() {
    let folder = folder();
    let call = "collide triangle.obj triangle.obj --at 1:3,0,0 --closest 1 --pairs triangle-triangle";
    let whole = satisfice_in(folder.path(), call);
    assert_eq!((whole.code, whole.stderr.as_str()), (0, ""));
    assert!(whole.stdout.contains(" 2 apart\n"), "{}", whole.stdout);
    let welded = satisfice_in(folder.path(), &format!("{call} --weld 10"));
    assert_eq!(
        welded.stderr,
        "note: --weld 10 merged 4 of 6 vertices with others\n\
         warning: --weld 10 turned 2 of 2 triangles into edges or points (most of them, 1, in triangle.obj#0): is the distance in the \
         unit of the meshes?\n"
    );
    // a triangle without area in the file is not one that welding made
    let flat = format!("{TRIANGLE}f 1 2 2\nv 1 0 0\nf 1 2 4\n");
    fs::write(folder.path().join("flat.obj"), flat).unwrap();
    let call = "collide flat.obj triangle.obj --threshold 1 --weld 0.001 --pairs triangle-triangle";
    let done = satisfice_in(folder.path(), call);
    assert_eq!(
        done.stderr,
        "note: --weld 0.001 merged 1 of 7 vertices with others\n"
    );
}

#[test]
fn a_file_without_a_body_is_refused_by_its_name() {
    let folder = folder();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let empty = r#"{"asset": {"version": "2.0"}, "scene": 0, "scenes": [{}]}"#;
    write("empty.gltf", empty);
    write("none.toml", "bodies = []\n");
    write(
        "list.toml",
        "[[bodies]]\nmesh = 'triangle.obj'\n[[bodies]]\nmesh = 'empty.gltf'\n",
    );
    for name in ["empty.gltf", "none.toml"] {
        let expected =
            format!("error: {name}: the file has no body: leave it out, or name the file that was meant");
        for call in [
            format!("collide {name} --self --threshold 1"),
            format!("collide triangle.obj {name} --threshold 1"),
            format!("collide triangle.obj above.obj {name} --threshold 1 --pairs triangle-triangle"),
        ] {
            assert_eq!(error_in(folder.path(), &call), expected, "{call}");
        }
        let motion =
            format!("collide --from triangle.obj {name} --to triangle.obj {name} --self --threshold 0");
        let error = error_in(folder.path(), &motion);
        assert!(error.contains(name) && error.contains("no body"), "{error}");
    }
    let error = error_in(folder.path(), "collide list.toml triangle.obj --threshold 1");
    assert!(
        error.contains("list.toml") && error.contains("empty.gltf") && error.contains("no body"),
        "{error}"
    );
}

#[test]
fn faces_that_cannot_be_cut_are_warned_of_once_a_file() {
    let folder = folder();
    let bow = "v 0 0 0\nv 4 4 0\nv 4 0 0\nv 0 3 0\nf 1 2 3 4\n";
    fs::write(folder.path().join("bow.obj"), bow).unwrap();
    fs::write(folder.path().join("bows.obj"), format!("{bow}f 1 2 3 4\n")).unwrap();
    let done = satisfice_in(
        folder.path(),
        "collide bow.obj bow.obj bows.obj triangle.obj --threshold 1 --pairs triangle-triangle",
    );
    assert_eq!(done.code, 0, "{}", done.stderr);
    assert_eq!(
        done.stderr,
        "warning: bow.obj has 1 face that crosses itself, seen along the normal, or so many corners that cutting takes too long: \
         it stays a fan of triangles about the first corner, whose pairs may not be those of the face\n\
         warning: bows.obj has 2 faces that cross themselves, seen along the normal, or so many corners that cutting takes too long: \
         they stay fans of triangles about the first corner, whose pairs may not be those of the face\n"
    );
}

#[test]
fn a_comb_of_very_many_corners_is_not_met_between_its_teeth() {
    let folder = folder();
    let teeth = 5000;
    let tooth = |k: i64| {
        format!(
            "v {} 0 0\nv {} 0 0\nv {} 10 0\nv {} 10 0\n",
            2 * k + 2,
            2 * k + 1,
            2 * k + 1,
            2 * k
        )
    };
    let top: String = (0..teeth).rev().map(tooth).collect();
    let face: String = (1..=4 * teeth + 2).map(|corner| format!(" {corner}")).collect();
    let comb = format!("v 0 -1 0\nv {} -1 0\n{top}f{face}\n", 2 * teeth);
    fs::write(folder.path().join("comb.obj"), comb).unwrap();
    let probe = |k: i64| {
        let x = 2 * k + 1;
        format!("v {x}.5 5 -0.05\nv {x}.6 5 -0.05\nv {x}.5 5.1 0.05\nf -3 -2 -1\n")
    };
    let probes: String = (0..teeth - 1).map(probe).collect();
    fs::write(folder.path().join("probes.obj"), probes).unwrap();
    let call = "collide comb.obj probes.obj --pairs triangle-triangle --threshold";
    // each is half its width from the teeth
    assert_eq!(json_of(folder.path(), &format!("{call} 0.3"))["hits"], 0);
    assert!(json_of(folder.path(), &format!("{call} 0.45"))["hits"].as_u64() >= Some(4999));
}

#[test]
fn the_teapot_of_patches_has_no_pairs_once_it_is_welded() {
    let folder = folder();
    let teapot = generate::teapot(4).unwrap();
    // Every triangle with vertices of its own, as STL has them.
    let corners = (0..teapot.triangles().len())
        .flat_map(|t| teapot.triangle(t))
        .collect::<Vec<_>>();
    let triangles = (0..corners.len() as u32 / 3)
        .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
        .collect();
    let soup = satisfice_collision::Mesh::new(corners, vec![], triangles).unwrap();
    io::save_obj(&soup, folder.path().join("soup.obj")).unwrap();
    let call = "collide soup.obj --self --threshold 1e-9";
    assert!(json_of(folder.path(), call)["hits"].as_u64() > Some(1000));
    assert_eq!(json_of(folder.path(), &format!("{call} --weld 1e-9"))["hits"], 0);
}

#[test]
fn inputs_and_other_outputs_are_not_overwritten() {
    let folder = folder();
    let scene = "collide triangle.obj above.obj --threshold 1";
    for (arguments, reason) in [
        (
            "--out above.obj",
            "--out above.obj would overwrite an input: choose another file",
        ),
        (
            "--json ./triangle.obj",
            "--json ./triangle.obj would overwrite an input",
        ),
        (
            "--json x --out x",
            "--json and --out both write x: choose two files",
        ),
        (
            "--json x --out ./x",
            "--json and --out both write ./x: choose two files",
        ),
        (
            "--picture x.png --out x.png",
            "--out and --picture both write x.png: choose two files",
        ),
        (
            "--out new/pairs.csv",
            "cannot write new/pairs.csv: its folder does not exist",
        ),
    ] {
        let line = error_in(folder.path(), &format!("{scene} {arguments}"));
        assert!(line.contains(reason), "{line}");
    }
    assert_eq!(
        fs::read_to_string(folder.path().join("triangle.obj")).unwrap(),
        TRIANGLE
    );
    assert!(!folder.path().join("new").exists() && !folder.path().join("x").exists());
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("above.obj", folder.path().join("link.csv")).unwrap();
        let line = error_in(folder.path(), &format!("{scene} --out link.csv"));
        assert!(line.contains("would overwrite an input"), "{line}");
    }
}

#[test]
fn compressed_meshes_are_read_by_the_command() {
    let folder = folder();
    let packed = std::process::Command::new("gzip")
        .arg("above.obj")
        .current_dir(folder.path())
        .status();
    if !packed.is_ok_and(|status| status.success()) {
        eprintln!("skipped: there is no gzip");
        return;
    }
    let report = json_of(folder.path(), "collide triangle.obj above.obj.gz --threshold 0.3");
    assert_eq!(report["hits"], 3);
}

#[test]
fn two_bodies_of_one_name_are_told_apart() {
    let folder = folder();
    let ball = generate::icosphere(1.0, 1).unwrap();
    for name in ["one", "two"] {
        fs::create_dir(folder.path().join(name)).unwrap();
        let at = Placement::from_translation([if name == "one" { 0.0 } else { 0.01 }, 0.0, 0.0]).unwrap();
        io::save_obj(
            &at.place(&ball).unwrap(),
            folder.path().join(name).join("ball.obj"),
        )
        .unwrap();
    }
    let names = |call: &str| -> Vec<String> {
        let report = json_of(folder.path(), call);
        let bodies = report["bodies"].as_array().unwrap();
        bodies
            .iter()
            .map(|body| body["name"].as_str().unwrap().to_owned())
            .collect()
    };
    assert_eq!(
        names("collide one/ball.obj two/ball.obj --threshold 0.1"),
        ["one/ball.obj", "two/ball.obj"]
    );
    assert_eq!(
        names("collide one/ball.obj one/ball.obj --threshold 0.1"),
        ["ball.obj#0", "ball.obj#1"]
    );
    fs::copy(
        folder.path().join("one/ball.obj"),
        folder.path().join("one/egg.obj"),
    )
    .unwrap();
    assert_eq!(
        names("collide one/ball.obj one/egg.obj --at egg:0,0,1 --at one/ball.obj:0,0,1 --threshold 0.1"),
        ["ball.obj", "egg.obj"],
        "no folders where files have names of their own"
    );
    let line = error_in(
        folder.path(),
        "collide one/ball.obj two/ball.obj --threshold 0.1 --at ball:0,0,1",
    );
    assert!(line.contains("bodies 0 and 1 are called so"), "{line}");
}
