//! What individual sources of the default engine contribute.

#![allow(clippy::unwrap_used, reason = "a test")]

use core::f64::consts::TAU;

use satisfice::problem::{BoxedFn, FnProblem};
use satisfice::{Budget, Completeness, Search, Space, engine, from_fn};

/// Hits of three seeds together.
fn hits(
    without: &str,
    evaluations: u64,
    space: &Space<f64>,
    delta: f64,
    fitness: fn(&[f64]) -> f64,
) -> usize {
    (0..3)
        .map(|seed| {
            let engine = engine::find("portfolio")
                .unwrap()
                .configure([("without", without)])
                .unwrap();
            let problem = from_fn(space.clone(), delta, fitness).boxed().separation(0.02);
            let mut search = Search::with(engine).seed(seed);
            search
                .run(&problem, &Budget::evaluations(evaluations))
                .unwrap()
                .hit_count()
        })
        .sum()
}

/// 9^3 = 729 minima, one for each choice of nine places on three axes; uneven ones, because on a grid translations would do as
/// well. All of them are found in 20,000 evaluations; in 2,000, seven times as many with recombination as without when this was
/// written: 1,347 and 183.
#[test]
fn recombination_finds_a_product_of_places() {
    let valleys = |x: &[f64]| {
        x.iter()
            .map(|x| 1.0 - (TAU * 8.0 * (x + 0.3 * x * x) / 1.3).cos())
            .sum()
    };
    let space = Space::cube(3, 0.0, 1.0).unwrap();
    let all = hits("none", 20_000, &space, 1e-4, valleys);
    assert_eq!(all, 3 * 729);
    let with = hits("none", 2_000, &space, 1e-4, valleys);
    let without = hits("recombination", 2_000, &space, 1e-4, valleys);
    assert!(with > 4 * without, "{with} {without}");
}

/// A cusp of fractal walls, as steep as |x|^0.63 on every scale: 1 in 10^9 of the space is below delta. The sources that adapt their
/// covariance get to its bottom.
#[test]
fn the_bottom_of_a_rugged_cusp_is_found() {
    let cusp = |x: &[f64]| {
        let place = [0.21, 0.77, 0.4, 0.5];
        let wall = |x: f64| -> f64 {
            (0..20)
                .map(|k| 0.5_f64.powi(k) * (1.0 - (TAU * 3.0_f64.powi(k) * x).cos()))
                .sum()
        };
        x.iter().zip(place).map(|(x, place)| wall(x - place)).sum()
    };
    let space = Space::cube(4, 0.0, 0.9).unwrap();
    assert_eq!(hits("none", 60_000, &space, 1e-3, cusp), 3);
}

/// A source that is left out proposes nothing; beside the others each of these does.
#[test]
fn a_source_can_be_left_out() {
    let rings = |x: &[f64]| (x[0].hypot(x[1]) - 1.0).abs().min((x[0] - 2.0).hypot(x[1]));
    let proposed = |without: &str| {
        let problem = from_fn(Space::cube(2, -4.0, 4.0).unwrap(), 0.02, rings)
            .boxed()
            .separation(0.01);
        let report = Search::named("portfolio")
            .unwrap()
            .set("without", without)
            .unwrap()
            .run(&problem, &Budget::evaluations(4_000))
            .unwrap();
        let last = report.sources.rows.last().unwrap();
        let proposed = last.proposed.iter().copied();
        let counts: Vec<(String, u64)> = report.sources.names.iter().cloned().zip(proposed).collect();
        counts
    };
    let all = proposed("none");
    for (without, name) in [
        ("swarms", "swarms"),
        ("recombination", "recombination"),
        ("descents", "descents"),
        ("cma-es", "CMA-ES"),
        ("flood-fill", "flood fill"),
        ("model", "model"),
        ("quadratic-descents", "quadratic descents"),
    ] {
        let count = |counts: &[(String, u64)]| counts.iter().find(|(source, _)| source == name).unwrap().1;
        assert!(count(&all) > 0, "{name} {all:?}");
        assert_eq!(count(&proposed(without)), 0, "{name}");
    }
}

