//! No output takes the place of a file that the command reads, whoever names it.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::path::Path;

use common::{error_in, satisfice_in};
use serde_json::json;
use tempfile::TempDir;

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const SPACE: &str = "[[axis]]\nlower = 0\nupper = 1\n";

/// A folder with these files.
fn folder(files: &[(&str, &[u8])]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, contents) in files {
        fs::write(folder.path().join(name), contents).unwrap();
    }
    folder
}

/// Runs a command that has to refuse an output, and to leave the file as it is.
fn refused(folder: &Path, arguments: &str, file: &str) {
    let before = fs::read(folder.join(file)).unwrap();
    let line = error_in(folder, arguments);
    assert!(
        line.contains("would overwrite an input: choose another file"),
        "{arguments}: {line}"
    );
    assert_eq!(fs::read(folder.join(file)).unwrap(), before, "{arguments}");
}

#[test]
fn meshes_that_a_scene_names_are_kept() {
    let scene = "[[bodies]]\nmesh = \"a.obj\"\n[[bodies]]\nmesh = \"sub/b.obj\"\nat = [0, 0, 0.25]\n";
    let folder = folder(&[("scene.toml", scene.as_bytes()), ("a.obj", TRIANGLE.as_bytes())]);
    fs::create_dir(folder.path().join("sub")).unwrap();
    fs::write(folder.path().join("sub/b.obj"), TRIANGLE).unwrap();
    let collide = "collide scene.toml --threshold 0.5";
    for output in [
        "--json a.obj",
        "--out sub/../a.obj",
        "--json a.obj --method random",
    ] {
        refused(folder.path(), &format!("{collide} {output}"), "a.obj");
    }
    refused(folder.path(), &format!("{collide} --json sub/b.obj"), "sub/b.obj");
    refused(
        folder.path(),
        &format!("{collide} --json scene.toml"),
        "scene.toml",
    );
    let motion = "collide --from scene.toml --to scene.toml --threshold 0.5 --json a.obj";
    refused(folder.path(), motion, "a.obj");
    assert_eq!(
        satisfice_in(folder.path(), &format!("{collide} --json b.obj")).code,
        0
    );
}

#[test]
fn buffers_of_gltf_are_kept() {
    let coordinates = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let buffer: Vec<u8> = coordinates.iter().flat_map(|c| c.to_le_bytes()).collect();
    let document = json!({
        "asset": { "version": "2.0" },
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 } }] }],
        "accessors": [{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }],
        "bufferViews": [{ "buffer": 0, "byteLength": 36 }],
        "buffers": [{ "byteLength": 36, "uri": "node.bin" }],
    });
    let folder = folder(&[
        ("node.gltf", document.to_string().as_bytes()),
        ("node.bin", &buffer),
        ("t.obj", TRIANGLE.as_bytes()),
    ]);
    refused(
        folder.path(),
        "collide node.gltf t.obj --threshold 2 --json node.bin",
        "node.bin",
    );
}

#[test]
fn a_checkpoint_is_replaced_by_checkpoints_only() {
    let folder = folder(&[]);
    let run = |arguments: &str| satisfice_in(folder.path(), &format!("run {arguments}"));
    let begun = run("queens --evaluations 500 --checkpoint k.json");
    assert_eq!(begun.code, 0, "{}", begun.stderr);
    for output in ["--json k.json", "--json ./k.json --checkpoint new.json"] {
        refused(folder.path(), &format!("run --resume k.json {output}"), "k.json");
    }
    let line = error_in(
        folder.path(),
        "run --resume k.json --checkpoint k.json --json k.json",
    );
    assert!(
        line.contains("--json and --checkpoint both write k.json"),
        "{line}"
    );
    let done = run("--resume k.json --checkpoint ./k.json --json new.json");
    assert_eq!(done.code, 0, "{}", done.stderr);
}

#[test]
fn what_a_problem_and_a_program_are_read_from_is_kept() {
    let folder = folder(&[
        ("f.cnf", b"p cnf 2 1\n1 2 0\n"),
        ("space.toml", SPACE.as_bytes()),
        ("sim.sh", b"echo 0\n"),
        ("suite.toml", b"[[part]]\nevaluations = 100\nseeds = \"0..1\"\nengines = [\"random\"]\nproblems = [\"queens\"]\n"),
    ]);
    let sat = "run sat --set file=f.cnf --evaluations 100";
    for output in [
        "--json f.cnf",
        "--checkpoint f.cnf",
        "--json x --checkpoint ./f.cnf",
    ] {
        refused(folder.path(), &format!("{sat} {output}"), "f.cnf");
    }
    for way in ["--program", "--worker"] {
        let mut command = common::command(
            folder.path(),
            "run --space space.toml --threshold 1 --evaluations 3",
        );
        let done: common::Done = command
            .args([way, "sh sim.sh {x}", "--json", "sim.sh"])
            .output()
            .unwrap()
            .into();
        assert!(
            done.stderr.contains("would overwrite an input"),
            "{}",
            done.stderr
        );
    }
    refused(
        folder.path(),
        "run --program echo{x} --space space.toml --threshold 1 --evaluations 3 --json space.toml",
        "space.toml",
    );
    // The folder gets a copy of the suite, which may be the suite itself, but no file in the place of another input.
    let done = satisfice_in(folder.path(), "bench suite.toml --out .");
    assert_eq!(done.code, 0, "{}", done.stderr);
    fs::rename(folder.path().join("f.cnf"), folder.path().join("summary.json")).unwrap();
    let suite = "[[part]]\nevaluations = 100\nseeds = \"0..1\"\nengines = [\"random\"]\nproblems = [{ name = \"sat\", file = \"summary.json\" }]\n";
    fs::write(folder.path().join("sat.toml"), suite).unwrap();
    refused(folder.path(), "bench sat.toml --out .", "summary.json");
}
