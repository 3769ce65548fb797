//! Triangle distances against parry3d-f64, on candidates of box pairs: time a pair, and wrong decisions.
//!
//! `cargo bench --bench distance`. Scenes are generated; with `SATISFICE_DATA` naming a folder that holds
//! `cloth_ball92.ply`, that cloth is measured too. Every method answers the same question for the same pairs in the
//! same run; parry is called through its dispatcher and directly through its GJK. Wrong decisions are counted on a
//! sample by rational arithmetic, also on pairs made hard (thresholds within 2^-54 to 2 of the distance).
#![allow(missing_docs, clippy::unwrap_used)]

#[path = "../crates/satisfice-collision/tests/stress/mod.rs"]
mod stress;

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::query::{self, details};
use parry3d_f64::shape;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;
use satisfice_collision::distance::{Threshold, Triangle, TriangleBatch, triangle_triangle};
use satisfice_collision::{Mesh, generate, io};
use stress::{families, referee};

type Pair = (Triangle, Triangle);

struct Scene {
    name: &'static str,
    delta: f64,
    pairs: Vec<Pair>,
}

fn triangles(mesh: &Mesh) -> Vec<Triangle> {
    (0..mesh.triangles().len()).map(|t| mesh.triangle(t)).collect()
}

/// Pairs whose boxes come within `delta` along every axis, without those that share a vertex; every `stride`-th is kept.
fn candidates(a: &[Triangle], b: &[Triangle], delta: f64, own: bool, stride: usize) -> Vec<Pair> {
    let bounds = |t: &Triangle| {
        let fold = |f: fn(f64, f64) -> f64| [0, 1, 2].map(|k| f(f(t[0][k], t[1][k]), t[2][k]));
        (fold(f64::min), fold(f64::max))
    };
    let sorted = |all: &[Triangle]| {
        let mut boxes: Vec<_> = all.iter().enumerate().map(|(k, t)| (bounds(t), k)).collect();
        boxes.sort_by(|x, y| x.0.0[0].total_cmp(&y.0.0[0]));
        boxes
    };
    let (boxes_a, boxes_b) = (sorted(a), sorted(b));
    let widest = boxes_b
        .iter()
        .map(|((low, high), _)| high[0] - low[0])
        .fold(0.0, f64::max);
    let mut pairs = Vec::new();
    for ((low_a, high_a), i) in &boxes_a {
        let from = boxes_b.partition_point(|((low, _), _)| low[0] < low_a[0] - delta - widest);
        for ((low_b, high_b), j) in boxes_b[from..]
            .iter()
            .take_while(|((low, _), _)| low[0] <= high_a[0] + delta)
        {
            let near = (0..3).all(|k| low_b[k] <= high_a[k] + delta && low_a[k] <= high_b[k] + delta);
            if near && !(own && (j <= i || a[*i].iter().any(|p| b[*j].contains(p)))) {
                pairs.push((a[*i], b[*j]));
            }
        }
    }
    pairs.into_iter().step_by(stride).collect()
}

fn scenes() -> Vec<Scene> {
    let teapot = generate::teapot(13).unwrap();
    let size = teapot.size();
    let a = triangles(&teapot);
    let (sin, cos) = 0.8_f64.sin_cos();
    let b: Vec<Triangle> = a
        .iter()
        .map(|t| {
            t.map(|[x, y, z]| {
                [
                    cos * x - sin * y + 0.45 * size,
                    sin * x + cos * y + 0.3 * size,
                    z + 0.1 * size,
                ]
            })
        })
        .collect();
    let mut scenes = Vec::new();
    for (name, share) in [
        ("teapots-0.002", 0.002),
        ("teapots-0.01", 0.01),
        ("teapots-0.05", 0.05),
    ] {
        let delta = share * size;
        let pairs = candidates(&a, &b, delta, false, 1);
        let stride = pairs.len() / 20_000 + 1;
        scenes.push(Scene {
            name,
            delta,
            pairs: pairs.into_iter().step_by(stride).collect(),
        });
    }
    if let Ok(folder) = std::env::var("SATISFICE_DATA") {
        let cloth = triangles(&io::read(format!("{folder}/cloth_ball92.ply")).unwrap());
        for (name, delta) in [("cloth-ball-self-0.01", 0.01), ("cloth-ball-self-0.05", 0.05)] {
            scenes.push(Scene {
                name,
                delta,
                pairs: candidates(&cloth, &cloth, delta, true, 47),
            });
        }
    } else {
        println!("SATISFICE_DATA is not set: the cloth-ball is left out");
    }
    scenes
}

