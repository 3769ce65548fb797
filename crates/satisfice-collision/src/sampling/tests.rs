//! Tests of the samples: sizes, reproducibility, value stability, and frequencies against what they should be.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::{Mesh, generate};

#[test]
fn uniform_samples_are_distinct_sorted_and_repeatable() {
    for (population, count) in [(0, 0), (1, 1), (10, 0), (10, 10), (5461, 5000)] {
        let sample = uniform_vertices(population, count, 7).unwrap();
        assert_eq!(sample.len(), count as usize);
        assert!(sample.windows(2).all(|w| w[0] < w[1]));
        assert!(sample.iter().all(|&v| v < population));
        assert_eq!(sample, uniform_vertices(population, count, 7).unwrap());
    }
    assert_ne!(
        uniform_vertices(100, 50, 1).unwrap(),
        uniform_vertices(100, 50, 2).unwrap()
    );
    assert!(matches!(
        uniform_vertices(3, 4, 0),
        Err(Error::Parameter {
            parameter: "sample size",
            ..
        })
    ));
}

#[test]
fn values_are_stable() {
    assert_eq!(uniform_vertices(1000, 8, 42).unwrap(), STABLE_UNIFORM);
    assert_eq!(permutation(8, 42), STABLE_PERMUTATION);
    assert_eq!(
        vertices_by_area(&generate::teapot(4).unwrap(), 6, 42).unwrap(),
        STABLE_BY_AREA
    );
}

const STABLE_UNIFORM: [u32; 8] = [130, 319, 590, 607, 702, 794, 814, 983];
const STABLE_PERMUTATION: [u32; 8] = [6, 3, 7, 0, 2, 1, 5, 4];
const STABLE_BY_AREA: [u32; 6] = [123, 200, 296, 430, 446, 521];

/// Each of 20 numbers falls into a sample of 5 with probability 1/4; five standard deviations are allowed.
#[test]
fn uniform_samples_are_uniform() {
    let (runs, population, count) = (8000, 20, 5);
    let mut seen = [0_u32; 20];
    for seed in 0..runs {
        for v in uniform_vertices(population, count, seed).unwrap() {
            seen[v as usize] += 1;
        }
    }
    let p = f64::from(count) / f64::from(population);
    let mean = runs as f64 * p;
    let allowed = 5.0 * (mean * (1.0 - p)).sqrt();
    assert!(
        seen.iter().all(|&s| (f64::from(s) - mean).abs() < allowed),
        "{seen:?}"
    );
}

/// All 24 orders of four items, each 1 in 24.
#[test]
fn permutations_are_uniform() {
    let runs = 24_000;
    let mut seen = std::collections::BTreeMap::new();
    for seed in 0..runs {
        *seen.entry(permutation(4, seed)).or_insert(0_u32) += 1;
    }
    assert_eq!(seen.len(), 24);
    assert!(
        seen.values()
            .all(|&s| (f64::from(s) - 1000.0).abs() < 5.0 * 1000.0_f64.sqrt()),
        "{seen:?}"
    );
}

/// Two triangles, the second three times as large as the first, a third without area, and a loose vertex.
fn uneven() -> Mesh {
    let vertices = vec![
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 5.0],
        [3.0, 0.0, 5.0],
        [0.0, 1.0, 5.0],
        [9.0, 9.0, 9.0],
    ];
    Mesh::new(vertices, vec![], vec![[0, 1, 2], [0, 0, 3], [3, 4, 5]]).unwrap()
}

#[test]
fn surface_points_follow_the_area_and_lie_on_their_triangles() {
    let mesh = uneven();
    let count = 40_000;
    let points = surface_points(&mesh, count, 3).unwrap();
    let large: Vec<_> = points.iter().filter(|p| p.triangle == 2).collect();
    assert!(points.iter().all(|p| p.triangle != 1));
    let mean = 0.75 * count as f64;
    assert!((large.len() as f64 - mean).abs() < 5.0 * (mean * 0.25).sqrt());
    for p in &points {
        assert!(p.barycentric.iter().all(|&b| b >= 0.0));
        approx::assert_relative_eq!(p.barycentric.iter().sum::<f64>(), 1.0, max_relative = 1e-15);
        assert!(p.position[0] >= 0.0 && p.position[1] >= 0.0);
    }
    // The mean of a uniform point is the centroid; each barycentric coordinate has variance 1/18.
    for k in 0..3 {
        let mean = large.iter().map(|p| p.barycentric[k]).sum::<f64>() / large.len() as f64;
        assert!((mean - 1.0 / 3.0).abs() < 5.0 / (18.0 * large.len() as f64).sqrt());
    }
    assert!(surface_points(&uneven(), 0, 0).unwrap().is_empty());
    let flat = Mesh::new(vec![[0.0; 3]; 3], vec![], vec![[0, 1, 2]]).unwrap();
    assert!(matches!(
        surface_points(&flat, 1, 0),
        Err(Error::Parameter {
            parameter: "surface area",
            ..
        })
    ));
}

#[test]
fn vertices_by_area_follow_their_shares() {
    let mesh = uneven();
    let shares = vertex_areas(&mesh);
    approx::assert_relative_eq!(shares[3] / shares[0], 3.0, max_relative = 1e-14);
    assert_eq!(shares[6], 0.0);
    // Of one drawn vertex, 3 in 4 come from the large triangle.
    let runs = 8000;
    let large = (0..runs)
        .filter(|&s| vertices_by_area(&mesh, 1, s).unwrap()[0] >= 3)
        .count();
    let mean = 0.75 * runs as f64;
    assert!((large as f64 - mean).abs() < 5.0 * (mean * 0.25).sqrt());
    assert_eq!(vertices_by_area(&mesh, 6, 9).unwrap(), [0, 1, 2, 3, 4, 5]);
    assert!(vertices_by_area(&mesh, 7, 9).is_err());
}

/// Without replacement: the chance that both of two draws are given items is a closed form.
#[test]
fn the_second_draw_leaves_the_first_out() {
    let weights = [5.0, 3.0, 2.0];
    let runs = 20_000;
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
    let mut first_two = 0;
    for _ in 0..runs {
        let mut tree = weights::WeightTree::new(&weights);
        let a = tree.draw(&mut rng);
        tree.remove(a);
        let b = tree.draw(&mut rng);
        assert_ne!(a, b);
        first_two += u32::from(a + b == 1);
    }
    let p: f64 = 0.5 * (0.3 / 0.5) + 0.3 * (0.5 / 0.7);
    let mean = f64::from(runs) * p;
    assert!((f64::from(first_two) - mean).abs() < 5.0 * (mean * (1.0 - p)).sqrt());
}

#[test]
fn areas_do_not_overflow_or_vanish_with_the_unit_of_length() {
    let plain = vertices_by_area(&generate::teapot(3).unwrap(), 50, 5).unwrap();
    for power in [-900, -300, 300, 1000] {
        let unscaled = generate::teapot(3).unwrap();
        let factor = 2.0_f64.powi(power);
        let scaled = unscaled
            .with_vertices(
                unscaled
                    .vertices()
                    .iter()
                    .map(|p| p.map(|c| c * factor))
                    .collect(),
            )
            .unwrap();
        assert_eq!(vertices_by_area(&scaled, 50, 5).unwrap(), plain, "2^{power}");
    }
}
