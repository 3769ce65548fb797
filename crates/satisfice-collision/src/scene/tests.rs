//! Worlds over several frames against brute force over all pairs of features, by every method and query.
#![allow(clippy::unwrap_used)]

use super::{Body, BodyId, Completeness, Contact, World};
use crate::broad::Method;
use crate::distance::{PairKind, Point, Threshold};
use crate::{Error, Placement, generate, oracle};

mod interrupted;
mod queries;
mod referee;
mod script;
mod steady;
mod structure;
mod unwound;

use referee::{KINDS, PosedMesh, contacts as referee, turn};

/// Frames in which bodies rest, creep, jump, part, deform in one corner and deform everywhere. Calls `check` after each.
fn play(world: &mut World, mut check: impl FnMut(&mut World, &[PosedMesh], usize)) {
    let torus = generate::torus(1.0, 0.35, 14, 8).unwrap();
    let ball = generate::icosphere(0.5, 1).unwrap();
    let sheet = generate::cloth(2.0, 2.0, 9, 9).unwrap();
    let fixed = world
        .add(Body::fixed(torus.clone()).at(turn(0.4, [0.0, 0.1, 0.0])))
        .unwrap();
    let rigid = world.add(Body::rigid(ball.clone())).unwrap();
    let soft = world.add(Body::deforming(sheet.clone()).beyond_ring(1)).unwrap();
    assert_eq!([fixed, rigid, soft], [0, 1, 2].map(BodyId::nth));
    let mut posed = vec![
        PosedMesh {
            mesh: turn(0.4, [0.0, 0.1, 0.0]).place(&torus).unwrap(),
            ring: None,
        },
        PosedMesh {
            mesh: ball.clone(),
            ring: None,
        },
        PosedMesh {
            mesh: sheet.clone(),
            ring: Some(1),
        },
    ];
    let mut points = sheet.vertices().to_vec();
    let centre = |points: &[Point]| points[40];
    for frame in 0..14 {
        let t = frame as f64;
        let place = match frame {
            0..=3 => Some(turn(0.3, [0.4 + 0.002 * t, 0.1, 0.05])),
            5 => Some(turn(1.0, [-0.6, 0.2, 0.1])),
            8 => Some(turn(1.0, [50.0, 0.0, 0.0])),
            10 => Some(turn(0.2, [0.1, -0.3, 0.2])),
            _ => None,
        };
        if let Some(place) = place {
            world.place(rigid, place).unwrap();
            posed[1].mesh = place.place(&ball).unwrap();
        }
        let deform = match frame {
            2 | 3 | 6 => {
                points[..5].iter_mut().for_each(|p| p[2] += 0.03);
                true
            }
            7 | 10 | 11 => {
                let c = centre(&points);
                points.iter_mut().enumerate().for_each(|(i, p)| {
                    for k in 0..3 {
                        p[k] = c[k] + (p[k] - c[k]) * 0.6 + 0.01 * ((i * 7 + k) % 5) as f64;
                    }
                });
                true
            }
            12 | 13 => {
                points.iter_mut().for_each(|p| p[0] += 0.001);
                true
            }
            _ => false,
        };
        if deform {
            world.deform(soft, &points).unwrap();
            posed[2].mesh = sheet.with_vertices(points.clone()).unwrap();
        }
        check(world, &posed, frame);
    }
}

#[test]
fn every_method_agrees_with_brute_force_in_every_frame() {
    for kind in KINDS {
        for method in [Method::Auto, Method::BruteForce, Method::Grid, Method::Tree] {
            let delta = 0.12;
            let mut world = World::new(kind, Threshold::new(delta).unwrap()).with_method(method);
            let mut total = 0;
            play(&mut world, |world, posed, frame| {
                let answer = world.frame().unwrap();
                let expected = referee(posed, kind, delta);
                assert!(
                    answer.contacts == expected,
                    "{kind} {method:?} frame {frame}: {} of {}",
                    answer.contacts.len(),
                    expected.len()
                );
                assert_eq!(answer.completeness, Completeness::Proved);
                total += expected.len();
            });
            assert!(total > 500, "{kind}: {total}");
        }
    }
}

