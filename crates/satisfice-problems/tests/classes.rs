//! Periodic points, small regions and mixed axes: their counts by independent referees.
#![allow(clippy::unwrap_used, missing_docs)]

use std::collections::BTreeSet;

use satisfice::catalogue::{Catalogued, Params};
use satisfice::{Budget, Encoding, Located, SatisficingProblem, Search, SearchRng};
use satisfice_problems::{MixedAxes, PeriodicPoints, Shape, SmallRegions};

/// The map as a newcomer would write it, in steps of one.
fn henon(x: f64, before: f64, (a, b): (f64, f64)) -> f64 {
    a - x * x - b * before
}

#[test]
fn every_root_is_a_cycle_of_the_map_and_they_differ() {
    for (a, b) in [(6.0, 0.3), (9.0, -0.9), (4.5, 0.0)] {
        for period in 1..=6 {
            let problem = PeriodicPoints::new(period, false, (a, b), 0.0, 0.1, 0).unwrap();
            let roots: Vec<Vec<f64>> = problem.roots().collect();
            for root in &roots {
                for k in 0..period {
                    let next = henon(root[k], root[(k + period - 1) % period], (a, b));
                    assert!((next - root[(k + 1) % period]).abs() < 1e-12, "{a} {b} {root:?}");
                }
            }
            let signs: BTreeSet<Vec<bool>> = roots
                .iter()
                .map(|root| root.iter().map(|x| *x > 0.0).collect())
                .collect();
            assert_eq!((roots.len(), signs.len()), (1 << period, 1 << period));
        }
    }
}

/// That there are no others: in one unknown without b, points of period n are the roots of a polynomial of degree 2^n, which has no
/// more; every one is where the sign of its difference changes.
#[test]
fn a_scan_of_the_logistic_map_finds_as_many() {
    let a = 4.5;
    for period in 1..=5 {
        let problem = PeriodicPoints::new(period, false, (a, 0.0), 0.0, 0.1, 0).unwrap();
        let missed = |x: f64| (0..period).fold(x, |x, _| henon(x, 0.0, (a, 0.0))) - x;
        let side = problem.space().axes()[0].upper();
        let cells = 400_000;
        let at = |i: u32| missed(-side + 2.0 * side * f64::from(i) / f64::from(cells));
        let changes = (0..cells).filter(|&i| (at(i) < 0.0) != (at(i + 1) < 0.0)).count();
        assert_eq!(
            changes as u64,
            problem.reference_hits().unwrap(),
            "period {period}"
        );
    }
}

/// Newton's method with differences, from anywhere: what it converges to is one of the roots.
#[test]
fn newton_from_random_starts_finds_no_other_root() {
    let problem = PeriodicPoints::new(2, false, (5.5, 0.3), 1.0, 0.1, 3).unwrap();
    let roots: Vec<Vec<f64>> = problem.roots().collect();
    let a: Vec<f64> = {
        // The first root is a cycle, which tells a_k.
        let [x, y] = [roots[0][0], roots[0][1]];
        vec![y + x * x + 0.3 * y, x + y * y + 0.3 * x]
    };
    let (mut rng, mut found) = (SearchRng::new(5), BTreeSet::new());
    let side = problem.space().axes()[0].upper();
    for _ in 0..500 {
        let mut p = [
            side * (2.0 * rng.uniform() - 1.0),
            side * (2.0 * rng.uniform() - 1.0),
        ];
        for _ in 0..60 {
            let e = [p[1] * 1.3 + p[0] * p[0] - a[0], p[0] * 1.3 + p[1] * p[1] - a[1]];
            let (j00, j11, off) = (2.0 * p[0], 2.0 * p[1], 1.3);
            let det = j00 * j11 - off * off;
            p = [
                p[0] - (j11 * e[0] - off * e[1]) / det,
                p[1] - (j00 * e[1] - off * e[0]) / det,
            ];
        }
        if p.iter().all(|x| x.is_finite() && x.abs() <= side) {
            let near = roots
                .iter()
                .position(|root| root.iter().zip(p).all(|(root, x)| (root - x).abs() < 1e-9));
            found.insert(near.expect("a root that is listed"));
        }
    }
    assert_eq!(found.len(), 4);
}

