//! Several lanes where points within a radius are one answer: two lanes may find two of them, and one is listed.

#![allow(clippy::unwrap_used, reason = "a test")]

use std::sync::Mutex;

use satisfice::testing::difference;
use satisfice::{
    Bounds, Budget, Completeness, Encoding, IslandRound, Located, Region, Report, Rounds, SatisficingProblem,
    Search, Space, StopReason, Tickets, engine, from_fn,
};

const RADIUS: f64 = 0.02;

/// F = | sin 3x | with its bound. Every point evaluated below the threshold is written down.
struct Wave {
    space: Space<f64>,
    hits: Mutex<Vec<f64>>,
}

impl Wave {
    fn new() -> Self {
        Self {
            space: Space::cube(1, -1.0, 1.3).unwrap(),
            hits: Mutex::default(),
        }
    }
}

fn wave(x: f64) -> f64 {
    (3.0 * x).sin().abs()
}

impl SatisficingProblem for Wave {
    type Scalar = f64;
    type Solution = Located<f64>;
    fn space(&self) -> &Space<f64> {
        &self.space
    }
    fn decode(&self, values: &[f64]) -> Located<f64> {
        Located::new(values, RADIUS)
    }
    fn fitness(&self, at: &Located<f64>) -> f64 {
        let (x, fitness) = (at.coordinates[0], wave(at.coordinates[0]));
        if fitness < self.threshold() {
            self.hits.lock().unwrap().push(x);
        }
        fitness
    }
    fn threshold(&self) -> f64 {
        0.3
    }
    fn encoding(&self) -> Option<&dyn Encoding<f64, Located<f64>>> {
        Some(self)
    }
    fn bounds(&self) -> Option<&dyn Bounds<f64>> {
        Some(self)
    }
}

impl Encoding<f64, Located<f64>> for Wave {
    fn encode(&self, hit: &Located<f64>, values: &mut [f64]) -> bool {
        values.copy_from_slice(&hit.coordinates);
        true
    }
    fn covers(&self, hit: &Located<f64>, region: &Region<f64>) -> bool {
        hit.covers(region)
    }
}

impl Bounds<f64> for Wave {
    fn lower_bound(&self, region: &Region<f64>) -> Option<f64> {
        let (lower, upper) = (region.lower[0], region.upper[0]);
        let half_wave = |x: f64| (3.0 * x / core::f64::consts::PI).floor();
        let has_zero = half_wave(lower) != half_wave(upper);
        Some(if has_zero {
            0.0
        } else {
            wave(lower).min(wave(upper)) - 1e-9
        })
    }
}

/// The distance from a point to the next listed hit.
fn to_next(report: &Report<Located<f64>>, x: &[f64]) -> f64 {
    let away = |hit: &Located<f64>| {
        let squares = hit.coordinates.iter().zip(x).map(|(a, b)| (a - b) * (a - b));
        squares.sum::<f64>().sqrt()
    };
    report
        .hits()
        .map(|hit| away(hit.solution))
        .fold(f64::INFINITY, f64::min)
}

/// Hits are apart, and every point of a fine grid that is a hit is near a listed one.
#[test]
fn what_is_proved_is_true() {
    let mut proved = [0; 2];
    for (place, islands) in [2, 4].into_iter().enumerate() {
        for seed in 18..30 {
            let mut search = Search::new().seed(seed).islands(islands);
            let report = search.run(&Wave::new(), &Budget::evaluations(60_000)).unwrap();
            let mut hits: Vec<f64> = report.hits().map(|hit| hit.solution.coordinates[0]).collect();
            hits.sort_unstable_by(f64::total_cmp);
            assert!(hits.windows(2).all(|pair| pair[1] - pair[0] > RADIUS));
            if report.completeness != Completeness::Proved {
                continue;
            }
            proved[place] += 1;
            for step in 0..=23_000 {
                let x = -1.0 + f64::from(step) / 10_000.0;
                let away = to_next(&report, &[x]);
                let is_near = away <= RADIUS * (1.0 + 1e-12);
                assert!(
                    wave(x) >= 0.3 || is_near,
                    "{islands} islands, seed {seed}: {x}, {away}"
                );
            }
        }
    }
    assert!(proved.iter().all(|&count| count >= 10), "{proved:?}");
}

/// Also where an engine evaluates next to its own hits again.
#[test]
fn every_hit_that_was_evaluated_is_near_a_listed_one() {
    // Of a long search: a model of F, whose proposals take milliseconds, stays out of it.
    let budget = Budget::evaluations(4_000).with_horizon(100_000);
    for name in ["portfolio", "random", "descent-flood", "pso", "walk"] {
        for islands in [1, 2, 5] {
            for seed in 0..2 {
                let problem = Wave::new();
                let mut search = Search::named(name).unwrap().seed(seed).islands(islands);
                let report = search.run(&problem, &budget).unwrap();
                for &x in problem.hits.lock().unwrap().iter() {
                    let away = to_next(&report, &[x]);
                    let near = away <= RADIUS * (1.0 + 1e-12);
                    assert!(near, "{name}, {islands} islands, seed {seed}: {x}, {away}");
                }
                let counts = report.counts;
                let found = counts.evaluations - counts.duplicates;
                assert!(report.hit_count() as u64 <= found, "{counts:?}");
            }
        }
    }
}

