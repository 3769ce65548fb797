//! Triangle pairs in batches: the same answers as one by one, in order, whatever the lanes hold.
#![allow(clippy::unwrap_used)]

mod stress;

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::SeedableRng;
use satisfice_collision::distance::{
    DecidedBy, Decision, Threshold, Triangle, TriangleBatch, triangle_triangle,
};
use stress::{below, families, referee::squared_distance};

fn answers(pairs: &[(Triangle, Triangle)], threshold: Threshold) -> Vec<(usize, Decision)> {
    let mut all = Vec::new();
    let mut batch = TriangleBatch::new(threshold);
    for (k, (a, b)) in pairs.iter().enumerate() {
        batch.push(a, b, k, |k, decision| all.push((k, decision)));
    }
    batch.finish(|k, decision| all.push((k, decision)));
    batch.finish(|_, _| panic!("the batch was emptied"));
    all
}

#[test]
fn batches_of_mixed_families_are_decided_right_and_in_order() {
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(7);
    for round in 0..250 {
        let mut pairs = Vec::new();
        for _ in 0..=below(&mut rng, 19) {
            let family = &families::ALL[below(&mut rng, families::ALL.len() as u64) as usize];
            pairs.push((family.draw)(&mut rng));
        }
        // A threshold hard for one of the pairs.
        let (a, b) = &pairs[below(&mut rng, pairs.len() as u64) as usize];
        let near = triangle_triangle::proximity(a, b).distance;
        let delta = families::threshold_near(near, &mut rng);
        let got = answers(&pairs, Threshold::new(delta).unwrap());
        assert_eq!(got.len(), pairs.len());
        for (k, ((tag, decision), (a, b))) in got.iter().zip(&pairs).enumerate() {
            assert_eq!(*tag, k);
            assert_eq!(
                decision.within,
                squared_distance(a, b).is_below(delta),
                "round {round}: {a:?} {b:?} {delta:e}"
            );
        }
    }
}

#[test]
fn one_bad_vertex_harms_no_other_lane() {
    let floor = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let far = floor.map(|[x, y, _]| [x, y, 5.0]);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for place in 0..18 {
            let mut spoilt = (floor, far);
            let side = if place < 9 { &mut spoilt.0 } else { &mut spoilt.1 };
            side[place % 9 / 3][place % 3] = bad;
            let mut pairs = vec![
                (floor, floor),
                (floor, far),
                (floor, floor),
                (far, floor),
                (floor, floor),
            ];
            pairs.insert(place % 5, spoilt);
            for (k, decision) in answers(&pairs, Threshold::new(1.0).unwrap()) {
                let expected = if k == place % 5 {
                    Decision {
                        within: false,
                        by: DecidedBy::NotFinite,
                    }
                } else {
                    Decision {
                        within: pairs[k].0 == pairs[k].1,
                        by: DecidedBy::Filter,
                    }
                };
                assert_eq!(decision, expected, "{bad} at {place}, pair {k}");
            }
        }
    }
}

/// Coordinates and delta times a power of two: the same answers, and not one of them by a slower stage, down to scales at
/// which every coordinate is denormal.
#[test]
fn no_scale_leaves_the_fast_filter() {
    // Few bits, so that scaling is exact.
    let mut rng = Xoshiro256PlusPlus::seed_from_u64(11);
    let mut point = || [0, 1, 2].map(|_| (below(&mut rng, 4096) as f64 - 2048.0) / 64.0);
    let pairs: Vec<(Triangle, Triangle)> = (0..400)
        .map(|_| ([point(), point(), point()], [point(), point(), point()]))
        .collect();
    let delta = 19.0 / 64.0;
    let at_one: Vec<Decision> = answers(&pairs, Threshold::new(delta).unwrap())
        .into_iter()
        .map(|(_, decision)| decision)
        .collect();
    assert!(at_one.iter().any(|d| d.within) && at_one.iter().any(|d| !d.within));
    for power in [-1068, -1060, -1030, -1000, -400, -99, 99, 400, 1000, 1016] {
        let (half, rest) = (2.0_f64.powi(power / 2), 2.0_f64.powi(power - power / 2));
        let scaled: Vec<_> = pairs
            .iter()
            .map(|pair| {
                let scale = |t: Triangle| t.map(|p| p.map(|x| x * half * rest));
                (scale(pair.0), scale(pair.1))
            })
            .collect();
        let threshold = Threshold::new(delta * half * rest).unwrap();
        for ((k, decision), (a, b)) in answers(&scaled, threshold).into_iter().zip(&scaled) {
            assert_eq!(decision, at_one[k], "2^{power}: {a:?} {b:?}");
            let single = triangle_triangle::decide(a, b, threshold);
            assert_eq!(single.within, decision.within);
            if decision.by == DecidedBy::Filter {
                assert_eq!(single.by, DecidedBy::Filter, "2^{power}: {a:?} {b:?}");
            }
        }
    }
}
