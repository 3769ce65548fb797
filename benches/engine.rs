//! What an evaluation costs: every engine on a free fitness, on the teapots and on a fitness of ten microseconds, the same
//! arithmetic as a hand-written loop beside the engine that it copies, one thread and two, the archive, and argmin's particle
//! swarm.
//!
//! `cargo bench --bench engine`; the figures are nanoseconds an evaluation (elements a second). Seeds are fixed. The
//! hand-written loops draw the same numbers as the engines: their hits are compared first.
#![allow(missing_docs, clippy::unwrap_used)]

use core::time::Duration;
use std::hint::black_box;

use argmin::core::{CostFunction, Executor};
use argmin::solver::particleswarm::ParticleSwarm;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use foldhash::fast::FixedState;
use hashbrown::HashSet;
use rand_xoshiro_07::Xoshiro256PlusPlus;
use rand_xoshiro_07::rand_core::SeedableRng;
use satisfice::{
    Archive, Budget, Catalogued, SatisficingProblem, Search, SearchRng, Space, Values, engine, from_fn,
};
use satisfice_collision::problem::Teapots;

type Group<'a> = BenchmarkGroup<'a, criterion::measurement::WallTime>;

/// Two indices, and hits in a diamond of 1,200 of a million points: next to nothing to compute.
struct Lattice(Space<f64>);

impl Lattice {
    fn new() -> Self {
        Self(Space::lattice(2, 1000).unwrap())
    }
}

impl SatisficingProblem for Lattice {
    type Scalar = f64;
    type Solution = (u32, u32);
    fn space(&self) -> &Space<f64> {
        &self.0
    }
    #[inline]
    fn decode(&self, values: &[f64]) -> (u32, u32) {
        (values[0] as u32, values[1] as u32)
    }
    #[inline]
    fn fitness(&self, &(i, j): &(u32, u32)) -> f64 {
        (f64::from(i) - 700.0).abs() + (f64::from(j) - 300.0).abs()
    }
    fn threshold(&self) -> f64 {
        25.0
    }
    fn encode(&self, &(i, j): &(u32, u32), values: &mut [f64]) -> bool {
        values.copy_from_slice(&[f64::from(i), f64::from(j)]);
        true
    }
    fn neighbours(&self, &(i, j): &(u32, u32), visit: &mut dyn FnMut((u32, u32))) -> bool {
        for (k, l) in [
            (i.wrapping_sub(1), j),
            (i + 1, j),
            (i, j.wrapping_sub(1)),
            (i, j + 1),
        ] {
            if k < 1000 && l < 1000 {
                visit((k, l));
            }
        }
        true
    }
}

/// The lattice, with arithmetic of about ten microseconds before each answer.
struct Slow(Lattice);

impl SatisficingProblem for Slow {
    type Scalar = f64;
    type Solution = (u32, u32);
    fn space(&self) -> &Space<f64> {
        self.0.space()
    }
    fn decode(&self, values: &[f64]) -> (u32, u32) {
        self.0.decode(values)
    }
    fn fitness(&self, solution: &(u32, u32)) -> f64 {
        let mut x = 1.0_f64;
        for _ in 0..2000 {
            // A chain of divisions of some 5 ns each.
            x = black_box(1.0 + 1.0 / x);
        }
        self.0.fitness(solution) + 0.0 * x
    }
    fn threshold(&self) -> f64 {
        self.0.threshold()
    }
    fn encode(&self, solution: &(u32, u32), values: &mut [f64]) -> bool {
        self.0.encode(solution, values)
    }
    fn neighbours(&self, of: &(u32, u32), visit: &mut dyn FnMut((u32, u32))) -> bool {
        self.0.neighbours(of, visit)
    }
}

