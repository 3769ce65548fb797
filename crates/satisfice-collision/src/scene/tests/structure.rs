//! Handles, shared meshes, what is refused, and what a frame costs.

use super::super::{Body, BodyId, Completeness, Contact, SharedMesh, World};
use super::referee::{KINDS, PosedMesh, contacts as referee, turn};
use crate::broad::Method;
use crate::distance::{PairKind, Threshold};
use crate::{Error, Mesh, Placement, generate};

fn at(x: f64, y: f64, z: f64) -> Placement {
    Placement::from_translation([x, y, z]).unwrap()
}

fn world(kind: PairKind, delta: f64) -> World {
    World::new(kind, Threshold::new(delta).unwrap())
}

fn is_refused<T>(result: Result<T, Error>, parameter: &str) {
    match result {
        Err(Error::Parameter { parameter: named, .. }) => assert_eq!(named, parameter),
        Err(other) => panic!("{other}"),
        Ok(_) => panic!("not refused"),
    }
}

#[test]
fn handles_of_removed_bodies_are_refused_everywhere() {
    let ball = SharedMesh::from(generate::icosphere(0.5, 1).unwrap());
    let mut world = world(PairKind::TriangleTriangle, 0.05);
    let ids: Vec<BodyId> = (0..3)
        .map(|x| {
            world
                .add(Body::rigid(ball.clone()).at(at(0.9 * f64::from(x), 0.0, 0.0)))
                .unwrap()
        })
        .collect();
    let before = world.frame().unwrap().contacts;
    assert!(before.len() > 20);
    world.remove(ids[1]).unwrap();
    assert_eq!(world.contacts().count(), 0, "what it touched is gone at once");
    assert_eq!((world.len(), world.contains(ids[1])), (2, false));
    // another body in its place
    let new = world
        .add(Body::rigid(ball.clone()).at(at(0.9, 0.0, 0.0)))
        .unwrap();
    assert_eq!((new.index(), new == ids[1]), (1, false));
    assert_eq!(
        (ids[1].to_string(), new.to_string()),
        ("1".to_owned(), "1.1".to_owned())
    );
    let stale = ids[1];
    is_refused(world.place(stale, at(0.0, 0.0, 0.0)), "body");
    is_refused(world.deform(stale, &[]), "body");
    is_refused(world.remove(stale), "body");
    is_refused(world.replace(stale, ball.clone()), "body");
    is_refused(world.exclude(ids[0], stale), "body");
    is_refused(world.include(stale, ids[0]), "body");
    is_refused(world.set_groups(stale, 1, 1), "body");
    is_refused(world.mesh(stale).map(|_| ()), "body");
    is_refused(world.bounds(stale), "body");
    is_refused(world.placement(stale), "body");
    is_refused(world.proximity(before[0]), "body");
    let after = world.frame().unwrap().contacts;
    assert_eq!(after.len(), before.len(), "the same bodies with another handle");
    assert!(world.bodies().eq([ids[0], new, ids[2]]));
}

