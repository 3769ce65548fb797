//! Passes and queries that end early: what they keep, and how they go on.

use super::*;

#[test]
fn an_interrupted_pass_resumes_exactly() {
    for kind in KINDS {
        let mut world = World::new(kind, Threshold::new(0.12).unwrap());
        let mut twin = World::new(kind, Threshold::new(0.12).unwrap());
        let mut orders = Vec::new();
        play(&mut twin, |twin, _, _| {
            let mut pass = twin.pass();
            twin.advance(&mut pass, &mut |_| false).unwrap();
            orders.push(twin.found_by(&pass).collect::<Vec<_>>());
            twin.finish(pass);
        });
        play(&mut world, |world, posed, frame| {
            let mut pass = world.pass();
            let mut interruptions = 0;
            loop {
                let mut asked = 0;
                let state = world
                    .advance(&mut pass, &mut |_| {
                        asked += 1;
                        asked > 2
                    })
                    .unwrap();
                if state == Completeness::Proved {
                    break;
                }
                interruptions += 1;
            }
            // in these frames nothing moves, or the only body that does leaves the others
            let is_trivial = [4, 8, 9].contains(&frame);
            assert_eq!(interruptions == 0, is_trivial, "{kind} frame {frame}");
            assert!(
                world.found_by(&pass).eq(orders[frame].iter().copied()),
                "{kind} frame {frame}"
            );
            let answer = world.finish(pass);
            assert_eq!(
                answer.contacts,
                referee(posed, kind, 0.12),
                "{kind} frame {frame}"
            );
            assert_eq!(answer.completeness, Completeness::Proved);
        });
    }
}

