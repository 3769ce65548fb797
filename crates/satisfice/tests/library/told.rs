//! What a report says in one line.

#![allow(clippy::unwrap_used, reason = "a test")]

use satisfice::{Budget, Search, Space, from_fn};

#[test]
fn a_report_without_hits_says_how_far_the_threshold_is() {
    let told = |fitness: fn(&[f64]) -> f64, delta| {
        let problem = from_fn(Space::lattice(1, 10).unwrap(), delta, fitness);
        let report = Search::new().seed(1).run(&problem, &Budget::evaluations(10));
        report.unwrap().to_string()
    };
    let least = "least F 0, a hit needs F < 0;";
    assert!(told(|x| x[0], 0.0).contains(least), "{}", told(|x| x[0], 0.0));
    let undefined = told(|_| f64::NAN, 0.0);
    assert!(undefined.contains("F not finite in 10"), "{undefined}");
    assert!(!undefined.contains("least F"), "{undefined}");
    let found = told(|x| x[0], 1.0);
    assert!(!found.contains("least F") && !found.contains("finite"), "{found}");
}
