//! The limits of `collide`: memory, listed pairs, time; and its closest points.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use common::satisfice_in;
use satisfice_collision::{Placement, generate, io};
use serde_json::{Value, json};
use tempfile::TempDir;

fn json_of(folder: &Path, arguments: &str) -> Value {
    let done = satisfice_in(folder, &format!("{arguments} --json -"));
    assert!(done.code <= 1, "{arguments}: {}", done.stderr);
    serde_json::from_str(&done.stdout).unwrap()
}

/// Two balls that cross.
fn balls(depth: u32) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let ball = generate::icosphere(1.0, depth).unwrap();
    let turned = Placement::from_axis_angle([1.0, 2.0, 3.0], 0.7).unwrap();
    let other = turned.moved([1.5, 0.1, 0.2]).unwrap().place(&ball).unwrap();
    io::save_obj(&ball, folder.path().join("a.obj")).unwrap();
    io::save_obj(&other, folder.path().join("b.obj")).unwrap();
    folder
}

#[test]
fn beyond_max_pairs_all_are_counted_and_fewer_listed() {
    let folder = balls(3);
    for kind in ["vertex-vertex", "edge-edge", "triangle-triangle"] {
        for method in ["exact", "brute-force", "tree --threads 2"] {
            let scene = format!("collide a.obj b.obj --threshold 0.2 --pairs {kind} --method {method}");
            let all = json_of(folder.path(), &scene);
            let count = all["hits"].as_u64().unwrap();
            assert!(count > 100, "{scene}");
            let few = json_of(folder.path(), &format!("{scene} --max-pairs 100"));
            assert_eq!(
                (&few["hits"], &few["reference_hits"], &few["completeness"]),
                (&100.into(), &count.into(), &"Unknown".into()),
                "{scene}"
            );
            // What was left out is counted in whole, or not said.
            for (reason, skipped) in few["skipped"].as_object().unwrap() {
                assert_eq!(skipped, &all["skipped"][reason], "{scene}: {reason}");
            }
            let listed = few["pairs"].as_array().unwrap();
            assert!(
                listed.len() == 100
                    && listed
                        .iter()
                        .all(|pair| all["pairs"].as_array().unwrap().contains(pair))
            );
            let enough = json_of(folder.path(), &format!("{scene} --max-pairs {count}"));
            assert_eq!(
                (&enough["pairs"], &enough["completeness"]),
                (&all["pairs"], &"Proved".into())
            );
        }
    }
    let scene = "collide a.obj b.obj --threshold 0.2 --max-pairs 10";
    let done = satisfice_in(folder.path(), scene);
    assert!(
        done.stderr
            .starts_with("warning: the list ends after 10 pairs; --max-pairs N lists more"),
        "{}",
        done.stderr
    );
    assert!(
        done.stdout.contains("all are counted, but not all are listed"),
        "{}",
        done.stdout
    );
    // The pairs of one body, without neighbours on the mesh.
    let own = "collide a.obj --self --ring-width 2 --pairs vertex-triangle --threshold 0.4";
    let count = json_of(folder.path(), own)["hits"].clone();
    assert_eq!(
        json_of(folder.path(), &format!("{own} --max-pairs 7"))["reference_hits"],
        count
    );
    fs::write(
        folder.path().join("report.json"),
        json_of(folder.path(), &format!("{own} --max-pairs 7")).to_string(),
    )
    .unwrap();
    let verified = satisfice_in(folder.path(), "verify report.json");
    assert_eq!(verified.code, 0, "{}", verified.stdout);
}

/// The command in so many kilobytes of address space, on two bodies of so many vertices that lie close together.
#[cfg(unix)]
fn in_little_memory(folder: &Path, kilobytes: u32, vertices: u32, arguments: &str) -> std::process::Output {
    let points = (0..vertices).fold(String::new(), |mut text, k| {
        writeln!(text, "v {} 0 0", f64::from(k) * 1e-6).unwrap();
        text
    });
    for name in ["a.obj", "b.obj"] {
        fs::write(folder.join(name), &points).unwrap();
    }
    std::process::Command::new("sh")
        .arg("-c")
        .arg(format!(
            "ulimit -v {kilobytes}; exec {} collide a.obj b.obj --threshold 1 {arguments}",
            env!("CARGO_BIN_EXE_satisfice")
        ))
        .current_dir(folder)
        .output()
        .unwrap()
}

