//! Axes that are logarithmic, periodic, categorical, and places of a permutation, as every engine sees them.

#![allow(clippy::unwrap_used, reason = "a test")]

use std::collections::BTreeSet;

use satisfice::{
    Axis, Budget, Completeness, Error, Identity, SatisficingProblem, Search, Space, engine, from_fn, testing,
};

fn mixed() -> Space<f64> {
    let axes = [
        Axis::continuous(1e-6, 1.0).logarithmic(),
        Axis::continuous(0.0, 360.0).periodic(),
        Axis::integer(1, 6),
        Axis::categorical(4),
    ];
    Space::new(axes.into_iter().chain(Axis::permutation(3))).unwrap()
}

/// Whether every value is of its axis.
fn is_valid(x: &[f64]) -> bool {
    let whole = |x: f64, upper: f64| x.fract() == 0.0 && (0.0..=upper).contains(&x);
    let ranks: BTreeSet<u64> = x[4..].iter().map(|x| x.to_bits()).collect();
    (1e-6..=1.0).contains(&x[0])
        && (0.0..=360.0).contains(&x[1])
        && whole(x[2] - 1.0, 5.0)
        && whole(x[3], 3.0)
        && x[4..].iter().all(|&x| whole(x, 2.0))
        && ranks.len() == 3
}

/// A rate near 1e-4, an angle near 0, category 2, in falling order.
fn fitness(x: &[f64]) -> f64 {
    assert!(is_valid(x), "{x:?}");
    let rate = (x[0] / 1e-4).ln().abs();
    let angle = x[1].min(360.0 - x[1]) / 90.0;
    let category = if x[3] == 2.0 { 0.0 } else { 2.0 };
    let order = (x[4] - 2.0).abs() + (x[5] - 1.0).abs();
    rate + angle + category + order + (x[2] - 3.0).abs() / 4.0
}

#[test]
fn every_engine_keeps_to_them() {
    for entry in engine::all() {
        let evaluations = if entry.name == "surrogate" { 60 } else { 1500 };
        let problem = from_fn(mixed(), 2.0, fitness).boxed();
        let run = || {
            let mut search = Search::with(entry.configure([]).unwrap()).seed(3);
            search.run(&problem, &Budget::evaluations(evaluations)).unwrap()
        };
        let report = run();
        assert!(report.counts.fitness_calls > 0);
        assert!(
            report.hits().all(|hit| is_valid(&hit.solution.coordinates)),
            "{}",
            entry.name
        );
        assert!(
            report
                .hits()
                .map(|hit| hit.solution)
                .eq(run().hits().map(|hit| hit.solution))
        );
        // None but the uniform sampler and the exact one, which halves values, are too weak for this one.
        let weak = ["random", "branch-and-bound", "surrogate"].contains(&entry.name);
        assert!(weak || report.hit_count() > 0, "{}: {report}", entry.name);
        if entry.name == "portfolio" {
            assert!(report.hit_count() > 20, "{report}");
        }
    }
}

#[test]
fn start_points_and_warm_starts_go_through_them() {
    let start = [1e-4, 359.0, 3.0, 2.0, 2.0, 1.0, 0.0];
    for name in ["portfolio", "descent", "latest-hit-qpso"] {
        let problem = from_fn(mixed(), 0.5, fitness).boxed();
        let mut search = Search::named(name).unwrap().start_from([start]);
        let first = search.run(&problem, &Budget::evaluations(50)).unwrap();
        let found = &first.hits().next().unwrap();
        assert_eq!(found.evaluation, 1, "{name}");
        for (x, wanted) in found.solution.coordinates.iter().zip(start) {
            assert!(
                (x / wanted - 1.0).abs() < 1e-12 || *x == wanted,
                "{x} is not {wanted}"
            );
        }
        let second = search.run(&problem, &Budget::evaluations(50)).unwrap();
        assert!(second.hit_count() > 0, "{name}");
    }
    let problem = from_fn(mixed(), 0.5, fitness).boxed();
    for (j, bad) in [(0, 0.0), (3, 1.5), (4, 1.0), (5, 3.0), (6, 0.5)] {
        let mut start = start;
        start[j] = bad;
        let refused = Search::named("random")
            .unwrap()
            .start_from([start])
            .run(&problem, &Budget::evaluations(5));
        assert!(matches!(refused, Err(Error::StartPoint { index: 0, .. })), "{j}");
    }
}

