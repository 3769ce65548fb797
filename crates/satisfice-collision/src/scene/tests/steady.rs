//! Rigid bodies that go on as they did, turn back and rest: what is expected of them against brute force.

use super::*;

#[test]
fn what_goes_on_steadily_holds_at_once_and_a_turn_is_noticed() {
    let ball = generate::icosphere(1.0, 3).unwrap();
    let delta = 0.1;
    for kind in [PairKind::VertexVertex, PairKind::TriangleTriangle] {
        let mut world = World::new(kind, Threshold::new(delta).unwrap());
        world
            .add(Body::fixed(ball.clone()).at(turn(0.3, [1.0, 0.0, 0.0])))
            .unwrap();
        let rigid = world.add(Body::rigid(ball.clone())).unwrap();
        // along, turning; from frame 9 on back; at rest in frames 5, 13 and 14
        let mut course = 0.0;
        let (mut steady, mut turning) = ([0, 0], [0, 0]);
        for frame in 0..19 {
            match frame {
                5 | 13 | 14 => {}
                0..9 => course += 1.0,
                _ => course -= 1.0,
            }
            let place = turn(0.004 * course, [-0.9 + 0.01 * course, 0.006 * course, 0.2]);
            world.place(rigid, place).unwrap();
            let mut pass = world.pass();
            let at_once = pass.found();
            world.advance(&mut pass, &mut |_| false).unwrap();
            let mut delivered = world.found_by(&pass).collect::<Vec<_>>();
            delivered.sort_unstable();
            let answer = world.finish(pass);
            assert!(delivered == answer.contacts, "each once, {kind} frame {frame}");
            assert_eq!(answer.completeness, Completeness::Proved);
            let posed = [turn(0.3, [1.0, 0.0, 0.0]), place].map(|place| PosedMesh {
                mesh: place.place(&ball).unwrap(),
                ring: None,
            });
            assert!(
                answer.contacts == referee(&posed, kind, delta),
                "{kind} frame {frame}"
            );
            world.measure_contacts();
            let share = match frame {
                // two frames after a start or a turn it is known to go on
                3 | 4 | 8 | 11 | 12 | 17 | 18 => &mut steady,
                9 => &mut turning,
                _ => continue,
            };
            share[0] += at_once;
            share[1] += answer.contacts.len();
        }
        assert!(
            steady[1] > 200 && 5 * steady[0] > 4 * steady[1],
            "{kind}: {steady:?}"
        );
        assert!(
            turning[0] * steady[1] < steady[0] * turning[1],
            "{turning:?} {steady:?}"
        );
    }
}

/// Balls in a row that sway, so that some contacts hold by the bound of motion and others have to be looked at again: whatever
/// is delivered is delivered once, of however many pairs of bodies.
#[test]
fn a_pass_delivers_every_contact_once() {
    let ball = generate::icosphere(1.0, 3).unwrap();
    for bodies in [2, 4] {
        let mut world = World::new(PairKind::VertexVertex, Threshold::new(0.15).unwrap());
        let place = |body: usize, t: f64| {
            let sway = 0.01 * (t + body as f64).sin();
            turn(
                0.02 * (2.0 * t).sin(),
                [1.95 * body as f64 + sway, 0.5 * sway, 0.0],
            )
        };
        for body in 0..bodies {
            world.add(Body::rigid(ball.clone()).at(place(body, 0.0))).unwrap();
        }
        let mut total = 0;
        for frame in 0..14 {
            let t = f64::from(frame);
            // some of them rest now and then
            for body in (0..bodies).filter(|body| !(frame as usize + body).is_multiple_of(3)) {
                world.place(BodyId::nth(body as u32), place(body, t)).unwrap();
            }
            let mut pass = world.pass();
            world.advance(&mut pass, &mut |_| false).unwrap();
            let mut delivered = world.found_by(&pass).collect::<Vec<_>>();
            delivered.sort_unstable();
            let answer = world.finish(pass);
            assert!(delivered == answer.contacts, "{bodies} bodies, frame {frame}");
            assert_eq!(world.frame().unwrap().contacts, answer.contacts);
            if frame % 4 != 3 {
                world.measure_contacts();
            }
            total += delivered.len();
        }
        assert!(total > 300, "{total}");
    }
}

/// What was laid out for a pass is of no use when its bodies are not asked for any more.
#[test]
fn a_pass_after_an_exclusion_delivers_nothing_of_it() {
    let ball = generate::icosphere(1.0, 2).unwrap();
    let mut world = World::new(PairKind::VertexVertex, Threshold::new(0.4).unwrap());
    for x in [0.0, 1.9, 3.8] {
        world
            .add(Body::rigid(ball.clone()).at(turn(0.0, [x, 0.0, 0.0])))
            .unwrap();
    }
    assert!(!world.frame().unwrap().contacts.is_empty());
    world.measure_contacts();
    world.exclude(BodyId::nth(0), BodyId::nth(1)).unwrap();
    world.place(BodyId::nth(2), turn(0.0, [3.79, 0.0, 0.0])).unwrap();
    let mut pass = world.pass();
    world.advance(&mut pass, &mut |_| false).unwrap();
    assert!(pass.found() > 0);
    assert!(
        world
            .found_by(&pass)
            .all(|contact| contact.body_a == BodyId::nth(1))
    );
    // an answer in between makes it useless, which is said
    let mut pass = world.pass();
    world.frame().unwrap();
    assert!(matches!(
        world.advance(&mut pass, &mut |_| false),
        Err(Error::Parameter { .. })
    ));
}