#[test]
fn what_is_refused_changes_nothing() {
    let ball = SharedMesh::from(generate::icosphere(0.5, 0).unwrap());
    let mut world = world(PairKind::TriangleTriangle, 0.05);
    let ids: Vec<BodyId> = (0..1000)
        .map(|n| {
            world.add(Body::rigid(ball.clone()).at(at(
                0.85 * f64::from(n % 10),
                0.85 * f64::from(n / 10),
                0.0,
            )))
        })
        .collect::<Result<_, _>>()
        .unwrap();
    let before = world.frame().unwrap().contacts;
    assert!(before.len() > 500, "{}", before.len());
    // a mesh without triangles, where triangles are asked for
    let dust = Mesh::new(vec![[0.0; 3]; 4], vec![], vec![]).unwrap();
    for refused in [
        world.add(Body::fixed(dust.clone())).map(|_| ()),
        world.replace(ids[7], dust.clone()),
    ] {
        let error = refused.unwrap_err();
        assert!(matches!(error, Error::NoFeature { .. }));
        assert_eq!(
            error.to_string(),
            "the mesh has no triangle: each mesh needs a triangle for triangle-triangle pairs"
        );
    }
    // NaN and infinity
    is_refused(Placement::from_translation([f64::NAN, 0.0, 0.0]), "translation");
    let far = Placement::from_translation([f64::MAX; 3]).unwrap();
    let large = generate::icosphere(1.0, 0).unwrap();
    let large = large
        .with_vertices(large.vertices().iter().map(|p| p.map(|c| 1e308 * c)).collect())
        .unwrap();
    assert!(matches!(
        world.add(Body::fixed(large.clone()).at(far)),
        Err(Error::NonFiniteVertex { .. })
    ));
    is_refused(Threshold::new(0.0), "threshold");
    assert_eq!(world.update().unwrap().recomputed, 0);
    assert_eq!(world.sorted_contacts(), before);
    let mut bad = ball.mesh().vertices().to_vec();
    bad[3][1] = f64::NAN;
    is_refused(world.deform(ids[500], &bad), "body");
    let soft = world
        .add(Body::deforming(ball.clone()).without_self_collision())
        .unwrap();
    world.remove(ids[0]).unwrap();
    let with_soft = world.frame().unwrap().contacts;
    assert!(matches!(
        world.deform(soft, &bad),
        Err(Error::NonFiniteVertex { vertex: 3, .. })
    ));
    is_refused(world.deform(soft, &bad[1..]), "number of vertices");
    assert_eq!(world.update().unwrap().recomputed, 0);
    assert_eq!(world.sorted_contacts(), with_soft);
    // a point, and a body of scale 0: all of its triangles are that point
    let point = vec![[0.3, 0.3, 0.5]; bad.len()];
    world.deform(soft, &point).unwrap();
    world.update().unwrap();
    assert!(
        world
            .contacts()
            .all(|contact| world.proximity(contact).unwrap().distance < 0.05)
    );
    // vertices count with triangles, but edges do not
    let mut mixed = World::new(PairKind::VertexTriangle, Threshold::new(0.1).unwrap());
    let dust = mixed.add(Body::fixed(dust)).unwrap();
    let sheet = mixed
        .add(Body::rigid(generate::cloth(1.0, 1.0, 3, 3).unwrap()))
        .unwrap();
    mixed.update().unwrap();
    assert!(mixed.contacts().count() >= 4);
    assert!(
        mixed
            .contacts()
            .all(|contact| (contact.body_a, contact.body_b) == (dust, sheet))
    );
}

/// Ten thousand copies of a mesh cost one mesh and one tree; a frame costs what moved in it.
#[test]
fn a_frame_costs_what_moves_in_it() {
    let ball = SharedMesh::from(generate::icosphere(0.45, 1).unwrap());
    let mut world = world(PairKind::TriangleTriangle, 0.01);
    let side = 16;
    let place = |n: usize| {
        at(
            (n % side) as f64,
            (n / side % side) as f64,
            (n / side / side) as f64,
        )
    };
    let ids: Vec<BodyId> = (0..side * side * side)
        .map(|n| world.add(Body::rigid(ball.clone()).at(place(n))).unwrap())
        .collect();
    let first = world.update().unwrap();
    assert_eq!(world.contacts().count(), 0);
    let n = ids.len() as u64;
    assert_eq!(first.skips.boxes_apart, n * (n - 1) / 2);
    assert!(world.bytes() < 400 * ids.len(), "{}", world.bytes() / ids.len());
    assert!(ids.iter().all(|&id| world.mesh(id).unwrap().is_same(&ball)));
    for frame in 1..6 {
        // one body moves towards a neighbour, one away
        let (near, far) = (ids[1000 + frame], ids[2000 + frame]);
        let moved = |n: usize, by: f64| place(n).then(&at(by, 0.0, 0.0)).unwrap();
        world.place(near, moved(1000 + frame, 0.1)).unwrap();
        world.place(far, moved(2000 + frame, 0.04)).unwrap();
        let update = world.update().unwrap();
        assert!((1..=60).contains(&update.recomputed), "{}", update.recomputed);
        assert!(
            world
                .body_changes()
                .all(|change| change.body_a == near || change.body_b == near)
        );
        assert_eq!(world.update().unwrap().recomputed, 0);
        assert_eq!(world.changes().count(), 0);
    }
    assert!(world.kept_pairs() < 200);
}

#[test]
fn all_bodies_in_one_place_and_in_one_line() {
    let ball = SharedMesh::from(generate::icosphere(0.5, 0).unwrap());
    for (step, expected) in [
        ([0.0; 3], 60 * 59 / 2),
        ([1.0, 0.0, 0.0], 59),
        ([0.0, 50.0, 0.0], 0),
    ] {
        let mut world = world(PairKind::VertexVertex, 0.3);
        for n in 0..60 {
            let by = step.map(|c| c * f64::from(n));
            world
                .add(Body::rigid(ball.clone()).at(at(by[0], by[1], by[2])))
                .unwrap();
        }
        assert_eq!(world.touching().unwrap().len(), expected);
        assert_eq!(
            world.update().unwrap().recomputed,
            if expected == 0 { 0 } else { expected }
        );
        let touching = world.body_changes().count();
        assert_eq!(touching, expected);
    }
}

