//! Tests of the feature-pair problems. Referees: the exact decision of every pair, and distances by sampling.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;

use satisfice::catalogue::{Catalogued, Params};
use satisfice::{Budget, Completeness, SatisficingProblem, Search, engine, testing};

use super::*;
use crate::distance::{self, PairKind};
use crate::{FeatureKind, Mesh, Placement, generate};

/// Two balls that cross, turned so that nothing is symmetric.
fn balls() -> [Mesh; 2] {
    let ball = generate::icosphere(1.0, 2).unwrap();
    let turned = Placement::from_axis_angle([1.0, 2.0, 3.0], 0.7).unwrap();
    let other = turned.moved([1.75, 0.1, 0.2]).unwrap().place(&ball);
    [ball, other.unwrap()]
}

/// A cloth in three layers.
fn fold() -> Mesh {
    generate::pleats(31, 9, 3, 0.1, 0.2).unwrap()
}

fn scenes(delta: f64) -> Vec<FeaturePairs> {
    let ([a, b], fold) = (balls(), fold());
    PairKind::ALL
        .into_iter()
        .flat_map(|kind| {
            [
                FeaturePairs::between(kind, &a, &b, delta).unwrap(),
                FeaturePairs::within(kind, &fold, delta, 0).unwrap(),
                FeaturePairs::within(kind, &fold, delta, 2).unwrap(),
            ]
        })
        .collect()
}

#[test]
fn every_kind_keeps_the_laws_of_problems() {
    for problem in scenes(0.12) {
        assert_eq!(
            testing::problem::check(&problem, 3),
            [],
            "{}",
            problem.description().name
        );
    }
}

#[test]
fn the_tree_and_every_pair_decided_agree() {
    for problem in scenes(0.12) {
        let pairs = problem.reference_pairs();
        assert!(!pairs.is_empty(), "{}", problem.description().name);
        assert_eq!(problem.exact_pairs(), pairs);
        for pair in pairs {
            assert!(problem.fitness(&pair) < 0.12);
        }
    }
}

/// Through the bounds the whole space is covered, with a small part of it evaluated.
#[test]
fn branch_and_bound_proves_the_exact_count() {
    for problem in scenes(0.12) {
        let report = Search::with(engine::BranchAndBound::default())
            .run(&problem, &Budget::evaluations(10_000_000))
            .unwrap();
        let name = problem.description().name;
        assert_eq!(report.completeness, Completeness::Proved, "{name}");
        let found: BTreeSet<_> = report.hits().map(|hit| *hit.solution).collect();
        assert_eq!(
            found.into_iter().collect::<Vec<_>>(),
            problem.exact_pairs(),
            "{name}"
        );
        let [m, n] = [0, 1].map(|k| problem.space().axes()[k].upper() + 1.0);
        assert!(
            (report.counts.evaluations as f64) < 0.5 * m * n,
            "{name}: {}",
            report.counts.evaluations
        );
        assert!(report.counts.bound_calls > 0);
    }
}

/// So does the older problem of vertices, and the teapots of the catalogue.
#[test]
fn branch_and_bound_proves_vertex_pairs() {
    let [a, b] = balls();
    let teapots = Params::with(
        Teapots::PARAMETERS,
        Teapots::NAME,
        [("segments", "4"), ("samples", "300")],
    )
    .unwrap();
    let teapots = Teapots::from_params(&teapots).unwrap();
    for problem in [
        VertexPairs::between(&a, &b, 0.2).unwrap(),
        VertexPairs::within(&fold(), 0.12, 1).unwrap(),
        teapots.pairs().clone(),
    ] {
        let report = Search::with(engine::BranchAndBound::default())
            .run(&problem, &Budget::evaluations(10_000_000))
            .unwrap();
        let found: BTreeSet<_> = report.hits().map(|hit| *hit.solution).collect();
        assert_eq!(report.completeness, Completeness::Proved);
        assert_eq!(found.into_iter().collect::<Vec<_>>(), problem.reference_pairs());
        assert!(report.hit_count() > 0 && report.counts.bound_calls > 0);
        let [m, n] = [0, 1].map(|k| problem.space().axes()[k].upper() + 1.0);
        assert!((report.counts.evaluations as f64) < 0.5 * m * n);
    }
    assert_eq!(testing::problem::check(&teapots, 7), []);
}