/// The first example of the README: 9,216 points, for which 20,000 evaluations have room.
#[test]
fn a_lattice_that_the_budget_has_room_for_is_proved_complete() {
    let e24 = [
        10, 11, 12, 13, 15, 16, 18, 20, 22, 24, 27, 30, 33, 36, 39, 43, 47, 51, 56, 62, 68, 75, 82, 91,
    ];
    let ohms = move |index: f64| 10_f64.powi(index as i32 / 24) * f64::from(e24[index as usize % 24]);
    let far = move |x: &[f64]| (ohms(x[1]) / (ohms(x[0]) + ohms(x[1])) / 0.3 - 1.0).abs();
    let space = Space::lattice(2, 96).unwrap();
    let all = (0..96 * 96)
        .filter(|i| far(&[f64::from(i / 96), f64::from(i % 96)]) < 0.005)
        .count();
    for (seed, budget) in [
        (1, Budget::millis(30_000).and_evaluations(20_000)),
        (2, Budget::millis(30_000)),
        (3, Budget::evaluations(9_600)),
        (4, Budget::evaluations(1_000_000)),
        (5, Budget::evaluations(9_216)),
        (6, Budget::evaluations(9_300)),
    ] {
        let report = Search::new()
            .seed(seed)
            .run(&from_fn(space.clone(), 0.005, far).boxed(), &budget)
            .unwrap();
        assert_eq!(report.completeness, Completeness::Proved, "{seed}: {report}");
        assert_eq!(report.hit_count(), all);
        assert!(report.counts.evaluations < 10_500, "{seed}: {report}");
    }
    let short = Search::new()
        .run(&from_fn(space, 0.005, far).boxed(), &Budget::evaluations(9_000))
        .unwrap();
    assert_ne!(short.completeness, Completeness::Proved);
}

/// The model of F costs a hundred times the time of other sources. Where it predicts nothing it is asked a few dozen times, whatever the
/// others find; where it predicts F, most candidates are its own.
#[test]
fn the_search_goes_first_where_there_is_time_to_enumerate() {
    // A ring of 2 % of the points. An enumeration comes by half of it after half of the points, whenever it begins.
    let space = Space::lattice(2, 400).unwrap();
    let ring = |x: &[f64]| ((x[0] - 200.0).hypot(x[1] - 160.0) - 100.0).abs();
    for (seed, budget) in [
        (1, Budget::millis(3_600_000)),
        (2, Budget::evaluations(10_000_000)),
    ] {
        let report = Search::new()
            .seed(seed)
            .run(&from_fn(space.clone(), 2.5, ring).boxed(), &budget)
            .unwrap();
        assert_eq!(report.completeness, Completeness::Proved, "{report}");
        assert!(report.counts.evaluations < 170_000, "{report}");
        let half = report.hits().nth(report.hit_count() / 2).unwrap();
        assert!(
            half.evaluation < 16_000,
            "half of the hits after {} evaluations",
            half.evaluation
        );
    }
}

#[test]
fn a_model_that_predicts_nothing_is_not_asked_for_long() {
    let asked = |delta: f64, fitness: fn(&[f64]) -> f64| {
        let problem = from_fn(Space::lattice(6, 10).unwrap(), delta, fitness).boxed();
        let report = Search::new()
            .seed(1)
            .run(&problem, &Budget::evaluations(400))
            .unwrap();
        let model = report
            .sources
            .names
            .iter()
            .position(|name| name == "model")
            .unwrap();
        report.sources.rows.last().unwrap().proposed[model]
    };
    let noise = |x: &[f64]| {
        let digits = x.iter().fold(7_u64, |sum, &x| {
            (sum ^ x as u64)
                .wrapping_mul(0x9e37_79b9_7f4a_7c15)
                .rotate_left(29)
        });
        (digits >> 11) as f64
    };
    let bowl = |x: &[f64]| x.iter().map(|x| (x.floor() - 6.0).powi(2)).sum::<f64>();
    assert!(asked(-1.0, noise) < 80, "{}", asked(-1.0, noise));
    assert!(asked(2.5, bowl) > 120, "{}", asked(2.5, bowl));
}