#[test]
fn groups_and_exclusions_can_change() {
    let ball = SharedMesh::from(generate::icosphere(0.5, 1).unwrap());
    let mut world = world(PairKind::EdgeTriangle, 0.05);
    let ids: Vec<BodyId> = (0..3)
        .map(|n| {
            world
                .add(Body::rigid(ball.clone()).at(turn(f64::from(n), [0.3 * f64::from(n), 0.0, 0.0])))
                .unwrap()
        })
        .collect();
    let touching = |world: &mut World| world.touching().unwrap().len();
    assert_eq!(touching(&mut world), 3);
    world.exclude(ids[2], ids[0]).unwrap();
    assert_eq!(touching(&mut world), 2);
    assert_eq!(world.update().unwrap().skips.filtered_bodies, 1);
    world.set_groups(ids[1], 2, 2).unwrap();
    assert_eq!(
        (
            touching(&mut world),
            world.update().unwrap().skips.filtered_bodies
        ),
        (0, 3)
    );
    world.include(ids[0], ids[2]).unwrap();
    assert_eq!(touching(&mut world), 1);
    world.set_groups(ids[1], 1, u32::MAX).unwrap();
    assert_eq!(
        (
            touching(&mut world),
            world.update().unwrap().skips.filtered_bodies
        ),
        (3, 0)
    );
    // an exclusion goes with its body
    world.exclude(ids[0], ids[1]).unwrap();
    world.remove(ids[1]).unwrap();
    world.add(Body::rigid(ball)).unwrap();
    assert_eq!(touching(&mut world), 3);
}

/// Whatever question takes in a move: contacts that are listed then are true, those of bodies that did not move are all there, and an
/// update finds the others.
#[test]
fn contacts_after_other_questions_are_true_and_an_update_completes_them() {
    let ball = generate::icosphere(0.5, 0).unwrap();
    let questions: [fn(&mut World, [BodyId; 2]); 4] = [
        |world, _| {
            world.touching().unwrap();
        },
        |world, _| {
            world.first().unwrap();
        },
        |world, [a, b]| {
            world.distance(a, b).unwrap();
        },
        |world, _| {
            world.nearest(3).unwrap();
        },
    ];
    let mut incomplete = 0;
    for (kind, question) in KINDS
        .into_iter()
        .flat_map(|kind| questions.map(|question| (kind, question)))
    {
        let shared = SharedMesh::from(ball.clone());
        let mut world = World::new(kind, Threshold::new(0.3).unwrap());
        let mut places: Vec<Placement> = (0..6)
            .map(|k| turn(0.4, [1.1 * f64::from(k), 0.0, 0.0]))
            .collect();
        let ids: Vec<BodyId> = places
            .iter()
            .map(|&place| world.add(Body::rigid(shared.clone()).at(place)).unwrap())
            .collect();
        world.update().unwrap();
        for (frame, moved) in [5, 0, 5, 3].into_iter().enumerate() {
            places[moved] = places[moved].moved([0.02, 0.1, 0.0]).unwrap();
            let before = world.sorted_contacts();
            world.place(ids[moved], places[moved]).unwrap();
            assert_eq!(
                world.sorted_contacts(),
                before,
                "{kind} {frame}: no question was asked"
            );
            question(&mut world, [ids[0], ids[5]]);
            let posed: Vec<PosedMesh> = places
                .iter()
                .map(|place| PosedMesh {
                    mesh: place.place(&ball).unwrap(),
                    ring: None,
                })
                .collect();
            let all = referee(&posed, kind, 0.3);
            let listed = world.sorted_contacts();
            assert!(
                listed.iter().all(|contact| all.contains(contact)),
                "{kind} {frame}"
            );
            let rests = |contact: &&Contact| contact.body_a != ids[moved] && contact.body_b != ids[moved];
            assert!(
                all.iter().filter(rests).eq(listed.iter().filter(rests)),
                "{kind} {frame}"
            );
            incomplete += usize::from(listed.len() < all.len());
            world.update().unwrap();
            assert_eq!(world.sorted_contacts(), all, "{kind} {frame}");
        }
    }
    assert!(incomplete > 10, "{incomplete}");
}

