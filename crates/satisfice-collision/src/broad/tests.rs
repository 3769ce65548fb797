//! Every way of enumerating pairs of points against brute force over all pairs.
#![allow(clippy::unwrap_used)]

use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{FeatureTree, Pair, PointGrid, TreeJoin};
use crate::distance::{Threshold, edge_edge, triangle_triangle, vertex_triangle, vertex_vertex};
use crate::{Error, FeatureKind, Mesh, Placement, generate};

type Points = Vec<[f64; 3]>;

fn brute(a: &[[f64; 3]], b: &[[f64; 3]], delta: f64, one_body: bool) -> Vec<Pair> {
    let threshold = Threshold::new(delta).unwrap();
    let mut pairs = Vec::new();
    for (i, p) in a.iter().enumerate() {
        for (j, q) in b.iter().enumerate().skip(if one_body { i + 1 } else { 0 }) {
            // a difference of a single coordinate rules most pairs out, exactly: rounding is monotone
            if (0..3).all(|k| (p[k] - q[k]).abs() <= delta) && vertex_vertex::within(p, q, threshold) {
                pairs.push(Pair {
                    a: i as u32,
                    b: j as u32,
                });
            }
        }
    }
    pairs
}

fn cloud(n: usize, seed: u64, place: impl Fn(f64, f64, f64) -> [f64; 3]) -> Points {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    (0..n)
        .map(|_| place(rng.random(), rng.random(), rng.random()))
        .collect()
}

/// Name, two bodies, thresholds.
fn scenes() -> Vec<(&'static str, Points, Points, Vec<f64>)> {
    let cube = |n, seed| cloud(n, seed, |x, y, z| [x, y, z]);
    let both = |n: usize, place: fn(f64, f64, f64) -> [f64; 3]| (cloud(n, 3, place), cloud(n, 4, place));
    let mut scenes = vec![
        ("uniform", cube(700, 1), cube(900, 2), vec![0.01, 0.1, 0.3, 5.0]),
        ("one against many", cube(1, 1), cube(900, 2), vec![0.1, 0.5]),
        ("nothing against many", Vec::new(), cube(9, 2), vec![0.1]),
        (
            "apart",
            cube(50, 1),
            cloud(50, 2, |x, y, z| [x + 2.0, y, z]),
            vec![0.1, 0.99, 1.01],
        ),
    ];
    let mut add = |name, (a, b): (Points, Points), deltas: &[f64]| scenes.push((name, a, b, deltas.to_vec()));
    add(
        "one place",
        both(60, |_, _, _| [0.1, -0.2, 0.3]),
        &[5e-324, 1e-3, 1e300],
    );
    add("line", both(300, |x, _, _| [x, 2.0 * x, -x]), &[1e-3, 0.1]);
    add(
        "plane",
        both(500, |x, y, _| [x - 0.5, 7.0, y - 0.5]),
        &[1e-2, 0.1],
    );
    add(
        "far from the origin",
        both(400, |x, y, z| [x + 1e12, y - 1e12, z]),
        &[0.1, 1e-4],
    );
    add("negative octant", both(400, |x, y, z| [-x, -y, -z]), &[0.1]);
    add(
        "tiny",
        both(300, |x, y, z| [x * 1e-162, y * 1e-162, z * 1e-162]),
        &[1e-163],
    );
    add(
        "denormal",
        both(200, |x, y, z| [x * 1e-320, y * 1e-320, z * 1e-320]),
        &[2e-321, 1e-300],
    );
    add(
        "huge",
        both(300, |x, y, z| [x * 1e150, y * 1e150, z * 1e150]),
        &[1e149],
    );
    add(
        "as large as it gets",
        both(200, |x, y, z| [(x - 0.5) * f64::MAX, y * 8e307, -z * 8e307]),
        &[1e307, 1.0],
    );
    // ties: many pairs at exactly delta, which do not count
    let lattice = |x: f64, y: f64, z: f64| [x, y, z].map(|c| (c * 9.0).floor() * 0.25);
    add(
        "lattice",
        both(500, lattice),
        &[0.25, 0.5, 0.750_000_000_000_000_1],
    );
    let moved = |x: f64, y: f64, z: f64| [x, y, z].map(|c| (c * 9.0).floor() * 0.25 + 1e7);
    add("lattice far away", both(500, moved), &[0.25, 0.5]);
    // clumps far smaller than what lies between them
    let clumps = |x: f64, y: f64, z: f64| {
        let far = if x < 0.3 {
            1e9
        } else if x < 0.6 {
            -3e8
        } else {
            0.0
        };
        [far + x * 1e-2, y * 1e-2, -far + z * 1e-2]
    };
    add("clumps", both(2500, clumps), &[1e-3, 1e-6]);
    // each clump holds a smaller one
    let nested = |x: f64, y: f64, z: f64| [x, y, z].map(|c| (-60.0 * x).exp() * (c + 1.0));
    add("nested clumps", both(3000, nested), &[1e-12, 1e-20, 1e-3]);
    let flat = |x: f64, y: f64, z: f64| [x * 1e12, y * 1e-12, z];
    add("needle of a box", both(600, flat), &[1e9, 0.2]);
    let sphere = |x: f64, y: f64, _: f64| {
        let (h, t) = (2.0 * x - 1.0, std::f64::consts::TAU * y);
        let r = (1.0 - h * h).sqrt();
        [r * t.cos(), r * t.sin(), h]
    };
    let (a, b) = both(17_000, sphere);
    add(
        "spheres",
        (a, b.into_iter().map(|[x, y, z]| [x + 1.7, y, z + 0.1]).collect()),
        &[0.02],
    );
    scenes
}

