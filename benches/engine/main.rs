//! What an evaluation costs: every engine on a free fitness, on the teapots and on a fitness of ten microseconds, the archive,
//! and beside them what one would compare with: the same arithmetic as a loop written by hand, argmin's particle swarm, two
//! threads.
//!
//! `cargo bench --bench engine` runs everything; the figures are times of whole runs and elements (evaluations) a second. Then
//! come the ratios, measured in interleaved rounds and written to `docs/results/engine.md`; `cargo bench --bench engine --
//! ratios` runs these alone. Seeds are fixed.
#![allow(missing_docs, clippy::unwrap_used)]

mod loops;
#[path = "../page.rs"]
mod page;
mod peers;
mod problems;
mod ratios;

use core::time::Duration;
use std::hint::black_box;

use criterion::{BenchmarkGroup, Criterion, Throughput};
use loops::{latest_hit_loop, random_loop};
use problems::{Lattice, Slow};
use satisfice::catalogue::{Catalogued, Params};
use satisfice::{Archive, Budget, Located, SatisficingProblem, Search, SearchRng, engine};
use satisfice_collision::problem::Teapots;

type Group<'a> = BenchmarkGroup<'a, criterion::measurement::WallTime>;

pub(crate) fn search<P>(problem: &P, name: &str, evaluations: usize, seed: u64) -> usize
where
    P: SatisficingProblem<Scalar = f64>,
{
    // Probes are not part of the comparison: no loop has them.
    let mut search = Search::named(name).unwrap().seed(seed).probes(0.0);
    let report = search
        .run(problem, &Budget::evaluations(evaluations as u64))
        .unwrap();
    report.hit_count()
}

fn every_engine<P>(c: &mut Criterion, group: &str, name: &str, problem: &P, evaluations: usize)
where
    P: SatisficingProblem<Scalar = f64, Solution = (u32, u32)>,
{
    let mut group = c.benchmark_group(group);
    settings(&mut group, evaluations);
    group.bench_function(format!("latest-hit-loop/{name}"), |b| {
        b.iter(|| latest_hit_loop(black_box(problem), evaluations, 7));
    });
    group.bench_function(format!("random-loop/{name}"), |b| {
        b.iter(|| random_loop(black_box(problem), evaluations, 7));
    });
    // The two that have a loop first, beside them.
    let engines = engine::all().iter().filter(|entry| !entry.expensive_proposals);
    let mut names: Vec<_> = engines.map(|entry| entry.name).collect();
    names.sort_by_key(|name| !["latest-hit-qpso", "random"].contains(name));
    for engine in names {
        group.bench_function(format!("{engine}/{name}"), |b| {
            b.iter(|| search(black_box(problem), engine, evaluations, 7));
        });
    }
    group.finish();
}

fn settings(group: &mut Group<'_>, evaluations: usize) {
    group
        .throughput(Throughput::Elements(evaluations as u64))
        .sample_size(15)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_millis(1500));
}

fn engines(c: &mut Criterion) {
    every_engine(c, "free", "lattice", &Lattice::new(), 20_000);
    every_engine(c, "teapots", "teapots", &teapots(), 20_000);
    every_engine(c, "ten-microseconds", "lattice", &Slow::new(), 1_000);
}

/// Two teapots, as `satisfice run teapots` takes them by default.
pub(crate) fn teapots() -> Teapots {
    Teapots::from_params(&Params::defaults(Teapots::PARAMETERS).unwrap()).unwrap()
}

fn archive(c: &mut Criterion) {
    let mut group = c.benchmark_group("archive");
    for hits in [1_000_u32, 100_000, 1_000_000] {
        let mut rng = SearchRng::new(1);
        let pairs: Vec<(u32, u32)> = (0..hits)
            .map(|_| (rng.below(1 << 20) as u32, rng.below(1 << 20) as u32))
            .collect();
        let others: Vec<(u32, u32)> = pairs.iter().map(|&(i, j)| (i + (1 << 20), j)).collect();
        settings(&mut group, pairs.len());
        let fill = || {
            let mut archive = Archive::default();
            for (n, &pair) in pairs.iter().enumerate() {
                archive.insert(pair, -1.0, n as u64, 0.0);
            }
            archive
        };
        let archive = fill();
        group.bench_function(format!("insert/{hits}"), |b| b.iter(fill));
        for (what, sought) in [("found", &pairs), ("not-found", &others)] {
            group.bench_function(format!("{what}/{hits}"), |b| {
                b.iter(|| sought.iter().filter(|pair| archive.contains(pair)).count());
            });
        }
    }
    group.finish();
}

/// Look-ups and entries where hits are steps along axes from each other, little longer than the separation: keys say little there.
fn crowded(c: &mut Criterion) {
    let mut group = c.benchmark_group("crowded");
    for (axes, hits) in [
        (6, 10_000),
        (6, 100_000),
        (20, 1_000),
        (20, 10_000),
        (20, 100_000),
    ] {
        let mut rng = SearchRng::new(1);
        let mut points = vec![Located::new(&vec![0.0; axes], 1.0)];
        while points.len() < hits {
            let mut point = points[rng.below(points.len())].clone();
            point.coordinates[rng.below(axes)] += if rng.uniform() < 0.5 { 1.1 } else { -1.1 };
            points.push(point);
        }
        settings(&mut group, hits);
        group.bench_function(format!("insert/{axes}-axes/{hits}"), |b| {
            b.iter(|| {
                let mut archive = Archive::default();
                for (n, point) in points.iter().enumerate() {
                    archive.insert(point.clone(), -1.0, n as u64, 0.0);
                }
                archive
            });
        });
    }
    group.finish();
}

fn peers(c: &mut Criterion) {
    let mut group = c.benchmark_group("peers");
    settings(&mut group, peers::EVALUATIONS);
    group.bench_function("argmin-pso/himmelblau", |b| b.iter(peers::argmin_swarm));
    group.bench_function("pso/himmelblau", |b| b.iter(|| peers::our_swarm("1")));
    group.bench_function("pso-by-sweeps/himmelblau", |b| b.iter(|| peers::our_swarm("40")));
    group.finish();
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let only = arguments.iter().find(|argument| !argument.starts_with("--"));
    if only.is_none_or(|only| only != "ratios") {
        let mut criterion = Criterion::default().configure_from_args();
        engines(&mut criterion);
        archive(&mut criterion);
        crowded(&mut criterion);
        peers(&mut criterion);
        criterion.final_summary();
    }
    if only.is_none_or(|only| only == "ratios") {
        ratios::run(arguments.iter().any(|argument| argument == "--bench"));
    }
}
