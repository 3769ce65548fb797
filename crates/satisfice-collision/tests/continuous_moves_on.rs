//! A step that is given one motion after the other.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeSet;

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use satisfice_collision::continuous::{MovingContact, Separation, Step};
use satisfice_collision::distance::PairKind;
use satisfice_collision::{Error, Mesh, Placement, generate};

const KINDS: [PairKind; 4] = [
    PairKind::VertexVertex,
    PairKind::VertexEdge,
    PairKind::VertexTriangle,
    PairKind::EdgeEdge,
];

/// Both frames of a body, and whether it deforms.
type MovingBody = (Mesh, Vec<[f64; 3]>, bool);

/// A cloth whose vertices are shaken, and a ball that falls through it.
fn shaken(seed: u64) -> Vec<MovingBody> {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut noise = |size: f64| size * ((rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64 - 0.5);
    let cloth = generate::cloth(1.0, 1.0, 8, 8).unwrap();
    let mut shake = |p: [f64; 3]| [p[0] + noise(0.2), p[1] + noise(0.2), p[2] + noise(0.4)];
    let from: Vec<_> = cloth.vertices().iter().map(|&p| shake(p)).collect();
    let to = cloth.vertices().iter().map(|&p| shake(p)).collect();
    let cloth = cloth.with_vertices(from).unwrap();
    let above = Placement::from_translation([0.1, 0.0, 0.6]).unwrap();
    let ball = above.place(&generate::icosphere(0.2, 1).unwrap()).unwrap();
    let below = ball.vertices().iter().map(|&[x, y, z]| [x, y, z - 1.1]).collect();
    vec![(cloth, to, true), (ball, below, false)]
}

fn step(bodies: &[MovingBody]) -> Step {
    let mut step = Step::new();
    for (mesh, to, deforms) in bodies {
        match deforms {
            true => step.add_deforming(mesh, to).unwrap(),
            false => step.add_rigid(mesh, to).unwrap(),
        };
    }
    step
}

#[test]
fn a_step_that_moves_on_answers_like_one_made_anew() {
    let scenes: Vec<Vec<MovingBody>> = (0..4).map(shaken).collect();
    let mut kept = step(&scenes[0]);
    for (round, scene) in scenes.iter().cycle().take(8).enumerate() {
        let mut moved = Vec::new();
        for (body, (mesh, to, deforms)) in scene.iter().enumerate() {
            // some motions start where the last one ended, some far away
            let mut from = mesh.vertices().to_vec();
            let mut to = to.clone();
            if round % 3 == 2 {
                let last = scenes[(round + 3) % scenes.len()][body].1.clone();
                (from, to) = (last, from);
            }
            if round == 3 {
                for p in from.iter_mut().chain(&mut to) {
                    *p = p.map(|x| x * 1e140 - 1e141);
                }
            }
            if round == 5 {
                from.reverse();
            }
            kept.set_motion(body, &from, &to).unwrap();
            moved.push((mesh.with_vertices(from).unwrap(), to, *deforms));
        }
        let anew = step(&moved);
        let delta = Separation::new(if round % 2 == 0 { 0.0 } else { 0.03 }).unwrap();
        for kind in KINDS {
            let [p, q] = [&kept, &anew].map(|step| step.hits(kind, delta).unwrap());
            let pairs = |pairs: &[MovingContact]| pairs.iter().copied().collect::<BTreeSet<_>>();
            assert_eq!(pairs(&p.pairs), pairs(&q.pairs), "round {round}, {kind}");
            assert_eq!((p.undecided, q.undecided), (0, 0));
        }
        let [p, q] = [&kept, &anew].map(|step| step.earliest(delta, 1e-6).unwrap());
        assert!(p.is_proved && q.is_proved);
        assert!(
            p.time[0] <= q.time[1] && q.time[0] <= p.time[1],
            "round {round}: {p:?} {q:?}"
        );
    }
}

#[test]
fn a_motion_that_does_not_fit_changes_nothing() {
    let scene = shaken(5);
    let mut step = step(&scene);
    let before = step.earliest(Separation::TOUCHING, 1e-6).unwrap();
    let (mesh, to, _) = &scene[1];
    let from = mesh.vertices();
    let mut infinite = to.clone();
    infinite[3][1] = f64::INFINITY;
    assert!(matches!(
        step.set_motion(2, from, to),
        Err(Error::Parameter { .. })
    ));
    assert!(matches!(
        step.set_motion(1, &from[1..], to),
        Err(Error::Parameter { .. })
    ));
    assert!(matches!(
        step.set_motion(1, from, &to[1..]),
        Err(Error::Parameter { .. })
    ));
    for [from, to] in [[from, &infinite[..]], [&infinite[..], to]] {
        let error = step.set_motion(1, from, to);
        assert!(matches!(
            error,
            Err(Error::NonFiniteVertex {
                vertex: 3,
                axis: 'y',
                ..
            })
        ));
    }
    assert_eq!(step.earliest(Separation::TOUCHING, 1e-6).unwrap(), before);
}
