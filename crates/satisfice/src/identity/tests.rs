//! Sameness against whole numbers and what is meant; keys against all pairs.

use super::*;

/// What [`Identity::visit_place`] promises of solutions that are the same.
fn are_near<S: Real>(a: &Located<S>, b: &Located<S>) -> bool {
    let place = |point: &Located<S>| {
        let mut place = Vec::new();
        point.visit_place(&mut |x, radius| place.push((x, radius)));
        place
    };
    let (a, b) = (place(a), place(b));
    let squares = a.iter().zip(&b).map(|(&(x, radius), &(y, same))| {
        assert_eq!(radius, same);
        if x == y { 0.0 } else { ((x - y) / radius).powi(2) }
    });
    a.len() == b.len() && squares.sum::<f64>() <= 1.0 + 1e-5
}

fn same_is_found<S: Real>() {
    let mut rng = crate::SearchRng::new(7);
    let mut same = 0;
    for trial in 0..60_000 {
        let dimension = 1 + trial % 7;
        let separation = S::of([0.0, 1e-3, 0.5, 0.02, 1e-30, 1e300, f64::INFINITY][trial % 7]);
        let size = S::of([1.0, 100.0, 1e6, 1e-3, 1e38][trial % 11 % 5]);
        // Round numbers, where cells begin, and others.
        let round = |x: S, rng: &mut crate::SearchRng| if rng.uniform() < 0.5 { x.round() } else { x };
        let mut a = Vec::new();
        let mut b = Vec::new();
        for _ in 0..dimension {
            let x = round(size * S::of(2.0 * rng.uniform() - 1.0), &mut rng);
            let step = S::of(1.1 * rng.uniform().round() * (2.0 * rng.uniform() - 1.0));
            a.push(x);
            b.push(x + separation.min(size) * step);
        }
        let (a, b) = (Located::new(&a, separation), Located::new(&b, separation));
        for (a, b) in [(&a, &b), (&b, &a)] {
            let mut visited = 0;
            let found = b.visit_keys(&mut |key| {
                visited += 1;
                key == a.key()
            });
            assert!(found || !a.same(b), "{a:?} {b:?}");
            assert!(visited <= 27, "{visited} keys for {b:?}");
            assert!(are_near(a, b) || !a.same(b), "by place: {a:?} {b:?}");
            same += u32::from(a.same(b));
        }
    }
    assert!(same > 50_000, "the test looks at {same} pairs that are the same");
}

#[test]
fn whatever_is_the_same_is_found_by_its_keys() {
    same_is_found::<f64>();
}

#[test]
fn whatever_is_the_same_is_found_by_its_keys_in_f32() {
    same_is_found::<f32>();
}

/// All pairs among points on mixed axes, by the keys and by what is meant.
#[test]
fn axes_by_themselves() {
    let mut rng = crate::SearchRng::new(8);
    let apart = Separation::axes([
        AxisSeparation::exact(),
        AxisSeparation::within(0.3).periodic(4.0),
        AxisSeparation::within(0.4),
        AxisSeparation::within(0.2).logarithmic(),
        AxisSeparation::exact().periodic(1.0),
    ]);
    let point = |rng: &mut crate::SearchRng| {
        let x = [
            rng.below(2) as f64,
            (rng.below(200) as f64) / 50.0,
            2.0 * rng.uniform(),
            (2.0 * rng.uniform()).exp(),
            rng.below(3) as f64 / 2.0,
        ];
        Located::new(&x, apart.clone())
    };
    let mut same = 0;
    for _ in 0..100_000 {
        let (a, b) = (point(&mut rng), point(&mut rng));
        let [x, y] = [&a, &b].map(|at| &at.coordinates);
        let around = (x[1] - y[1]).abs();
        let parts = [
            around.min(4.0 - around) / 0.3,
            (x[2] - y[2]) / 0.4,
            (x[3] / y[3]).ln() / 0.2,
        ];
        let exact = x[0] == y[0] && (x[4] - y[4]).abs() % 1.0 == 0.0;
        let meant = exact && parts.iter().map(|part| part * part).sum::<f64>() <= 1.0;
        let sum: f64 = parts.iter().map(|part| part * part).sum();
        if (sum - 1.0).abs() > 1e-9 {
            assert_eq!(a.same(&b), meant, "{a:?} {b:?}");
        }
        assert_eq!(a.same(&b), b.same(&a));
        assert!(
            !a.same(&b) || b.visit_keys(&mut |key| key == a.key()),
            "{a:?} {b:?}"
        );
        assert!(!a.same(&b) || are_near(&a, &b));
        same += u32::from(meant);
    }
    assert!(same > 100, "the test looks at {same} pairs that are the same");
}

