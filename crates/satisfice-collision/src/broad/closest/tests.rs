//! Against brute force over all pairs.
#![allow(clippy::unwrap_used)]

use rand::{RngExt as _, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::*;
use crate::{FeatureKind, Mesh, generate};

fn random_placement(rng: &mut Xoshiro256PlusPlus, apart: f64) -> Placement {
    let mut number = || rng.random::<f64>() - 0.5;
    let turned = Placement::from_axis_angle([number(), number(), number() + 1.0], 6.0 * number()).unwrap();
    turned
        .moved([apart * number(), apart * number(), apart * number()])
        .unwrap()
}

/// All pairs that are kept with their distances, sorted.
fn brute_force(
    (a, pose_a): (&FeatureTree, &Placement),
    (b, pose_b): (&FeatureTree, &Placement),
    keep: Keep<'_>,
) -> Vec<(Pair, f64)> {
    let mut all = Vec::new();
    for i in 0..a.len() as u32 {
        for j in 0..b.len() as u32 {
            if keep.is_none_or(|keep| keep(i, j)) {
                let one = a.shape(i).map(|p| pose_a.apply(p));
                let two = b.shape(j).map(|p| pose_b.apply(p));
                all.push((Pair { a: i, b: j }, distance::proximity(&one, &two).distance));
            }
        }
    }
    all.sort_by(|(a, d), (b, e)| d.total_cmp(e).then(a.cmp(b)));
    all
}

fn check(meshes: [&Mesh; 2], kinds: [FeatureKind; 2], poses: [&Placement; 2], keep: Keep<'_>) {
    let trees = [0, 1].map(|n| FeatureTree::new(meshes[n], kinds[n]));
    let (a, b) = ((&trees[0], poses[0]), (&trees[1], poses[1]));
    let all = brute_force(a, b, keep);
    for k in [0, 1, 2, 17, 100_000] {
        let found: Vec<_> = closest_pairs(a, b, k, keep)
            .unwrap()
            .into_iter()
            .map(|(pair, proximity)| (pair, proximity.distance))
            .collect();
        assert_eq!(found, all[..k.min(all.len())], "{kinds:?} {k}");
    }
}

#[test]
fn every_kind_at_every_distance() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(3);
    let ball = generate::icosphere(0.7, 1).unwrap();
    let ring = generate::torus(0.9, 0.2, 9, 5).unwrap();
    let mut touching = 0;
    for round in 0..24 {
        let apart = [0.0, 1.5, 4.0, 1e3, 1e8, 1e15][round % 6];
        let (one, two) = (
            random_placement(&mut rng, apart),
            random_placement(&mut rng, apart),
        );
        let kinds = [
            FeatureKind::ALL[round % 3],
            FeatureKind::ALL[(round / 3 + round / 9) % 3],
        ];
        check([&ball, &ring], kinds, [&one, &two], None);
        let triangles = [0, 1].map(|n| FeatureTree::new([&ball, &ring][n], FeatureKind::Triangle));
        let found = closest_pairs((&triangles[0], &one), (&triangles[1], &two), 1, None).unwrap();
        touching += usize::from(found[0].1.distance == 0.0);
    }
    assert!((3..20).contains(&touching), "{touching} of 24 touch");
}

#[test]
fn sizes_that_differ_by_everything() {
    let ball = generate::icosphere(1.0, 0).unwrap();
    let scaled = |factor: f64| {
        let vertices = ball.vertices().iter().map(|p| p.map(|c| factor * c)).collect();
        ball.with_vertices(vertices).unwrap()
    };
    let turned = Placement::from_axis_angle([1.0, 2.0, 0.5], 1.0).unwrap();
    for (a, b, at) in [
        (1e-8, 1.0, 2.0),
        (1.0, 1e-12, 1.0),
        (1e150, 1e-150, 1e150),
        (1e-300, 1e-300, 3e-300),
        (1e300, 1e300, 5e300),
        (1e-320, 1.0, 0.5),
    ] {
        let there = turned.moved([at, -at / 2.0, at / 3.0]).unwrap();
        let kinds = [FeatureKind::Triangle, FeatureKind::Edge];
        check([&scaled(a), &scaled(b)], kinds, [&turned, &there], None);
    }
}