/// Every answer of a discrete space is found, and counted as itself.
#[test]
fn categories_and_orders_are_never_merged() {
    let axes = [
        Axis::integer(0, 4),
        Axis::categorical(5),
        Axis::integer(0, 9).periodic(),
    ];
    let space = Space::new(axes.into_iter().chain(Axis::permutation(3))).unwrap();
    let problem = from_fn(space, 2.5, |x: &[f64]| {
        let far = if x[1] == 3.0 || x[1] == 0.0 { 0.0 } else { 1.0 };
        x[0] + far + x[2].min(10.0 - x[2]) + (x[3] - x[4]).abs()
    })
    .boxed();
    let mut expected = 0;
    for a in 0..5_i32 {
        for far in [0, 1, 1, 0, 1] {
            for c in 0..10_i32 {
                for apart in [1, 2, 1, 1, 2, 1] {
                    expected += usize::from(a + far + c.min(10 - c) + apart <= 2);
                }
            }
        }
    }
    for name in ["portfolio", "random", "descent-flood"] {
        let mut search = Search::named(name).unwrap().seed(1);
        let report = search.run(&problem, &Budget::evaluations(60_000)).unwrap();
        assert_eq!(report.hit_count(), expected, "{name}");
    }
}

#[test]
fn a_circle_has_no_seam_and_a_logarithm_no_small_end() {
    let space = Space::new([
        Axis::continuous(0.0, 360.0).periodic(),
        Axis::continuous(1e-8, 1e8).logarithmic(),
    ])
    .unwrap();
    let problem = from_fn(space, 0.5, |x: &[f64]| {
        x[0].min(360.0 - x[0]) / 20.0 + x[1].ln().abs()
    })
    .boxed();
    // Separated by 5 degrees and half an e-fold: at most 5 answers around 0 and 3 along the other axis.
    let problem = problem.separations(&[5.0, 0.5]).unwrap();
    for seed in 0..4 {
        let mut search = Search::named("portfolio").unwrap().seed(seed);
        let report = search.run(&problem, &Budget::evaluations(20_000)).unwrap();
        assert!((4..=12).contains(&report.hit_count()), "{report}");
        for (i, a) in report.hits().enumerate() {
            for b in report.hits().skip(i + 1) {
                let (a, b) = (&a.solution.coordinates, &b.solution.coordinates);
                let turn = (a[0] - b[0]).abs();
                let turn = turn.min(360.0 - turn) / 5.0;
                let fold = (a[1] / b[1]).ln() / 0.5;
                assert!(turn.hypot(fold) > 1.0, "{a:?} {b:?}");
            }
        }
    }
}

fn whole_and_real() -> Space<f64> {
    Space::new([Axis::integer(0, 9), Axis::continuous(0.0, 1.0)]).unwrap()
}

#[test]
fn radii_of_axes_make_an_ellipsoid() {
    let same = |radii: [f64; 2], a: [f64; 2], b: [f64; 2]| {
        let problem = from_fn(whole_and_real(), 0.5, |_: &[f64]| 0.0)
            .boxed()
            .separations(&radii)
            .unwrap();
        assert_eq!(testing::problem::check(&problem, 1), [], "{radii:?}");
        let [a, b] = [a, b].map(|x| problem.decode(&x));
        let mut archive = satisfice::Archive::default();
        archive.insert(a.clone(), 0.0, 1, 0.0);
        assert_eq!(archive.contains(&b), a.same(&b), "{a:?} {b:?}");
        a.same(&b)
    };
    assert!(!same([0.0, 0.0], [1.0, 0.5], [1.0, 0.5 + 1e-15]));
    assert!(same([1.25, 1.25], [1.0, 0.0], [2.0, 0.75]));
    assert!(!same([1.25, 1.25], [1.0, 0.0], [2.0, 0.7500001]));
    assert!(same([0.0, 0.5], [1.0, 0.0], [1.0, 0.5]));
    assert!(!same([0.0, 0.5], [1.0, 0.0], [2.0, 0.0]));
    assert!(same([2.0, 0.5], [1.0, 0.0], [2.0, 0.4]));
    assert!(!same([2.0, 0.5], [1.0, 0.0], [2.0, 0.45]));
}