/// A sheet that leaves a ball and comes back to the bit, and one whose next frame is refused after another was taken.
#[test]
fn frames_in_which_nothing_was_refitted_are_not_taken_for_frames_at_rest() {
    let ball = generate::icosphere(1.0, 3).unwrap();
    let sheet = generate::cloth(2.0, 2.0, 12, 12).unwrap();
    let at = |z: f64| -> Vec<Point> { sheet.vertices().iter().map(|&[x, y, _]| [x, y, z]).collect() };
    for (kind, refuses) in [
        (PairKind::TriangleTriangle, false),
        (PairKind::VertexTriangle, false),
        (PairKind::VertexTriangle, true),
    ] {
        let mut world = World::new(kind, Threshold::new(0.1).unwrap());
        let cloth = world.add(Body::deforming(sheet.clone())).unwrap();
        world.add(Body::fixed(ball.clone())).unwrap();
        // its pairs with itself would have its tree refitted in every frame
        world.exclude(cloth, cloth).unwrap();
        let mut counts = Vec::new();
        for z in [1.0, 1.0, 50.0, 1.0, 0.99, 50.0, 0.99] {
            world.deform(cloth, &at(z)).unwrap();
            let mut bad = at(3.0);
            bad[7][1] = f64::NAN;
            assert!(!refuses || world.deform(cloth, &bad).is_err());
            counts.push(world.frame().unwrap().contacts.len());
        }
        assert!(counts[0] > 50, "{counts:?}");
        assert_eq!(
            (counts[1], counts[2], counts[3]),
            (counts[0], 0, counts[0]),
            "{kind}"
        );
        assert_eq!((counts[5], counts[6]), (0, counts[4]), "{kind}");
    }
    // self-pairs of vertices by a grid, whose boxes a refused frame must leave alone
    let threshold = Threshold::new(0.3).unwrap();
    let mut world = World::new(PairKind::VertexVertex, threshold);
    let cloth = world.add(Body::deforming(sheet.clone()).beyond_ring(1)).unwrap();
    world.deform(cloth, &at(1.0)).unwrap();
    world.frame().unwrap();
    let curled: Vec<Point> = sheet
        .vertices()
        .iter()
        .map(|&[x, y, _]| [0.5 * x, y, 0.4 * (5.0 * x).sin()])
        .collect();
    world.deform(cloth, &curled).unwrap();
    let mut bad = at(3.0);
    bad[7][1] = f64::INFINITY;
    assert!(world.deform(cloth, &bad).is_err());
    let expected: Vec<[u32; 2]> = oracle::pairs_within(&curled, &sheet.adjacency().rings(1), threshold)
        .into_iter()
        .collect();
    let found = world.frame().unwrap().contacts;
    let found: Vec<[u32; 2]> = found.iter().map(|contact| [contact.a, contact.b]).collect();
    assert!(!expected.is_empty() && found == expected);
}

/// Two bodies part, and for a long time questions are asked about boxes alone: contacts of long ago are not shown, even while one of
/// the two is about to move again.
#[test]
fn contacts_of_long_ago_are_not_shown() {
    let ball = crate::scene::SharedMesh::from(generate::icosphere(0.5, 1).unwrap());
    let mut world = World::new(PairKind::TriangleTriangle, Threshold::new(0.1).unwrap());
    let at = |x: f64| Placement::from_translation([x, 0.0, 0.0]).unwrap();
    let [_, other, third] = [0.0, 1.0, 50.0].map(|x| world.add(Body::rigid(ball.clone()).at(at(x))).unwrap());
    let before = world.frame().unwrap().contacts.len();
    let nowhere = crate::Aabb::point([-1e9; 3]);
    world.translate(other, [1.15, 0.0, 0.0]).unwrap();
    // longer than a body remembers when it came
    for frame in 0..70_000 {
        world
            .translate(third, [f64::from(50 + frame % 2), 0.0, 0.0])
            .unwrap();
        assert!(world.bodies_in(&nowhere).unwrap().is_empty());
    }
    assert_eq!(world.kept_pairs(), 1, "their boxes still meet");
    world.translate(other, [1.05, 0.0, 0.0]).unwrap();
    assert!(before > 0 && world.contacts().count() == 0);
    let now = world.frame().unwrap().contacts;
    let posed = [0.0, 1.05].map(|x| PosedMesh {
        mesh: at(x).place(ball.mesh()).unwrap(),
        ring: None,
    });
    assert!(!now.is_empty() && now == referee(&posed, PairKind::TriangleTriangle, 0.1));
}
