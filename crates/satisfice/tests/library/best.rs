//! Every hit carries its fitness, and a report knows the least fitness that was evaluated.

#![allow(clippy::unwrap_used, reason = "a test")]

use std::sync::Mutex;

use satisfice::{
    Axis, Budget, Hit, Located, Report, RunOptions, SatisficingProblem, Search, Space, engine, from_fn,
};

/// A valley along a curve, with a patch without a number, and every value of F that was computed.
struct Valley {
    space: Space<f64>,
    threshold: f64,
    computed: Mutex<Vec<f64>>,
}

impl Valley {
    fn new(threshold: f64) -> Self {
        let axes = [Axis::continuous(-2.0, 2.0), Axis::integer(-3, 3)];
        Self {
            space: Space::new(axes).unwrap(),
            threshold,
            computed: Mutex::default(),
        }
    }

    fn least(&self) -> f64 {
        let computed = self.computed.lock().unwrap();
        computed.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

fn value(x: &[f64]) -> f64 {
    if x[0] > 1.5 {
        f64::NEG_INFINITY // never a hit, and never the best
    } else {
        0.5 + (x[0] * x[0] - 0.1 * x[1]).abs()
    }
}

impl SatisficingProblem for Valley {
    type Scalar = f64;
    type Solution = Located<f64>;
    fn space(&self) -> &Space<f64> {
        &self.space
    }
    fn decode(&self, values: &[f64]) -> Located<f64> {
        Located::new(values, 0.01)
    }
    fn fitness(&self, solution: &Located<f64>) -> f64 {
        let fitness = value(&solution.coordinates);
        if fitness.is_finite() {
            self.computed.lock().unwrap().push(fitness);
        }
        fitness
    }
    fn threshold(&self) -> f64 {
        self.threshold
    }
}

fn is_true(report: &Report<Located<f64>>, valley: &Valley, name: &str) {
    for hit in report.hits() {
        assert_eq!(hit.fitness, value(&hit.solution.coordinates), "{name}");
        assert!(hit.fitness < valley.threshold, "{name}");
    }
    let best = report.best().unwrap();
    assert_eq!(best.fitness, value(&best.solution.coordinates), "{name}");
    assert_eq!(best.fitness, valley.least(), "{name}");
    assert!(
        (1..=report.counts.evaluations).contains(&best.evaluation),
        "{name}"
    );
}

#[test]
fn with_and_without_hits() {
    for entry in engine::all() {
        let evaluations = if entry.expensive_proposals { 150 } else { 1_500 };
        for threshold in [0.6, 0.5] {
            let valley = Valley::new(threshold);
            let mut search = Search::with(entry.configure([]).unwrap()).seed(5).probes(0.1);
            let report = search.run(&valley, &Budget::evaluations(evaluations)).unwrap();
            assert_eq!(report.hit_count() > 0, threshold > 0.5, "{}", entry.name);
            is_true(&report, &valley, entry.name);
        }
    }
}

#[test]
fn over_islands() {
    for threads in [1, 2] {
        let valley = Valley::new(0.51);
        let mut search = Search::named("walk")
            .unwrap()
            .islands(3)
            .threads(threads)
            .probes(0.05);
        let report = search.run(&valley, &Budget::evaluations(3_000)).unwrap();
        assert!(report.hit_count() > 0);
        is_true(&report, &valley, "walk");
    }
}

#[test]
fn after_a_checkpoint() {
    let valley = Valley::new(0.5);
    let mut search = Search::with(engine::LatestHitQpso::default()).seed(2);
    let mut slice = search.start(&valley, &Budget::evaluations(900)).unwrap();
    for _ in 0..10 {
        let fitness: Vec<f64> = slice.ask().unwrap().iter().map(|c| valley.fitness(c)).collect();
        slice.tell(&fitness).unwrap();
    }
    let saved = slice.checkpoint();
    let mut resumed = Search::resume(saved, engine::LatestHitQpso::default()).unwrap();
    let report = resumed.run_resumed(&valley, RunOptions::new()).unwrap();
    is_true(&report, &valley, "resumed");
}

#[test]
fn nothing_is_best_where_no_fitness_is_finite() {
    let nowhere = from_fn(Space::cube(1, 0.0, 1.0).unwrap(), 1.0, |_: &[f64]| f64::NAN).boxed();
    let report = Search::default()
        .run(&nowhere, &Budget::evaluations(200))
        .unwrap();
    assert!(report.best().is_none());
}

#[test]
fn observers_see_the_fitness() {
    let problem = from_fn(Space::lattice(1, 100).unwrap(), 5.0_f32, |x: &[f32]| x[0] + 0.1).boxed();
    let mut seen = Vec::new();
    let mut watch = |hit: Hit<'_, Located<f32>>, _: usize| {
        seen.push((hit.solution.coordinates[0], hit.fitness));
        std::ops::ControlFlow::Continue(())
    };
    Search::with(engine::Random::default())
        .run_with(
            &problem,
            &Budget::evaluations(500),
            RunOptions::new().observer(&mut watch),
        )
        .unwrap();
    assert_eq!(seen.len(), 5);
    for (x, fitness) in seen {
        assert_eq!(fitness, f64::from(x + 0.1_f32));
    }
}

/// Halves are represented by the whole number below, a representative that is no hit is not used.
struct Whole(Space<f64>);

impl SatisficingProblem for Whole {
    type Scalar = f64;
    type Solution = u32;
    fn space(&self) -> &Space<f64> {
        &self.0
    }
    fn decode(&self, values: &[f64]) -> u32 {
        values[0] as u32
    }
    fn fitness(&self, half: &u32) -> f64 {
        if *half == 4 { 100.0 } else { f64::from(*half) }
    }
    fn threshold(&self) -> f64 {
        10.0
    }
    fn canonical(&self, half: &u32) -> Option<u32> {
        (half % 2 == 1).then(|| half - 1)
    }
}

#[test]
fn a_representative_is_listed_with_its_own_fitness() {
    let report = Search::with(engine::Random::default())
        .run(
            &Whole(Space::lattice(1, 12).unwrap()),
            &Budget::evaluations(2_000),
        )
        .unwrap();
    let mut listed: Vec<_> = report.hits().map(|hit| (*hit.solution, hit.fitness)).collect();
    listed.sort_by_key(|hit| hit.0);
    assert_eq!(listed, [(0, 0.0), (2, 2.0), (5, 5.0), (6, 6.0), (8, 8.0)]);
    assert_eq!(report.best().unwrap().fitness, 0.0);
}
