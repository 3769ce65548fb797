//! The named suites can be run as they are.

#![allow(clippy::unwrap_used, missing_docs)]

use satisfice_bench::sweep::{self, Plan, Suite};
use satisfice_catalogue::Catalogue;

#[test]
fn every_named_suite_is_valid() {
    let mut names = 0;
    for name in sweep::names() {
        let mut suite = Suite::open(name).unwrap();
        assert!(
            !suite.about.is_empty() && suite.title != name,
            "{name} says what it shows"
        );
        // Small scenes are built faster, and are no less valid, but have another label.
        for part in &mut suite.parts {
            part.beside.retain(|label, _| label != "teapots");
        }
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
        if let Err(error) = Plan::new(suite, &Catalogue::bundled()) {
            panic!("{name}: {error}");
        }
        names += 1;
    }
    assert!(names >= 4, "{names}");
}

const QUEENS: &str = r#"
    seeds = "0..1"
    [[part]]
    engines = ["random"]
    problems = ["himmelblau", { name = "queens", n = 4 }]
    evaluations = 100
    beside = { "queens n=4" = "backtracking: both in a moment" }
"#;

#[test]
fn what_stands_beside_a_problem_is_said_with_its_figures_alone() {
    let plan = Plan::new(Suite::parse("mine", QUEENS).unwrap(), &Catalogue::bundled()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let done = sweep::execute(
        &plan,
        folder.path(),
        1,
        None,
        &satisfice::Cancel::new(),
        &mut |_| {},
    )
    .unwrap();
    let groups = sweep::groups(&plan, &done.rows);
    let beside: Vec<Option<&str>> = groups.iter().map(|group| group.beside.as_deref()).collect();
    assert_eq!(beside, [None, Some("backtracking: both in a moment")]);
    let table = sweep::table(&groups);
    assert_eq!(
        table
            .matches("beside them: backtracking: both in a moment")
            .count(),
        1,
        "{table}"
    );
}

#[test]
fn something_beside_a_problem_that_is_not_there_is_refused() {
    for (wrong, hint) in [
        (r#""queen n=4" = "x""#, "did you mean `queens n=4`"),
        (
            r#""queens n=4" = 2"#,
            "beside, queens n=4: invalid type: integer `2`, expected a string",
        ),
    ] {
        let text = QUEENS.replace(r#""queens n=4" = "backtracking: both in a moment""#, wrong);
        let error = Suite::parse("mine", &text)
            .and_then(|suite| Plan::new(suite, &Catalogue::bundled()))
            .err()
            .unwrap();
        assert!(error.to_string().contains(hint), "{error}");
    }
}

#[test]
fn the_same_stands_beside_the_problems_of_both_generalisation_suites() {
    let beside = |name| Suite::open(name).unwrap().parts.remove(0).beside;
    assert!(!beside("generalisation").is_empty());
    assert_eq!(beside("generalisation"), beside("generalisation-time"));
}

#[test]
fn the_regret_suite_has_every_problem_and_engine_and_holds_back_a_third() {
    let suite = Suite::open("regret").unwrap();
    let regret = suite.regret.clone().unwrap();
    assert_eq!(regret.engine, "portfolio");
    for part in &suite.parts {
        for problem in satisfice_catalogue::catalogue::all() {
            let is_there = part.problems.iter().any(|choice| choice.name == problem.name);
            assert!(is_there, "{} lacks {}", part.name, problem.name);
        }
        // Only the one engine whose proposals are expensive is left out where there are many.
        for engine in satisfice::engine::all() {
            let is_there = part.engines.iter().any(|choice| choice.name == engine.name);
            let many = part.name == "many evaluations";
            assert_eq!(
                is_there,
                !(many && engine.expensive_proposals),
                "{}: {}",
                part.name,
                engine.name
            );
        }
        let problems = part.problems.len();
        assert!((problems / 3..=problems.div_ceil(3)).contains(&regret.held_back.len()));
    }
}

/// A table of a suite names its problem or engine under `name`, so a parameter of that name could not be set.
#[test]
fn no_parameter_has_the_key_of_a_name() {
    let problems = satisfice_catalogue::catalogue::all().iter();
    let engines = satisfice::engine::all().iter();
    let parameters = problems
        .map(|problem| (problem.name, problem.parameters))
        .chain(engines.map(|engine| (engine.name, engine.parameters())));
    for (owner, parameters) in parameters {
        assert!(
            parameters.iter().all(|parameter| parameter.name != "name"),
            "{owner}"
        );
    }
}
