//! What users of a model of F meet: evaluations that fail, several at once, many axes.

#![allow(clippy::unwrap_used, reason = "a test")]

use satisfice::{Budget, Search, Space, engine, from_fn};

/// A number in [0, 1) that says nothing of the point.
fn chance(x: &[f64]) -> f64 {
    let mix = |key: u64, x: &f64| {
        let key = (key ^ x.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        key ^ (key >> 29)
    };
    let word = x
        .iter()
        .fold(0x5bd1_e995_u64, mix)
        .wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (word >> 11) as f64 / (1_u64 << 53) as f64
}

/// Mean hits of a ring, of 100 evaluations of which this share fails, whatever the point.
fn hits_of_a_ring(engine: &str, failing: f64) -> usize {
    let mut all = 0;
    for seed in 0..4 {
        let ring = move |x: &[f64]| {
            if chance(&[x[0], x[1], seed as f64]) < failing {
                f64::NAN
            } else {
                (x[0] * x[0] + x[1] * x[1] - 1.5).abs()
            }
        };
        let problem = from_fn(Space::cube(2, -2.0, 2.0).unwrap(), 0.1, ring).separation(0.05);
        let mut search = Search::named(engine).unwrap().seed(seed);
        all += search
            .run(&problem, &Budget::evaluations(100))
            .unwrap()
            .hit_count();
    }
    all / 4
}

/// While a failure counted as bad wherever it was, a tenth of the evaluations cost more than half of the hits.
#[test]
fn evaluations_that_fail_by_chance_cost_little_more_than_their_share() {
    for engine in ["portfolio", "surrogate"] {
        let [none, some] = [0.0, 0.1].map(|failing| hits_of_a_ring(engine, failing));
        assert!(none > 60 && some * 10 > none * 7, "{engine}: {none}, {some}");
    }
}

/// Half of the square has no F. The model has to stay out of it, though hits are next to it.
#[test]
fn a_region_without_f_is_left() {
    let half = |x: &[f64]| {
        if x[0] > 0.0 {
            f64::NAN
        } else {
            (x[0] + 0.2).hypot(x[1])
        }
    };
    let problem = from_fn(Space::cube(2, -2.0, 2.0).unwrap(), 0.4, half).separation(0.02);
    for seed in 0..4 {
        let mut search = Search::with(engine::Surrogate::default()).seed(seed);
        let report = search.run(&problem, &Budget::evaluations(100)).unwrap();
        assert!(report.counts.non_finite < 30, "{}", report.counts.non_finite);
        assert!(report.hit_count() > 50, "{}", report.hit_count());
    }
}

#[test]
fn the_model_alone_proposes_as_many_points_as_go_on_at_once() {
    let problem = from_fn(Space::cube(3, -1.0, 1.0).unwrap(), 0.05, |x: &[f64]| {
        x.iter().map(|x| x * x).sum()
    });
    let budget = Budget::evaluations(60).with_parallel(12);
    let mut search = Search::with(engine::Surrogate::default());
    let mut stepper = search.start(&problem, &budget).unwrap();
    let mut batches = Vec::new();
    loop {
        let batch = stepper.ask().unwrap();
        if batch.is_empty() {
            break;
        }
        let values: Vec<f64> = batch.iter().map(|hit| problem_value(&hit.coordinates)).collect();
        batches.push(values.len());
        stepper.tell(&values).unwrap();
    }
    assert_eq!(batches, [12; 5]);
}

fn problem_value(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum()
}

/// A cover of sets of which each element is in four: 60 axes with two values.
#[test]
fn the_default_has_a_model_on_many_axes() {
    const AXES: usize = 60;
    let at = |k: usize| (chance(&[k as f64]) * AXES as f64) as usize;
    let problem = from_fn(Space::lattice(AXES, 2).unwrap(), 6.0, move |x: &[f64]| {
        let covered = |set: usize| (0..4).map(|k| x[at(4 * set + k)]).sum::<f64>();
        (0..AXES / 2).map(|set| (covered(set) - 1.0).abs()).sum()
    });
    let hits = |without: &str| {
        let mut search = Search::named("portfolio").unwrap().seed(1);
        if !without.is_empty() {
            search = search.set("without", without).unwrap();
        }
        search
            .run(&problem, &Budget::evaluations(300))
            .unwrap()
            .hit_count()
    };
    let (with, without) = (hits(""), hits("model"));
    assert!(with > 2 * without && with > 20, "{with}, {without}");
}