/// By default two points are one within 1 % of each axis, whatever the lengths of the others.
#[test]
fn axes_of_other_units_are_told_apart_by_default() {
    let metres = Axis::continuous(1e-3, 2e-3);
    let pascals = Axis::continuous(0.0, 1e6);
    let space = Space::new([metres, pascals, Axis::continuous(1.0, 100.0).logarithmic()]).unwrap();
    let problem = from_fn(space, 0.5, |_: &[f64]| 0.0);
    let same = |a: [f64; 3], b: [f64; 3]| problem.decode(&a).same(&problem.decode(&b));
    assert!(same([1.1e-3, 0.0, 10.0], [1.109e-3, 0.0, 10.0]));
    assert!(!same([1.1e-3, 0.0, 10.0], [1.111e-3, 0.0, 10.0]));
    assert!(same([1.1e-3, 0.0, 10.0], [1.1e-3, 9e3, 10.0]));
    assert!(!same([1.1e-3, 0.0, 10.0], [1.1e-3, 1.1e4, 10.0]));
    // 1 % of ln 100.
    assert!(same([1.1e-3, 0.0, 10.0], [1.1e-3, 0.0, 10.4]));
    assert!(!same([1.1e-3, 0.0, 10.0], [1.1e-3, 0.0, 10.5]));
}

#[test]
fn a_separation_that_is_not_usable_is_refused() {
    for radii in [&[0.1][..], &[-1.0, 0.1], &[0.1, f64::NAN], &[f64::INFINITY, 0.1]] {
        let refused = from_fn(whole_and_real(), 0.5, |_: &[f64]| 0.0)
            .boxed()
            .separations(radii);
        assert!(
            refused.is_err_and(|error| error.to_string().contains("separations")),
            "{radii:?}"
        );
    }
}

/// Categories are told apart whatever the radius.
#[test]
fn a_radius_says_nothing_about_categories() {
    let space = Space::new([Axis::categorical(3), Axis::continuous(0.0, 1.0)]).unwrap();
    let problem = from_fn(space, 0.5, |_: &[f64]| 0.0)
        .boxed()
        .separations(&[5.0, 0.5])
        .unwrap();
    assert!(!problem.decode(&[0.0, 0.5]).same(&problem.decode(&[1.0, 0.5])));
    assert!(problem.decode(&[1.0, 0.5]).same(&problem.decode(&[1.0, 0.6])));
}

/// Orders of five in which no neighbours are two apart, by all 5^5 words.
#[test]
fn all_orders_are_enumerated() {
    let fits = |x: &[f64]| x.windows(2).all(|pair| (pair[0] - pair[1]).abs() != 2.0);
    let expected = (0..3125_u32)
        .map(|code| [1, 5, 25, 125, 625].map(|place| f64::from(code / place % 5)))
        .filter(|x| (1..5).all(|j| !x[..j].contains(&x[j])) && fits(x))
        .count();
    let space = Space::new(Axis::permutation(5)).unwrap();
    assert_eq!(space.cardinality(), Some(120.0));
    let problem = from_fn(space, 0.5, |x: &[f64]| f64::from(u8::from(!fits(x)))).boxed();
    for (name, evaluations) in [("portfolio", 120), ("portfolio", 1000), ("branch-and-bound", 120)] {
        let mut search = Search::named(name).unwrap();
        let report = search.run(&problem, &Budget::evaluations(evaluations)).unwrap();
        let found = (report.completeness, report.hit_count());
        assert_eq!(found, (Completeness::Proved, expected), "{name}: {report}");
        assert!(report.counts.evaluations <= 125, "{name}: {report}");
    }
}

/// Points inside regions are orders, beside a continuous axis, too.
#[test]
fn regions_hold_orders_beside_continuous_axes() {
    let axes = Axis::permutation(4).chain([Axis::continuous(0.0, 1.0)]);
    let fitness = |x: &[f64]| (x[0] - 3.0).abs() + x[3] + (x[4] - 0.5).abs();
    let problem = from_fn(Space::new(axes).unwrap(), 0.1, fitness)
        .separation(0.25)
        .boxed();
    let mut search = Search::named("branch-and-bound").unwrap();
    let report = search.run(&problem, &Budget::evaluations(10_000)).unwrap();
    let found: BTreeSet<_> = report
        .hits()
        .map(|hit| {
            hit.solution.coordinates[..4]
                .iter()
                .map(|&x| x as u8)
                .collect::<Vec<_>>()
        })
        .collect();
    assert_eq!(
        found,
        BTreeSet::from([vec![3, 1, 2, 0], vec![3, 2, 1, 0]]),
        "{report}"
    );
}
