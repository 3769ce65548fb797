//! Every problem at its defaults keeps the laws of the framework's suite, and its table builds it.
#![allow(clippy::unwrap_used, missing_docs)]

use satisfice::catalogue::{Catalogued, Params};
use satisfice::{Budget, Search, testing};
use satisfice_problems::*;

fn keeps_the_laws<P: Catalogued>(settings: &[(&str, &str)]) {
    let values = Params::with(P::PARAMETERS, P::NAME, settings.iter().copied()).unwrap();
    let problem = P::from_params(&values).unwrap();
    assert_eq!(testing::problem::check(&problem, 1), [], "{}", P::NAME);
    assert_eq!(problem.description().name, P::NAME);
    // What a report says builds the same problem again.
    let parameters = problem.description().parameters;
    let again = parameters
        .iter()
        .map(|(name, value)| (name.as_str(), value.as_str()));
    let again = P::from_params(&Params::with(P::PARAMETERS, P::NAME, again).unwrap()).unwrap();
    assert_eq!(again.description().parameters, parameters);
    assert_eq!(again.space(), problem.space());
}

#[test]
fn lattices() {
    keeps_the_laws::<Rastrigin>(&[]);
    keeps_the_laws::<Rastrigin>(&[("dimension", "2")]);
    keeps_the_laws::<Shell>(&[]);
    keeps_the_laws::<Islands>(&[]);
    keeps_the_laws::<Needles>(&[]);
    keeps_the_laws::<SallenKey>(&[]);
    keeps_the_laws::<DiscPacking>(&[]);
    for problem in ["g01", "g04", "g06", "g08", "g09", "g12", "g24"] {
        keeps_the_laws::<Cec2006>(&[("problem", problem)]);
    }
    keeps_the_laws::<Arm>(&[]);
    keeps_the_laws::<SevenJoints>(&[]);
    keeps_the_laws::<Falsification>(&[]);
    keeps_the_laws::<Transmission>(&[]);
}

#[test]
fn constraints() {
    keeps_the_laws::<Queens>(&[]);
    keeps_the_laws::<Queens>(&[("encoding", "random-key")]);
    keeps_the_laws::<GraphColouring>(&[]);
    keeps_the_laws::<Costas>(&[]);
    keeps_the_laws::<Costas>(&[("encoding", "random-key")]);
    keeps_the_laws::<MagicSquare>(&[]);
    keeps_the_laws::<MagicSquare>(&[("encoding", "integer")]);
    keeps_the_laws::<LatinSquare>(&[]);
    keeps_the_laws::<Langford>(&[]);
    keeps_the_laws::<Sat>(&[]);
}

#[test]
fn continuous() {
    keeps_the_laws::<Roots>(&[]);
    keeps_the_laws::<Himmelblau>(&[]);
    keeps_the_laws::<Branin>(&[]);
    keeps_the_laws::<Hartmann6>(&[]);
    keeps_the_laws::<Cec2013>(&[]);
    keeps_the_laws::<System>(&[]);
    keeps_the_laws::<Puma>(&[]);
    keeps_the_laws::<PeriodicPoints>(&[]);
    keeps_the_laws::<PeriodicPoints>(&[("unknowns", "start"), ("spread", "0.5")]);
    for shape in ["box", "ball", "ellipsoid"] {
        keeps_the_laws::<SmallRegions>(&[("shape", shape), ("radius", "0.2"), ("count", "4")]);
    }
    keeps_the_laws::<SmallRegions>(&[("steps", "2"), ("dimension", "2"), ("radius", "0.1")]);
    keeps_the_laws::<MixedAxes>(&[]);
}

/// Hits are too rare for the suite to meet them by chance, so the default engine finds some.
fn components_of_hits_are_within_their_limits<P: Catalogued<Scalar = f64>>(settings: &[(&str, &str)]) {
    let values = Params::with(P::PARAMETERS, P::NAME, settings.iter().copied()).unwrap();
    let problem = P::from_params(&values).unwrap();
    let report = Search::new()
        .seed(2)
        .run(&problem, &Budget::evaluations(200))
        .unwrap();
    assert!(report.hit_count() >= 1, "{}", P::NAME);
    let components = problem.components().unwrap();
    let mut all = vec![f64::NAN; components.count()];
    for hit in report.hits() {
        components.write(hit.solution, &mut all);
        assert!(all.iter().all(|x| x.abs() <= 1.0 + 1e-9), "{}: {all:?}", P::NAME);
    }
}

#[test]
fn components() {
    components_of_hits_are_within_their_limits::<Arm>(&[]);
    components_of_hits_are_within_their_limits::<SevenJoints>(&[]);
    components_of_hits_are_within_their_limits::<SallenKey>(&[]);
    components_of_hits_are_within_their_limits::<Roots>(&[]);
    components_of_hits_are_within_their_limits::<Himmelblau>(&[]);
    components_of_hits_are_within_their_limits::<Puma>(&[]);
    components_of_hits_are_within_their_limits::<System>(&[]);
    components_of_hits_are_within_their_limits::<PeriodicPoints>(&[]);
    components_of_hits_are_within_their_limits::<PeriodicPoints>(&[("unknowns", "start"), ("period", "3")]);
}