fn to_parry(t: &Triangle) -> shape::Triangle {
    let [p, q, r] = t.map(Vector::from_array);
    shape::Triangle::new(p, q, r)
}

fn hits_in_batches(pairs: &[Pair], threshold: Threshold) -> usize {
    let mut hits = 0;
    let mut batch = TriangleBatch::new(threshold);
    for (a, b) in pairs {
        batch.push(a, b, (), |(), decision| hits += usize::from(decision.within));
    }
    batch.finish(|(), decision| hits += usize::from(decision.within));
    hits
}

fn times(criterion: &mut Criterion) {
    for scene in scenes() {
        let threshold = Threshold::new(scene.delta).unwrap();
        let theirs: Vec<_> = scene
            .pairs
            .iter()
            .map(|(a, b)| (to_parry(a), to_parry(b)))
            .collect();
        let here = Pose::identity();
        let mut group = criterion.benchmark_group(format!("triangle-triangle/{}", scene.name));
        group.throughput(Throughput::Elements(scene.pairs.len() as u64));
        group.sample_size(20);
        group.measurement_time(std::time::Duration::from_secs(2));
        group.warm_up_time(std::time::Duration::from_millis(300));
        group.bench_function("ours/decide-batch", |b| {
            b.iter(|| hits_in_batches(black_box(&scene.pairs), threshold));
        });
        group.bench_function("ours/decide", |b| {
            b.iter(|| {
                scene
                    .pairs
                    .iter()
                    .filter(|(a, b)| triangle_triangle::within(a, b, threshold))
                    .count()
            });
        });
        group.bench_function("parry/distance", |b| {
            b.iter(|| {
                let near = |(a, b): &&(shape::Triangle, shape::Triangle)| {
                    query::distance(&here, a, &here, b).unwrap().distance < scene.delta
                };
                theirs.iter().filter(near).count()
            });
        });
        group.bench_function("parry/gjk", |b| {
            b.iter(|| {
                let near = |(a, b): &&(shape::Triangle, shape::Triangle)| {
                    details::distance_support_map_support_map(&here, a, b) < scene.delta
                };
                theirs.iter().filter(near).count()
            });
        });
        group.bench_function("ours/proximity", |b| {
            b.iter(|| {
                scene
                    .pairs
                    .iter()
                    .map(|(a, b)| triangle_triangle::proximity(a, b).distance)
                    .sum::<f64>()
            });
        });
        group.finish();
        let sample = scene.pairs.iter().step_by(scene.pairs.len() / 2000 + 1);
        count_wrong(scene.name, sample.map(|&(a, b)| (a, b, scene.delta)));
    }
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
    for name in [
        "random",
        "near-parallel",
        "near-coplanar",
        "slivers to 1:1e12",
        "small integers",
        "offsets to 1e12",
    ] {
        let family = families::ALL.iter().find(|family| family.name == name).unwrap();
        let hard: Vec<_> = (0..2000)
            .map(|_| {
                let (a, b) = (family.draw)(&mut rng);
                let near = triangle_triangle::proximity(&a, &b).distance;
                (a, b, families::threshold_near(near, &mut rng))
            })
            .collect();
        count_wrong(name, hard.into_iter());
    }
}

/// Decisions that differ from rational arithmetic.
fn count_wrong(name: &str, pairs: impl Iterator<Item = (Triangle, Triangle, f64)>) {
    let here = Pose::identity();
    let (mut all, mut ours, mut theirs) = (0, 0, 0);
    for (a, b, delta) in pairs {
        let truth = referee::squared_distance(&a, &b).is_below(delta);
        all += 1;
        ours += usize::from(hits_in_batches(&[(a, b)], Threshold::new(delta).unwrap()) != usize::from(truth));
        let distance =
            query::distance(&here, &to_parry(&a), &here, &to_parry(&b)).map_or(f64::NAN, |d| d.distance);
        theirs += usize::from((distance < delta) != truth);
    }
    println!("wrong decisions, {name}: ours {ours}, parry {theirs}, of {all}");
}

criterion_group!(benches, times);
criterion_main!(benches);