#[test]
fn shooting_has_the_same_roots_and_hits_become_them() {
    let orbit = PeriodicPoints::new(6, false, (6.0, 0.3), 0.5, 0.1, 8).unwrap();
    let start = PeriodicPoints::new(6, true, (6.0, 0.3), 0.5, 0.1, 8).unwrap();
    let mut rng = SearchRng::new(2);
    for (cycle, start_of_it) in orbit.roots().zip(start.roots()) {
        assert_eq!(cycle[..2], start_of_it[..]);
        for (problem, root) in [(&orbit, cycle), (&start, start_of_it)] {
            assert!(problem.fitness(&problem.decode(&root)) < 1e-9);
            let near: Vec<f64> = root.iter().map(|x| x + 1e-7 * rng.normal()).collect();
            let near = problem.decode(&near);
            assert!(problem.fitness(&near) < problem.threshold());
            assert_eq!(problem.canonical(&near).unwrap().coordinates, root);
        }
    }
}

#[test]
fn parameters_without_a_known_count_are_refused() {
    for (a, b) in [
        (1.4, 0.3),
        (6.0, -3.0),
        (f64::NAN, 0.3),
        (6.0, f64::NAN),
        (f64::INFINITY, 0.3),
    ] {
        assert!(
            PeriodicPoints::new(3, false, (a, b), 0.0, 0.1, 0).is_err(),
            "{a} {b}"
        );
    }
    assert!(PeriodicPoints::new(0, false, (6.0, 0.3), 0.0, 0.1, 0).is_err());
    assert!(PeriodicPoints::new(3, false, (6.0, 0.3), f64::NAN, 0.1, 0).is_err());
    assert!(PeriodicPoints::new(3, false, (6.0, 0.3), 0.0, 0.0, 0).is_err());
}

/// The volume of a ball of radius 1.
fn unit_ball(dimension: usize) -> f64 {
    match dimension {
        0 => 1.0,
        1 => 2.0,
        n => unit_ball(n - 2) * std::f64::consts::TAU / n as f64,
    }
}

/// The share of uniform points that hit is the sum of the volumes, within five deviations, and each region has hits: so many disjoint
/// regions of that size there are.
#[test]
fn hits_fill_the_volume_of_the_regions() {
    for (dimension, shape, radius, aspect) in [
        (2, Shape::Box, 0.08, 1.0),
        (3, Shape::Ball, 0.15, 1.0),
        (3, Shape::Ellipsoid, 0.2, 4.0),
        (2, Shape::Ellipsoid, 0.15, 10.0),
    ] {
        let (count, points) = (6, 200_000);
        let problem = SmallRegions::new(dimension, count, shape, radius, aspect, 0, 4).unwrap();
        let one = match shape {
            Shape::Box => (2.0 * radius).powi(dimension as i32),
            Shape::Ball => unit_ball(dimension) * radius.powi(dimension as i32),
            // Half-axes from the radius to radius / aspect: their geometric mean is radius / sqrt(aspect).
            Shape::Ellipsoid => unit_ball(dimension) * (radius / aspect.sqrt()).powi(dimension as i32),
        };
        let share = count as f64 * one;
        let mut rng = SearchRng::new(6);
        let mut position = vec![0.0; dimension];
        let (mut hits, mut regions) = (0_u32, BTreeSet::new());
        for _ in 0..points {
            rng.position(problem.space(), &mut position);
            let solution = problem.decode(&position);
            if problem.fitness(&solution) < 1.0 {
                hits += 1;
                let centre = problem.canonical(&solution).unwrap().coordinates;
                assert!(problem.centres().any(|known| known == centre));
                regions.insert(format!("{centre:?}"));
            }
        }
        let deviation = (share * (1.0 - share) * f64::from(points)).sqrt();
        let expected = share * f64::from(points);
        assert!(
            (f64::from(hits) - expected).abs() < 5.0 * deviation,
            "{shape:?}: {hits} instead of {expected}"
        );
        assert_eq!(regions.len(), count);
    }
}

#[test]
fn plateaus_are_whole_numbers_with_the_same_hits() {
    let smooth = SmallRegions::new(3, 4, Shape::Box, 0.1, 1.0, 0, 9).unwrap();
    let plateaus = SmallRegions::new(3, 4, Shape::Box, 0.1, 1.0, 3, 9).unwrap();
    let (mut rng, mut position, mut seen) = (SearchRng::new(1), [0.0; 3], BTreeSet::new());
    for _ in 0..5_000 {
        rng.position(smooth.space(), &mut position);
        let [f, step] = [&smooth, &plateaus].map(|problem| problem.fitness(&problem.decode(&position)));
        assert_eq!((step, f < 1.0), (f.floor().min(3.0), step < 1.0));
        seen.insert(step as u32);
    }
    assert_eq!(seen.len(), 4);
}