/// Between two questions little is found, however much there is: each takes time.
#[test]
fn a_stop_is_asked_after_what_is_found_too() {
    use std::sync::atomic::{AtomicUsize, Ordering};
    let mut world = World::new(PairKind::TriangleTriangle, Threshold::new(9.0).unwrap());
    for _ in 0..2 {
        world
            .add(Body::fixed(generate::icosphere(1.0, 3).unwrap()))
            .unwrap();
    }
    let (told, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let stop = |found: usize| {
        let new = found - told.swap(found, Ordering::Relaxed);
        most.fetch_max(new, Ordering::Relaxed);
        false
    };
    world.update_until(&stop).unwrap();
    assert_eq!(world.contacts().count(), 1280 * 1280);
    assert!(most.into_inner() <= 1 << 16);
}

#[test]
fn trees_are_built_beforehand_on_one_thread_too() {
    for kind in [
        PairKind::TriangleTriangle,
        PairKind::VertexTriangle,
        PairKind::EdgeEdge,
    ] {
        let mut world = World::new(kind, Threshold::new(0.2).unwrap());
        let add = |world: &mut World| world.add(Body::rigid(generate::icosphere(1.0, 2).unwrap()));
        let ids = [(); 2].map(|()| add(&mut world).unwrap());
        let (first, second) = world.feature_kinds();
        let has_tree = |world: &World, id, kind| world.mesh(id).unwrap().pays_for_tree(kind);
        assert!(!has_tree(&world, ids[0], first));
        world.build_trees().unwrap();
        for id in ids {
            assert!(
                has_tree(&world, id, first) && has_tree(&world, id, second),
                "{kind}"
            );
        }
    }
}

#[test]
fn a_stopped_question_keeps_what_it_found() {
    use std::sync::atomic::{AtomicUsize, Ordering};
    let ball = generate::icosphere(1.0, 3).unwrap();
    let threshold = Threshold::new(0.2).unwrap();
    let row = || {
        let mut world = World::new(PairKind::TriangleTriangle, threshold);
        for k in 0..4 {
            let at = turn(0.3, [2.1 * f64::from(k), 0.0, 0.0]);
            world.add(Body::rigid(at.place(&ball).unwrap())).unwrap();
        }
        world
    };
    let never = |_: usize| false;
    let (witnesses, state) = row().witnesses_until(&never).unwrap();
    assert_eq!((witnesses.len(), state), (3, Completeness::Proved));
    let (some, state) = row().witnesses_until(&|found| found >= 2).unwrap();
    assert_eq!((&some[..], state), (&witnesses[..2], Completeness::Unknown));

    assert_eq!(
        row().first_until(&|_| true).unwrap(),
        (None, Completeness::Unknown)
    );
    let first = row().first().unwrap();
    assert!(first.is_some_and(|first| witnesses.contains(&first)));
    assert_eq!(row().first_until(&never).unwrap(), (first, Completeness::Proved));

    let all = row().frame().unwrap().contacts;
    let (closest, state) = row().closest_until(5, &never).unwrap();
    assert_eq!(
        (&closest, state),
        (&row().closest(5).unwrap(), Completeness::Proved)
    );
    let questions = AtomicUsize::new(0);
    let count = |_: usize| {
        questions.fetch_add(1, Ordering::Relaxed);
        false
    };
    let (whole, _) = row().closest_until(all.len(), &count).unwrap();
    let questions = questions.into_inner();
    assert!(whole.len() == all.len() && questions >= 3, "{questions}");
    for at in 0..=questions {
        let asked = AtomicUsize::new(0);
        let stop = |_: usize| asked.fetch_add(1, Ordering::Relaxed) >= at;
        let (some, state) = row().closest_until(all.len(), &stop).unwrap();
        assert!(some.iter().all(|(contact, _)| all.contains(contact)));
        assert!(some.is_sorted_by(|(_, p), (_, q)| p.distance <= q.distance));
        // one yes is enough to say that something may be missing
        assert_eq!(state == Completeness::Unknown, at < questions, "stopped at {at}");
        assert_eq!(some.len() < all.len(), at < questions, "stopped at {at}");
    }
}

/// Points so crowded that the grid looks at clumps in frames of their own, and points of which it need not.
#[test]
fn a_stopped_enumeration_keeps_what_it_found() {
    use std::sync::atomic::{AtomicUsize, Ordering};
    let ball = generate::icosphere(1.0, 3).unwrap();
    for (delta, least) in [(0.9, 0), (2.5, 3)] {
        for method in [Method::BruteForce, Method::Grid, Method::Tree] {
            for world in [World::new, |kind, threshold| {
                World::new(kind, threshold).parallel()
            }] {
                let mut world =
                    world(PairKind::VertexVertex, Threshold::new(delta).unwrap()).with_method(method);
                world.add(Body::deforming(ball.clone())).unwrap();
                world
                    .add(Body::deforming(turn(0.3, [0.1, 0.0, 0.0]).place(&ball).unwrap()))
                    .unwrap();
                let asked = AtomicUsize::new(0);
                let all = world
                    .frame_until(&|_| {
                        asked.fetch_add(1, Ordering::Relaxed);
                        false
                    })
                    .unwrap();
                assert_eq!(all.completeness, Completeness::Proved);
                assert!(asked.into_inner() >= least, "{method:?} {delta}");
                for at in [0, 2] {
                    // as if the bodies had just moved
                    let to = world
                        .state(0)
                        .state()
                        .vertices()
                        .iter()
                        .map(|&[x, y, z]| [x, y, -z]);
                    let to: Vec<Point> = to.collect();
                    world.deform(BodyId::nth(0), &to).unwrap();
                    let asked = AtomicUsize::new(0);
                    let some = world
                        .frame_until(&|_| asked.fetch_add(1, Ordering::Relaxed) >= at)
                        .unwrap();
                    let whole = world.frame().unwrap();
                    assert_eq!(whole.completeness, Completeness::Proved);
                    let known = |contact: &Contact| whole.contacts.binary_search(contact).is_ok();
                    assert!(some.contacts.is_sorted() && some.contacts.iter().all(known));
                    // one yes is enough to say that something may be missing
                    let was_stopped = asked.into_inner() > at;
                    assert!(was_stopped || at >= least, "{method:?} {delta} stopped at {at}");
                    assert_eq!(some.completeness == Completeness::Unknown, was_stopped);
                    if was_stopped {
                        assert!(at > 0 || some.contacts.len() < whole.contacts.len());
                    } else {
                        assert_eq!(some.contacts, whole.contacts);
                    }
                }
            }
        }
    }
}

#[test]
fn a_budget_cut_finds_last_frames_contacts_first() {
    let sheet = generate::cloth(2.0, 2.0, 60, 60).unwrap();
    let fold = |t: f64| -> Vec<Point> {
        let place = |p: &Point| {
            [
                p[0],
                p[1],
                0.02 * (9.0 * p[0] + t).sin() + 0.02 * (11.0 * p[1] - t).cos(),
            ]
        };
        sheet.vertices().iter().map(place).collect()
    };
    let threshold = Threshold::new(0.04).unwrap();
    let mut world = World::new(PairKind::VertexVertex, threshold);
    let body = world.add(Body::deforming(sheet.clone())).unwrap();
    world.deform(body, &fold(0.0)).unwrap();
    let all = world.frame().unwrap().contacts.len();
    world.deform(body, &fold(0.05)).unwrap();
    let mut pass = world.pass();
    // as many questions as the verification of last frame's pairs takes
    let mut left = all / 128 + 1;
    world
        .advance(&mut pass, &mut |_| {
            left -= 1;
            left == 0
        })
        .unwrap();
    let cut = world.frame_of(&pass);
    assert_eq!(cut.completeness, Completeness::Unknown);
    let now = world.frame().unwrap();
    assert!(
        all > 2000
            && cut
                .contacts
                .iter()
                .all(|contact| now.contacts.binary_search(contact).is_ok())
    );
    assert!(
        cut.contacts.len() * 10 > now.contacts.len() * 6,
        "{} of {}",
        cut.contacts.len(),
        now.contacts.len()
    );
}

/// Bodies that rest are not visited by a pass, either: what is known of them comes at once, and counts as complete.
#[test]
fn a_pass_takes_over_what_has_not_moved() {
    let ball = generate::icosphere(0.5, 2).unwrap();
    let mut world = World::new(PairKind::TriangleTriangle, Threshold::new(0.05).unwrap());
    let at = |x: f64| Placement::from_translation([x, 0.01, 0.02]).unwrap();
    world.add(Body::fixed(ball.clone())).unwrap();
    for x in [0.9, 1.8] {
        world.add(Body::rigid(ball.clone()).at(at(x))).unwrap();
    }
    let before = world.frame().unwrap().contacts;
    let complete = |world: &mut World| {
        let mut pass = world.pass();
        world.advance(&mut pass, &mut |_| false).unwrap();
        world.finish(pass)
    };
    let same = complete(&mut world);
    assert_eq!(
        (&same.contacts, same.skips.unmoved_bodies, same.skips.boxes_apart),
        (&before, 2, 1)
    );
    // The last ball moves: of three pairs of bodies only the first one rests.
    world.place(BodyId::nth(2), at(1.81)).unwrap();
    let mut pass = world.pass();
    let of_first = before
        .iter()
        .filter(|contact| contact.bodies() == (BodyId::nth(0), BodyId::nth(1)))
        .count();
    world.advance(&mut pass, &mut |found| found >= of_first).unwrap();
    assert!(pass.found() >= of_first && of_first > 100);
    let part = world.finish(pass).contacts;
    let answer = complete(&mut world);
    assert_eq!(answer.completeness, Completeness::Proved);
    let mut fresh = World::new(PairKind::TriangleTriangle, Threshold::new(0.05).unwrap());
    fresh.add(Body::fixed(ball.clone())).unwrap();
    for x in [0.9, 1.81] {
        fresh.add(Body::rigid(ball.clone()).at(at(x))).unwrap();
    }
    assert_eq!(answer.contacts, fresh.frame().unwrap().contacts);
    assert!(part.iter().all(|contact| answer.contacts.contains(contact)));
}

#[test]
fn a_pass_of_another_world_is_refused() {
    let ball = generate::icosphere(1.0, 1).unwrap();
    let world_of = |count: usize| {
        let mut world = World::new(PairKind::VertexVertex, Threshold::new(0.1).unwrap());
        for _ in 0..count {
            world.add(Body::rigid(ball.clone())).unwrap();
        }
        world
    };
    let (mut many, mut few) = (world_of(4), world_of(1));
    let mut pass = many.pass();
    let own = few.pass();
    few.finish(own);
    assert!(few.advance(&mut pass, &mut |_| false).is_err());
    assert_eq!(few.found_by(&pass).count(), 0);
    assert_eq!(few.finish(pass).contacts, []);
    let mut pass = many.pass();
    let mut other = few.pass();
    assert!(many.advance(&mut other, &mut |_| false).is_err());
    assert_eq!(
        many.advance(&mut pass, &mut |_| false).unwrap(),
        Completeness::Proved
    );
    assert!(many.found_by(&pass).count() > 0);
}
