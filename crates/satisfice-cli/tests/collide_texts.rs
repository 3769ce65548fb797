//! What `collide` says: numbers, names and reasons that are true to the letter.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::path::Path;

use common::{error_in, satisfice_in};
use satisfice_collision::{generate, io};
use serde_json::Value;
use tempfile::TempDir;

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

/// A ball of so many triangles that preparing it is left to another thread.
fn large_ball(folder: &Path) {
    io::save_obj(&generate::icosphere(1.0, 6).unwrap(), folder.join("ball.obj")).unwrap();
}

#[test]
fn spacings_of_numbers_are_those_of_the_format() {
    let far = |z: &str| format!("v 1e9 0 {z}\nv 1000000001 0 {z}\nv 1e9 1 {z}\nf 1 2 3\n");
    let folder = folder(&[("a.obj", &far("0")), ("b.obj", &far("0.5"))]);
    let said = |threshold: &str| {
        let call = format!("collide a.obj b.obj --pairs triangle-triangle --threshold {threshold}");
        satisfice_in(folder.path(), &call).stderr
    };
    // 1e9 lies between 2^29 and 2^30
    let spacing = (1e9_f64 - 1e9_f64.next_down()).to_string();
    assert!(spacing.starts_with("0.000000119"), "{spacing}");
    let text = said("1e-8");
    assert!(
        text.contains("where neighbouring numbers are 1.19e-7 apart"),
        "{text}"
    );
    let single = 1e9_f32 - 1e9_f32.next_down();
    let text = said("0.75");
    assert!(text.contains(&format!("are steps of {single};")), "{text}");
}

#[test]
fn a_distance_below_the_threshold_is_not_shown_as_the_threshold() {
    let folder = folder(&[
        ("a.obj", "v 0 0 0\n"),
        ("b.obj", "v 0.04999999999 0 0\nv 0 0.0123456789 0\n"),
    ]);
    let said = satisfice_in(folder.path(), "collide a.obj b.obj --threshold 0.05").stdout;
    for line in [
        "distances     0.0123457 to just below 0.05\n",
        "b.obj, just below 0.05 apart\n",
    ] {
        assert!(said.contains(line), "{said}");
    }
}

#[test]
fn one_is_no_plural() {
    let folder = folder(&[
        ("a.obj", TRIANGLE),
        ("bad.obj", "v 0 0 0\nf 1 2 3\n"),
        ("seam.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nf 1 2 3\n"),
    ]);
    let said = error_in(folder.path(), "collide a.obj bad.obj --threshold 1");
    assert!(
        said.ends_with("face 0 names vertex 2, but the mesh has 1 vertex (1)"),
        "{said}"
    );
    let said = satisfice_in(folder.path(), "collide a.obj a.obj --threshold 3 --max-pairs 1").stderr;
    assert!(
        said.contains("warning: the list ends after 1 pair; --max-pairs"),
        "{said}"
    );
    let said = satisfice_in(
        folder.path(),
        "collide --from a.obj a.obj --to a.obj a.obj --threshold 3 --max-pairs 1",
    );
    assert!(
        said.stderr
            .contains("warning: the list ends after 1 pair; --max-pairs"),
        "{said:?}"
    );
    let said = satisfice_in(folder.path(), "collide seam.obj --self --threshold 0.1").stderr;
    assert!(
        said.contains("seam.obj has 1 vertex that lies on others, as at seams"),
        "{said}"
    );
}

#[test]
fn the_mesh_that_lacks_a_feature_is_named() {
    let folder = folder(&[
        ("a.obj", TRIANGLE),
        ("points.obj", "v 0 0 0\nv 1 0 0\n"),
        ("point.obj", "v 5 0 0\n"),
    ]);
    for (call, why) in [
        ("points.obj a.obj", "points.obj has no triangles"),
        ("points.obj point.obj a.obj", "only a.obj has triangles"),
        ("points.obj point.obj", "no mesh has any triangles"),
    ] {
        let said = error_in(
            folder.path(),
            &format!("collide {call} --threshold 1 --pairs triangle-triangle"),
        );
        assert!(said.contains(&format!("since {why}: choose other")), "{said}");
    }
}

#[test]
fn a_search_without_time_says_nothing_of_motion_and_trees() {
    let folder = folder(&[("a.obj", TRIANGLE)]);
    large_ball(folder.path());
    for mesh in ["a.obj", "ball.obj"] {
        let call = format!("collide {mesh} {mesh} --threshold 0.1 --method brute-force --time 1ns");
        let done = satisfice_in(folder.path(), &call);
        assert!(!done.stdout.contains("did not move"), "{}", done.stdout);
        assert!(!done.stderr.contains("trees"), "{}", done.stderr);
        assert_eq!(
            done.stderr.contains("the meshes were still being prepared"),
            mesh == "ball.obj"
        );
    }
}

#[test]
fn what_is_proved_of_the_first_pair_is_the_answer() {
    let folder = folder(&[("a.obj", TRIANGLE)]);
    let done = satisfice_in(
        folder.path(),
        "collide a.obj a.obj --threshold 3 --first --json -",
    );
    let report: Value = serde_json::from_str(&done.stdout).unwrap();
    assert_eq!(
        (
            &report["answer"],
            &report["completeness"],
            &report["stop_reason"],
            &report["hits"]
        ),
        (&"Proved".into(), &"Unknown".into(), &"Hits".into(), &1.into())
    );
}
