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
fn an_axis_without_values_says_so() {
    let text = |space: Result<Space<f64>, Error>| space.unwrap_err().to_string();
    assert_eq!(
        text(Space::lattice(2, 0)),
        "cells = 0 is not allowed: an axis without cells has no value: give at least 1"
    );
    assert!(text(Space::new([Axis::categorical(0)])).ends_with("there is no category: give at least 1"));
    assert!(text(Space::new([Axis::integer(5, 1)])).ends_with("there is no value between them"));
    let chained = [Axis::continuous(0.0, 1.0)]
        .into_iter()
        .chain(Axis::permutation(0));
    let error = text(Space::new(chained));
    assert!(error.starts_with("axis 1: "), "{error}");
    assert!(
        error.ends_with("a permutation of nothing: give at least 1 place"),
        "{error}"
    );
}

#[test]
fn cardinality_counts_lattice_points() {
    assert_eq!(Space::<f64>::lattice(3, 10).unwrap().cardinality(), Some(1000.0));
    assert_eq!(Space::<f64>::cube(2, 0.0, 1.0).unwrap().cardinality(), None);
}

#[test]
fn a_logarithmic_axis_moves_by_orders_of_magnitude() {
    let space = Space::<f64>::new([Axis::continuous(1e-6, 1.0).logarithmic()]).unwrap();
    let axis = space.axes()[0];
    let mut values = [0.0];
    for (share, value) in [(0.0, 1e-6), (0.5, 1e-3), (1.0, 1.0)] {
        space.values(&[axis.at(share)], &mut values);
        approx::assert_relative_eq!(values[0], value, max_relative = 1e-12);
    }
    // Exact at the bounds, and never beyond.
    space.values(&[axis.start()], &mut values);
    assert_eq!(values, [1e-6]);
    let mut position = [1e-6];
    space.positions(&mut position);
    assert_eq!(position, [axis.start()]);
    for bad in [
        Axis::continuous(0.0, 1.0).logarithmic(),
        Axis::continuous(-1.0, 1.0).logarithmic(),
        Axis::integer(1, 9).logarithmic(),
        Axis::continuous(1.0, 2.0).logarithmic().periodic(),
    ] {
        assert!(
            matches!(Space::new([bad]), Err(Error::Bounds { axis: 0, .. })),
            "{bad:?}"
        );
    }
}

#[test]
fn keys_become_ranks_and_ranks_keys() {
    let axes = [Axis::continuous(-1.0, 1.0)]
        .into_iter()
        .chain(Axis::permutation(4));
    let space = Space::<f64>::new(axes.chain(Axis::permutation(2))).unwrap();
    let mut values = [0.0; 7];
    space.values(&[0.5, 0.9, 0.1, 0.1, 0.4, 0.2, 0.1], &mut values);
    assert_eq!(values, [0.5, 3.0, 0.0, 1.0, 2.0, 1.0, 0.0]);
    assert!(space.check_values(&values).is_ok());
    let mut position = values;
    space.positions(&mut position);
    assert!(space.contains(&position));
    let mut again = [0.0; 7];
    space.values(&position, &mut again);
    assert_eq!(again, values);
    let mut at_once = [0.0; 7];
    space.keep_inside_with_values(&mut position, &mut at_once);
    assert_eq!(at_once, values);
    let (mut other, mut same) = ([0.5, 0.8, 0.3, 0.3, 0.35, 0.9, 0.2], position);
    space.centre(&mut other);
    space.centre(&mut same);
    assert_eq!(other, same);
    for bad in [
        [0.5, 3.0, 0.0, 1.0, 3.0, 1.0, 0.0],
        [0.5, 3.0, 0.0, 1.0, 2.0, 1.0, 1.0],
    ] {
        assert!(
            matches!(space.check_values(&bad), Err(Error::Solution(_))),
            "{bad:?}"
        );
    }
    let mut torn: Vec<Axis<f64>> = Axis::permutation(3).collect();
    torn.swap(0, 1);
    assert!(Space::new(torn.clone()).is_err());
    torn.truncate(2);
    assert!(Space::new(torn).is_err());
}

#[test]
fn a_periodic_axis_wraps_whatever_the_rule_of_the_space() {
    let axes = [
        Axis::continuous(0.0, 360.0).periodic(),
        Axis::continuous(0.0, 360.0),
        Axis::integer(0, 9).periodic(),
    ];
    for boundary in [Boundary::Reflect, Boundary::Clamp, Boundary::Wrap] {
        let space = Space::new(axes).unwrap().with_boundary(boundary);
        let mut position = [370.0, 370.0, -1.0];
        space.keep_inside(&mut position);
        assert_eq!((position[0], position[2]), (10.0, 9.0));
        assert!(space.is_periodic(0) && space.is_periodic(2));
        assert_eq!(space.is_periodic(1), boundary == Boundary::Wrap);
    }
}