/// Regions and search may have the same number: 64 points hit boxes of a millionth of the cube by knowing their places only.
#[test]
fn a_search_does_not_draw_the_places_of_an_instance() {
    for number in 0..4 {
        let boxes = SmallRegions::new(6, 8, Shape::Box, 0.05, 1.0, 0, number).unwrap();
        let mut search = Search::named("random").unwrap().seed(number);
        let report = search.run(&boxes, &Budget::evaluations(64)).unwrap();
        assert_eq!(report.hit_count(), 0, "{number}");
    }
}

#[test]
fn regions_without_room_are_refused() {
    for (radius, aspect) in [
        (0.0, 2.0),
        (0.5, 2.0),
        (f64::NAN, 2.0),
        (0.1, 0.5),
        (0.1, f64::NAN),
        (0.4, 1.0),
    ] {
        assert!(
            SmallRegions::new(2, 9, Shape::Ball, radius, aspect, 0, 0).is_err(),
            "{radius} {aspect}"
        );
    }
    assert!(SmallRegions::new(0, 1, Shape::Box, 0.1, 1.0, 0, 0).is_err());
    let centre = SmallRegions::new(2, 1, Shape::Box, 0.1, 1.0, 0, 0).unwrap();
    assert!(centre.fitness(&Located::new(&[0.5], 0.1)).is_nan());
}

/// The hits as they are seen through the space: every category, every integer, and many more rates and angles than there are cells.
#[test]
fn mixed_axes_have_as_many_hits_as_a_fine_scan_sees() {
    for instance in [0, 7] {
        let problem = MixedAxes::new(5, 12, 0.2, instance).unwrap();
        let mut seen: BTreeSet<[u32; 4]> = BTreeSet::new();
        let (rates, angles) = (37 * 12, 41 * 12);
        for kind in 0..5 {
            for rate in 0..rates {
                let rate = 10_f64.powf(-3.0 + 6.0 * (f64::from(rate) + 0.5) / f64::from(rates));
                for angle in (0..angles).step_by(7) {
                    let angle = std::f64::consts::TAU * (f64::from(angle) + 0.5) / f64::from(angles);
                    for layers in 1..=24 {
                        let solution = problem.decode(&[f64::from(kind), rate, angle, f64::from(layers)]);
                        if problem.fitness(&solution) < problem.threshold() {
                            seen.insert(solution);
                        }
                    }
                }
            }
        }
        assert_eq!(
            Some(seen.len() as u64),
            problem.reference_hits(),
            "instance {instance}"
        );
        assert!(!seen.is_empty());
        let mut values = [0.0; 4];
        for solution in &seen {
            assert!(problem.encode(solution, &mut values) && problem.decode(&values) == *solution);
        }
        let kinds: BTreeSet<u32> = seen.iter().map(|solution| solution[0]).collect();
        assert!(kinds.len() <= 2, "one in three");
    }
}

#[test]
fn mixed_axes_that_are_none_are_refused() {
    assert!(MixedAxes::new(0, 5, 0.1, 0).is_err() && MixedAxes::new(3, 0, 0.1, 0).is_err());
    assert!(MixedAxes::new(3, 5, f64::NAN, 0).is_err());
    let problem = MixedAxes::from_params(&Params::defaults(MixedAxes::PARAMETERS).unwrap()).unwrap();
    for wrong in [[12, 0, 0, 0], [0, 60, 0, 0], [0, 0, 60, 0], [0, 0, 0, 24]] {
        assert!(problem.fitness(&wrong).is_nan() && problem.settings(&wrong).is_none());
    }
}

/// Beside a ball that is one answer there are misses alone, and the model expects hits: it used to look around the first one until the
/// evaluations were spent, and found 8 of 48.
#[test]
fn a_model_leaves_a_region_that_is_one_answer() {
    let balls = SmallRegions::new(5, 6, Shape::Ball, 0.2, 1.0, 0, 17).unwrap();
    let hits = |seed| {
        let mut search = Search::named("surrogate").unwrap().seed(seed);
        search.run(&balls, &Budget::evaluations(50)).unwrap().hit_count()
    };
    let found: usize = (0..8).map(hits).sum();
    assert!(found >= 14, "{found}");
}