#[test]
fn a_separation_survives_json_and_bytes() {
    for separation in [
        Separation::Radius(0.25),
        Separation::axes([AxisSeparation::exact(), AxisSeparation::within(2.0).periodic(8.0)]),
    ] {
        let point = Located::new(&[1.0_f64, 2.0], separation);
        let text = serde_json::to_string(&point).unwrap();
        assert_eq!(
            serde_json::from_str::<Located<f64>>(&text).unwrap(),
            point,
            "{text}"
        );
        let bytes = postcard::to_extend(&point, Vec::new()).unwrap();
        assert_eq!(postcard::from_bytes::<Located<f64>>(&bytes).unwrap(), point);
    }
}

#[test]
fn every_coordinate_of_a_lattice_is_hashed() {
    let keys: std::collections::BTreeSet<u64> = (0..100)
        .map(|axis| {
            let mut x = [0.0_f64; 100];
            x[axis] = 1.0;
            Located::new(&x, 0.0).key()
        })
        .collect();
    assert_eq!(keys.len(), 100);
}

#[test]
fn negative_zero_is_zero() {
    let (a, b) = (Located::new(&[0.0_f64], 0.0), Located::new(&[-0.0], 0.0));
    assert!(a.same(&b) && b.visit_keys(&mut |key| key == a.key()));
}

/// The distances of whole coordinates, which integers know exactly, at and around a radius: by one coordinate alone, where sameness ends
/// early, and by all of them.
fn same_is_what_integers_say<S: Real>(size: i64, unit: f64) {
    let mut rng = crate::SearchRng::new(9);
    let mut counts = [0; 4];
    for trial in 0..200_000 {
        let dimension = 1 + trial % 7;
        let radius = 1 + (rng.uniform() * size as f64) as i64;
        let alone = rng.uniform() < 0.5;
        let share = [0.9, 0.9999, 1.0, 1.009, 1.01, 1.02][trial % 6]
            / if alone { 1.0 } else { (dimension as f64).sqrt() };
        let steps: Vec<i64> = (0..dimension)
            .map(|axis| match (alone, axis == trial % dimension) {
                (true, true) | (false, _) => (share * radius as f64) as i64 + i64::from(rng.uniform() < 0.5),
                (true, false) => (rng.uniform() * 3.0) as i64,
            })
            .collect();
        let from: Vec<i64> = steps
            .iter()
            .map(|_| (rng.uniform() * size as f64) as i64)
            .collect();
        let located = |x: Vec<i64>| {
            let x: Vec<S> = x.iter().map(|&x| S::of(x as f64 * unit)).collect();
            Located::new(&x, S::of(radius as f64 * unit))
        };
        let to = from.iter().zip(&steps).map(|(x, step)| x + step).collect();
        let same = located(from).same(&located(to));
        let square: i128 = steps.iter().map(|&step| i128::from(step).pow(2)).sum();
        let most = i128::from(radius).pow(2);
        // Nearer to the radius than a hundred roundings, either answer is right.
        let margin = (most as f64 * 100.0 * S::epsilon().f64()) as i128;
        if (square - most).abs() > margin {
            assert_eq!(same, square < most, "{steps:?} within {radius}");
            counts[usize::from(alone) * 2 + usize::from(same)] += 1;
        }
    }
    assert!(counts.iter().all(|&count| count > 5_000), "{counts:?}");
}

