//! Continuous queries against known answers and against the referee of distances.
#![allow(clippy::unwrap_used)]

mod motions;
mod stress;

use motions::{Case, Kind, Query};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use satisfice_collision::continuous::{DecidedBy, Moving, Separation, decide, impact, is_hit, touches};
use satisfice_collision::distance::Threshold;

/// The scales at which families are tried: powers of two with these exponents, as far as +-150 decimal digits.
const SCALES: [i32; 25] = [
    -498, -400, -300, -200, -100, -60, -40, -30, -20, -10, -5, -1, 0, 1, 5, 10, 20, 30, 40, 60, 100, 200,
    300, 400, 498,
];

fn rng(seed: u64) -> Xoshiro256PlusPlus {
    Xoshiro256PlusPlus::seed_from_u64(seed)
}

/// A decision must not depend on the direction of time, on the order of features and vertices, or on the unit.
fn check(query: &Query, expected: bool) {
    for variant in query.variants() {
        assert_eq!(variant.touches(), expected, "{variant:?}");
    }
}

#[test]
fn exact_touches_and_near_misses_at_every_scale() {
    let mut rng = rng(1);
    for case in Case::ALL {
        for exponent in SCALES {
            for _ in 0..12 {
                let (query, expected) = case.sample(&mut rng);
                check(&query.scaled(exponent), expected);
            }
        }
    }
}

#[test]
fn the_time_of_a_known_touch_is_bounded() {
    let mut rng = rng(2);
    for case in Case::ALL {
        for _ in 0..60 {
            let (query, expected) = case.sample(&mut rng);
            for tolerance in [1e-3, 1e-9, 1e-12] {
                let impact = query.impact(0.0, tolerance);
                assert_eq!(impact.is_some(), expected, "{case:?} {query:?}");
                let Some(impact) = impact else { continue };
                let [low, high] = impact.time;
                assert!(0.0 <= low && high <= 1.0 && high - low <= tolerance, "{impact:?}");
                if let Some(known) = query.first_touch {
                    assert!(low <= known && known <= high, "{known} {impact:?} {query:?}");
                }
            }
        }
    }
}

/// Small integers meet in every degenerate way. A pair that touches comes nearer than every delta, and the two
/// questions are decided by different polynomials.
#[test]
fn touching_is_being_nearer_than_any_distance() {
    let mut rng = rng(3);
    let (mut hits, mut misses) = (0, 0);
    for round in 0..4000 {
        let kind = Kind::ALL[round % 4];
        let query = Query::small_integers(kind, &mut rng, 2 + (round / 4 % 3) as i64);
        let touching = query.touches();
        assert_eq!(query.is_hit(2f64.powi(-60)), touching, "{query:?}");
        for variant in query.variants() {
            assert_eq!(variant.touches(), touching, "{variant:?}");
        }
        if touching {
            hits += 1;
        } else {
            misses += 1;
        }
    }
    assert!(hits > 300 && misses > 300, "{hits} {misses}");
}

/// Distances at dyadic times are exact, and a feature moves no farther than its fastest vertex, which decides all but
/// grazing cases.
#[test]
fn hits_agree_with_sampled_exact_distances() {
    let mut rng = rng(4);
    let (mut hits, mut misses, mut open) = (0, 0, 0);
    for round in 0..400 {
        let query = Query::small_integers(Kind::ALL[round % 4], &mut rng, 4);
        for delta in [0.125, 1.0, 1.5] {
            match query.referee(delta) {
                Some(expected) => {
                    for variant in query.variants() {
                        assert_eq!(variant.is_hit(delta), expected, "{variant:?} {delta}");
                    }
                    if expected {
                        hits += 1;
                    } else {
                        misses += 1;
                    }
                }
                None => open += 1,
            }
        }
    }
    assert!(hits > 200 && misses > 200 && open < 60, "{hits} {misses} {open}");
}

#[test]
fn the_first_time_below_delta_is_bounded_on_both_sides() {
    let mut rng = rng(5);
    for round in 0..400 {
        let query = Query::small_integers(Kind::ALL[round % 4], &mut rng, 4);
        let delta = 0.75;
        let Some(impact) = query.impact(delta, 1e-6) else {
            assert!(!query.is_hit(delta));
            continue;
        };
        assert!(query.is_hit(delta));
        let [low, high] = impact.time;
        assert!(high - low <= 1e-6, "{impact:?}");
        assert_eq!(impact.at_start, query.distance_at(0.0) < delta, "{query:?}");
        // Before the lower bound nothing is nearer, up to the rounding of the sampled coordinates.
        let before = if impact.at_start { 0 } else { 20 };
        for k in 0..before {
            let time = low * f64::from(k) / 20.0;
            assert!(
                query.distance_at(time) >= delta * (1.0 - 1e-12),
                "{query:?} {impact:?}"
            );
        }
        // By the upper bound it is about delta: no vertex is faster than 16.
        assert!(
            query.distance_at(high) < delta + 2.0 * 16.0 * 1e-6,
            "{query:?} {impact:?}"
        );
        let length: f64 = impact.normal.iter().map(|x| x * x).sum::<f64>();
        assert!((length - 1.0).abs() < 1e-9, "{impact:?}");
    }
}