/// A valley, turned against the axes, of which descents by themselves find next to nothing in 100 evaluations.
#[test]
fn the_default_is_nearly_as_good_as_its_model_on_a_smooth_level_set() {
    let hits = |engine: &str| -> usize {
        let run = |seed| {
            let valley = |x: &[f64]| {
                let along = x.iter().sum::<f64>() / 8.0_f64.sqrt() - 0.3;
                let square = x.iter().map(|x| (x - 0.2).powi(2)).sum::<f64>();
                (square + 4.0 * along * along).sqrt()
            };
            let space = Space::cube(8, -1.0, 1.0).unwrap();
            let problem = from_fn(space, 0.5, valley).separation(0.05);
            let mut search = Search::named(engine).unwrap().seed(seed);
            search
                .run(&problem, &Budget::evaluations(100))
                .unwrap()
                .hit_count()
        };
        (0..6).map(run).sum()
    };
    let [default, model, descents] = ["portfolio", "surrogate", "quadratic-descent"].map(hits);
    assert!(
        5 * default > 4 * model && model > 10 * descents,
        "{default} {model} {descents}"
    );
}

/// The model has a part in searches of up to 10,000 evaluations, and in longer ones where the problem tells components.
#[test]
fn the_model_keeps_out_of_long_searches() {
    // Five traps of five bits: 41 hits in 33 million points, of which one is found without a model.
    let traps = |x: &[f64]| -> f64 {
        let trap = |bits: &[f64]| match bits.iter().sum() {
            5.0 => 0.0,
            ones => 1.0 + ones,
        };
        x.chunks(5).map(trap).sum()
    };
    let plain = from_fn(Space::lattice(25, 2).unwrap(), 2.5, traps).boxed();
    let told = from_fn(Space::lattice(25, 2).unwrap(), 2.5, traps)
        .boxed()
        .components(1, move |x, components| components[0] = traps(x) / 2.5);
    let run = |problem: &FnProblem<f64, BoxedFn<'_, f64>>, evaluations| {
        let report = Search::new()
            .seed(1)
            .run(problem, &Budget::evaluations(evaluations))
            .unwrap();
        let model = report.sources.names.iter().position(|name| name == "model");
        let proposed = model.map_or(0, |model| report.sources.rows.last().unwrap().proposed[model]);
        (proposed, report.hit_count())
    };
    let (model, hits) = run(&plain, 10_000);
    assert!(model > 100 && hits > 5, "{model} {hits}");
    assert_eq!(run(&plain, 10_001).0, 0);
    assert!(run(&told, 10_001).0 > 100);
}

/// 2,000 evaluations of a cheap F take a millisecond, 1,000 proposals of the model half a second.
#[test]
fn a_limit_of_time_that_is_short_for_the_model_keeps_it_out() {
    let proposed = |budget: &Budget| {
        let problem = from_fn(Space::lattice(6, 10).unwrap(), 0.5, |x: &[f64]| x.iter().sum()).boxed();
        let report = Search::new().seed(1).run(&problem, budget).unwrap();
        let mut names = report.sources.names.iter();
        let model = names.position(|name| name == "model").unwrap();
        report.sources.rows.last().unwrap().proposed[model]
    };
    assert_eq!(proposed(&Budget::millis(400).and_evaluations(2_000)), 0);
    assert!(proposed(&Budget::millis(600_000).and_evaluations(100)) > 50);
}

