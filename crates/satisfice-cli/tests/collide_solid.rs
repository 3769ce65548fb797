//! `collide --solid`: closed bodies that lie inside each other, and how deep.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::path::Path;

use common::{error_in, satisfice_in};
use satisfice_collision::{Mesh, Placement, generate, io};
use serde_json::{Value, json};

fn save(folder: &Path, name: &str, mesh: &Mesh, x: f64) {
    let there = Placement::from_translation([x, 0.0, 0.0]).unwrap();
    io::save_obj(&there.place(mesh).unwrap(), folder.join(name)).unwrap();
}

fn report(folder: &Path, arguments: &str) -> (i32, Value) {
    let done = satisfice_in(folder, &format!("{arguments} --json report.json"));
    assert!(done.code <= 1, "{}", done.stderr);
    let text = fs::read(folder.join("report.json")).unwrap();
    (done.code, serde_json::from_slice(&text).unwrap())
}

#[test]
fn a_ball_inside_a_ball() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let ball = |radius: f64| generate::icosphere(radius, 3).unwrap();
    save(folder, "large.obj", &ball(2.0), 0.0);
    save(folder, "small.obj", &ball(0.5), 1.0);
    save(folder, "far.obj", &ball(0.5), 9.0);
    let scene = "collide large.obj small.obj far.obj --threshold 0.01 --pairs triangle-triangle";
    // As surfaces they touch nothing.
    let (code, surfaces) = report(folder, scene);
    assert_eq!((code, &surfaces["touching"]), (1, &json!([])));
    assert_eq!(surfaces.get("overlaps"), None);

    let (code, solids) = report(folder, &format!("{scene} --solid"));
    assert_eq!(
        (code, &solids["touching"], &solids["hits"]),
        (0, &json!([[0, 1]]), &json!(0))
    );
    let overlaps = solids["overlaps"].as_array().unwrap();
    assert_eq!(overlaps.len(), 1);
    assert_eq!(overlaps[0]["relation"], "b-inside-a");
    // To the surface, and across the small ball.
    let depth = overlaps[0]["depth_at_most"].as_f64().unwrap();
    assert!((depth - 1.5).abs() < 0.02, "{depth}");
    assert!(depth - overlaps[0]["depth_at_least"].as_f64().unwrap() < 1e-9);
    let verified = satisfice_in(folder, "verify report.json");
    assert_eq!(verified.code, 0, "{}", verified.stdout);
    for (key, wrong) in [
        ("relation", json!("surfaces-meet")),
        ("depth_at_most", json!(1.2)),
    ] {
        let mut altered = solids.clone();
        altered["overlaps"][0][key] = wrong;
        fs::write(folder.join("altered.json"), altered.to_string()).unwrap();
        let refused = satisfice_in(folder, "verify altered.json");
        assert!(
            refused.code == 1 && refused.stdout.contains("overlaps"),
            "{}",
            refused.stdout
        );
    }
    let told = satisfice_in(folder, &format!("{scene} --touching --solid"));
    assert!(
        told.stdout.contains("small.obj lies inside large.obj, depth 1.4"),
        "{}",
        told.stdout
    );
    assert!(told.stdout.contains("or one inside the other"), "{}", told.stdout);
    let apart = satisfice_in(folder, "collide small.obj far.obj --threshold 0.01 --solid");
    assert_eq!(apart.code, 1);
    assert!(
        apart.stdout.contains("no body lies inside another"),
        "{}",
        apart.stdout
    );
}

#[test]
fn an_open_mesh_is_no_solid() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    save(
        folder,
        "sheet.obj",
        &generate::cloth(1.0, 1.0, 2, 2).unwrap(),
        0.0,
    );
    save(folder, "ball.obj", &generate::icosphere(1.0, 1).unwrap(), 0.0);
    let scene = "collide ball.obj sheet.obj --threshold 0.01 --solid";
    let said = error_in(folder, scene);
    assert!(
        said.contains("sheet.obj")
            && said
                .contains("not closed: 4 edges have an odd number of triangles, the first of them between"),
        "{said}"
    );
    let said = error_in(
        folder,
        "collide ball.obj ball.obj --threshold 0.01 --solid --method random",
    );
    assert!(
        said.contains("--solid is answered by the exact methods"),
        "{said}"
    );
}

/// That the sheet is open is not found out within the limit.
#[test]
fn solids_are_prepared_within_the_limit() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // so many triangles that another thread prepares them
    save(folder, "ball.obj", &generate::icosphere(1.0, 6).unwrap(), 0.0);
    save(
        folder,
        "sheet.obj",
        &generate::cloth(1.0, 1.0, 60, 60).unwrap(),
        0.0,
    );
    let call = "collide ball.obj sheet.obj --threshold 0.1 --pairs triangle-triangle --solid";
    let said = error_in(folder, call);
    assert!(
        said.contains("sheet.obj") && said.contains("not closed"),
        "{said}"
    );
    let done = satisfice_in(folder, &format!("{call} --time 1ns"));
    assert_eq!(done.code, 1, "{}", done.stderr);
    assert!(
        done.stdout
            .contains("overlap       not known: the time was over before one was found\n"),
        "{}",
        done.stdout
    );
}
