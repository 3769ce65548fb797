//! The framework allocates for hits, archive and trace, never for an evaluation: counted by an allocator.

#![allow(clippy::unwrap_used, reason = "a test")]

use allocation_counter::measure;
use satisfice::engine::{self, EngineSpec};
use satisfice::{Budget, SatisficingProblem, Search, Space, from_fn};
use satisfice::{Encoding, Neighbourhood};

/// Pairs of indices, as in collision detection.
struct Pairs(Space<f64>);

impl SatisficingProblem for Pairs {
    type Scalar = f64;
    type Solution = [u32; 2];
    fn space(&self) -> &Space<f64> {
        &self.0
    }
    fn decode(&self, values: &[f64]) -> [u32; 2] {
        [values[0] as u32, values[1] as u32]
    }
    fn fitness(&self, &[i, j]: &[u32; 2]) -> f64 {
        (f64::from(i) - 700.0).abs() + (f64::from(j) - 300.0).abs()
    }
    fn threshold(&self) -> f64 {
        40.0
    }
    fn encoding(&self) -> Option<&dyn Encoding<f64, [u32; 2]>> {
        Some(self)
    }
    fn neighbourhood(&self) -> Option<&dyn Neighbourhood<[u32; 2]>> {
        Some(self)
    }
}

impl Encoding<f64, [u32; 2]> for Pairs {
    fn encode(&self, &[i, j]: &[u32; 2], values: &mut [f64]) -> bool {
        values.copy_from_slice(&[f64::from(i), f64::from(j)]);
        true
    }
}

impl Neighbourhood<[u32; 2]> for Pairs {
    fn count(&self, _: &[u32; 2]) -> usize {
        4
    }

    fn neighbour(&self, &[i, j]: &[u32; 2], index: usize) -> Option<[u32; 2]> {
        let (k, l) = match index {
            0 => (i.wrapping_sub(1), j),
            1 => (i + 1, j),
            2 => (i, j.wrapping_sub(1)),
            3 => (i, j + 1),
            _ => return None,
        };
        (k < 1000 && l < 1000).then_some([k, l])
    }
}

/// Allocations and hits of a run.
fn run<P: SatisficingProblem<Scalar = f64>>(problem: &P, entry: &EngineSpec, evaluations: u64) -> (u64, u64) {
    // Probes keep every solution that they hit, new or not: they are left out, whatever the engine wishes.
    let mut search = Search::with(entry.configure([]).unwrap()).seed(3).probes(0.0);
    let mut hits = 0;
    let allocations = measure(|| {
        let report = search.run(problem, &Budget::evaluations(evaluations)).unwrap();
        hits = report.hit_count() as u64;
    });
    (allocations.count_total, hits)
}

/// Allocations that grow with the logarithm of a run: each list that grows doubles once or twice in twice the evaluations.
const LISTS: u64 = 40;

/// Engines that keep a box in memory for each region that is still open, and whose regions grow with the evaluations.
const GROWING: &[&str] = &["branch-and-bound"];

fn a_longer_run_allocates_for_its_hits_only<P>(problem: &P, for_a_hit: u64)
where
    P: SatisficingProblem<Scalar = f64>,
{
    for entry in engine::all()
        .iter()
        .filter(|entry| !entry.expensive_proposals && !GROWING.contains(&entry.name))
    {
        let (short, hits_short) = run(problem, entry, 100_000);
        let (long, hits_long) = run(problem, entry, 200_000);
        let allowed = LISTS + for_a_hit * hits_long.saturating_sub(hits_short);
        assert!(
            long <= short + allowed,
            "{}: {short} allocations in 100,000 evaluations with {hits_short} hits, {long} in 200,000 with {hits_long}",
            entry.name
        );
    }
}

#[test]
fn on_pairs_of_indices() {
    let problem = Pairs(Space::lattice(2, 1000).unwrap());
    a_longer_run_allocates_for_its_hits_only(&problem, 0);
}

#[test]
fn on_a_continuous_closure() {
    // A located solution owns its coordinates: one allocation a hit, and one for a candidate that is a hit until it turns
    // out to be in C.
    let problem = from_fn(Space::cube(2, -1.0, 1.0).unwrap(), 0.05, |x: &[f64]| {
        (x[0].hypot(x[1]) - 0.5).abs()
    });
    a_longer_run_allocates_for_its_hits_only(&problem, 2);
}

/// Every pair is a hit.
struct Everything(Space<f64>);

impl SatisficingProblem for Everything {
    type Scalar = f64;
    type Solution = [u32; 2];
    fn space(&self) -> &Space<f64> {
        &self.0
    }
    fn decode(&self, values: &[f64]) -> [u32; 2] {
        [values[0] as u32, values[1] as u32]
    }
    fn fitness(&self, _: &[u32; 2]) -> f64 {
        0.0
    }
    fn threshold(&self) -> f64 {
        1.0
    }
}

/// A million hits; 20 million with `SATISFICE_EXAMINE=full`.
#[test]
fn a_hit_takes_64_bytes_beside_its_solution() {
    let full = std::env::var("SATISFICE_EXAMINE").is_ok_and(|extent| extent == "full");
    let hits = if full { 20_000_000 } else { 1_000_000 };
    let problem = Everything(Space::lattice(2, 1 << 30).unwrap());
    let mut search = Search::named("random").unwrap().seed(1).probes(0.0);
    let mut found = 0;
    let memory = measure(|| {
        let report = search.run(&problem, &Budget::evaluations(hits)).unwrap();
        found = report.hit_count() as u64;
    });
    assert_eq!(found, hits);
    let bytes = memory.bytes_current as f64 / hits as f64 - 8.0;
    let most = memory.bytes_max as f64 / hits as f64 - 8.0;
    println!("| bytes per hit beside its solution, {hits} hits: kept, at most | {bytes:.0}, {most:.0} |");
    assert!(most <= 64.0, "{bytes} bytes per hit, {most} at most");
}

#[test]
fn the_counter_counts() {
    let allocations = measure(|| drop::<Vec<u8>>(std::hint::black_box(Vec::with_capacity(10))));
    assert_eq!(allocations.count_total, 1);
}