/// Motions that an implementation in wide use misses: its error bound takes the least coordinate where it should take the largest.
#[test]
fn touches_at_the_middle_of_a_step_are_not_missed() {
    for [a, b, c] in [
        [
            f64::from_bits(0x3f8b_72f4_6421_b1a8),
            -f64::from_bits(0x3f53_c670_0b00_9933),
            -f64::from_bits(0x3f54_9ce6_9dd7_5276),
        ],
        [
            f64::from_bits(0x407f_e53e_850a_0905),
            -f64::from_bits(0x4050_30e0_3103_501f),
            -f64::from_bits(0x4057_ae4f_a9fb_9eb6),
        ],
    ] {
        let vertex = Moving::new([a, -1.0, 0.0], [a, 1.0, 0.0]);
        let triangle = Moving::at_rest([[b, 0.0, -1.0], [a, 0.0, 0.0], [c, 0.0, 1.0]]);
        assert!(touches(&vertex, &triangle));
        let time = impact(&vertex, &triangle, Separation::TOUCHING, 1e-12)
            .unwrap()
            .unwrap()
            .time;
        assert!(time[0] <= 0.5 && 0.5 <= time[1]);
    }
}

#[test]
fn one_step_of_a_double_beside_a_corner_is_a_miss() {
    for exponent in SCALES {
        let one = 2f64.powi(exponent);
        let triangle = Moving::at_rest([[0.0; 3], [one, 0.0, 0.0], [0.0, one, 0.0]]);
        for (x, expected) in [(one, true), (one.next_up(), false), (one.next_down(), true)] {
            let vertex = Moving::new([x, 0.0, -one], [x, 0.0, one]);
            assert_eq!(touches(&vertex, &triangle), expected);
            let edge = Moving::new([[x, -one, -one], [x, one, -one]], [[x, -one, one], [x, one, one]]);
            assert_eq!(
                touches(&edge, &Moving::at_rest([[0.0; 3], [one, 0.0, 0.0]])),
                expected
            );
        }
    }
}

#[test]
fn sliding_in_a_plane_far_from_the_origin() {
    let far = 2f64.powi(20);
    let floor = [[far, far, far], [far + 1.0, far, far], [far, far + 1.0, far]];
    let over = |z: f64| Moving::new([far - 1.0, far + 0.25, z], [far + 1.0, far + 0.25, z]);
    assert!(touches(&over(far), &Moving::at_rest(floor)));
    assert!(!touches(&over(far.next_up()), &Moving::at_rest(floor)));
    let gap = far.next_up() - far;
    assert!(!is_hit(
        &over(far.next_up()),
        &Moving::at_rest(floor),
        Threshold::new(gap).unwrap()
    ));
    assert!(is_hit(
        &over(far.next_up()),
        &Moving::at_rest(floor),
        Threshold::new(gap.next_up()).unwrap()
    ));
    // Edges that slide along each other on one line.
    let rail = Moving::at_rest([[far, far, far], [far + 2.0, far, far]]);
    let along = |y: f64| {
        Moving::new(
            [[far - 4.0, y, far], [far - 3.0, y, far]],
            [[far - 2.0, y, far], [far - 1.0, y, far]],
        )
    };
    assert!(!touches(&along(far), &rail));
    let onto = |y: f64| {
        Moving::new(
            [[far - 4.0, y, far], [far - 3.0, y, far]],
            [[far - 1.0, y, far], [far, y, far]],
        )
    };
    assert!(touches(&onto(far), &rail));
    assert!(!touches(&onto(far.next_down()), &rail));
}

#[test]
fn what_is_not_finite_is_never_a_hit() {
    let floor = Moving::at_rest([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let vertex = Moving::new([0.25, 0.25, 1.0], [0.25, bad, -1.0]);
        let decided = decide(&vertex, &floor, Separation::TOUCHING);
        assert!(!decided.within);
        assert_eq!(decided.by, DecidedBy::NotFinite);
        assert_eq!(impact(&vertex, &floor, Separation::TOUCHING, 1e-6).unwrap(), None);
        assert!(Separation::new(bad).is_err());
    }
    let vertex = Moving::at_rest([0.25, 0.25, 1.0]);
    for bad in [0.0, -1.0, f64::NAN] {
        assert!(impact(&vertex, &floor, Separation::TOUCHING, bad).is_err());
    }
}

#[test]
fn huge_and_tiny_coordinates_are_decided() {
    for size in [f64::MAX, f64::MAX / 2.0, f64::MIN_POSITIVE, f64::from_bits(4)] {
        let half = size / 2.0;
        let floor = Moving::at_rest([[-half, -half, 0.0], [size, -half, 0.0], [-half, size, 0.0]]);
        assert!(touches(&Moving::new([0.0, 0.0, half], [0.0, 0.0, -half]), &floor));
        assert!(!touches(&Moving::new([0.0, 0.0, size], [0.0, 0.0, half]), &floor));
        assert!(is_hit(
            &Moving::new([0.0, 0.0, size], [0.0, 0.0, half]),
            &floor,
            Threshold::new(size).unwrap()
        ));
    }
}

/// The fuzz target on fixed seeds, so that it keeps compiling and holding without a fuzzer.
#[test]
fn motions_of_arbitrary_bit_patterns() {
    let mut rng = rng(6);
    for round in 0..300_u32 {
        let mut data = vec![0; 1 + stress::below(&mut rng, 220) as usize];
        rng.fill_bytes(&mut data);
        data[0] = round as u8;
        motions::fuzzing::check(&data);
    }
    motions::fuzzing::check(&[]);
}