/// 300,000 pairs in 300 MB of address space.
#[cfg(unix)]
#[test]
fn many_pairs_take_little_memory() {
    let folder = tempfile::tempdir().unwrap();
    let done = in_little_memory(folder.path(), 300_000, 550, "--json report.json --out pairs.csv");
    assert_eq!(
        done.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&done.stderr)
    );
    let csv = fs::read_to_string(folder.path().join("pairs.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + 550 * 550);
    let stdout = String::from_utf8(done.stdout).unwrap();
    assert!(stdout.contains("  pairs         302,500\n"), "{stdout}");
}

/// Where memory ends, what was found is written and all pairs are counted; the program says so in one line.
#[cfg(unix)]
#[test]
fn memory_that_ends_is_one_line() {
    const VERTICES: usize = 1500;
    let folder = tempfile::tempdir().unwrap();
    let arguments = "--out pairs.csv --json report.json";
    let done = in_little_memory(folder.path(), 200_000, VERTICES as u32, arguments);
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    assert_eq!(done.status.code(), Some(2), "{said}");
    let csv = fs::read_to_string(folder.path().join("pairs.csv")).unwrap();
    let listed = csv.lines().count() - 1;
    assert!(listed > 100_000 && listed < VERTICES * VERTICES, "{listed}");
    let errors: Vec<&str> = said
        .lines()
        .filter(|line| !line.starts_with("warning: "))
        .collect();
    let expected =
        format!("error: memory ended after {listed} pairs, which are written; --max-pairs N asks for fewer");
    assert_eq!(errors, [expected]);
    let report = fs::read(folder.path().join("report.json")).unwrap();
    let report: Value = serde_json::from_slice(&report).unwrap();
    assert_eq!(report["hits"], listed);
    assert_eq!(report["completeness"], "Unknown");
    assert_eq!(report["stop_reason"], "Memory");
    assert_eq!(report["reference_hits"], VERTICES * VERTICES);
    // Without a file only a summary is written.
    let done = in_little_memory(folder.path(), 200_000, VERTICES as u32, "");
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    assert!(said.contains(" pairs; --max-pairs N asks for fewer\n"), "{said}");
}

#[test]
fn a_time_limit_covers_measuring() {
    let folder = balls(4);
    let scene = "collide a.obj b.obj --threshold 0.3 --pairs triangle-triangle";
    for limit in ["1ms", "30ms", "100ms", "300ms"] {
        let report = json_of(folder.path(), &format!("{scene} --time {limit}"));
        let [elapsed, overshoot, time] =
            ["elapsed_seconds", "overshoot_seconds", "budget"].map(|key| match key {
                "budget" => report[key]["time_seconds"].as_f64().unwrap(),
                key => report[key].as_f64().unwrap(),
            });
        assert!(
            (overshoot - (elapsed - time).max(0.0)).abs() < 1e-9,
            "{limit}: {elapsed} {overshoot}"
        );
        let nulls = report["pairs"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|pair| pair["distance"].is_null());
        let unmeasured = nulls.count();
        assert_eq!(report["unmeasured"], unmeasured);
        if unmeasured > 0 {
            assert_eq!(report["stop_reason"], "Time");
            fs::write(folder.path().join("report.json"), report.to_string()).unwrap();
        }
    }
    // The first limit ends while pairs are listed, so that none of them is measured.
    let report = json_of(folder.path(), &format!("{scene} --time 100us"));
    let pairs = report["pairs"].as_array().unwrap();
    assert!(pairs.iter().all(|pair| pair["distance"].is_null()));
}

/// Building the trees of 327,680 triangles takes far longer than the first look at the clock is away.
#[test]
fn a_time_limit_covers_the_trees() {
    let folder = tempfile::tempdir().unwrap();
    let ball = generate::icosphere(1.0, 7).unwrap();
    io::save_obj(&ball, folder.path().join("ball.obj")).unwrap();
    for ask in ["", "--closest 3"] {
        let scene = format!(
            "collide ball.obj ball.obj --pairs triangle-triangle --threshold 0.001 {ask} --time 100us --json -"
        );
        let done = satisfice_in(folder.path(), &scene);
        assert!(
            done.code == 1 && done.stderr.contains("no pair was compared"),
            "{ask}: {}",
            done.stderr
        );
        let report: Value = serde_json::from_str(&done.stdout).unwrap();
        assert_eq!(
            (&report["stop_reason"], &report["completeness"], &report["hits"]),
            (&"Time".into(), &"Unknown".into(), &0.into()),
            "{ask}"
        );
    }
}

#[test]
fn witnesses_are_written_to_json_and_csv_and_shown() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("a.obj"),
        "v 0 0 0\nv 2 0 0\nv 0 2 0\nf 1 2 3\n",
    )
    .unwrap();
    fs::write(
        folder.path().join("b.obj"),
        "v 0.5 0.5 0.25\nv 0.5 0.5 9\nv 0.75 0.5 9\nf 1 2 3\n",
    )
    .unwrap();
    fs::write(
        folder.path().join("c.obj"),
        "v 0.5 0.5 -1\nv 0.5 0.5 1\nv 0.75 0.5 1\nf 1 2 3\n",
    )
    .unwrap();
    let scene = "collide a.obj b.obj --threshold 1 --pairs triangle-triangle --witnesses";
    let expected = json!({
        "point_a": [0.5, 0.5, 0.0], "point_b": [0.5, 0.5, 0.25], "normal": [0.0, 0.0, 1.0],
        "part_a": "face", "part_b": "vertex 0",
    });
    for method in [
        "exact",
        "exact --threads 2",
        "random --evaluations 50",
        "exact --closest 1",
    ] {
        let report = json_of(folder.path(), &format!("{scene} --method {method}"));
        assert_eq!(report["pairs"][0]["witness"], expected, "{method}");
    }
    let done = satisfice_in(folder.path(), &format!("{scene} --out -"));
    assert_eq!(
        done.stdout,
        "a_body,a_feature,b_body,b_feature,distance,ax,ay,az,bx,by,bz,nx,ny,nz,a_part,b_part\n\
         0,0,1,0,0.25,0.5,0.5,0,0.5,0.5,0.25,0,0,1,face,vertex 0\n"
    );
    let shown = satisfice_in(folder.path(), scene).stdout;
    assert!(
        shown.contains("0.25 apart, from (0.5 0.5 0) to (0.5 0.5 0.25)"),
        "{shown}"
    );
    // Where the triangles cross there is no normal.
    let crossing = json_of(folder.path(), &scene.replace("b.obj", "c.obj"));
    assert_eq!(
        (
            &crossing["pairs"][0]["distance"],
            &crossing["pairs"][0]["witness"]["normal"]
        ),
        (&0.0.into(), &Value::Null)
    );
    // The points on both edges are rounded, so that they differ where the edges cross.
    fs::write(
        folder.path().join("slant.obj"),
        "v 0.1 0.2 0\nv 0.7 1.3 0\nv 9 0 0\nf 1 2 3\n",
    )
    .unwrap();
    fs::write(
        folder.path().join("steep.obj"),
        "v 0.3 0.1 -0.7\nv 0.4 1.1 0.9\nv 0.3 0.1 9\nf 1 2 3\n",
    )
    .unwrap();
    let cut = json_of(
        folder.path(),
        "collide slant.obj steep.obj --threshold 1e-9 --pairs edge-triangle --witnesses",
    );
    assert!(!cut["pairs"].as_array().unwrap().is_empty());
    for pair in cut["pairs"].as_array().unwrap() {
        assert_eq!(
            (&pair["distance"], &pair["witness"]["normal"]),
            (&0.0.into(), &Value::Null)
        );
    }
    let without = json_of(folder.path(), &scene.replace(" --witnesses", ""));
    assert_eq!(without["pairs"][0]["witness"], Value::Null);
}

