//! Problems behind a pointer to a trait object.

#![allow(clippy::unwrap_used, reason = "a test")]

use satisfice::{Budget, Located, SatisficingProblem, Search, Space, from_fn};

type Any = dyn SatisficingProblem<Scalar = f64, Solution = Located<f64>>;

#[test]
fn a_trait_object_runs_like_the_problem_behind_it() {
    let disc = from_fn(Space::lattice(2, 100).unwrap(), 5.0, |x: &[f64]| {
        (x[0] - 30.0).hypot(x[1] - 60.0)
    })
    .boxed();
    let square = from_fn(Space::cube(2, -1.0, 1.0).unwrap(), 0.1, |x: &[f64]| {
        x[0].hypot(x[1])
    })
    .boxed();
    let budget = Budget::evaluations(3_000);
    let expected = Search::new().seed(2).run(&disc, &budget).unwrap();
    let problems: [Box<Any>; 2] = [Box::new(disc), Box::new(square)];
    let mut search = Search::<Any>::new().seed(2);
    let report = search.run(&*problems[0], &budget).unwrap();
    assert_eq!(satisfice::testing::difference(&report, &expected), None);
    // Another problem of the same type, with as many axes.
    assert!(search.run(problems[1].as_ref(), &budget).unwrap().hit_count() > 0);
}
