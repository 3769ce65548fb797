//! A callback of the caller's that panics leaves the world as it would be without the question.

use std::panic::{AssertUnwindSafe, catch_unwind};

use super::{Body, Placement, World, generate};
use crate::distance::{PairKind, Threshold};
use crate::scene::{ChangeKind, Completeness};

/// Balls in a row, of which each meets the next one.
fn row(parallel: bool) -> World {
    let world = World::new(PairKind::TriangleTriangle, Threshold::new(0.1).unwrap());
    let mut world = if parallel { world.parallel() } else { world };
    for k in 0..30 {
        let at = Placement::from_translation([1.5 * f64::from(k), 0.0, 0.0]).unwrap();
        world
            .add(Body::rigid(generate::icosphere(1.0, 1).unwrap()).at(at))
            .unwrap();
    }
    world
}

fn panics<R>(question: impl FnOnce() -> R) {
    assert!(catch_unwind(AssertUnwindSafe(question)).is_err());
}

#[test]
fn a_predicate_of_a_ray_that_panics_takes_nothing_from_the_world() {
    let (mut world, mut twin) = (row(false), row(false));
    let way = [[-9.0, 0.1, 0.1], [99.0, 0.1, 0.1]];
    panics(|| world.cast_ray_where(way[0], way[1], |_| panic!("as the caller wants")));
    let hit = world.cast_ray(way[0], way[1]).unwrap();
    assert!(hit.is_some());
    assert_eq!(hit, twin.cast_ray(way[0], way[1]).unwrap());
    assert_eq!(world.nearest(3).unwrap(), twin.nearest(3).unwrap());
    assert_eq!(world.frame().unwrap(), twin.frame().unwrap());
}

#[test]
fn a_stop_that_panics_takes_nothing_from_the_world() {
    let (mut world, mut twin) = (row(false), row(false));
    let fuse = |most: usize| {
        let asked = std::sync::atomic::AtomicUsize::new(0);
        move |_: usize| {
            let asked = asked.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            assert!(asked < most, "as the caller wants");
            false
        }
    };
    panics(|| world.closest_until(3, &fuse(2)));
    panics(|| world.nearest_until(3, &fuse(2)));
    panics(|| world.witnesses_until(&fuse(2)));
    panics(|| world.first_until(&fuse(0)));
    panics(|| world.count_until(&fuse(2)));
    let mut pass = world.pass();
    panics(|| world.advance(&mut pass, &mut |found| found > 0 && panic!("as the caller wants")));
    assert_eq!(
        world.advance(&mut pass, &mut |_| false).unwrap(),
        Completeness::Proved
    );
    let all = world.frame_of(&pass).contacts;
    assert_eq!(world.nearest(3).unwrap(), twin.nearest(3).unwrap());
    assert_eq!(world.frame().unwrap().contacts, all);
    assert_eq!(twin.frame().unwrap().contacts, all);
}

#[test]
fn an_update_that_panics_is_made_up_for_by_the_next_one() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    for parallel in [false, true] {
        for most in [0, 1, 7] {
            pool.install(|| {
                let (mut world, mut twin) = (row(parallel), row(parallel));
                for frame in 0..3 {
                    for k in 0..30 {
                        let body = super::BodyId::nth(k);
                        let x = 1.5 * f64::from(k) + 0.1 * f64::from(frame) * f64::from(k % 3);
                        for world in [&mut world, &mut twin] {
                            world.translate(body, [x, 0.0, 0.0]).unwrap();
                        }
                    }
                    let asked = std::sync::atomic::AtomicUsize::new(0);
                    let stop = |_: usize| {
                        let asked = asked.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                        assert!(asked < most, "as the caller wants");
                        false
                    };
                    panics(|| world.update_until(&stop));
                    let expected = twin.frame().unwrap().contacts;
                    let known = world.sorted_contacts();
                    assert!(known.iter().all(|contact| expected.contains(contact)));
                    assert_eq!(world.frame().unwrap().contacts, expected);
                    let here = world.changes().filter(|change| change.kind != ChangeKind::Ended);
                    assert_eq!(here.count(), expected.len());
                    assert_eq!(world.update().unwrap().recomputed, 0);
                }
            });
        }
    }
}
