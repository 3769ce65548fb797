//! Rigid bodies that go on as they did, turn back and rest: what is expected of them against brute force.

use super::*;

#[test]
fn what_goes_on_steadily_holds_at_once_and_a_turn_is_noticed() {
    let ball = generate::icosphere(1.0, 3).unwrap();
    let delta = 0.1;
    for kind in [PairKind::VertexVertex, PairKind::TriangleTriangle] {
        let mut scene = Scene::new(kind, Threshold::new(delta).unwrap());
        scene.add(Body::fixed(ball.clone()).at(turn(0.3, [1.0, 0.0, 0.0])));
        let rigid = scene.add(Body::rigid(ball.clone()));
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
            scene.place(rigid, place).unwrap();
            let mut pass = scene.pass();
            let mut asked = 0;
            scene
                .advance(&mut pass, &mut |_| {
                    asked += 1;
                    asked > 1
                })
                .unwrap();
            let at_once = pass.contacts().len();
            scene.advance(&mut pass, &mut |_| false).unwrap();
            let answer = scene.finish(pass);
            assert_eq!(answer.completeness, Completeness::Proved);
            let posed = [turn(0.3, [1.0, 0.0, 0.0]), place].map(|place| Posed {
                mesh: place.place(&ball).unwrap(),
                ring: None,
            });
            assert!(
                answer.contacts == referee(&posed, kind, delta),
                "{kind} frame {frame}"
            );
            scene.measure_contacts();
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
