//! Placements against Rodrigues' formula, and what is refused.
#![allow(clippy::unwrap_used)]

use proptest::prelude::*;

use super::*;

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// Rodrigues' formula, the reference for the quaternion.
fn rodrigues(axis: [f64; 3], angle: f64, p: [f64; 3]) -> [f64; 3] {
    let length = distance(axis, [0.0; 3]);
    let [x, y, z] = axis.map(|c| c / length);
    let (s, c) = angle.sin_cos();
    let along = (x * p[0] + y * p[1] + z * p[2]) * (1.0 - c);
    let cross = [y * p[2] - z * p[1], z * p[0] - x * p[2], x * p[1] - y * p[0]];
    std::array::from_fn(|k| p[k] * c + cross[k] * s + [x, y, z][k] * along)
}

#[test]
fn no_rotation_is_exact() {
    let p = [0.1, -1e300, 7.3e-310];
    assert_eq!(Placement::IDENTITY.apply(p), p);
    let moved = Placement::from_translation([0.2, 1e299, 1.0]).unwrap();
    assert_eq!(moved.apply(p), [0.1 + 0.2, -1e300 + 1e299, 7.3e-310 + 1.0]);
}

#[test]
fn what_is_not_a_placement_is_refused_by_name() {
    let named = |result: Result<Placement, Error>, name: &str| match result {
        Err(Error::Parameter { parameter, .. }) => assert_eq!(parameter, name),
        other => panic!("{name}: {other:?}"),
    };
    named(Placement::from_translation([0.0, f64::NAN, 0.0]), "translation");
    named(Placement::from_quaternion([0.0; 4]), "quaternion");
    named(
        Placement::from_quaternion([1.0, f64::INFINITY, 0.0, 0.0]),
        "quaternion",
    );
    named(Placement::from_axis_angle([0.0; 3], 1.0), "axis");
    named(Placement::from_axis_angle([f64::NAN, 0.0, 1.0], 1.0), "axis");
    named(
        Placement::from_axis_angle([0.0, 0.0, 1.0], f64::INFINITY),
        "angle",
    );
    let far = Placement::from_translation([1.7e308, 0.0, 0.0]).unwrap();
    named(far.then(&far), "translation");
    let mesh = Mesh::new(vec![[1.7e308, 0.0, 0.0]], vec![], vec![]).unwrap();
    assert!(matches!(
        far.place(&mesh),
        Err(Error::NonFiniteVertex {
            vertex: 0,
            axis: 'x',
            ..
        })
    ));
}

#[test]
fn quaternions_of_any_length_are_normalised() {
    let plain = Placement::from_quaternion([1.0, 2.0, -3.0, 4.0]).unwrap();
    for scale in [2.0_f64.powi(-1060), 2.0_f64.powi(1020)] {
        let scaled = Placement::from_quaternion([1.0, 2.0, -3.0, 4.0].map(|c| c * scale)).unwrap();
        assert_eq!(plain, scaled);
    }
}

#[test]
fn what_is_not_a_rotation_matrix_is_refused() {
    let rows = Placement::IDENTITY.rotation;
    let refused = |rows, translation, name: &str, why: &str| match Placement::from_matrix(rows, translation) {
        Err(Error::Parameter {
            parameter, allowed, ..
        }) => assert!(parameter == name && allowed.contains(why), "{allowed}"),
        other => panic!("{why}: {other:?}"),
    };
    assert_eq!(
        Placement::from_matrix(rows, [1.0, 2.0, 3.0]).unwrap(),
        Placement::from_translation([1.0, 2.0, 3.0]).unwrap()
    );
    refused(rows, [0.0, f64::NAN, 0.0], "translation", "finite");
    for (value, why) in [
        (f64::NAN, "finite"),
        (f64::INFINITY, "finite"),
        (1e200, "scales"),
        (-1.0, "mirrors"),
    ] {
        let mut wrong = rows;
        wrong[1][1] = value;
        refused(wrong, [0.0; 3], "rotation", why);
    }
    let mut sheared = rows;
    sheared[0][1] = 1e-5;
    refused(sheared, [0.0; 3], "rotation", "shears");
    refused([[0.0; 3]; 3], [0.0; 3], "rotation", "scales");
}

proptest! {
    #[test]
    fn what_is_stored_comes_back(
        quaternion in prop::array::uniform4(-1.0..1.0_f64),
        offset in prop::array::uniform3(-5.0..5.0_f64),
        other in prop::array::uniform4(-1.0..1.0_f64),
    ) {
        prop_assume!([quaternion, other].iter().all(|q| q.iter().any(|c| c.abs() > 1e-3)));
        let one = Placement::from_quaternion(quaternion).unwrap().moved(offset).unwrap();
        let two = Placement::from_quaternion(other).unwrap();
        for placement in [one, two, one.then(&two).unwrap(), one.inverse().unwrap()] {
            let again = Placement::from_quaternion(placement.quaternion()).unwrap();
            prop_assert_eq!(again.with_translation(placement.translation()).unwrap(), placement);
            let near = Placement::from_matrix(placement.rotation(), placement.translation()).unwrap();
            let turns = placement.rotation().into_iter().flatten().zip(near.rotation().into_iter().flatten());
            for (a, b) in turns {
                prop_assert!((a - b).abs() < 4e-15, "{} {}", a, b);
            }
        }
    }

    #[test]
    fn agrees_with_rodrigues_and_keeps_distances(
        axis in prop::array::uniform3(-1.0..1.0_f64),
        angle in -10.0..10.0_f64,
        offset in prop::array::uniform3(-5.0..5.0_f64),
        p in prop::array::uniform3(-5.0..5.0_f64),
        q in prop::array::uniform3(-5.0..5.0_f64),
    ) {
        prop_assume!(distance(axis, [0.0; 3]) > 1e-3);
        let placed = Placement::from_axis_angle(axis, angle).unwrap().moved(offset).unwrap();
        let turned = rodrigues(axis, angle, p);
        let expected = std::array::from_fn(|k| turned[k] + offset[k]);
        prop_assert!(distance(placed.apply(p), expected) < 1e-13);
        prop_assert!((distance(placed.apply(p), placed.apply(q)) - distance(p, q)).abs() < 1e-13);
        let twice = placed.then(&placed).unwrap();
        prop_assert!(distance(twice.apply(p), placed.apply(placed.apply(p))) < 1e-12);
    }
}