#[test]
fn surfaces_that_may_cut_are_pointed_at_where_only_vertices_were_compared() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("flat.obj"),
        "v 0 0 0\nv 2 0 0\nv 0 2 0\nf 1 2 3\n",
    )
    .unwrap();
    fs::write(
        folder.path().join("through.obj"),
        "v 0.5 0.5 -1\nv 0.5 0.5 1\nv 0.75 0.5 1\nf 1 2 3\n",
    )
    .unwrap();
    let scene = "collide flat.obj through.obj --threshold 0.01";
    let done = satisfice_in(folder.path(), scene);
    assert_eq!(
        (done.code, done.stderr.as_str()),
        (
            1,
            "note: only vertices were compared; the surfaces of flat.obj and through.obj may be closer than the threshold all \
             the same, as their boxes are: --pairs triangle-triangle compares surfaces\n"
        )
    );
    for other in ["--pairs triangle-triangle", "--at through:0,0,2"] {
        let done = satisfice_in(folder.path(), &format!("{scene} {other}"));
        assert!(!done.stderr.contains("note:"), "{other}: {}", done.stderr);
    }
}

#[test]
fn the_summary_speaks_of_pairs_and_distances() {
    let folder = balls(2);
    let done = satisfice_in(
        folder.path(),
        "collide a.obj b.obj --threshold 0.15 --pairs vertex-edge",
    );
    for part in [
        "vertex-edge pairs closer than 0.15 by exact\n",
        "  pairs  ",
        "  distances  ",
        " apart\n",
        ", finished\n",
    ] {
        assert!(done.stdout.contains(part), "{part}: {}", done.stdout);
    }
    for part in ["F =", "evaluation", "fitness", "seed", "hit 1"] {
        assert!(!done.stdout.contains(part), "{part}: {}", done.stdout);
    }
}

