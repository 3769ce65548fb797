//! Against an ordered set and all pairs; what probes do; memory at rest.

use std::collections::BTreeSet;

use super::*;
use crate::identity::Located;

#[test]
fn agrees_with_an_ordered_set() {
    let mut rng = crate::SearchRng::new(3);
    let (mut archive, mut set) = (Archive::default(), BTreeSet::new());
    for n in 0..200_000_u64 {
        let pair = [rng.below(600), rng.below(600)];
        assert_eq!(archive.contains(&pair), set.contains(&pair));
        if rng.uniform() < 0.6 {
            assert_eq!(archive.insert(pair, -1.0, n, 0.0), set.insert(pair));
        }
    }
    assert_eq!(archive.len(), set.len());
    assert!(archive.iter().all(|hit| set.contains(hit.solution)));
    assert!(archive.len() > FILTERED, "both regimes of the filter are passed");
}

#[test]
fn located_solutions_agree_with_all_pairs() {
    let mut rng = crate::SearchRng::new(4);
    for dimension in [1, 2, 5] {
        let mut archive = Archive::default();
        for n in 0..3000 {
            let point: Vec<f64> = (0..dimension).map(|_| rng.uniform() * 2.0 - 1.0).collect();
            let located = Located::new(&point, 0.05);
            let near = archive.solutions().iter().any(|other| located.same(other));
            assert_eq!(archive.contains(&located), near);
            assert_eq!(archive.insert(located, -1.0, n, 0.0), !near);
        }
    }
}

/// Enters points, some of them as probes, and compares every look-up with all pairs.
fn agrees_with_all_pairs<S: crate::Real>(
    points: impl IntoIterator<Item = Located<S>>,
) -> Archive<Located<S>> {
    let mut archive = Archive::default();
    let (mut most_probes, mut found) = (0, 0);
    for (n, located) in points.into_iter().enumerate() {
        let same = |archive: &Archive<Located<S>>| -> Vec<usize> {
            let all = archive.solutions().iter().enumerate();
            let same = all.filter(|(_, other)| other.same(&located));
            same.map(|(i, _)| i).collect()
        };
        let (seen, probes): (Vec<usize>, Vec<usize>) = same(&archive)
            .into_iter()
            .partition(|&i| !archive.is_probe_only(i));
        assert_eq!(archive.contains(&located), !seen.is_empty(), "{located:?}");
        assert_eq!(archive.any_same(&located, |_| true), !seen.is_empty());
        found += usize::from(!seen.is_empty());
        match archive.position(&located) {
            Some(index) => assert!(seen.contains(&index) || (seen.is_empty() && probes.contains(&index))),
            None => assert!(seen.is_empty() && probes.is_empty()),
        }
        if seen.is_empty() {
            let probing = n % 7 == 0;
            let entered = archive.enter(located, -1.0, n as u64, 0.0, probing);
            let expected = match (probes.is_empty(), probing) {
                (true, _) => Insertion::New,
                (false, true) => Insertion::Known,
                (false, false) => Insertion::Promoted,
            };
            assert_eq!(entered, expected);
        }
        most_probes = most_probes.max(archive.probe_only());
    }
    assert!(
        archive.near.is_some(),
        "hits are filed by their places on the way"
    );
    assert!(most_probes > 10 && found > 10, "{most_probes} {found}");
    assert!(archive.set_probe_only(0) && archive.is_probe_only(0));
    archive.rest();
    assert!(archive.iter().all(|hit| archive.contains(hit.solution)));
    archive
}

#[test]
fn crowded_solutions_agree_with_all_pairs() {
    let mut rng = crate::SearchRng::new(5);
    agrees_with_all_pairs((0..3000).map(|_| {
        let point: Vec<f64> = (0..6).map(|_| 0.3 * rng.uniform()).collect();
        Located::new(&point, 0.1)
    }));
}

/// Steps along single axes from known points, half a radius to two radii long, so that many coordinates are equal.
#[test]
fn steps_along_axes_agree_with_all_pairs() {
    let mut rng = crate::SearchRng::new(6);
    let mut points = vec![[0.0_f32; 20]];
    for _ in 0..3000 {
        let mut point = points[rng.below(points.len())];
        point[rng.below(20)] += 0.05 * (rng.below(4) as f32 + 1.0) * (rng.below(3) as f32 - 1.0);
        points.push(point);
    }
    agrees_with_all_pairs(points.iter().map(|point| Located::new(point, 0.1_f32)));
}

#[test]
fn crowded_solutions_on_mixed_axes_agree_with_all_pairs() {
    use crate::{AxisSeparation, Separation};
    let mut rng = crate::SearchRng::new(7);
    let apart = Separation::axes([
        AxisSeparation::exact(),
        AxisSeparation::within(0.3),
        AxisSeparation::within(0.5).periodic(1.0),
        AxisSeparation::within(0.2),
        AxisSeparation::within(0.2).logarithmic(),
        AxisSeparation::within(0.1),
    ]);
    agrees_with_all_pairs((0..3000).map(|_| {
        let point = [
            rng.below(2) as f64,
            rng.uniform(),
            rng.uniform(),
            rng.uniform(),
            rng.uniform().exp(),
            0.3 * rng.uniform(),
        ];
        Located::new(&point, apart.clone())
    }));
}

