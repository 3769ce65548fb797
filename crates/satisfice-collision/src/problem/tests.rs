//! Tests of the vertex-vertex problem. Referees: integer arithmetic, graph search, and brute force.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;

use proptest::prelude::*;
use satisfice::catalogue::{Catalogued, Params};
use satisfice::{Budget, SatisficingProblem, Search, engine, testing};

use super::*;
use crate::distance::Threshold;
use crate::{Error, Mesh, Placement, VertexOrder, generate, oracle};

fn cloud(points: &[[i32; 3]]) -> Mesh {
    Mesh::new(points.iter().map(|p| p.map(f64::from)).collect(), vec![], vec![]).unwrap()
}

/// Every solution of the space, by decoding and evaluating every point of it.
fn enumerate(problem: &impl SatisficingProblem<Scalar = f64, Solution = (u32, u32)>) -> Vec<(u32, u32)> {
    let axes = problem.space().axes();
    let mut hits = BTreeSet::new();
    for p in 0..=axes[0].upper() as u32 {
        for q in 0..=axes[1].upper() as u32 {
            let solution = problem.decode(&[f64::from(p), f64::from(q)]);
            if problem.fitness(&solution) < problem.threshold() {
                hits.insert(solution);
            }
        }
    }
    hits.into_iter().collect()
}

const ORDERS: [VertexOrder; 4] = [
    VertexOrder::File,
    VertexOrder::Random { seed: 4 },
    VertexOrder::Morton,
    VertexOrder::Hilbert,
];

proptest! {
    /// Whole coordinates and a whole delta, so that integers decide exactly; ties are common and are no hits.
    #[test]
    fn hits_are_those_of_integer_arithmetic(
        a in prop::collection::vec(prop::array::uniform3(-6_i32..6), 1..14),
        b in prop::collection::vec(prop::array::uniform3(-6_i32..6), 1..14),
        delta in 1_i32..9,
        power in prop::sample::select(vec![0, -1070, -600, -500, 500, 520, 1010]),
        order in 0_usize..4,
    ) {
        let close = |p: &[i32; 3], q: &[i32; 3]| {
            (0..3).map(|k| (p[k] - q[k]).pow(2)).sum::<i32>() < delta * delta
        };
        let mut expected = Vec::new();
        for (i, p) in a.iter().enumerate() {
            for (j, q) in b.iter().enumerate() {
                if close(p, q) { expected.push((i as u32, j as u32)); }
            }
        }
        // Scaled by powers of two, down to where squares vanish and up to where they overflow.
        let unit = 2.0_f64.powi(power / 2) * 2.0_f64.powi(power - power / 2);
        let scaled = |points: &[[i32; 3]]| {
            let mesh = cloud(points);
            mesh.with_vertices(mesh.vertices().iter().map(|p| p.map(|c| c * unit)).collect()).unwrap()
        };
        let problem = VertexPairs::between(&scaled(&a), &scaled(&b), f64::from(delta) * unit)
            .unwrap()
            .with_orders(ORDERS[order], ORDERS[3 - order]);
        prop_assert_eq!(enumerate(&problem), &expected[..]);
        prop_assert_eq!(problem.reference_pairs(), &expected[..]);

        let own: Vec<_> = (0..a.len()).flat_map(|i| (i + 1..a.len()).map(move |j| (i, j)))
            .filter(|&(i, j)| close(&a[i], &a[j]))
            .map(|(i, j)| (i as u32, j as u32))
            .collect();
        let own_problem = VertexPairs::within(&scaled(&a), f64::from(delta) * unit, 1).unwrap();
        prop_assert_eq!(enumerate(&own_problem), &own[..]);
        prop_assert_eq!(own_problem.reference_pairs(), &own[..]);
    }
}

/// F is the distance itself, also where the plain formula would overflow or vanish.
#[test]
fn fitness_is_the_euclidean_distance() {
    for unit in [1.0, 2.0_f64.powi(-1000), 2.0_f64.powi(1000), 2.0_f64.powi(-1070)] {
        let at = |p: [f64; 3]| Mesh::new(vec![p.map(|c| c * unit)], vec![], vec![]).unwrap();
        let (a, b) = (at([1.0, 2.0, 3.0]), at([3.0, 5.0, 9.0]));
        for delta in [1.0, 7.0, 8.0] {
            let problem = VertexPairs::between(&a, &b, delta * unit).unwrap();
            assert_eq!(problem.fitness(&(0, 0)), 7.0 * unit);
        }
        let same = VertexPairs::between(&a, &a, unit).unwrap();
        assert_eq!(same.fitness(&(0, 0)), 0.0);
    }
    let far = |x: f64| Mesh::new(vec![[x, 0.0, 0.0]], vec![], vec![]).unwrap();
    let problem = VertexPairs::between(&far(-1.7e308), &far(1.7e308), 1.0).unwrap();
    assert_eq!(problem.fitness(&(0, 0)), f64::MAX);
}