/// In two dimensions a drought begins after 2,800 evaluations; from then on half of the choices are niching's.
#[test]
fn niching_searches_once_no_source_finds_anything() {
    let proposed = |evaluations: u64| {
        let bowl = |x: &[f64]| x[0].hypot(x[1]);
        let problem = from_fn(Space::cube(2, -1.0, 1.0).unwrap(), -1.0, bowl).boxed();
        let report = Search::new()
            .seed(1)
            .run(&problem, &Budget::evaluations(evaluations))
            .unwrap();
        let niching = report
            .sources
            .names
            .iter()
            .position(|name| name == "niching")
            .unwrap();
        report.sources.rows.last().unwrap().proposed[niching]
    };
    assert_eq!(proposed(2_700), 0);
    let later = proposed(5_600);
    assert!(later > 1_000, "{later}");
}

/// No time is limited, so that nothing depends on what an evaluation takes.
#[test]
fn a_search_for_some_hits_does_not_look_at_the_clock() {
    let bowl = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
    let found = |wait: u64, named: bool| {
        let slow = move |x: &[f64]| {
            if wait > 0 {
                std::thread::sleep(core::time::Duration::from_micros(wait));
            }
            bowl(x)
        };
        let budget = Budget::hits(25).and_patience(400);
        let space = if named {
            Space::new([satisfice::Axis::integer(-50, 50); 3]).unwrap()
        } else {
            Space::cube(3, -50.0, 50.0).unwrap()
        };
        let problem = from_fn(space, 12.0, slow).boxed().separation(0.1);
        let mut search = Search::new().seed(6);
        let report = if named {
            let next = |x: &mut [f64], i: usize| {
                x[i / 2] += [1.0, -1.0][i % 2];
                x[i / 2].abs() <= 50.0
            };
            search.run(&problem.neighbours(6, next), &budget)
        } else {
            search.run(&problem, &budget)
        };
        let report = report.unwrap();
        assert_eq!(report.hit_count(), 25);
        let hits: Vec<_> = report.hits().map(|hit| hit.evaluation).collect();
        (report.counts.evaluations, hits)
    };
    for named in [false, true] {
        let quick = found(0, named);
        for wait in [20, 3_000] {
            assert_eq!(found(wait, named), quick, "{wait} microseconds, named {named}");
        }
    }
}

/// No time is limited, so that no source is charged with time.
#[test]
fn a_search_for_some_hits_finds_the_same_again() {
    let ring = from_fn(Space::lattice(4, 1000).unwrap(), 3.0, |x: &[f64]| {
        (x.iter().map(|x| (x - 500.0).powi(2)).sum::<f64>().sqrt() - 300.0).abs()
    });
    let search = || {
        let report = Search::new().seed(4).run(&ring, &Budget::hits(3_000)).unwrap();
        assert_eq!(report.hit_count(), 3_000);
        (
            report.counts.evaluations,
            report.hits().last().unwrap().evaluation,
        )
    };
    let first = search();
    assert_eq!([first; 3], [search(), search(), search()]);
}

/// From 21 places on, the orders of a permutation cannot be numbered in 64 bits. A search for a first hit goes by descents all the same, also
/// where F has few values: nine of ten choices of the first 250 are theirs.
#[test]
fn permutations_are_searched_in_one_way_however_many_places_there_are() {
    for places in [20_u32, 21, 60] {
        let space = Space::new(satisfice::Axis::permutation(places)).unwrap();
        let jumps = from_fn(space, -0.5, |x: &[f64]| {
            let far = x.windows(2).filter(|pair| (pair[0] - pair[1]).abs() > 6.0);
            (far.count() / 20).min(3) as f64
        });
        let report = Search::new()
            .seed(3)
            .run(&jumps, &Budget::evaluations(250))
            .unwrap();
        let of = |name: &str| report.sources.names.iter().position(|known| known == name);
        let proposed = report.sources.rows.last().unwrap().proposed[of("descents").unwrap()];
        assert!(proposed > 190, "{places} places: {proposed}");
    }
}