/// Latest-hit QPSO without the framework: two integer axes, reflection, a set of hits, and nothing else.
fn latest_hit_loop<P>(problem: &P, evaluations: usize, seed: u64) -> usize
where
    P: SatisficingProblem<Scalar = f64, Solution = (u32, u32)>,
{
    const N: usize = 30;
    let width: [f64; 2] = core::array::from_fn(|j| problem.space().axes()[j].end());
    let last = width.map(|w| w - 1.0);
    let threshold = problem.threshold();
    let mut rng = SearchRng::new(seed);
    let mut hits: HashSet<(u32, u32), FixedState> = HashSet::default();
    let decode = |x: &[f64; 2]| problem.decode(&[x[0].floor().min(last[0]), x[1].floor().min(last[1])]);

    let mut positions = [[0.0; 2]; N];
    for x in &mut positions {
        *x = core::array::from_fn(|j| rng.uniform() * width[j]);
    }
    let mut fitness = positions.map(|x| {
        let solution = decode(&x);
        let f = if hits.contains(&solution) {
            f64::INFINITY
        } else {
            problem.fitness(&solution)
        };
        if f < threshold {
            hits.insert(solution);
        }
        f
    });
    let mut bests = positions;
    let mut latest: Option<[f64; 2]> = None;
    let mut leader = (0..N).min_by(|&a, &b| fitness[a].total_cmp(&fitness[b])).unwrap();

    let (mut i, mut mean) = (0, [0.0; 2]);
    for _ in N..evaluations {
        if i == 0 {
            mean = [0.0; 2];
            for best in &bests {
                for j in 0..2 {
                    mean[j] += best[j] * (1.0 / N as f64);
                }
            }
        }
        let attractor = latest.unwrap_or(bests[leader]);
        let mut x = positions[i];
        for j in 0..2 {
            let (phi, negative) = rng.uniform_and_sign();
            let centre = attractor[j] + phi * (bests[i][j] - attractor[j]);
            let spread = (mean[j] - x[j]).abs() * rng.exponential();
            x[j] = if negative {
                centre - spread
            } else {
                centre + spread
            };
            if !(0.0..=width[j]).contains(&x[j]) {
                let rest = x[j].abs() % (2.0 * width[j]);
                x[j] = if rest > width[j] {
                    width[j] - (rest - width[j])
                } else {
                    rest
                };
            }
        }
        positions[i] = x;
        let solution = decode(&x);
        if !hits.contains(&solution) {
            let f = problem.fitness(&solution);
            if f < threshold {
                hits.insert(solution);
                latest = Some(x);
                bests[i] = x;
                fitness[i] = f;
            } else if f < fitness[i] {
                bests[i] = x;
                fitness[i] = f;
                if f < fitness[leader] {
                    leader = i;
                }
            }
        }
        i = if i + 1 == N { 0 } else { i + 1 };
    }
    hits.len()
}

/// Uniform sampling without the framework.
fn random_loop<P>(problem: &P, evaluations: usize, seed: u64) -> usize
where
    P: SatisficingProblem<Scalar = f64, Solution = (u32, u32)>,
{
    let width: [f64; 2] = core::array::from_fn(|j| problem.space().axes()[j].end());
    let mut rng = SearchRng::new(seed);
    let mut hits: HashSet<(u32, u32), FixedState> = HashSet::default();
    for _ in 0..evaluations {
        let x = width.map(|w| (rng.uniform() * w).floor().min(w - 1.0));
        let solution = problem.decode(&x);
        if !hits.contains(&solution) && problem.fitness(&solution) < problem.threshold() {
            hits.insert(solution);
        }
    }
    hits.len()
}

fn search<P>(problem: &P, name: &str, evaluations: usize, seed: u64) -> usize
where
    P: SatisficingProblem<Scalar = f64>,
{
    // Probes are not part of the comparison: no loop has them.
    let mut search = Search::new(engine::build(name).unwrap()).seed(seed).probes(0.0);
    let report = search
        .run(problem, &Budget::evaluations(evaluations as u64))
        .unwrap();
    report.hit_count()
}