#[test]
fn pairs_that_do_not_count_are_left_out() {
    let ball = generate::icosphere(0.5, 1).unwrap();
    let there = Placement::from_translation([0.3, 0.2, 1.4]).unwrap();
    let keep = |i: u32, j: u32| (i + 3 * j).is_multiple_of(5);
    let kinds = [FeatureKind::Triangle; 2];
    check([&ball, &ball], kinds, [&Placement::IDENTITY, &there], Some(&keep));
    let none = |_: u32, _: u32| false;
    check([&ball, &ball], kinds, [&Placement::IDENTITY, &there], Some(&none));
}

/// One body with itself, below a cutoff, and over several searches together.
#[test]
fn one_body_and_a_cutoff() {
    let sheet = generate::cloth(1.0, 1.0, 8, 8).unwrap();
    let folded = sheet
        .vertices()
        .iter()
        .map(|&[x, y, z]| [x.abs(), y, z + 0.1 * x + 0.03 * y]);
    let sheet = sheet.with_vertices(folded.collect()).unwrap();
    let tree = FeatureTree::new(&sheet, FeatureKind::Triangle);
    let keep = |i: u32, j: u32| {
        let (a, b) = (tree.corners(i), tree.corners(j));
        !a.iter().any(|v| b.contains(v))
    };
    let here = Placement::IDENTITY;
    let ordered = |i: u32, j: u32| i < j && keep(i, j);
    let all = brute_force((&tree, &here), (&tree, &here), Some(&ordered));
    let query = PairQuery {
        a: (&tree, &here),
        b: (&tree, &here),
        one_body: true,
        threshold: Threshold::LARGEST,
        keep: Some(&keep),
        moved: [Dirty::All; 2],
        shares_mesh: false,
    };
    let watch = Watch::none();
    let mut closest = Closest::new(30, None);
    find_closest(&query, &mut closest, |pair| pair, &watch);
    let found: Vec<_> = closest
        .into_sorted()
        .iter()
        .map(|found| (found.key, found.distance))
        .collect();
    assert_eq!(found, all[..30]);
    // strictly below the cutoff, which is one of the distances
    let positive = all
        .iter()
        .position(|(_, distance)| *distance > all[20].1)
        .unwrap();
    let cutoff = Threshold::new(all[positive].1).unwrap();
    let is_below = |pair: &Pair| {
        let [one, two] = query.shapes(*pair);
        distance::within(&one, &two, cutoff)
    };
    let below = all.iter().filter(|(pair, _)| is_below(pair)).count();
    assert!(below > 10 && below < all.len() / 2);
    let mut closest = Closest::new(usize::MAX, Some(cutoff));
    find_closest(&query, &mut closest, |pair| pair, &watch);
    assert_eq!(closest.into_sorted().len(), below);
    // the same twice with different keys: each counts
    let mut closest = Closest::new(40, None);
    for time in 0..2 {
        find_closest(&query, &mut closest, |pair| (pair, time), &watch);
    }
    let found: Vec<_> = closest.into_sorted().iter().map(|found| found.distance).collect();
    let twice: Vec<f64> = all[..20]
        .iter()
        .flat_map(|&(_, distance)| [distance; 2])
        .collect();
    assert_eq!(found, twice);
}

#[test]
fn few_pairs_are_measured() {
    let ball = FeatureTree::new(&generate::icosphere(1.0, 4).unwrap(), FeatureKind::Triangle);
    let there = Placement::from_axis_angle([0.3, 0.1, 1.0], 0.7).unwrap();
    let there = there.moved([2.1, 0.2, 0.1]).unwrap();
    let asked = std::sync::atomic::AtomicUsize::new(0);
    let keep = |_: u32, _: u32| {
        asked.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        true
    };
    let found = closest_pairs((&ball, &Placement::IDENTITY), (&ball, &there), 1, Some(&keep)).unwrap();
    assert!(found[0].1.distance > 0.0);
    let asked = asked.into_inner();
    assert!(
        asked < 2000,
        "{asked} pairs measured of {}",
        ball.len() * ball.len()
    );
}

