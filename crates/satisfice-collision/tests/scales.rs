//! Worlds at every scale of `f64`: the tree and the grid find what a decision of every pair finds.
#![allow(clippy::unwrap_used)]

use satisfice_collision::broad::Method;
use satisfice_collision::continuous::{Separation, Step};
use satisfice_collision::distance::{PairKind, Threshold};
use satisfice_collision::scene::{Body, Contact, World};
use satisfice_collision::{Mesh, Placement, generate};

fn contacts(kind: PairKind, method: Method, bodies: &[(Mesh, Placement)], delta: f64) -> Vec<Contact> {
    let mut world = World::new(kind, Threshold::new(delta).unwrap()).with_method(method);
    for (mesh, placement) in bodies {
        let body = world.add(Body::rigid(mesh.clone())).unwrap();
        world.place(body, *placement).unwrap();
    }
    world.update().unwrap();
    let mut contacts: Vec<Contact> = world.contacts().collect();
    contacts.sort_unstable();
    contacts
}

#[test]
fn bodies_of_any_size_turned_or_not() {
    let ball = generate::icosphere(1.0, 2).unwrap();
    for power in [-1060, -1040, -1019, -500, 0, 500, 1000, 1015] {
        let (half, rest) = (2.0_f64.powi(power / 2), 2.0_f64.powi(power - power / 2));
        let scale = |x: f64| x * half * rest;
        let scaled = ball
            .with_vertices(ball.vertices().iter().map(|p| p.map(scale)).collect())
            .unwrap();
        let apart = [1.3, 1.1, 0.9].map(scale);
        let aside = Placement::from_translation(apart).unwrap();
        let turned = Placement::from_axis_angle([1.0, 2.0, 3.0], 0.7)
            .unwrap()
            .moved(apart)
            .unwrap();
        for placement in [aside, turned] {
            let bodies = [(scaled.clone(), Placement::IDENTITY), (scaled.clone(), placement)];
            for kind in [PairKind::VertexVertex, PairKind::TriangleTriangle] {
                let expected = contacts(kind, Method::BruteForce, &bodies, scale(0.2));
                assert!(!expected.is_empty(), "{kind} at 2^{power}");
                for method in [Method::Tree, Method::Grid, Method::Auto] {
                    let found = contacts(kind, method, &bodies, scale(0.2));
                    assert_eq!(found, expected, "{kind} by {method:?} at 2^{power}");
                }
            }
        }
    }
}

/// Sizes of bodies, as powers of two, and thresholds that are longer than they are by more than single precision can say.
const LONG_THRESHOLDS: [(i32, f64); 6] = [
    (0, 1e39),
    (0, f64::MAX),
    (-660, 0.25),
    (-1060, f64::MAX),
    (-140, 1.0),
    (800, f64::MAX),
];

/// A ball whose features fill no group of eight.
fn ball(power: i32, detail: u32) -> Mesh {
    let ball = generate::icosphere(1.0, detail).unwrap();
    let (half, rest) = (2.0_f64.powi(power / 2), 2.0_f64.powi(power - power / 2));
    let vertices = ball.vertices().iter().map(|p| p.map(|x| x * half * rest));
    ball.with_vertices(vertices.collect()).unwrap()
}

#[test]
fn all_features_are_within_a_threshold_that_is_far_longer_than_the_bodies() {
    for (power, delta) in LONG_THRESHOLDS {
        let ball = ball(power, 0);
        for placement in [
            Placement::IDENTITY,
            Placement::from_axis_angle([1.0, 2.0, 3.0], 0.7).unwrap(),
        ] {
            let bodies = [(ball.clone(), Placement::IDENTITY), (ball.clone(), placement)];
            for (kind, pairs) in [
                (PairKind::VertexVertex, 12 * 12),
                (PairKind::TriangleTriangle, 20 * 20),
            ] {
                for method in [Method::BruteForce, Method::Tree, Method::Grid] {
                    let found = contacts(kind, method, &bodies, delta);
                    assert_eq!(found.len(), pairs, "{kind} by {method:?}, {delta} at 2^{power}");
                }
            }
        }
    }
}

#[test]
fn all_features_in_motion_are_within_a_threshold_that_is_far_longer_than_the_bodies() {
    for (power, delta) in LONG_THRESHOLDS {
        let separation = Separation::new(delta).unwrap();
        for (detail, [vertices, edges, triangles]) in [(0, [12, 30, 20]), (1, [42, 120, 80])] {
            let ball = ball(power, detail);
            let opposite: Vec<_> = ball.vertices().iter().map(|p| p.map(|x| -x)).collect();
            let mut step = Step::new();
            step.add_rigid(&ball, &opposite).unwrap();
            step.add_rigid(&ball, ball.vertices()).unwrap();
            for (kind, pairs) in [
                (PairKind::VertexVertex, vertices * vertices),
                (PairKind::VertexEdge, 2 * vertices * edges),
                (PairKind::VertexTriangle, 2 * vertices * triangles),
                (PairKind::EdgeEdge, edges * edges),
            ] {
                let hits = step.hits(kind, separation).unwrap();
                assert_eq!(hits.pairs.len(), pairs, "{kind}, {delta} at 2^{power}");
                let first = step.earliest_among(&[kind], separation, 1e-6, &mut || false);
                let first = first.unwrap();
                assert!(
                    first.is_proved && first.time == [0.0, 0.0],
                    "{kind}, {delta} at 2^{power}: {first:?}"
                );
            }
        }
    }
}
