//! Mutated meshes, suites, checkpoints, reports and DIMACS files: each is accepted or refused in one line.

use std::fs;
use std::path::Path;

use satisfice::SearchRng;

use crate::extent::{cases, figure};
use crate::mutation::mutate;
use crate::process::{command, run};

/// Runs the command on mutations of a file and asserts that it never misbehaves.
fn examine(kind: &str, name: &str, original: &[u8], arguments: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let count = cases(40, 10_000);
    let mut codes = [0_u64; 3];
    let mut faults = Vec::new();
    for case in 0..count {
        let mut rng = SearchRng::new(case);
        let bytes = mutate(original, &mut rng);
        fs::write(folder.path().join(name), &bytes).unwrap();
        // Results of another suite would be refused, and nothing run.
        drop(fs::remove_dir_all(folder.path().join("out")));
        let outcome = run(folder.path(), arguments);
        if let Some(fault) = outcome.fault() {
            faults.push(format!("case {case}: {fault}"));
        } else if let Some(count) = outcome
            .code
            .and_then(|code| codes.get_mut(usize::try_from(code).ok()?))
        {
            *count += 1;
        }
    }
    figure(
        &format!("mutated {kind}"),
        format!(
            "{count} cases, exit codes 0/1/2: {}/{}/{}",
            codes[0], codes[1], codes[2]
        ),
    );
    assert!(
        faults.is_empty(),
        "{} of {count} mutated files of kind {kind} misbehave:\n{}",
        faults.len(),
        faults.iter().take(8).cloned().collect::<Vec<_>>().join("\n")
    );
}

/// A closed mesh of 8 vertices and 12 triangles.
const CUBE: [[u32; 3]; 12] = [
    [0, 1, 3],
    [0, 3, 2],
    [4, 6, 7],
    [4, 7, 5],
    [0, 4, 5],
    [0, 5, 1],
    [2, 3, 7],
    [2, 7, 6],
    [0, 2, 6],
    [0, 6, 4],
    [1, 5, 7],
    [1, 7, 3],
];

fn corners() -> impl Iterator<Item = [f32; 3]> {
    (0..8_u8).map(|i| [f32::from(i & 1), f32::from(i >> 1 & 1), f32::from(i >> 2)])
}

fn obj() -> Vec<u8> {
    let vertices = corners().map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    let faces = CUBE
        .iter()
        .map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1));
    vertices.chain(faces).collect::<String>().into_bytes()
}

fn ply(format: &str) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat {format} 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n\
         element face 12\nproperty list uchar int vertex_indices\nend_header\n"
    )
    .into_bytes();
    if format == "ascii" {
        let vertices = corners().map(|[x, y, z]| format!("{x} {y} {z}\n"));
        let faces = CUBE.iter().map(|[a, b, c]| format!("3 {a} {b} {c}\n"));
        bytes.extend(vertices.chain(faces).collect::<String>().into_bytes());
    } else {
        bytes.extend(corners().flatten().flat_map(f32::to_le_bytes));
        for face in CUBE {
            bytes.push(3);
            bytes.extend(face.into_iter().flat_map(u32::to_le_bytes));
        }
    }
    bytes
}

fn stl() -> Vec<u8> {
    let corners: Vec<[f32; 3]> = corners().collect();
    let mut bytes = vec![b' '; 80];
    bytes.extend(12_u32.to_le_bytes());
    for face in CUBE {
        bytes.extend([0; 12]);
        bytes.extend(
            face.into_iter()
                .flat_map(|i| corners[i as usize])
                .flat_map(f32::to_le_bytes),
        );
        bytes.extend([0; 2]);
    }
    bytes
}

fn self_pairs(name: &'static str) -> [&'static str; 9] {
    [
        "collide",
        name,
        "--self",
        "--threshold",
        "0.01",
        "--pairs",
        "triangle-triangle",
        "--time",
        "100ms",
    ]
}

#[test]
fn mutated_obj_meshes() {
    examine("OBJ meshes", "m.obj", &obj(), &self_pairs("m.obj"));
}

#[test]
fn mutated_ascii_ply_meshes() {
    examine("PLY meshes, ASCII", "m.ply", &ply("ascii"), &self_pairs("m.ply"));
}

#[test]
fn mutated_binary_ply_meshes() {
    examine(
        "PLY meshes, binary",
        "m.ply",
        &ply("binary_little_endian"),
        &self_pairs("m.ply"),
    );
}

#[test]
fn mutated_binary_stl_meshes() {
    examine("STL meshes, binary", "m.stl", &stl(), &self_pairs("m.stl"));
}

#[test]
fn mutated_suites() {
    let suite = b"title = \"t\"\nseeds = \"0..2\"\n[[part]]\nname = \"p\"\nengines = [\"random\", { name = \"walk\", uniform = [0.1, 0.5] }]\n\
                  problems = [{ name = \"queens\", n = [4, 5] }]\nevaluations = 50\nat-evaluations = [10]\nagainst = \"random\"\n";
    examine("suites", "s.toml", suite, &["bench", "s.toml", "--out", "out"]);
}

#[test]
fn mutated_dimacs_files() {
    let formula = b"c a formula\np cnf 4 5\n1 -2 0\n2 -3 4 0\n-1 3 0\n-4 1 2 0\n3 4 0\n";
    let arguments = ["run", "sat", "--set", "file=f.cnf", "--evaluations", "100"];
    examine("DIMACS files", "f.cnf", formula, &arguments);
}

/// The file that a run writes.
fn written(arguments: &[&str], name: &str) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let status = command(folder.path(), arguments).output().unwrap().status;
    assert!(status.code().is_some_and(|code| code < 2), "{arguments:?}");
    read(folder.path(), name)
}

fn read(folder: &Path, name: &str) -> Vec<u8> {
    fs::read(folder.join(name)).unwrap()
}

#[test]
fn mutated_reports() {
    let arguments = [
        "run",
        "queens",
        "--set",
        "n=6",
        "--evaluations",
        "2000",
        "--json",
        "r.json",
    ];
    let report = written(&arguments, "r.json");
    examine("reports", "r.json", &report, &["verify", "r.json"]);
}

#[test]
fn mutated_checkpoints() {
    let run = [
        "run",
        "queens",
        "--set",
        "n=6",
        "--evaluations",
        "500",
        "--slices",
        "2",
    ];
    let checkpoint = written(&[&run[..], &["--checkpoint", "c.json"]].concat(), "c.json");
    examine(
        "checkpoints",
        "c.json",
        &checkpoint,
        &["run", "queens", "--resume", "c.json"],
    );
}