#[test]
fn the_closest_pairs_need_no_threshold() {
    let folder = tempfile::tempdir().unwrap();
    let save = |name: &str, x: f64| {
        let ball = generate::icosphere(1.0, 4).unwrap();
        let ball = Placement::from_translation([x, 0.0, 0.0])
            .unwrap()
            .place(&ball)
            .unwrap();
        io::save_obj(&ball, folder.path().join(name)).unwrap();
    };
    save("a.obj", 0.0);
    save("b.obj", 5.3);
    let call = "collide a.obj b.obj --pairs triangle-triangle --closest 3";
    let report = json_of(folder.path(), call);
    assert_eq!((&report["hits"], &report["threshold"]), (&3.into(), &Value::Null));
    let distance = report["pairs"][0]["distance"].as_f64().unwrap();
    assert!((distance - 3.3).abs() < 0.01, "{distance}");
    // Apart from being the closest, they say nothing of what touches.
    assert_eq!(
        (&report["answer"], &report["completeness"], &report["touching"]),
        (&"Proved".into(), &"Unknown".into(), &json!([]))
    );
    let limited = json_of(folder.path(), &format!("{call} --threshold 10"));
    assert_eq!(limited["pairs"], report["pairs"]);
    fs::write(folder.path().join("report.json"), report.to_string()).unwrap();
    let verified = satisfice_in(folder.path(), "verify report.json");
    assert_eq!(verified.code, 0, "{}", verified.stdout);
    let told = satisfice_in(folder.path(), call);
    assert!(
        told.stdout
            .starts_with("the closest triangle-triangle pairs by exact"),
        "{}",
        told.stdout
    );
    assert!(
        told.stdout
            .contains("  answer        proved: no other pair is closer\n")
            && !told.stdout.contains("completeness"),
        "{}",
        told.stdout
    );
    // Of two by two pairs all are listed.
    for (name, x) in [("c.obj", 0.0), ("d.obj", 2.0)] {
        fs::write(folder.path().join(name), format!("v {x} 0 0\nv {x} 1 0\n")).unwrap();
    }
    for (call, says) in [
        ("--closest 1", "  answer        proved: no other pair is closer\n"),
        ("--closest 9", "  completeness  proved: these are all\n"),
        (
            "--threshold 3 --first",
            "  answer        one pair, whichever is found first\n",
        ),
        (
            "--threshold 3 --touching",
            "  answer        proved: no other bodies touch, ",
        ),
        ("--threshold 3", "  completeness  proved: these are all\n"),
    ] {
        let answer = &json_of(folder.path(), &format!("collide c.obj d.obj {call}"))["answer"];
        assert_eq!(answer, "Proved", "{call}");
        let told = satisfice_in(folder.path(), &format!("collide c.obj d.obj {call}"));
        assert!(told.stdout.contains(says), "{call}: {}", told.stdout);
        let says_once = told.stdout.matches("proved").count() + told.stdout.matches("unknown").count();
        assert!(says_once <= 1, "{call}: {}", told.stdout);
    }
}