/// The hits of one kind hang together by neighbours: a flood from a few of them reaches many.
#[test]
fn engines_find_pairs_of_every_kind() {
    for problem in scenes(0.12) {
        let report = Search::with(engine::DescentFlood::default())
            .seed(1)
            .run(&problem, &Budget::evaluations(20_000))
            .unwrap();
        let all = problem.exact_pairs().len();
        assert!(
            4 * report.hit_count() > all,
            "{}: {} of {all}",
            problem.description().name,
            report.hit_count()
        );
    }
}

#[test]
fn a_feature_has_the_neighbours_that_share_a_vertex() {
    // Two triangles of a square and one that hangs by a corner.
    let corners = vec![
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [2.0, 2.0, 0.0],
        [2.0, 1.0, 0.0],
    ];
    let mesh = Mesh::new(corners, vec![], vec![[0, 1, 2], [0, 2, 3], [2, 4, 5]]).unwrap();
    let visited = |problem: &FeaturePairs, of| {
        let neighbourhood = problem.neighbourhood().unwrap();
        (0..neighbourhood.count(&of))
            .filter_map(|index| neighbourhood.neighbour(&of, index))
            .collect::<Vec<_>>()
    };
    let coarse = FeaturePairs::between(PairKind::VertexTriangle, &mesh, &mesh, 9.0).unwrap();
    assert!(!coarse.joint_moves());
    assert_eq!(visited(&coarse, (1, 2)), [(0, 2), (2, 2), (1, 0), (1, 1)]);
    let fine = FeaturePairs::between(PairKind::TriangleTriangle, &mesh, &mesh, 0.1).unwrap();
    assert!(fine.joint_moves());
    assert_eq!(visited(&fine, (0, 1)), [(1, 1), (2, 1), (0, 0), (0, 2), (1, 0)]);
    let edges = FeaturePairs::between(PairKind::EdgeEdge, &mesh, &mesh, 0.1).unwrap();
    // Edge 0 joins 0 and 1: with it in a triangle are 0-2 and 1-2, which are edges 1 and 3; 0-3 only shares a vertex.
    assert_eq!(mesh.edges()[..4], [[0, 1], [0, 2], [0, 3], [1, 2]]);
    assert_eq!(visited(&edges, (0, 0)).len(), 3 + 3 + 2 * 2);
    // Within one body: ordered, never what touches.
    let own = FeaturePairs::within(PairKind::EdgeEdge, &mesh, 9.0, 0).unwrap();
    for edge in 0..mesh.edges().len() as u32 {
        for (i, j) in visited(&own, (0, edge)) {
            let [e, f] = [i, j].map(|e| mesh.edges()[e as usize]);
            assert!(i < j && e.iter().all(|v| !f.contains(v)));
        }
    }
}

#[test]
fn frames_keep_positions_and_move_bounds() {
    let [a, b] = balls();
    let mut problem = FeaturePairs::between(PairKind::EdgeEdge, &a, &b, 0.05).unwrap();
    let (before, mut at, mut again) = (problem.exact_pairs(), [0.0; 2], [0.0; 2]);
    assert!(problem.encoding().unwrap().encode(&before[0], &mut at));
    let away = Placement::from_translation([0.0, 5.0, 0.0])
        .unwrap()
        .place(&b)
        .unwrap();
    problem.move_b(&away).unwrap();
    assert!(problem.encoding().unwrap().encode(&before[0], &mut again) && again == at);
    assert!(
        problem.exact_pairs().is_empty()
            && problem
                .bounds()
                .unwrap()
                .lower_bound(&problem.space().region())
                .unwrap()
                > 1.0
    );
    assert!(problem.move_a(&fold()).is_err());
    let mut own = FeaturePairs::within(PairKind::VertexTriangle, &fold(), 0.12, 0).unwrap();
    let wide = Mesh::new(
        fold().vertices().iter().map(|p| p.map(|c| 100.0 * c)).collect(),
        vec![],
        fold().triangles().to_vec(),
    );
    own.move_a(&wide.unwrap()).unwrap();
    assert!(own.exact_pairs().is_empty());
    assert_eq!(testing::problem::check(&own, 1), []);
}

