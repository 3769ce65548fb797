//! Continuous collision: time a query, a frame and a first impact.
//!
//! `cargo bench --bench continuous`. Scenes are generated; with `SATISFICE_DATA` naming a folder that holds
//! `cloth_ball92.ply` and `cloth_ball93.ply`, that step is measured too. Peers are measured by `continuous_peers.py` beside this file.
#![allow(missing_docs, clippy::unwrap_used)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use satisfice_collision::continuous::{Moving, Separation, Step, decide, impact};
use satisfice_collision::distance::PairKind;
use satisfice_collision::{Mesh, Placement, generate, io};

fn queries(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("continuous/query");
    let triangle = Moving::at_rest([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let cases = [
        ("apart", Moving::new([0.2, 0.3, 1.0], [0.9, 0.9, 0.5])),
        ("through", Moving::new([0.2, 0.3, 1.0], [0.3, 0.2, -0.7])),
        ("past-an-edge", Moving::new([0.6, 0.6, 1.0], [0.6, 0.6, -1.0])),
        ("through-a-corner", Moving::new([1.0, 0.0, 1.0], [1.0, 0.0, -1.0])),
        (
            "one-step-beside-a-corner",
            Moving::new([1.0_f64.next_up(), 0.0, 1.0], [1.0_f64.next_up(), 0.0, -1.0]),
        ),
        ("sliding", Moving::new([-1.0, 0.25, 0.0], [1.0, 0.25, 0.0])),
    ];
    for (name, vertex) in cases {
        group.bench_function(format!("vertex-triangle/{name}"), |bencher| {
            bencher.iter(|| decide(black_box(&vertex), black_box(&triangle), Separation::TOUCHING));
        });
        group.bench_function(format!("vertex-triangle/{name}/time"), |bencher| {
            bencher.iter(|| {
                impact(
                    black_box(&vertex),
                    black_box(&triangle),
                    Separation::TOUCHING,
                    1e-6,
                )
            });
        });
    }
    group.finish();
}

/// A pleated cloth whose waves run on.
fn cloth() -> (Mesh, Vec<[f64; 3]>) {
    let from = generate::pleats(121, 41, 5, 0.05, 0.0).unwrap();
    let to = generate::pleats(121, 41, 5, 0.05, 0.2).unwrap();
    (from, to.vertices().to_vec())
}

/// A ball that passes through a sheet.
fn bullet() -> Step {
    let sheet = generate::cloth(2.0, 2.0, 101, 101).unwrap();
    let ball = generate::icosphere(0.05, 3).unwrap();
    let place = |z: f64| {
        Placement::from_translation([0.1, 0.2, z])
            .unwrap()
            .place(&ball)
            .unwrap()
    };
    let mut step = Step::new();
    step.add_rigid(&place(1.0), place(-1.0).vertices()).unwrap();
    step.add_deforming(&sheet, sheet.vertices()).unwrap();
    step
}

fn steps() -> Vec<(&'static str, Step)> {
    let (mesh, to) = cloth();
    let mut pleats = Step::new();
    pleats.add_deforming(&mesh, &to).unwrap();
    let mut steps = vec![("pleats", pleats), ("bullet", bullet())];
    if let Some(folder) = std::env::var_os("SATISFICE_DATA") {
        let read = |name: &str| io::read(std::path::Path::new(&folder).join(name)).unwrap();
        let mut ball = Step::new();
        ball.add_deforming(&read("cloth_ball92.ply"), read("cloth_ball93.ply").vertices())
            .unwrap();
        steps.push(("cloth-ball", ball));
    }
    steps
}

fn frames(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("continuous/frame");
    group.sample_size(10);
    for (name, step) in steps() {
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            group.bench_function(format!("all-pairs/{name}/{threads}-threads"), |bencher| {
                bencher.iter(|| {
                    pool.install(|| {
                        [PairKind::VertexTriangle, PairKind::EdgeEdge]
                            .map(|kind| step.hits(kind, Separation::TOUCHING).unwrap().pairs.len())
                    })
                });
            });
        }
        group.bench_function(format!("first-impact/{name}"), |bencher| {
            bencher.iter(|| step.earliest(Separation::TOUCHING, 1e-6).unwrap());
        });
    }
    group.finish();
}

criterion_group!(benches, queries, frames);
criterion_main!(benches);