#[test]
fn sameness_agrees_with_whole_numbers() {
    same_is_what_integers_say::<f64>(1 << 40, 1.0);
    same_is_what_integers_say::<f64>(1 << 40, 2_f64.powi(-1000));
    same_is_what_integers_say::<f32>(1 << 22, 1.0);
    // Few units: what one coordinate may be apart at most is rounded to a whole number of them.
    same_is_what_integers_say::<f64>(100, f64::from_bits(1));
}

/// A plain, a logarithmic and a periodic axis: against the farthest of many coordinates on each.
#[test]
fn a_region_is_covered_where_its_farthest_point_is_the_same() {
    let radii = [0.5, 0.3, 40.0];
    let separation = Separation::axes([
        AxisSeparation::within(radii[0]),
        AxisSeparation::within(radii[1]).logarithmic(),
        AxisSeparation::within(radii[2]).periodic(360.0),
    ]);
    let distance = |axis: usize, a: f64, b: f64| match axis {
        0 => (a - b).abs(),
        1 => (a / b).ln().abs(),
        _ => {
            let d = (a - b).rem_euclid(360.0);
            d.min(360.0 - d)
        }
    };
    let mut rng = crate::SearchRng::new(4);
    let mut counts = [0, 0];
    for trial in 0..20_000 {
        let centre = [
            rng.uniform(),
            (20.0 * rng.uniform() - 10.0).exp(),
            360.0 * rng.uniform(),
        ];
        // Some regions are a whole turn, some go over its end.
        let size = if trial % 10 == 0 { 3.0 } else { rng.uniform() };
        let shares = [rng.uniform(), rng.uniform(), rng.uniform()].map(|share| size * share);
        let lower = [
            centre[0] - radii[0] * shares[0],
            centre[1] * (-radii[1] * shares[1]).exp(),
            centre[2] - radii[2] * shares[2] - if trial % 3 == 0 { 360.0 } else { 0.0 },
        ];
        let region = Region {
            lower: lower.to_vec(),
            upper: vec![
                lower[0] + radii[0] * size * rng.uniform(),
                lower[1] * (radii[1] * size * rng.uniform()).exp(),
                lower[2] + if trial % 10 == 0 { 9.0 } else { 1.0 } * radii[2] * size * rng.uniform(),
            ],
        };
        let square: f64 = (0..3)
            .map(|axis| {
                let (lower, upper) = (region.lower[axis], region.upper[axis]);
                let farthest = (0..=100)
                    .map(|i| lower + (upper - lower) * f64::from(i) / 100.0)
                    .map(|x| distance(axis, centre[axis], x.min(upper)))
                    .fold(0.0, f64::max);
                (farthest / radii[axis]).powi(2)
            })
            .sum();
        let covers = Located::new(&centre, separation.clone()).covers(&region);
        if !(0.98..=1.0).contains(&square) {
            assert_eq!(covers, square < 1.0, "{centre:?} {region:?} {square}");
            counts[usize::from(covers)] += 1;
        }
    }
    assert!(counts.iter().all(|&count| count > 2000), "{counts:?}");
}

/// Points that are alike on all axes but one have keys of their own: a table of them is no list.
#[test]
fn every_axis_with_a_radius_counts_in_the_key() {
    for axes in 1..=HASHED {
        for separation in [
            Separation::Radius(0.01),
            Separation::axes((0..axes).map(|_| AxisSeparation::within(0.01))),
            Separation::axes((0..axes).map(|_| AxisSeparation::within(0.01).logarithmic())),
        ] {
            for axis in 0..axes {
                let key = |x: f64| {
                    let mut values = vec![1.0; axes];
                    values[axis] = x;
                    Located::new(&values, separation.clone()).key()
                };
                let keys: std::collections::BTreeSet<u64> = (1..=100).map(|i| key(f64::from(i))).collect();
                assert!(
                    keys.len() > 50,
                    "{separation:?}, axis {axis}: {} keys",
                    keys.len()
                );
            }
        }
    }
}