#[test]
fn what_need_not_be_done_is_skipped_and_counted() {
    let kind = PairKind::VertexVertex;
    let mut world = World::new(kind, Threshold::new(0.12).unwrap()).with_method(Method::Tree);
    let mut all = Vec::new();
    play(&mut world, |world, _, frame| {
        let skips = world.frame().unwrap().skips;
        assert_eq!(skips.rigid_self, 2);
        // three bodies, of which one collides with itself, too; one of them is far away in frames 8 and 9
        if frame == 4 || frame == 9 {
            assert_eq!(
                skips.unmoved_bodies,
                if frame == 4 { 4 } else { 2 },
                "frame {frame}"
            );
        }
        assert_eq!(skips.boxes_apart, if frame == 8 || frame == 9 { 2 } else { 0 });
        all.push(skips);
    });
    let sum = |of: fn(&super::Skips) -> u64| all.iter().map(of).sum::<u64>();
    assert!(
        sum(|s| s.unmoved_pairs) > 0,
        "a cloth that moves in one corner keeps the other pairs"
    );
    assert!(sum(|s| s.mesh_neighbours) > 0);
    let reasons = all[0].by_reason();
    assert!(
        reasons
            .iter()
            .enumerate()
            .all(|(i, (name, _))| reasons[..i].iter().all(|(other, _)| other != name))
    );
}

#[test]
fn queries_agree_with_the_complete_answer() {
    for kind in KINDS {
        let mut world = World::new(kind, Threshold::new(0.12).unwrap());
        play(&mut world, |world, posed, frame| {
            let expected = referee(posed, kind, 0.12);
            let mut touching: Vec<_> = expected
                .iter()
                .map(|c| (c.body_a.min(c.body_b), c.body_a.max(c.body_b)))
                .collect();
            touching.sort_unstable();
            touching.dedup();
            assert_eq!(world.touching().unwrap(), touching, "{kind} frame {frame}");
            let first = world.first().unwrap();
            assert_eq!(first.is_some(), !expected.is_empty());
            assert!(first.is_none_or(|contact| expected.contains(&contact)));
            let mut by_distance: Vec<_> = expected
                .iter()
                .map(|&contact| (world.proximity(contact).unwrap().distance, contact))
                .collect();
            let (listed, mut measured): (Vec<_>, _) = (
                by_distance.iter().map(|&(_, contact)| contact).collect(),
                Vec::new(),
            );
            world.contact_distances(&listed, &mut measured).unwrap();
            assert!(
                measured
                    .iter()
                    .zip(&by_distance)
                    .all(|(one, (other, _))| one == other)
                    && measured.len() == listed.len()
            );
            by_distance.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            for k in [0, 1, 7, 10_000] {
                let closest: Vec<_> = world
                    .closest(k)
                    .unwrap()
                    .into_iter()
                    .map(|(contact, p)| (p.distance, contact))
                    .collect();
                assert_eq!(
                    closest,
                    by_distance[..k.min(by_distance.len())],
                    "{kind} frame {frame}"
                );
            }
            if frame % 3 == 0 {
                assert_eq!(world.frame().unwrap().contacts, expected);
            }
        });
    }
}

#[test]
fn contacts_that_hold_by_motion_are_right() {
    for kind in KINDS {
        let mut world = World::new(kind, Threshold::new(0.12).unwrap());
        let mut held = 0;
        play(&mut world, |world, posed, frame| {
            let mut pass = world.pass();
            world.advance(&mut pass, &mut |_| false).unwrap();
            held += pass.skips().held_by_motion;
            assert_eq!(
                world.finish(pass).contacts,
                referee(posed, kind, 0.12),
                "{kind} frame {frame}"
            );
            world.measure_contacts();
        });
        assert!(held > 100, "{kind}: {held}");
    }
}