/// Archives of points within a radius of each other, compared with lists that compare each with each.
#[test]
fn a_hit_near_another_is_known_wherever_it_is_filed() {
    let mut rng = crate::SearchRng::new(10);
    // The last: steps from one place along one of many axes.
    for (dimension, changed, side, radius) in [(1, 1, 1.0, 0.002), (6, 6, 0.3, 0.1), (60, 1, 0.3, 0.1)] {
        let mut by_places = 0;
        for round in 0..40 {
            let (mut archive, mut left) = (Archive::default(), Vec::new());
            for n in 0..60 + 10 * round {
                let mut point = vec![0.0; dimension];
                let first = rng.below(dimension - changed + 1);
                for x in &mut point[first..first + changed] {
                    *x = side * rng.uniform();
                }
                let located = Located::new(&point, radius);
                let is_new = left.iter().all(|other| !located.same(other));
                assert_eq!(archive.contains(&located), !is_new, "{located:?}");
                assert_eq!(archive.insert(located.clone(), -1.0, n, 0.0), is_new);
                if is_new {
                    left.push(located);
                }
            }
            let probe = Located::new(&vec![9.0; dimension], radius);
            assert_eq!(archive.enter(probe, -1.0, 60, 0.0, true), Insertion::New);
            by_places += usize::from(archive.near.is_some());
            assert_eq!(
                (&archive.solutions()[..left.len()], archive.probe_only()),
                (&left[..], 1)
            );
            assert!(left.iter().all(|hit| archive.contains(hit) && archive.holds(hit)));
        }
        assert_eq!(by_places > 20, dimension > 1, "{by_places}");
    }
}

#[test]
fn a_point_without_coordinates_among_crowded_ones_is_found() {
    let mut archive = Archive::default();
    for n in 0..200 {
        archive.insert(Located::new(&[0.0, 0.0, 0.0, f64::from(n)], 0.5), 0.0, 1, 0.0);
    }
    let none = Located::new(&[], 0.5);
    assert!(archive.near.is_some() && !archive.contains(&none));
    archive.insert(none.clone(), 0.0, 1, 0.0);
    assert!(archive.contains(&none));
}

/// No axis has cells, so that all hits share one key.
#[test]
fn angles_agree_with_all_pairs() {
    use crate::{AxisSeparation, Separation};
    let mut rng = crate::SearchRng::new(9);
    let angle = AxisSeparation::within(0.4_f32).periodic(core::f32::consts::TAU);
    let apart = Separation::axes([angle; 3]);
    agrees_with_all_pairs((0..3000).map(|_| {
        let point = [0; 3].map(|_| core::f32::consts::TAU * (rng.uniform() as f32 - 0.5));
        Located::new(&point, apart.clone())
    }));
}

/// Coordinates as far from the seam on either side have one place.
#[test]
fn points_in_one_place_are_told_apart_by_the_rest() {
    use crate::{AxisSeparation, Separation};
    let apart = Separation::axes([
        AxisSeparation::within(0.1),
        AxisSeparation::within(0.1),
        AxisSeparation::within(0.1),
        AxisSeparation::within(0.1),
        AxisSeparation::within(1e-10).periodic(1000.0),
    ]);
    let mut rng = crate::SearchRng::new(8);
    let archive = agrees_with_all_pairs((0..2000).map(|_| {
        let around = rng.below(600) as f64 + 200.0;
        Located::new(&[1.0, 1.0, 1.0, 1.0, around], apart.clone())
    }));
    assert!(archive.len() > 500);
}

/// Batches whose solutions are looked up together and entered one by one, probes among them, of which some are promoted.
#[test]
fn a_look_up_after_another_says_what_the_archive_says() {
    let mut rng = crate::SearchRng::new(6);
    let mut archive = Archive::default();
    let (mut cheap, mut promoted) = (0, 0);
    for n in 0..2000 {
        let (probing, size) = (n % 5 == 0, if n % 50 == 1 { 3 * LATEST } else { 8 });
        let mut draw = || (120.0 * rng.uniform()) as u8;
        let mut batch: Vec<[u8; 2]> = (0..size).map(|_| [draw(), draw()]).collect();
        batch.retain(|solution| !archive.contains(solution));
        let mark = archive.mark();
        for solution in batch {
            let (known, mut recent) = (archive.contains(&solution), usize::MAX);
            cheap += usize::from(archive.entered_since(mark).is_some());
            assert_eq!(archive.contains_again(&solution, Some(mark), &mut recent), known);
            assert_eq!(archive.solutions().get(recent) == Some(&solution), known);
            if !known {
                let entered = archive.enter(solution, -1.0, 1, 0.0, probing);
                promoted += usize::from(entered == Insertion::Promoted);
            }
        }
    }
    assert!(cheap > 1000 && promoted > 100, "{cheap} {promoted}");
}

#[test]
fn at_rest_it_stays_under_32_bytes_a_hit() {
    for hits in [1_000_u32, 60_000, 200_000, 458_753] {
        let mut archive = Archive::default();
        for n in 0..hits {
            archive.insert([n, n], -1.0, u64::from(n), 0.0);
        }
        archive.rest();
        let bytes = archive.overhead_bytes() as f64 / f64::from(hits);
        assert!(bytes < 32.0, "{bytes} bytes per hit at {hits}");
        assert!(archive.contains(&[hits - 1, hits - 1]) && !archive.contains(&[hits, hits]));
    }
}