/// A mesh that is larger than memory: one line, and what was there before stays.
#[cfg(unix)]
#[test]
fn a_mesh_beyond_memory_is_one_line() {
    const TRIANGLES: u32 = 400_000;
    let folder = tempfile::tempdir().unwrap();
    let mut stl = vec![0; 80];
    stl.extend(TRIANGLES.to_le_bytes());
    for k in 0..TRIANGLES {
        let x = k as f32;
        let corners = [[0.0; 3], [x, 0.0, 0.0], [x + 0.5, 0.0, 0.0], [x, 1.0, 0.0]];
        stl.extend(corners.as_flattened().iter().flat_map(|c| c.to_le_bytes()));
        stl.extend([0; 2]);
    }
    fs::write(folder.path().join("large.stl"), stl).unwrap();
    fs::write(folder.path().join("pairs.csv"), "of an earlier run").unwrap();
    for (kilobytes, call) in [
        (
            120_000,
            "collide large.stl large.stl --threshold .1 --out pairs.csv",
        ),
        (
            60_000,
            "run sat --set variables=10000 --evaluations 1000 --json pairs.csv",
        ),
    ] {
        let done = std::process::Command::new("sh")
            .arg("-c")
            .arg(format!(
                "ulimit -v {kilobytes}; exec {} {call}",
                env!("CARGO_BIN_EXE_satisfice")
            ))
            .current_dir(folder.path())
            .output()
            .unwrap();
        let said = String::from_utf8(done.stderr).unwrap();
        assert_eq!(done.status.code(), Some(2), "{call}: {said}");
        assert!(
            said.starts_with("error: memory ended, ") && said.lines().count() == 1,
            "{call}: {said}"
        );
        let names: Vec<_> = fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name())
            .collect();
        assert_eq!(names.len(), 2, "{call}: {names:?}");
        let csv = fs::read_to_string(folder.path().join("pairs.csv")).unwrap();
        assert_eq!(csv, "of an earlier run", "{call}");
    }
}

#[test]
fn one_pair_is_one_and_counts_follow_what_they_count() {
    let folder = tempfile::tempdir().unwrap();
    let triangle = |corners: &str| format!("{corners}f 1 2 3\n");
    fs::write(
        folder.path().join("a.obj"),
        triangle("v 0 0 0\nv 1 0 0\nv 0 1 0\n"),
    )
    .unwrap();
    fs::write(
        folder.path().join("b.obj"),
        triangle("v 0 0 .5\nv 5 0 3\nv 0 5 3\n"),
    )
    .unwrap();
    let call = "collide a.obj b.obj --threshold 1 --method random --evaluations 1";
    let said = satisfice_in(folder.path(), call).stdout;
    assert!(
        said.contains("completeness  1 pair not seen\n")
            && said.contains("skipped       self-pairs of rigid bodies: 2\n"),
        "{said}"
    );
}
