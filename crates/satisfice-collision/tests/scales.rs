//! Worlds at every scale of `f64`: the tree and the grid find what a decision of every pair finds.
#![allow(clippy::unwrap_used)]

use satisfice_collision::broad::Method;
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
