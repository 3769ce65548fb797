//! Tests of the space: bounds, reflection, floors.

use super::*;

/// Reflection one fold at a time: slow, and right by definition.
fn reflect_slowly(mut x: f64, lower: f64, end: f64) -> f64 {
    loop {
        if x < lower {
            x = 2.0 * lower - x;
        } else if x > end {
            x = 2.0 * end - x;
        } else {
            return x;
        }
    }
}

#[test]
fn reflection_agrees_with_folding_step_by_step() {
    for i in -4000..4000 {
        let x = f64::from(i) / 256.0; // exact in binary, so both ways are exact
        for (lower, end) in [(0.0, 1.0), (-0.5, 1.5), (2.0, 2.25), (-8.0, -4.0)] {
            let got = bring_inside(x, lower, end, Boundary::Reflect);
            let inside = if (lower..=end).contains(&x) { x } else { got };
            assert_eq!(
                inside,
                reflect_slowly(x, lower, end),
                "x = {x} in [{lower}, {end}]"
            );
        }
    }
}

#[test]
fn every_overshoot_ends_inside() {
    let widths = [
        (0.0, 1.0),
        (-1e300, 1e300),
        (1e-320, 2e-320),
        (5.0, 5.0),
        (-3.0, 7.25),
    ];
    let xs = [
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
        f64::MAX,
        f64::MIN,
        1e17,
        -1e17,
        5e-324,
        -0.0,
    ];
    for boundary in [Boundary::Reflect, Boundary::Clamp, Boundary::Wrap] {
        for (lower, upper) in widths {
            let space = Space::new([Axis::continuous(lower, upper)])
                .unwrap()
                .with_boundary(boundary);
            for x in xs {
                let mut position = [x];
                space.keep_inside(&mut position);
                assert!(
                    space.contains(&position),
                    "{x} became {position:?} in [{lower}, {upper}], {boundary:?}"
                );
            }
        }
    }
}

#[test]
fn infinite_goes_to_its_bound_and_nan_to_the_middle() {
    let space = Space::new([Axis::continuous(-1.0, 3.0); 3]).unwrap();
    let mut position = [f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
    space.keep_inside(&mut position);
    assert_eq!(position, [3.0, -1.0, 1.0]);
}

#[test]
fn wrap_is_periodic() {
    let space = Space::new([Axis::continuous(-1.0, 1.0)])
        .unwrap()
        .with_boundary(Boundary::Wrap);
    for (x, wrapped) in [(1.5, -0.5), (-1.5, 0.5), (5.25, -0.75), (-4.75, -0.75)] {
        let mut position = [x];
        space.keep_inside(&mut position);
        assert_eq!(position, [wrapped]);
    }
}

#[test]
fn integer_cells_have_width_one_and_negative_ones_are_floored() {
    let space = Space::<f64>::new([Axis::integer(-2, 1)]).unwrap();
    for (position, value) in [
        (-2.0, -2.0),
        (-1.01, -2.0),
        (-0.5, -1.0),
        (0.0, 0.0),
        (1.999, 1.0),
        (2.0, 1.0),
    ] {
        let mut values = [f64::NAN];
        space.values(&[position], &mut values);
        assert_eq!(values, [value], "at {position}");
    }
    let mut back = [-2.0];
    space.positions(&mut back);
    assert_eq!(back, [-1.5]);
}

#[test]
fn unusable_bounds_are_errors() {
    assert_eq!(Space::<f64>::new([]).unwrap_err(), Error::NoAxis);
    for (lower, upper) in [
        (f64::NAN, 1.0),
        (0.0, f64::INFINITY),
        (1.0, 0.0),
        (f64::MIN, f64::MAX),
        (0.0, f64::NAN),
    ] {
        assert!(matches!(
            Space::new([Axis::continuous(0.0, 1.0), Axis::continuous(lower, upper)]),
            Err(Error::Bounds { axis: 1, .. })
        ));
    }
    assert!(matches!(
        Space::<f32>::new([Axis::integer(0, 1 << 24)]),
        Err(Error::Bounds { axis: 0, .. })
    ));
    assert!(Space::<f32>::new([Axis::integer(0, (1 << 24) - 1)]).is_ok());
    assert!(Space::<f64>::lattice(2, 0).is_err());
}

#[test]
fn cardinality_counts_lattice_points() {
    assert_eq!(Space::<f64>::lattice(3, 10).unwrap().cardinality(), Some(1000.0));
    assert_eq!(Space::<f64>::cube(2, 0.0, 1.0).unwrap().cardinality(), None);
}