#[test]
fn two_bodies_agree_with_brute_force() {
    let mut grid = PointGrid::new();
    for (name, a, b, deltas) in scenes() {
        for delta in deltas {
            let pairs = grid.between(&a, &b, Threshold::new(delta).unwrap()).unwrap();
            assert!(
                pairs == brute(&a, &b, delta, false),
                "{name}, {delta}: {} pairs",
                pairs.len()
            );
        }
    }
}

#[test]
fn points_with_thousands_of_partners_have_all_of_them() {
    let a: Vec<[f64; 3]> = (0..5).map(|i| [f64::from(i) * 0.1, 0.0, 0.0]).collect();
    let b: Vec<[f64; 3]> = (0..10_000)
        .map(|i| [f64::from(i * 7919 % 10_000) * 1e-4, 0.1, 0.0])
        .collect();
    for delta in [0.3, 2.0] {
        let threshold = Threshold::new(delta).unwrap();
        let expected = brute(&a, &b, delta, false);
        assert!(expected.len() > 5 * 4095 / 2);
        for mut grid in [PointGrid::new(), PointGrid::parallel()] {
            assert!(grid.between(&a, &b, threshold).unwrap() == expected, "{delta}");
            assert_eq!(grid.between(&b, &a, threshold).unwrap().len(), expected.len());
        }
    }
}

#[test]
fn one_body_agrees_with_brute_force() {
    let mut grid = PointGrid::new();
    for (name, a, _, deltas) in scenes().into_iter().filter(|(_, a, ..)| a.len() < 10_000) {
        for delta in deltas {
            let pairs = grid.within(&a, Threshold::new(delta).unwrap()).unwrap();
            assert!(
                pairs == brute(&a, &a, delta, true),
                "{name}, {delta}: {} pairs",
                pairs.len()
            );
        }
    }
}

fn point_tree(points: &[[f64; 3]]) -> Option<FeatureTree> {
    let mesh = Mesh::new(points.to_vec(), vec![], vec![]).ok()?;
    Some(FeatureTree::new(&mesh, FeatureKind::Vertex))
}

#[test]
fn kept_trees_agree_with_brute_force() {
    let mut join = TreeJoin::new();
    let rest = Placement::IDENTITY;
    for (name, a, b, deltas) in scenes() {
        let (Some(tree_a), Some(tree_b)) = (point_tree(&a), point_tree(&b)) else {
            continue;
        };
        for delta in deltas {
            let threshold = Threshold::new(delta).unwrap();
            let pairs = join
                .between((&tree_a, &rest), (&tree_b, &rest), threshold, None)
                .unwrap();
            assert!(
                pairs == brute(&a, &b, delta, false),
                "{name}, {delta}: {} pairs",
                pairs.len()
            );
            if a.len() < 10_000 {
                let pairs = join.within(&tree_a, threshold, None);
                assert!(
                    pairs == brute(&a, &a, delta, true),
                    "{name}, {delta}: {} pairs",
                    pairs.len()
                );
            }
        }
    }
}