/// A record that was not examined before the stop has moved all the same.
#[test]
fn an_update_that_is_stopped_does_not_say_that_bodies_rest() {
    let ball = generate::icosphere(0.5, 3).unwrap();
    let mut cut = 0;
    for method in [Method::BruteForce, Method::Tree, Method::Auto] {
        let mut world = World::new(PairKind::VertexVertex, Threshold::new(0.3).unwrap()).with_method(method);
        for k in 0..4 {
            let at = Placement::from_translation([0.9 * f64::from(k), 0.0, 0.0]).unwrap();
            world.add(Body::rigid(ball.clone()).at(at)).unwrap();
        }
        let stopped = world.update_until(&|_| true).unwrap();
        assert_eq!(stopped.skips.unmoved_bodies, 0, "{method:?}");
        cut += u32::from(stopped.completeness == Completeness::Unknown);
        world.update().unwrap();
        assert!(world.update().unwrap().skips.unmoved_bodies > 0);
    }
    assert!(cut > 0);
}

/// What is known of the motion of a body that is gone is of no use to anyone.
#[test]
fn contacts_are_measured_after_a_moving_body_is_gone() {
    let ball = SharedMesh::from(generate::icosphere(1.0, 1).unwrap());
    for what in 0..3 {
        let mut world = world(PairKind::TriangleTriangle, 0.1);
        let ids = [(); 3].map(|()| world.add(Body::rigid(ball.clone())).unwrap());
        world.update().unwrap();
        world.measure_contacts();
        for (id, x) in ids.into_iter().zip([0.1, 0.2, 0.3]) {
            world.place(id, at(x, 0.0, 0.0)).unwrap();
        }
        world.update().unwrap();
        match what {
            0 => world.remove(ids[0]).unwrap(),
            1 => world
                .replace(ids[0], generate::cloth(1.0, 1.0, 2, 2).unwrap())
                .unwrap(),
            _ => {
                world.remove(ids[0]).unwrap();
                world.add(Body::fixed(ball.clone())).unwrap();
            }
        }
        world.measure_contacts();
        world.place(ids[1], at(0.3, 0.0, 0.0)).unwrap();
        let pass = world.pass();
        let held = world.found_by(&pass).collect::<Vec<_>>();
        let all = world.frame().unwrap().contacts;
        assert!(!all.is_empty() && held.iter().all(|contact| all.binary_search(contact).is_ok()));
    }
}

/// Bodies whose partners must be found are listed without looking through the list, which must not grow for ever either.
#[test]
fn bodies_that_come_and_go_between_updates_leave_nothing_behind() {
    let ball = SharedMesh::from(generate::icosphere(1.0, 1).unwrap());
    let mut world = world(PairKind::TriangleTriangle, 0.1);
    let stays = world.add(Body::rigid(ball.clone())).unwrap();
    for k in 0..1000 {
        world.set_groups(stays, 1, 1 + k % 2).unwrap();
        let goes = world.add(Body::rigid(ball.clone())).unwrap();
        world.replace(goes, ball.clone()).unwrap();
        world.remove(goes).unwrap();
    }
    assert!(world.unpaired.len() < 100, "{}", world.unpaired.len());
    world.set_groups(stays, 1, 1).unwrap();
    let frame = world.frame().unwrap();
    assert!(frame.contacts.is_empty() && world.unpaired.is_empty());
    let other = world.add(Body::rigid(ball)).unwrap();
    let contacts = world.frame().unwrap().contacts;
    assert!(!contacts.is_empty() && contacts.iter().all(|contact| contact.bodies() == (stays, other)));
}

/// However large the meshes are, and however many bodies there are.
#[test]
fn what_is_printed_is_short() {
    let body = Body::rigid(generate::icosphere(1.0, 3).unwrap()).at(at(1.0, 2.0, 3.0));
    let mut world = world(PairKind::TriangleTriangle, 0.1);
    for _ in 0..20 {
        world.add(body.clone()).unwrap();
    }
    let pass = world.pass();
    let (body, world, pass) = (format!("{body:?}"), format!("{world:?}"), format!("{pass:?}"));
    assert!(
        body.contains("Rigid") && body.contains("1280 triangles"),
        "{body}"
    );
    assert!(
        world.contains("TriangleTriangle") && world.contains("bodies: 20"),
        "{world}"
    );
    assert!(pass.contains("found: 0"), "{pass}");
    assert!([body, world, pass].iter().all(|text| text.len() < 500));
}