/// 0.6^2 + 0.8^2 with rounded coordinates: whether the distance is below delta is decided for these very numbers.
#[test]
fn the_threshold_is_strict_and_decided_exactly() {
    let a = cloud(&[[0, 0, 0]]);
    let b = cloud(&[[3, 4, 0]]);
    let hit = |delta: f64| {
        let problem = VertexPairs::between(&a, &b, delta).unwrap();
        problem.fitness(&(0, 0)) < delta
    };
    assert!(!hit(5.0) && hit(5.0_f64.next_up()) && !hit(5.0_f64.next_down()));
}

#[test]
fn thresholds_and_vertices_out_of_range_are_refused() {
    let ball = generate::icosphere(1.0, 0).unwrap();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for result in [
            VertexPairs::between(&ball, &ball, bad),
            VertexPairs::within(&ball, bad, 1),
        ] {
            assert!(
                matches!(
                    result,
                    Err(Error::Parameter {
                        parameter: "threshold",
                        ..
                    })
                ),
                "{bad}"
            );
        }
    }
    let problem = VertexPairs::between(&ball, &ball, 0.1).unwrap();
    assert!(problem.clone().with_vertices(&[], &[0]).is_err());
    assert!(problem.clone().with_vertices(&[0], &[12]).is_err());
    assert!(problem.clone().move_a(&cloud(&[[0, 0, 0]])).is_err());
    // Numbers that are no vertices are never a hit, whoever asks.
    assert!(problem.fitness(&(0, 12)).is_nan() && problem.fitness(&(u32::MAX, 0)).is_nan());
    let mut values = [0.0; 2];
    assert!(!problem.encoding().unwrap().encode(&(0, 12), &mut values));
    let neighbourhood = problem.neighbourhood().unwrap();
    assert_eq!(neighbourhood.count(&(u32::MAX, 0)), 0);
    assert_eq!(neighbourhood.neighbour(&(u32::MAX, 0), 0), None);
    for wild in [-1.0, 1e300, f64::NAN, f64::INFINITY] {
        let (i, j) = problem.decode(&[wild, wild]);
        assert!(i < 12 && j < 12);
    }
}

#[test]
fn decode_undoes_encode_in_every_order_and_choice() {
    let ball = generate::icosphere(1.0, 1).unwrap();
    let chosen: Vec<u32> = (0..42).filter(|v| v % 3 != 1).collect();
    for order in ORDERS {
        for problem in [
            VertexPairs::between(&ball, &ball, 0.5).unwrap(),
            VertexPairs::within(&ball, 0.5, 1).unwrap(),
        ] {
            let problem = problem
                .with_vertices(&chosen, &chosen)
                .unwrap()
                .with_orders(order, order);
            let mut values = [0.0; 2];
            for p in 0..chosen.len() {
                for q in 0..chosen.len() {
                    let solution = problem.decode(&[p as f64, q as f64]);
                    assert!(chosen.contains(&solution.0) && chosen.contains(&solution.1));
                    assert!(problem.encoding().unwrap().encode(&solution, &mut values));
                    assert_eq!(problem.decode(&values), solution);
                    assert_eq!(problem.canonical(&solution), None);
                }
            }
            assert!(
                !problem.encoding().unwrap().encode(&(1, 0), &mut values),
                "vertex 1 was not chosen"
            );
            assert_eq!(enumerate(&problem), problem.reference_pairs());
        }
    }
}

/// Self-pairs against a search in the graph: never within the ring, never twice, never a vertex with itself.
#[test]
fn self_pairs_leave_out_the_ring() {
    let cloth = generate::cloth(1.0, 1.0, 10, 9).unwrap();
    let edges: BTreeSet<[u32; 2]> = cloth.edges().iter().copied().collect();
    let joined = |i: u32, j: u32| edges.contains(&[i.min(j), i.max(j)]);
    let n = cloth.vertices().len() as u32;
    for width in 0..3 {
        let problem = VertexPairs::within(&cloth, 0.45, width).unwrap();
        let mut expected = Vec::new();
        for i in 0..n {
            for j in i + 1..n {
                let apart = match width {
                    0 => true,
                    1 => !joined(i, j),
                    _ => !joined(i, j) && !(0..n).any(|k| joined(i, k) && joined(k, j)),
                };
                let (p, q) = (cloth.vertex(i), cloth.vertex(j));
                if apart && ((p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2)).sqrt() < 0.45 {
                    expected.push((i, j));
                }
            }
        }
        assert!(!expected.is_empty());
        assert_eq!(enumerate(&problem), expected);
        assert_eq!(problem.reference_pairs(), expected);
        let excluded = cloth.adjacency().rings(width);
        let direct = oracle::pairs_within(cloth.vertices(), &excluded, Threshold::new(0.45).unwrap());
        assert_eq!(direct, expected.iter().map(|&(i, j)| [i, j]).collect::<Vec<_>>());
        // What is no pair is finite, no hit, and no closer than anything.
        for v in 0..n {
            let f = problem.fitness(&(v, v));
            assert!(f.is_finite() && f >= 2.0_f64.sqrt());
        }
    }
    let wide = VertexPairs::within(&cloth, 100.0, 1).unwrap();
    assert!(wide.fitness(&(0, 0)) >= 100.0);
}

