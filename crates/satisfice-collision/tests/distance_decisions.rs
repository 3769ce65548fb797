//! Decisions and distances against the rational referee, on every family of hard cases and on the known traps.
#![allow(clippy::unwrap_used)]

mod stress;

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;
use satisfice_collision::distance::{DecidedBy, PairKind};
use stress::referee::squared_distance;
use stress::{Motion, Point, below, decide, families, orders, proximity, scaled, sizes};

/// Checks one pair at one threshold in its own order, swapped in order, moved and scaled without rounding.
fn check(kind: PairKind, a: &[Point], b: &[Point], delta: f64, expected: bool, rng: &mut Xoshiro256PlusPlus) {
    let verify = |a: &[Point], b: &[Point], delta: f64| {
        let got = decide(kind, a, b, delta);
        assert_eq!(
            got.within, expected,
            "{kind} {a:?} {b:?} {delta:e} by {:?}",
            got.by
        );
        assert_ne!(got.by, DecidedBy::NotFinite);
    };
    verify(a, b, delta);
    let (orders_a, orders_b) = (orders(a), orders(b));
    let a = &orders_a[below(rng, orders_a.len() as u64) as usize];
    let b = &orders_b[below(rng, orders_b.len() as u64) as usize];
    verify(a, b, delta);
    if a.len() == b.len() {
        verify(b, a, delta);
    }
    let motion = Motion::random(rng);
    verify(&motion.apply(a), &motion.apply(b), delta);
    let exponent = below(rng, 801) as i32 - 400;
    if let (Some(a), Some(b), Some(d)) = (
        scaled(a, exponent),
        scaled(b, exponent),
        scaled(&[[delta; 3]], exponent),
    ) {
        verify(&a, &b, d[0][0]);
    }
}

#[test]
fn every_family_is_decided_right_and_measured_to_one_ulp() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(20_260_101);
    for family in families::ALL {
        for _ in 0..120 {
            let (a, b) = (family.draw)(&mut rng);
            for kind in PairKind::ALL {
                let (m, n) = sizes(kind);
                let (a, b) = (&a[..m], &b[..n]);
                let truth = squared_distance(a, b);
                let near = proximity(kind, a, b);
                let error = truth.error_in_ulp(near.distance);
                // Two points have a square without division, so that the root is rounded once.
                let most = if kind == PairKind::VertexVertex {
                    0.5001
                } else {
                    1.0
                };
                assert!(
                    error <= most,
                    "{}: {kind} {a:?} {b:?}: {near:?} off by {error} ulp",
                    family.name
                );
                for _ in 0..3 {
                    let delta = families::threshold_near(near.distance, &mut rng);
                    check(kind, a, b, delta, truth.is_below(delta), &mut rng);
                }
            }
        }
    }
}
