//! Spaces with periodic axes.

#![allow(clippy::unwrap_used, reason = "a test")]

use satisfice::{Axis, AxisSeparation, Budget, Identity, Located, Search, Separation, Space, from_fn};

/// How many keys a thousand points of two axes have.
fn keys(on_axis: AxisSeparation<f64>) -> usize {
    let separation = Separation::axes([on_axis, on_axis]);
    let mut keys: Vec<u64> = (0..1000)
        .map(|i| {
            Located::new(
                &[f64::from(i % 37) * 9.73, f64::from(i) * 0.359],
                separation.clone(),
            )
            .key()
        })
        .collect();
    keys.sort_unstable();
    keys.dedup();
    keys.len()
}

#[test]
fn points_apart_have_keys_of_their_own() {
    assert!(keys(AxisSeparation::within(0.0).periodic(360.0)) > 900);
    assert!(keys(AxisSeparation::within(1e-12).periodic(360.0)) > 900);
}

#[test]
fn points_a_period_apart_are_found() {
    for radius in [0.0, 1e-11] {
        let axis = AxisSeparation::within(radius).periodic(360.0);
        for x in [
            -725.25,
            -360.0,
            -0.0,
            0.0,
            1e-12,
            90.0,
            179.999_999_999_9,
            180.0,
            359.5,
            360.0,
        ] {
            for turns in -3..=3 {
                let a = Located::new(&[x], Separation::axes([axis]));
                let b = Located::new(&[x + 360.0 * f64::from(turns)], Separation::axes([axis]));
                if a.same(&b) {
                    assert!(b.visit_keys(&mut |key| key == a.key()), "{radius} {x} {turns}");
                    assert!(a.visit_keys(&mut |key| key == b.key()), "{radius} {x} {turns}");
                }
                assert!(a.same(&b) || x.fract() != 0.0);
            }
        }
    }
}

#[test]
fn hits_on_a_torus_are_all_distinct_and_take_no_quadratic_time() {
    let space = Space::new([0; 2].map(|_| Axis::continuous(0.0, 360.0).periodic())).unwrap();
    let problem = from_fn(space, 1.0, |_: &[f64]| 0.0).separation(0.0);
    let mut search = Search::named("random").unwrap().seed(1);
    // a minute where every hit is compared with all others
    let report = search.run(&problem, &Budget::evaluations(100_000)).unwrap();
    assert_eq!(report.hit_count(), 100_000);
}