/// Corners of a small lattice, most of them several times: nearly all distances are equal to others.
fn lattice(rng: &mut Xoshiro256PlusPlus, corners: usize, side: f64) -> Mesh {
    let vertices: Vec<_> = (0..corners)
        .map(|_| [0; 3].map(|_| (rng.random::<f64>() * side).floor()))
        .collect();
    let mut corner = || rng.random_range(0..corners as u32);
    let triangles = (0..corners).map(|_| [corner(), corner(), corner()]).collect();
    Mesh::new(vertices, Vec::new(), triangles).unwrap()
}

#[test]
fn equal_distances_are_ordered_by_number() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(8);
    for round in 0..18 {
        let side = [1.0, 2.0, 3.0][round % 5 % 3];
        let meshes = [60, 40].map(|corners| lattice(&mut rng, corners, side));
        let kinds = [FeatureKind::ALL[round % 3], FeatureKind::ALL[round / 3 % 3]];
        let trees = [0, 1].map(|n| FeatureTree::new(&meshes[n], kinds[n]));
        let there = Placement::from_translation([[0.0; 3], [0.5, 0.25, 7.0]][round % 2]).unwrap();
        let (a, b) = ((&trees[0], &Placement::IDENTITY), (&trees[1], &there));
        let odd = |i: u32, j: u32| !(i + j).is_multiple_of(3);
        for keep in [None, Some(&odd as &(dyn Fn(u32, u32) -> bool + Sync))] {
            let all = brute_force(a, b, keep);
            for k in [1, 5, 100] {
                let found = closest_pairs(a, b, k, keep).unwrap();
                let found: Vec<_> = found.iter().map(|(pair, near)| (*pair, near.distance)).collect();
                assert_eq!(found, all[..k], "{round} {k}");
            }
        }
        // of one body with itself
        let ordered = |i: u32, j: u32| i < j;
        let all = brute_force(a, a, Some(&ordered));
        let query = PairQuery {
            a,
            b: a,
            one_body: true,
            threshold: Threshold::LARGEST,
            keep: None,
            moved: [Dirty::All; 2],
            shares_mesh: false,
        };
        for k in [1, 5, 100] {
            let mut closest = Closest::new(k, None);
            find_closest(&query, &mut closest, |pair| pair, &Watch::none());
            let found = closest.into_sorted().into_iter();
            let found: Vec<_> = found.map(|found| (found.key, found.distance)).collect();
            assert_eq!(found, all[..k], "{round} {k}");
        }
    }
}

/// 24,000 vertices at one place, and as many at another: 576 million pairs at one distance.
#[test]
fn coincident_features_are_not_looked_at_one_by_one() {
    let all_at = |place: [f64; 3]| {
        let mesh = Mesh::new(vec![place; 24_000], Vec::new(), Vec::new()).unwrap();
        FeatureTree::new(&mesh, FeatureKind::Vertex)
    };
    let here = all_at([0.1, 0.2, 0.3]);
    for (there, far) in [([0.1, 0.2, 0.3], 0.0), ([0.1, 0.2, 4.3], 4.0)] {
        let there = all_at(there);
        let asked = std::sync::atomic::AtomicUsize::new(0);
        let keep = |_: u32, _: u32| {
            asked.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            true
        };
        let pose = Placement::IDENTITY;
        let found = closest_pairs((&here, &pose), (&there, &pose), 5, Some(&keep)).unwrap();
        let expected: Vec<_> = (0..5).map(|b| (Pair { a: 0, b }, far)).collect();
        let found: Vec<_> = found.iter().map(|(pair, near)| (*pair, near.distance)).collect();
        assert_eq!(found, expected);
        assert!(asked.into_inner() < 1_000_000);
    }
}