#[test]
fn posed_trees_answer_for_the_posed_coordinates() {
    let (a, b) = (
        cloud(600, 1, |x, y, z| [x, y, z]),
        cloud(500, 2, |x, y, z| [3.0 * x, y, -z]),
    );
    let (tree_a, tree_b) = (point_tree(&a).unwrap(), point_tree(&b).unwrap());
    let mut join = TreeJoin::new();
    let threshold = Threshold::new(0.125).unwrap();
    let mut hits = 0;
    for step in 0..12 {
        let angle = f64::from(step) * 0.4;
        let far = [0.0, 1e3, -1e9][step as usize % 3];
        let pose_a = Placement::from_axis_angle([1.0, 0.3, -0.2], angle)
            .unwrap()
            .moved([far, 0.2, 0.0])
            .unwrap();
        let turn = if step % 2 == 0 { 0.0 } else { -angle };
        let pose_b = Placement::from_axis_angle([0.0, 0.1, 1.0], turn)
            .unwrap()
            .moved([far, 0.0, 0.1])
            .unwrap();
        let posed_a: Points = a.iter().map(|&p| pose_a.apply(p)).collect();
        let posed_b: Points = b.iter().map(|&p| pose_b.apply(p)).collect();
        let pairs = join
            .between((&tree_a, &pose_a), (&tree_b, &pose_b), threshold, None)
            .unwrap();
        assert!(pairs == brute(&posed_a, &posed_b, 0.125, false), "step {step}");
        hits += pairs.len();
        let back = join
            .between((&tree_b, &pose_b), (&tree_a, &pose_a), threshold, None)
            .unwrap()
            .len();
        assert_eq!(back, pairs_len(&posed_a, &posed_b));
    }
    assert!(hits > 1000);
}

fn pairs_len(a: &[[f64; 3]], b: &[[f64; 3]]) -> usize {
    brute(a, b, 0.125, false).len()
}

#[test]
fn a_refitted_tree_is_as_good_as_a_new_one() {
    let mut points = cloud(3000, 1, |x, y, z| [x, y, z]);
    let mut tree = point_tree(&points).unwrap();
    let mut join = TreeJoin::new();
    let threshold = Threshold::new(0.05).unwrap();
    for frame in 1..4 {
        for (i, point) in points.iter_mut().enumerate() {
            point[i % 3] += 0.3 * f64::from(frame) * ((i * 37 % 101) as f64 / 101.0 - 0.4);
        }
        tree.refit(&points).unwrap();
        assert!(
            join.within(&tree, threshold, None) == brute(&points, &points, 0.05, true),
            "frame {frame}"
        );
    }
    points[7][2] = f64::NAN;
    assert!(matches!(
        tree.refit(&points),
        Err(Error::NonFiniteVertex {
            vertex: 7,
            axis: 'z',
            ..
        })
    ));
    assert!(matches!(tree.refit(&points[1..]), Err(Error::Parameter { .. })));
}

#[test]
fn edges_and_triangles_agree_with_brute_force() {
    let a = generate::torus(1.0, 0.4, 24, 14).unwrap();
    let pose = Placement::from_axis_angle([1.0, 0.2, 0.1], 1.2)
        .unwrap()
        .moved([0.9, 0.1, 0.2])
        .unwrap();
    let b = generate::icosphere(0.8, 2).unwrap();
    let posed = pose.place(&b).unwrap();
    let mut join = TreeJoin::new();
    let rest = Placement::IDENTITY;
    let tree = |mesh: &Mesh, kind| FeatureTree::new(mesh, kind);
    for delta in [1e-3, 0.05, 0.2] {
        let threshold = Threshold::new(delta).unwrap();
        let all = |rows: usize, columns: usize, within: &dyn Fn(usize, usize) -> bool| {
            let pairs = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
            let hits = pairs.filter(|&(i, j)| within(i, j));
            hits.map(|(i, j)| Pair {
                a: i as u32,
                b: j as u32,
            })
            .collect::<Vec<_>>()
        };
        let edge = |mesh: &Mesh, e: usize| mesh.edges()[e].map(|v| mesh.vertex(v));
        let (kinds, expected): (_, Vec<Vec<Pair>>) = (
            [FeatureKind::Vertex, FeatureKind::Edge, FeatureKind::Triangle],
            vec![
                all(a.vertices().len(), b.triangles().len(), &|i, j| {
                    vertex_triangle::within(&a.vertices()[i], &posed.triangle(j), threshold)
                }),
                all(a.edges().len(), b.edges().len(), &|i, j| {
                    edge_edge::within(&edge(&a, i), &edge(&posed, j), threshold)
                }),
                all(a.triangles().len(), b.triangles().len(), &|i, j| {
                    triangle_triangle::within(&a.triangle(i), &posed.triangle(j), threshold)
                }),
            ],
        );
        for (kind, expected) in kinds.into_iter().zip(expected) {
            let other = if kind == FeatureKind::Vertex {
                FeatureKind::Triangle
            } else {
                kind
            };
            let (tree_a, tree_b) = (tree(&a, kind), tree(&b, other));
            let pairs = join
                .between((&tree_a, &rest), (&tree_b, &pose), threshold, None)
                .unwrap();
            assert!(
                pairs == expected,
                "{kind:?} {delta}: {} of {}",
                pairs.len(),
                expected.len()
            );
            assert!(!pairs.is_empty() || delta < 0.01);
            let turned: Vec<Pair> = join
                .between((&tree_b, &pose), (&tree_a, &rest), threshold, None)
                .unwrap()
                .iter()
                .map(|pair| Pair { a: pair.b, b: pair.a })
                .collect();
            let mut turned = turned;
            turned.sort_unstable();
            assert!(turned == expected, "{kind:?} {delta}, the other way round");
        }
    }
}