fn every_engine<P>(c: &mut Criterion, group: &str, name: &str, problem: &P, evaluations: usize)
where
    P: SatisficingProblem<Scalar = f64, Solution = (u32, u32)>,
{
    assert_eq!(
        search(problem, "latest-hit-qpso", evaluations, 7),
        latest_hit_loop(problem, evaluations, 7),
        "the loop does not do what the engine does"
    );
    assert_eq!(
        search(problem, "random", evaluations, 7),
        random_loop(problem, evaluations, 7)
    );
    let mut group = c.benchmark_group(group);
    settings(&mut group, evaluations);
    group.bench_function(format!("latest-hit-loop/{name}"), |b| {
        b.iter(|| latest_hit_loop(black_box(problem), evaluations, 7));
    });
    group.bench_function(format!("random-loop/{name}"), |b| {
        b.iter(|| random_loop(black_box(problem), evaluations, 7));
    });
    // The two that have a loop first, beside them.
    let mut names: Vec<_> = engine::all().iter().map(|entry| entry.name).collect();
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
    let values = Values::defaults(Teapots::PARAMETERS).unwrap();
    every_engine(
        c,
        "teapots",
        "teapots",
        &Teapots::from_values(&values).unwrap(),
        20_000,
    );
    every_engine(c, "ten-microseconds", "lattice", &Slow(Lattice::new()), 1_000);
}

/// Ten-microsecond evaluations in batches of at least 64, on one thread and on two: the ratio is the speed-up.
fn threads(c: &mut Criterion) {
    let problem = Slow(Lattice::new());
    let evaluations = 4_096;
    let mut group = c.benchmark_group("threads");
    settings(&mut group, evaluations);
    for (name, batch) in [("random", "64"), ("portfolio", "64")] {
        for threads in [1, 2] {
            group.bench_function(format!("{name}/{threads}"), |b| {
                b.iter(|| {
                    let engine = engine::find(name).unwrap().build([("batch", batch)]).unwrap();
                    let mut search = Search::new(engine).seed(7).threads(threads);
                    let budget = Budget::evaluations(evaluations as u64);
                    search.run(black_box(&problem), &budget).unwrap().hit_count()
                });
            });
        }
    }
    group.finish();
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
                archive.insert(pair, n as u64, 0.0);
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

/// Himmelblau's function, on [-6, 6]^2: the cheap problem in two continuous variables.
fn himmelblau(x: &[f64]) -> f64 {
    let (a, b) = (x[0] * x[0] + x[1] - 11.0, x[0] + x[1] * x[1] - 7.0);
    a * a + b * b
}

struct Himmelblau;

impl CostFunction for Himmelblau {
    type Param = Vec<f64>;
    type Output = f64;
    fn cost(&self, x: &Vec<f64>) -> Result<f64, argmin::core::Error> {
        Ok(himmelblau(x))
    }
}

const PARTICLES: usize = 40;
const SWEEPS: usize = 500;

/// argmin's swarm, set up as its documentation does, with a generator as fast as ours. It counts nothing and keeps the best
/// point only.
fn argmin_swarm() -> f64 {
    let rng = Xoshiro256PlusPlus::seed_from_u64(7);
    let solver = ParticleSwarm::new((vec![-6.0, -6.0], vec![6.0, 6.0]), PARTICLES).with_rng_generator(rng);
    let result = Executor::new(Himmelblau, solver)
        .configure(|state| state.max_iters(SWEEPS as u64))
        .run()
        .unwrap();
    result.state.get_best_cost()
}

/// Constriction PSO with as many particles and evaluations, one at a time or a sweep at once.
fn our_swarm(batch: &str) -> usize {
    let problem = from_fn(Space::cube(2, -6.0, 6.0).unwrap(), 1e-2, himmelblau).separation(0.5);
    let particles = PARTICLES.to_string();
    let settings = [("particles", particles.as_str()), ("batch", batch)];
    let engine = engine::find("pso").unwrap().build(settings).unwrap();
    let budget = Budget::evaluations((PARTICLES * (SWEEPS + 1)) as u64);
    let report = Search::new(engine).seed(7).run(&problem, &budget).unwrap();
    report.hit_count()
}

fn peers(c: &mut Criterion) {
    let mut group = c.benchmark_group("peers");
    settings(&mut group, PARTICLES * (SWEEPS + 1));
    group.bench_function("argmin-pso/himmelblau", |b| b.iter(argmin_swarm));
    group.bench_function("pso/himmelblau", |b| b.iter(|| our_swarm("1")));
    group.bench_function("pso-by-sweeps/himmelblau", |b| b.iter(|| our_swarm("40")));
    group.finish();
}

criterion_group!(benches, engines, threads, archive, peers);
criterion_main!(benches);
