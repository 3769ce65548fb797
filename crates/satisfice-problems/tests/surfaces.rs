//! Branin's and Hartmann's functions against their published minima, and the share of the space below the default thresholds.
#![allow(clippy::unwrap_used, missing_docs)]

use satisfice::SearchRng;
use satisfice::catalogue::{Catalogued, Params};
use satisfice_problems::{Branin, Hartmann6};

const MINIMUM: [f64; 6] = [0.201_69, 0.150_011, 0.476_874, 0.275_332, 0.311_652, 0.657_3];

#[test]
fn the_least_values_are_the_published_ones() {
    for (x, y) in [
        (-std::f64::consts::PI, 12.275),
        (std::f64::consts::PI, 2.275),
        (9.424_78, 2.475),
    ] {
        let f = Branin::value(&[(x + 5.0) / 15.0, y / 15.0]);
        assert!((f - 0.397_887).abs() < 1e-6, "{f}");
    }
    let f = Hartmann6::value(&MINIMUM);
    assert!((f + 3.322_37).abs() < 1e-5, "{f}");
}

/// At a minimum no nearby point is lower: that a constant is right which hardly counts there.
#[test]
fn the_published_minima_are_minima() {
    let mut rng = SearchRng::new(3);
    for _ in 0..2_000 {
        let near = MINIMUM.map(|x| x + 0.2 * (rng.uniform() - 0.5));
        assert!(Hartmann6::value(&near) > -3.322_38);
        let (x, y) = (rng.uniform(), rng.uniform());
        assert!(Branin::value(&[x, y]) > 0.397_886);
    }
}

/// The share of uniform points below the default threshold is a hundredth, within five deviations.
fn a_hundredth_hits<P: Catalogued<Scalar = f64>>() {
    let problem = P::from_params(&Params::defaults(P::PARAMETERS).unwrap()).unwrap();
    let (mut rng, points) = (SearchRng::new(11), 100_000);
    let mut position = vec![0.0; problem.space().dimension()];
    let hits = (0..points).filter(|_| {
        rng.position(problem.space(), &mut position);
        problem.fitness(&problem.decode(&position)) < problem.threshold()
    });
    let hits = hits.count();
    assert!((840..=1_160).contains(&hits), "{}: {hits}", P::NAME);
}

#[test]
fn a_hundredth_of_the_space_hits() {
    a_hundredth_hits::<Branin>();
    a_hundredth_hits::<Hartmann6>();
}

#[test]
fn a_threshold_or_separation_that_is_no_number_is_refused() {
    assert!(Branin::new(f64::NAN, 0.1).is_err() && Branin::new(1.0, -0.1).is_err());
    assert!(Hartmann6::new(f64::INFINITY, 0.1).is_err() && Hartmann6::new(-1.0, f64::NAN).is_err());
}