#[test]
fn bodies_without_the_feature_and_bad_thresholds_are_refused() {
    let points = Mesh::new(vec![[0.0; 3]], vec![], vec![]).unwrap();
    let [ball, _] = balls();
    for (kind, fine) in [
        (PairKind::VertexVertex, true),
        (PairKind::VertexTriangle, true),
        (PairKind::EdgeEdge, false),
        (PairKind::TriangleTriangle, false),
    ] {
        assert_eq!(
            FeaturePairs::between(kind, &points, &ball, 0.1).is_ok(),
            fine,
            "{kind}"
        );
        assert!(FeaturePairs::between(kind, &ball, &ball, f64::NAN).is_err());
        assert!(FeaturePairs::within(kind, &ball, 0.0, 0).is_err());
    }
    let problem = FeaturePairs::between(PairKind::TriangleTriangle, &ball, &ball, 0.1).unwrap();
    assert!(problem.fitness(&(0, 320)).is_nan() && problem.fitness(&(u32::MAX, 0)).is_nan());
    assert!(!problem.encoding().unwrap().encode(&(0, 320), &mut [0.0; 2]));
    let neighbourhood = problem.neighbourhood().unwrap();
    assert_eq!(neighbourhood.count(&(u32::MAX, 0)), 0);
    assert_eq!(neighbourhood.neighbour(&(u32::MAX, 0), 0), None);
    assert!(problem.fitness(&(0, 0)) == 0.0 && distance::ACCURACY < 1e-9);
}

/// A ring around a feature leaves pairs where some feature is outside it.
#[test]
fn a_body_has_pairs_if_not_all_are_within_the_ring() {
    let strip: Vec<[f64; 3]> = (0..6)
        .map(|k| [f64::from(k / 2), f64::from(k % 2), 0.0])
        .collect();
    let strip = Mesh::new(strip, vec![], vec![[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4]]).unwrap();
    for kind in PairKind::ALL {
        for ring_width in 0..4 {
            let problem = FeaturePairs::within(kind, &strip, 100.0, ring_width).unwrap();
            let has_pairs = FeaturePairs::has_pairs_within(kind, &strip, ring_width);
            assert_eq!(
                has_pairs,
                !problem.reference_pairs().is_empty(),
                "{kind} {ring_width}"
            );
        }
    }
}

#[test]
fn problems_that_share_ordered_features_are_those_made_alone() {
    let ball = generate::icosphere(1.0, 2).unwrap();
    let other = Placement::from_translation([1.8, 0.1, 0.0])
        .unwrap()
        .place(&ball)
        .unwrap();
    for kind in PairKind::ALL {
        let (kind_a, kind_b) = kind.features();
        let a = OrderedFeatures::new(&ball, kind_a).unwrap();
        let own = OrderedFeatures::new(&ball, kind_b).unwrap();
        let b = OrderedFeatures::new(&other, kind_b).unwrap();
        let between = FeaturePairs::between_ordered(kind, &a, &b, 0.2).unwrap();
        let within = FeaturePairs::within_ordered(kind, &a, &own, 0.2, 1).unwrap();
        for (shared, alone) in [
            (between, FeaturePairs::between(kind, &ball, &other, 0.2).unwrap()),
            (within, FeaturePairs::within(kind, &ball, 0.2, 1).unwrap()),
        ] {
            let budget = Budget::evaluations(2_000);
            let [one, two] = [shared, alone].map(|problem| {
                let report = Search::new().seed(5).run(&problem, &budget).unwrap();
                (
                    report.hits().map(|hit| *hit.solution).collect::<Vec<_>>(),
                    problem.joint_moves(),
                )
            });
            assert_eq!(one, two, "{kind}");
        }
        assert!(FeaturePairs::within_ordered(kind, &a, &b, 0.2, 1).is_err());
        if kind_a != kind_b {
            assert!(FeaturePairs::between_ordered(kind, &b, &a, 0.2).is_err());
        }
    }
    // A problem that moves on leaves the others as they are.
    let a = OrderedFeatures::new(&ball, FeatureKind::Vertex).unwrap();
    let b = OrderedFeatures::new(&other, FeatureKind::Vertex).unwrap();
    let make = || FeaturePairs::between_ordered(PairKind::VertexVertex, &a, &b, 0.2).unwrap();
    let (mut moving, resting) = (make(), make());
    moving.move_a(&other).unwrap();
    assert_ne!(moving.exact_pairs(), resting.exact_pairs());
    assert_eq!(resting.exact_pairs(), make().exact_pairs());
}
