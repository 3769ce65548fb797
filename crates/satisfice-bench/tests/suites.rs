//! The named suites can be run as they are.

#![allow(clippy::unwrap_used, missing_docs)]

use satisfice_bench::sweep::{self, Plan, Suite};

#[test]
fn every_named_suite_is_valid() {
    let mut names = 0;
    for name in sweep::names() {
        let mut suite = Suite::open(name).unwrap();
        assert!(
            !suite.about.is_empty() && suite.title != name,
            "{name} says what it shows"
        );
        // Small scenes are built faster, and are no less valid.
        for problem in suite.parts.iter_mut().flat_map(|part| &mut part.problems) {
            let small = match problem.name.as_str() {
                "teapots" => ("samples", "50"),
                "cloth" => ("columns", "8"),
                _ => continue,
            };
            problem.settings.retain(|(name, _)| name != small.0);
            problem
                .settings
                .push((small.0.to_owned(), vec![small.1.to_owned()]));
        }
        if let Err(error) = Plan::new(suite) {
            panic!("{name}: {error}");
        }
        names += 1;
    }
    assert!(names >= 4, "{names}");
}
