//! What is kept from evaluation has no hits, and sparing it pays.

use crate::Bounds;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::engine::{ConfiguredEngine, all, find};
use crate::testing::engine::check;
use crate::{Budget, Completeness, Region, Report, SatisficingProblem, Search, Space};

/// Lattice points within a width of a sphere, with a bound; counts evaluations far away.
struct LatticeShell {
    space: Space<f64>,
    radius: f64,
    far: AtomicU64,
}

impl LatticeShell {
    fn new(dimension: usize, cells: u32, radius: f64) -> Self {
        Self {
            space: Space::lattice(dimension, cells).unwrap(),
            radius,
            far: AtomicU64::new(0),
        }
    }
    fn centre(&self) -> f64 {
        self.space.axes()[0].upper() / 4.0
    }
}

impl SatisficingProblem for LatticeShell {
    type Scalar = f64;
    type Solution = Vec<u32>;
    fn space(&self) -> &Space<f64> {
        &self.space
    }
    fn decode(&self, values: &[f64]) -> Vec<u32> {
        values.iter().map(|&x| x as u32).collect()
    }
    fn fitness(&self, at: &Vec<u32>) -> f64 {
        let square: f64 = at.iter().map(|&x| (f64::from(x) - self.centre()).powi(2)).sum();
        let distance = square.sqrt();
        if distance > 3.0 * self.radius {
            self.far.fetch_add(1, Ordering::Relaxed);
        }
        (distance - self.radius).abs()
    }
    fn threshold(&self) -> f64 {
        0.5
    }
    fn bounds(&self) -> Option<&dyn Bounds<f64>> {
        Some(self)
    }
}

impl Bounds<f64> for LatticeShell {
    fn lower_bound(&self, region: &Region<f64>) -> Option<f64> {
        let ends = || region.lower.iter().zip(&region.upper);
        let c = self.centre();
        let nearest: f64 = ends().map(|(&l, &u)| (c.max(l).min(u) - c).powi(2)).sum();
        let farthest: f64 = ends()
            .map(|(&l, &u)| (c - l).abs().max((u - c).abs()).powi(2))
            .sum();
        Some(
            (nearest.sqrt() - self.radius)
                .max(self.radius - farthest.sqrt())
                .max(0.0),
        )
    }
}

fn run(problem: &LatticeShell, engine: &str, pruned: bool, evaluations: u64) -> Report<Vec<u32>> {
    let engine = find(engine).unwrap().configure([]).unwrap();
    let engine = if pruned { engine.pruned() } else { engine };
    let mut search = Search::with(engine).seed(4);
    search.run(problem, &Budget::evaluations(evaluations)).unwrap()
}

#[test]
fn dead_regions_are_hardly_sampled_and_hits_are_not_lost() {
    for entry in all().iter().filter(|entry| !entry.expensive_proposals) {
        let (plain, sparing) = (LatticeShell::new(3, 100, 12.0), LatticeShell::new(3, 100, 12.0));
        let before = run(&plain, entry.name, false, 20_000);
        let after = run(&sparing, entry.name, true, 20_000);
        let spent = after.counts.evaluations + after.counts.bound_calls;
        assert!(spent <= 20_002, "{}: {spent}", entry.name);
        let (before_far, after_far) = (
            plain.far.load(Ordering::Relaxed),
            sparing.far.load(Ordering::Relaxed),
        );
        assert!(
            after_far <= before_far / 2 + 500,
            "{}: {before_far} {after_far}",
            entry.name
        );
        assert!(
            after.hit_count() * 2 >= before.hit_count(),
            "{}: {} {}",
            entry.name,
            before.hit_count(),
            after.hit_count()
        );
    }
}

#[test]
fn uniform_sampling_gains_what_the_dead_part_was() {
    let before = run(&LatticeShell::new(3, 100, 12.0), "random", false, 20_000);
    let after = run(&LatticeShell::new(3, 100, 12.0), "random", true, 20_000);
    assert!(
        after.hit_count() > 5 * before.hit_count(),
        "{} {}",
        before.hit_count(),
        after.hit_count()
    );
}

#[test]
fn a_space_without_hits_is_proved_to_have_none() {
    let report = run(&LatticeShell::new(2, 50, 500.0), "walk", true, 1000);
    assert_eq!(
        (report.hit_count(), report.completeness, report.counts.evaluations),
        (0, Completeness::Proved, 0)
    );
}

#[test]
fn resumed_it_goes_on() {
    for name in ["random", "latest-hit-qpso", "descent-flood"] {
        let problem = LatticeShell::new(3, 60, 9.0);
        let make = || find(name).unwrap().configure::<f64>([]).unwrap().pruned();
        let mut search = Search::with(make()).seed(2);
        let mut slice = search.start(&problem, &Budget::evaluations(3000)).unwrap();
        let mut resumed = None;
        for batch in 0.. {
            let candidates = slice.ask().unwrap().to_vec();
            if candidates.is_empty() {
                break;
            }
            if batch == 40 {
                resumed = Some(Search::resume(slice.checkpoint(), make()).unwrap());
            }
            let fitness: Vec<f64> = candidates.iter().map(|c| problem.fitness(c)).collect();
            slice.tell(&fitness).unwrap();
        }
        let expected = slice.finish();
        let report = resumed
            .unwrap()
            .run_resumed(&problem, crate::RunOptions::new())
            .unwrap();
        assert!(expected.counts.bound_calls > 20);
        assert_eq!(report.counts, expected.counts);
        let hits = |report: &Report<Vec<u32>>| -> Vec<_> {
            report
                .hits()
                .map(|hit| (hit.solution.clone(), hit.evaluation))
                .collect()
        };
        assert_eq!(hits(&report), hits(&expected));
    }
}

#[test]
fn without_bounds_nothing_changes() {
    let violations = check::<f64>(&ConfiguredEngine::named("random").unwrap().pruned()).unwrap();
    assert!(violations.is_empty(), "{:?}", violations.first());
    let problem = crate::from_fn(Space::lattice(2, 50).unwrap(), 60.0, |x: &[f64]| x[0] * x[1]).boxed();
    let budget = Budget::evaluations(2000);
    let make = || find("latest-hit-qpso").unwrap().configure::<f64>([]).unwrap();
    let one = Search::with(make()).run(&problem, &budget).unwrap();
    let two = Search::with(make().pruned()).run(&problem, &budget).unwrap();
    assert_eq!(one.counts, two.counts);
    assert!(
        one.hits()
            .map(|hit| hit.evaluation)
            .eq(two.hits().map(|hit| hit.evaluation))
    );
}