fn visited(problem: &VertexPairs, of: (u32, u32)) -> Vec<(u32, u32)> {
    let neighbourhood = problem.neighbourhood().unwrap();
    (0..neighbourhood.count(&of))
        .filter_map(|index| neighbourhood.neighbour(&of, index))
        .collect()
}

#[test]
fn neighbours_follow_the_mesh() {
    // A square of two triangles: 0 is joined to 1, 2, 3; 1 to 0 and 2.
    let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let square = Mesh::new(corners, vec![], vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let coarse = VertexPairs::between(&square, &square, 2.0).unwrap();
    assert!(!coarse.joint_moves());
    assert_eq!(visited(&coarse, (0, 1)), [(1, 1), (2, 1), (3, 1), (0, 0), (0, 2)]);
    let fine = VertexPairs::between(&square, &square, 0.5).unwrap();
    assert!(fine.joint_moves(), "delta is below the length of the edges");
    assert_eq!(
        visited(&fine, (0, 1)),
        [
            (1, 1),
            (2, 1),
            (3, 1),
            (0, 0),
            (0, 2),
            (1, 0),
            (1, 2),
            (2, 0),
            (2, 2),
            (3, 0),
            (3, 2)
        ]
    );
    assert_eq!(visited(&fine.with_joint_moves(false), (0, 1)).len(), 5);

    // Of one body with itself: ordered, and never what is no pair.
    let own = VertexPairs::within(&square, 2.0, 0).unwrap();
    assert_eq!(visited(&own, (0, 1)), [(1, 2), (1, 3), (0, 2)]);
    assert!(visited(&VertexPairs::within(&square, 2.0, 1).unwrap(), (1, 3)).is_empty());

    // Only chosen vertices are visited, across those that are not (1 and 3 of b, both next to 0 and 2); without edges
    // neighbours are not offered.
    let some = VertexPairs::between(&square, &square, 2.0)
        .unwrap()
        .with_vertices(&[0, 1, 3], &[1, 3])
        .unwrap();
    assert_eq!(visited(&some, (0, 1)), [(1, 1), (3, 1), (0, 3)]);
    let loose = VertexPairs::between(&cloud(&[[0, 0, 0]]), &cloud(&[[1, 0, 0]]), 2.0).unwrap();
    assert!(loose.neighbourhood().is_none());
}

#[test]
fn a_moved_body_keeps_its_places() {
    let ball = generate::icosphere(1.0, 2).unwrap();
    let place = |x: f64| {
        Placement::from_translation([x, 0.0, 0.0])
            .unwrap()
            .place(&ball)
            .unwrap()
    };
    let mut problem = VertexPairs::between(&ball, &place(3.0), 0.3).unwrap();
    assert!(problem.reference_pairs().is_empty());
    let before = problem.decode(&[5.0, 9.0]);
    problem.move_b(&place(1.9)).unwrap();
    assert_eq!(problem.decode(&[5.0, 9.0]), before);
    assert_eq!(problem.b(), &place(1.9));
    let fresh = VertexPairs::between(&ball, &place(1.9), 0.3).unwrap();
    assert!(!fresh.reference_pairs().is_empty());
    assert_eq!(problem.reference_pairs(), fresh.reference_pairs());
    let mut own = VertexPairs::within(&ball, 0.3, 1).unwrap();
    own.move_b(&place(7.0)).unwrap();
    assert_eq!(own.a(), &place(7.0));
}

#[test]
fn the_laws_of_a_problem_hold() {
    let cloth = generate::cloth(1.0, 1.0, 12, 9).unwrap();
    let ball = generate::icosphere(0.5, 2).unwrap();
    let points = cloud(&[[0, 0, 0], [1, 0, 0], [0, 0, 0]]);
    let some = VertexPairs::between(&cloth, &ball, 0.1).unwrap();
    for problem in [
        some.clone(),
        some.with_vertices(&[3, 5, 90], &[1])
            .unwrap()
            .with_joint_moves(true),
        VertexPairs::within(&cloth, 0.2, 1).unwrap(),
        VertexPairs::within(&cloth, 0.2, 1)
            .unwrap()
            .with_joint_moves(true),
        VertexPairs::within(&points, 0.2, 0).unwrap(),
    ] {
        assert_eq!(
            testing::problem::check(&problem, 1),
            [],
            "{:?}",
            problem.description()
        );
    }
    assert_eq!(testing::problem::check(&teapots(&[]).unwrap(), 1), []);
}

// Teapots

fn teapots(settings: &[(&str, &str)]) -> Result<Teapots, satisfice::Error> {
    Teapots::from_params(&Params::with(
        Teapots::PARAMETERS,
        Teapots::NAME,
        settings.iter().copied(),
    )?)
}

#[test]
fn the_teapots_of_experiment_one() {
    let problem = teapots(&[]).unwrap();
    let (a, b) = (problem.pairs().a(), problem.pairs().b());
    assert_eq!((a.vertices().len(), b.vertices().len()), (5461, 5461));
    let size = a.size();
    for (p, q) in a.vertices().iter().zip(b.vertices()) {
        assert_eq!([p[0] + 0.45 * size, p[1], p[2]], *q);
    }
    assert_eq!(problem.threshold(), 0.02 * size);
    assert_eq!(problem.space().cardinality(), Some(25e6));
    assert_eq!(problem.reference_hits(), Some(TEAPOT_HITS));
    // The same by a plain double loop over the chosen vertices.
    let chosen = |side: usize| -> BTreeSet<u32> {
        let values = |k: u32| {
            if side == 0 {
                [f64::from(k), 0.0]
            } else {
                [0.0, f64::from(k)]
            }
        };
        (0..5000)
            .map(|k| {
                let (i, j) = problem.decode(&values(k));
                if side == 0 { i } else { j }
            })
            .collect()
    };
    let (left, right) = (chosen(0), chosen(1));
    assert_eq!((left.len(), right.len()), (5000, 5000));
    assert_ne!(left, right);
    let mut count = 0;
    for &i in &left {
        for &j in &right {
            count += u64::from(problem.fitness(&(i, j)) < problem.threshold());
        }
    }
    assert_eq!(count, TEAPOT_HITS);
}

const TEAPOT_HITS: u64 = 977;

#[test]
fn the_order_changes_places_but_no_hits() {
    for order in VertexOrder::NAMES {
        assert_eq!(
            teapots(&[("order", order)]).unwrap().reference_hits(),
            Some(TEAPOT_HITS),
            "{order}"
        );
    }
    let all = teapots(&[("samples", "0")]).unwrap();
    assert_eq!(all.space().cardinality(), Some(5461.0 * 5461.0));
    assert_eq!(all.reference_hits(), Some(1140));
    assert_ne!(
        teapots(&[("sample-seed", "2")]).unwrap().reference_hits(),
        Some(TEAPOT_HITS)
    );
    assert!(teapots(&[("sampling", "area")]).unwrap().reference_hits() > Some(0));
    assert_eq!(teapots(&[("offset", "3")]).unwrap().reference_hits(), Some(0));
}

#[test]
fn teapot_parameters_are_refused_by_name() {
    let say = |settings: &[(&str, &str)]| teapots(settings).unwrap_err().to_string();
    assert!(say(&[("segments", "0")]).contains("segments = 0 is not allowed"));
    assert!(say(&[("delta", "-0.1")]).contains("delta = -0.1 is not allowed"));
    assert!(say(&[("delta", "nan")]).contains("delta = nan is not allowed"));
    assert!(say(&[("ordre", "file")]).contains("did you mean `order`?"));
    assert!(say(&[("order", "hilbret")]).contains("did you mean `hilbert`?"));
    assert_eq!(
        say(&[("segments", "2")]),
        "samples = 5000 is not allowed: at most the number of vertices"
    );
}

#[test]
fn an_engine_finds_teapot_hits_that_are_true() {
    let problem = teapots(&[]).unwrap();
    let truth = problem.pairs().reference_pairs();
    let mut search = Search::with(engine::LatestHitQpso::default()).seed(1);
    let report = search.run(&problem, &Budget::evaluations(50_000)).unwrap();
    assert!(report.hit_count() > 50, "{}", report.hit_count());
    for hit in report.hits() {
        assert!(truth.binary_search(hit.solution).is_ok());
    }
}