/// A ball of answers in many dimensions, where an archive files hits by their places.
#[test]
fn hits_filed_by_their_places_are_near_listed_ones() {
    let evaluated = Mutex::new(Vec::new());
    let fitness = |x: &[f64]| {
        let value = x.iter().map(|x| x * x).sum::<f64>();
        if value < 0.8 {
            evaluated.lock().unwrap().push(x.to_vec());
        }
        value
    };
    let problem = from_fn(Space::cube(4, -1.0, 1.0).unwrap(), 0.8, fitness).separation(0.4);
    let mut search = Search::named("random").unwrap().islands(4).seed(2);
    let report = search.run(&problem, &Budget::evaluations(8_000)).unwrap();
    assert!(report.hit_count() > 80, "{}", report.hit_count());
    for x in evaluated.lock().unwrap().iter() {
        assert!(to_next(&report, x) <= 0.4 * (1.0 + 1e-12), "{x:?}");
    }
    for hit in report.hits() {
        let same = report
            .hits()
            .filter(|other| other.solution.coordinates != hit.solution.coordinates);
        let mut away = same.map(|other| {
            let squares = other.solution.coordinates.iter().zip(&hit.solution.coordinates);
            squares.map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
        });
        assert!(away.all(|away| away > 0.4));
    }
}

#[test]
fn a_limit_of_hits_is_one_of_listed_hits() {
    for seed in 0..20 {
        let budget = Budget::evaluations(40_000).and_hits(12);
        let mut search = Search::named("random").unwrap().seed(seed).islands(6);
        let report = search.run(&Wave::new(), &budget).unwrap();
        assert_eq!(
            (report.hit_count(), report.stop_reason),
            (12, StopReason::Hits),
            "{seed}"
        );
    }
}

/// By rounds in other processes, by tickets, and by hand with a file in between: the report of one search.
#[test]
fn wherever_lanes_run_the_report_is_the_same() {
    let budget = Budget::evaluations(6_000).with_horizon(100_000);
    for (name, islands) in [("portfolio", 3), ("random", 4)] {
        let search = || Search::<Wave>::named(name).unwrap().seed(20).islands(islands);
        let engine = || engine::ConfiguredEngine::named(name).unwrap();
        let report = search().run(&Wave::new(), &budget).unwrap();
        assert!(report.hit_count() > 10);

        let mut rounds = Rounds::begin(search(), Wave::new(), &budget).unwrap();
        loop {
            let round = rounds.round(&mut ());
            if round.is_empty() {
                break;
            }
            for island in round {
                let sent = serde_json::to_string(&island).unwrap();
                let island: IslandRound<Located<f64>> = serde_json::from_str(&sent).unwrap();
                rounds
                    .take(island.run(engine(), &Wave::new(), None).unwrap())
                    .unwrap();
            }
        }
        rounds.evaluate_probes();
        assert_eq!(difference(&report, &rounds.finish()), None, "{name}");

        let mut tickets = Tickets::ordered(search(), Wave::new(), &budget).unwrap();
        loop {
            let mut asked = tickets.ask(40);
            if asked.is_empty() {
                break;
            }
            asked.reverse();
            for asked in asked {
                let value = tickets.problem().fitness(&asked.solution);
                tickets.tell(asked.ticket, value).unwrap();
            }
        }
        assert_eq!(difference(&report, &tickets.finish()), None, "{name}");

        let (problem, mut search, mut batches) = (Wave::new(), search(), 0);
        let mut slice = search.start(&problem, &budget).unwrap();
        let mut saved = None;
        loop {
            let batch = slice.ask().unwrap();
            let fitness: Vec<f64> = batch.iter().map(|point| wave(point.coordinates[0])).collect();
            if fitness.is_empty() {
                break;
            }
            batches += 1;
            if batches == 7 {
                saved = Some(serde_json::to_string(&slice.checkpoint()).unwrap());
            }
            slice.tell(&fitness).unwrap();
        }
        assert_eq!(difference(&report, &slice.finish()), None, "{name}");
        let saved = serde_json::from_str(&saved.unwrap()).unwrap();
        let mut resumed = Search::resume(saved, engine()).unwrap();
        let resumed = resumed.run_resumed(&problem, Default::default()).unwrap();
        assert_eq!(difference(&report, &resumed), None, "{name}");
    }
}