#[test]
fn filters_leave_out_bodies_and_vertices() {
    let ball = generate::icosphere(0.5, 1).unwrap();
    let threshold = Threshold::new(0.1).unwrap();
    let kind = PairKind::VertexVertex;
    let mut world = World::new(kind, threshold);
    for (groups, mask) in [(1, 2), (2, 1), (2, 2), (4, 0)] {
        world
            .add(Body::rigid(ball.clone()).in_groups(groups, mask))
            .unwrap();
    }
    let bodies = |world: &mut World| world.touching().unwrap();
    assert_eq!(bodies(&mut world), [(BodyId::nth(0), BodyId::nth(1))]);
    assert_eq!(world.frame().unwrap().skips.filtered_bodies, 5);
    world.exclude(BodyId::nth(1), BodyId::nth(0)).unwrap();
    assert_eq!(bodies(&mut world), []);

    let mut world = World::new(kind, threshold);
    world
        .add(Body::rigid(ball.clone()).with_vertices(|v| v % 3 == 0))
        .unwrap();
    world.add(Body::fixed(ball.clone())).unwrap();
    let answer = world.frame().unwrap();
    let all = referee(
        &[
            PosedMesh {
                mesh: ball.clone(),
                ring: None,
            },
            PosedMesh {
                mesh: ball,
                ring: None,
            },
        ],
        kind,
        0.1,
    );
    let expected: Vec<_> = all.into_iter().filter(|contact| contact.a % 3 == 0).collect();
    assert!(answer.contacts == expected && answer.skips.filtered_vertices > 0);
}

#[test]
fn wrong_calls_are_refused_and_change_nothing() {
    let ball = generate::icosphere(0.5, 1).unwrap();
    let count = ball.vertices().len();
    let mut world = World::new(PairKind::EdgeEdge, Threshold::new(0.1).unwrap());
    assert!(world.frame().unwrap().contacts.is_empty() && world.is_empty());
    let fixed = world.add(Body::fixed(ball.clone())).unwrap();
    let rigid = world.add(Body::rigid(ball.clone())).unwrap();
    let soft = world.add(Body::deforming(ball.clone())).unwrap();
    let before = world.frame().unwrap().contacts;
    let away = Placement::from_translation([9.0, 0.0, 0.0]).unwrap();
    assert!(matches!(world.place(fixed, away), Err(Error::Parameter { .. })));
    assert!(matches!(
        world.place(BodyId::nth(7), away),
        Err(Error::Parameter { .. })
    ));
    for (body, to) in [
        (fixed, 9.0),
        (soft, 9.0),
        (BodyId::nth(7), 9.0),
        (rigid, f64::NAN),
    ] {
        let refused = world.translate(body, [to, 0.0, 0.0]);
        assert!(matches!(refused, Err(Error::Parameter { .. })), "{body}");
    }
    assert!(world.translate(rigid, [f64::INFINITY, 0.0, 0.0]).is_err());
    assert!(matches!(
        world.deform(rigid, ball.vertices()),
        Err(Error::Parameter { .. })
    ));
    assert!(matches!(
        world.deform(soft, &ball.vertices()[1..]),
        Err(Error::Parameter { .. })
    ));
    let mut bad = ball.vertices().to_vec();
    bad[count - 1][2] = f64::NAN;
    assert!(matches!(
        world.deform(soft, &bad),
        Err(Error::NonFiniteVertex { axis: 'z', .. })
    ));
    let far = Placement::from_translation([f64::MAX, 0.0, 0.0]).unwrap();
    let farther = Placement::from_translation([f64::MAX, f64::MAX, f64::MAX]).unwrap();
    assert!(world.place(rigid, far).is_ok() && world.place(rigid, farther).is_ok());
    world.place(rigid, Placement::IDENTITY).unwrap();
    assert_eq!(world.frame().unwrap().contacts, before);
    let none = Contact {
        body_a: BodyId::nth(0),
        body_b: BodyId::nth(1),
        a: 1 << 30,
        b: 0,
    };
    assert!(matches!(world.proximity(none), Err(Error::Parameter { .. })));
    let stale = world.pass();
    world.place(rigid, away).unwrap();
    world.touching().unwrap();
    let mut stale = stale;
    assert!(world.advance(&mut stale, &mut |_| false).is_err());
}