#[test]
fn pairs_that_are_not_kept_are_left_out() {
    let points = cloud(900, 3, |x, y, z| [x, y, z]);
    let tree = point_tree(&points).unwrap();
    let mut join = TreeJoin::new();
    let odd = |i: u32, j: u32| (i + j) % 2 == 1;
    let kept = join
        .within(&tree, Threshold::new(0.2).unwrap(), Some(&odd))
        .to_vec();
    let mut expected = brute(&points, &points, 0.2, true);
    expected.retain(|pair| odd(pair.a, pair.b));
    assert!(kept == expected && !kept.is_empty());
}

#[test]
fn threads_change_nothing() {
    let (a, b) = (
        cloud(60_000, 1, |x, y, z| [x, y, z]),
        cloud(70_000, 2, |x, y, z| [x, 0.9 * y, z * z]),
    );
    let threshold = Threshold::new(0.02).unwrap();
    let mut alone = PointGrid::new();
    let one = alone.between(&a, &b, threshold).unwrap().to_vec();
    let work = alone.work();
    let same = alone.within(&a, threshold).unwrap().to_vec();
    assert!(one.len() > 100_000 && same.len() > 30_000);
    for threads in [2, 3, 8] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let mut grid = PointGrid::parallel();
            assert!(
                one == grid.between(&a, &b, threshold).unwrap(),
                "{threads} threads"
            );
            assert_eq!(grid.work(), work, "{threads} threads");
            assert!(same == grid.within(&a, threshold).unwrap(), "{threads} threads");
            let mut join = TreeJoin::parallel();
            let (tree_a, tree_b) = (point_tree(&a).unwrap(), point_tree(&b).unwrap());
            let rest = Placement::IDENTITY;
            let pairs = join
                .between((&tree_a, &rest), (&tree_b, &rest), threshold, None)
                .unwrap();
            assert!(one == pairs, "{threads} threads");
            assert!(same == join.within(&tree_a, threshold, None), "{threads} threads");
        });
    }
}

#[test]
fn dense_clumps_are_not_compared_pair_by_pair() {
    // two clumps of 20,000 points at the ends of a box 1e12 times as wide
    let place = |x: f64, y: f64, z: f64| [if x < 0.5 { x } else { x + 1e12 }, y, z];
    let points = cloud(40_000, 5, place);
    let mut grid = PointGrid::new();
    let found = grid.within(&points, Threshold::new(0.01).unwrap()).unwrap().len();
    assert!(found > 100, "{found}");
    assert!(grid.work().tests < 40_000_000, "{:?}", grid.work());
}

#[test]
fn a_point_that_is_not_finite_is_named() {
    let mut points = cloud(3000, 1, |x, y, z| [x, y, z]);
    let mut grid = PointGrid::new();
    let threshold = Threshold::new(0.1).unwrap();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        points[2345][1] = bad;
        for result in [
            grid.within(&points, threshold).err(),
            grid.between(&points[..5], &points, threshold).err(),
        ] {
            let Some(Error::NonFiniteVertex { vertex, axis, value }) = result else {
                panic!("{bad}: {result:?}");
            };
            assert_eq!((vertex, axis, value.to_bits()), (2345, 'y', bad.to_bits()));
        }
    }
}
