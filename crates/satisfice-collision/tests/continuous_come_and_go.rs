//! A step whose bodies come near each other and part again, against every pair of features.
#![allow(clippy::unwrap_used)]

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use satisfice_collision::continuous::{FeatureOf, Moving, MovingContact, Separation, Step, decide};
use satisfice_collision::distance::{PairKind, Point};
use satisfice_collision::{Mesh, Placement, generate};

/// A body and where its vertices are at the end.
type MovingBody = (Mesh, Vec<Point>);

/// All pairs of two bodies, decided one by one.
fn hits_of_pair(
    numbers: [u32; 2],
    bodies: [&MovingBody; 2],
    kind: PairKind,
    delta: Separation,
) -> Vec<MovingContact> {
    let at = |side: usize, v: u32| {
        let (mesh, to) = bodies[side];
        (mesh.vertices()[v as usize], to[v as usize])
    };
    let vertex = |side: usize, v: u32| {
        let (from, to) = at(side, v);
        Moving::new(from, to)
    };
    let edge = |side: usize, e: usize| {
        let ends = bodies[side].0.edges()[e].map(|v| at(side, v));
        Moving::new(ends.map(|(from, _)| from), ends.map(|(_, to)| to))
    };
    let triangle = |side: usize, t: usize| {
        let corners = bodies[side].0.triangles()[t].map(|v| at(side, v));
        Moving::new(corners.map(|(from, _)| from), corners.map(|(_, to)| to))
    };
    let contact = |sides: [usize; 2], a: usize, b: usize| MovingContact {
        a: FeatureOf {
            body: numbers[sides[0]],
            index: a as u32,
        },
        b: FeatureOf {
            body: numbers[sides[1]],
            index: b as u32,
        },
    };
    let mut hits = Vec::new();
    match kind {
        PairKind::EdgeEdge => {
            for a in 0..bodies[0].0.edges().len() {
                for b in 0..bodies[1].0.edges().len() {
                    if decide(&edge(0, a), &edge(1, b), delta).within {
                        hits.push(contact([0, 1], a, b));
                    }
                }
            }
        }
        PairKind::VertexTriangle => {
            for [p, q] in [[0, 1], [1, 0]] {
                for a in 0..bodies[p].0.vertices().len() {
                    for b in 0..bodies[q].0.triangles().len() {
                        if decide(&vertex(p, a as u32), &triangle(q, b), delta).within {
                            hits.push(contact([p, q], a, b));
                        }
                    }
                }
            }
        }
        _ => unreachable!("not asked for here"),
    }
    hits
}

#[test]
fn pairs_are_those_of_all_bodies_whoever_was_near_before() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(1);
    let mut number = move |size: f64| size * ((rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64 - 0.5);
    let mut bodies: Vec<MovingBody> = (0..14)
        .map(|body| {
            let ball = generate::icosphere(0.3, u32::from(body < 5)).unwrap();
            let at = [0; 3].map(|_| number(3.0));
            let ball = Placement::from_translation(at).unwrap().place(&ball).unwrap();
            let to = ball.vertices().to_vec();
            (ball, to)
        })
        .collect();
    let mut step = Step::new();
    for (mesh, to) in &bodies {
        step.add_rigid(mesh, to).unwrap();
    }
    let mut involved = Vec::new();
    for round in 0..5 {
        for (body, (mesh, to)) in bodies.iter_mut().enumerate() {
            let mut from = std::mem::take(to);
            if round == 3 && body == 2 {
                // its order no longer fits
                from.reverse();
            }
            let by = [0; 3].map(|_| number(0.8));
            *to = from.iter().map(|p| [0, 1, 2].map(|k| p[k] + by[k])).collect();
            step.set_motion(body, &from, to).unwrap();
            *mesh = mesh.with_vertices(from).unwrap();
        }
        // a larger delta has more bodies near, in the same motion
        for delta in [0.0, 0.25] {
            let delta = Separation::new(delta).unwrap();
            for kind in [PairKind::VertexTriangle, PairKind::EdgeEdge] {
                let mut expected = Vec::new();
                for a in 0..bodies.len() {
                    for b in a + 1..bodies.len() {
                        expected.extend(hits_of_pair(
                            [a as u32, b as u32],
                            [&bodies[a], &bodies[b]],
                            kind,
                            delta,
                        ));
                    }
                }
                expected.sort_unstable();
                let mut hits = step.hits(kind, delta).unwrap().pairs;
                hits.sort_unstable();
                assert_eq!(hits, expected, "round {round}, {kind}, {delta}");
                let mut bodies: Vec<u32> = hits.iter().flat_map(|hit| [hit.a.body, hit.b.body]).collect();
                bodies.sort_unstable();
                bodies.dedup();
                involved.push(bodies);
            }
        }
    }
    let least = involved.iter().map(Vec::len).min().unwrap();
    let most = involved.iter().map(Vec::len).max().unwrap();
    involved.dedup();
    assert!(
        least > 0 && least < 4 && most > 7 && involved.len() > 8,
        "{least} {most} {}",
        involved.len()
    );
}
