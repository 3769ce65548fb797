//! The comparison of one engine with the best of the others, from a short sweep.

#![allow(clippy::unwrap_used, missing_docs)]

use std::path::Path;

use satisfice::Cancel;
use satisfice_bench::sweep::{self, Plan, Row, Selection, Suite};
use satisfice_catalogue::Catalogue;

const SUITE: &str = r#"
    seeds = "0..3"
    engines = ["random", "descent", "walk"]
    problems = ["queens", { name = "small-regions", dimension = 2, radius = 0.1 }, "himmelblau"]

    [beside]
    queens = "backtracking: all 92"

    [regret]
    engine = "random"
    held-back = ["himmelblau"]

    [[part]]
    name = "few"
    evaluations = [20, 300]

    [[part]]
    name = "one"
    problems = ["queens"]
    evaluations = 1000
"#;

fn in_digits(ratio: f64) -> String {
    if ratio < 0.1 {
        format!("{ratio:.3}")
    } else {
        format!("{ratio:.2}")
    }
}

fn run(suite: Suite, folder: &Path) -> (Plan, Vec<Row>) {
    let plan = Plan::new(suite, &Catalogue::bundled()).unwrap();
    let done = sweep::execute(&plan, folder, 1, None, &Cancel::new(), &mut |_| {}).unwrap();
    assert_eq!(done.missing(), 0);
    (plan, done.rows)
}

/// Hits of each engine over all seeds.
fn sums(rows: &[Row], problem: &str, evaluations: u64) -> [u64; 3] {
    ["random", "descent", "walk"].map(|engine| {
        let of = rows.iter().filter(|row| {
            row.problem_label == problem
                && row.engine_label == engine
                && row.report.spec.budget.evaluations == Some(evaluations)
        });
        of.map(|row| row.report.hits).sum()
    })
}

#[test]
fn figures_are_those_of_the_runs() {
    let folder = tempfile::tempdir().unwrap();
    let (plan, rows) = run(Suite::parse("mine", SUITE).unwrap(), folder.path());
    let groups = sweep::groups(&plan, &rows);
    let finding = sweep::regret::finding(&plan, &groups, &rows).unwrap();
    let table = |start: &str| {
        &finding
            .tables
            .iter()
            .find(|(caption, _)| caption.starts_with(start))
            .unwrap()
            .1
    };

    let ratios = table("Each problem");
    assert_eq!(
        ratios[0],
        [
            "problem",
            "20 evaluations",
            "300 evaluations",
            "1,000 evaluations"
        ]
    );
    let labels: Vec<&str> = ratios[1..].iter().map(|row| row[0].as_str()).collect();
    assert_eq!(
        labels,
        ["queens", "small-regions dimension=2 radius=0.1", "himmelblau *"]
    );
    let mut logs = Vec::new();
    for (row, label) in ratios[1..].iter().zip(labels) {
        for (cell, evaluations) in row[1..].iter().zip([20, 300, 1000]) {
            let problem = label.trim_end_matches(" *");
            if evaluations == 1000 && problem != "queens" {
                assert_eq!(cell, "-");
                continue;
            }
            let [random, others @ ..] = sums(&rows, problem, evaluations);
            let best = *others.iter().max().unwrap();
            let ratio = (random as f64 + 0.5) / (best as f64 + 0.5);
            let counts = best >= 3;
            let expected = if counts {
                in_digits(ratio)
            } else {
                format!("({})", in_digits(ratio))
            };
            assert_eq!(*cell, expected, "{label}, {evaluations}");
            if counts && evaluations == 300 && problem != "himmelblau" {
                logs.push(ratio.ln());
            }
        }
    }
    assert!(!logs.is_empty(), "something is counted");
    let mean = (logs.iter().sum::<f64>() / logs.len() as f64).exp();
    let summary = table("Least");
    let tuning = summary
        .iter()
        .find(|row| row[0] == "tuning" && row[1] == "300 evaluations")
        .unwrap();
    assert_eq!(
        (tuning[2].clone(), tuning[5].clone(), tuning[6].as_str()),
        (logs.len().to_string(), in_digits(mean), "3")
    );
    assert!(summary.iter().any(|row| row[0] == "held back"));
    assert_eq!(table("Mean hits")[1].last().unwrap(), "backtracking: all 92");

    sweep::publish(folder.path(), &plan, &rows, &[], "satisfice bench mine.toml").unwrap();
    let document = std::fs::read_to_string(folder.path().join("regret.md")).unwrap();
    for part in [
        "satisfice bench mine.toml",
        "| himmelblau * |",
        "## Least and geometric mean",
        "## The machine",
    ] {
        assert!(document.contains(part), "{part}: {document}");
    }
    assert!(folder.path().join("figures/regret.svg").exists());
    let page = std::fs::read_to_string(folder.path().join("report.html")).unwrap();
    assert!(page.contains("random against the best of the other engines"));
}

#[test]
fn what_an_engine_has_not_run_is_not_compared() {
    let folder = tempfile::tempdir().unwrap();
    let (plan, mut rows) = run(Suite::parse("mine", SUITE).unwrap(), folder.path());
    rows.retain(|row| row.engine_label != "walk" || row.problem_label == "queens");
    let finding = sweep::regret::finding(&plan, &sweep::groups(&plan, &rows), &rows).unwrap();
    let ratios = &finding.tables[1].1;
    assert_eq!((ratios.len(), ratios[1][0].as_str()), (2, "queens"));
}

#[test]
fn a_selection_goes_on_with_a_larger_one() {
    let folder = tempfile::tempdir().unwrap();
    let small = Selection {
        seeds: Some(0..1),
        problems: vec!["queens".to_owned()],
        budgets: vec!["300".to_owned()],
        ..Selection::default()
    };
    let suite = small.apply(Suite::parse("mine", SUITE).unwrap()).unwrap();
    let (_, rows) = run(suite, folder.path());
    assert_eq!(rows.len(), 3);
    // Nothing is run again.
    let plan = Plan::new(Suite::parse("mine", SUITE).unwrap(), &Catalogue::bundled()).unwrap();
    let cancel = Cancel::new();
    cancel.cancel();
    let done = sweep::execute(&plan, folder.path(), 1, None, &cancel, &mut |_| {}).unwrap();
    assert_eq!((done.rows.len(), done.foreign), (3, 0));
}

#[test]
fn engines_without_the_one_that_is_compared_are_refused_with_what_to_do() {
    let only = |engines: &[&str]| {
        let selection = Selection {
            engines: engines.iter().map(ToString::to_string).collect(),
            ..Selection::default()
        };
        selection
            .apply(Suite::parse("mine", SUITE).unwrap())
            .and_then(|suite| Plan::new(suite, &Catalogue::bundled()))
    };
    assert_eq!(
        only(&["walk", "descent"]).err().unwrap().to_string(),
        "mine: this suite compares random with other engines: choose it too, `--engines random,walk,descent`"
    );
    assert!(only(&["walk", "random"]).is_ok());
}

#[test]
fn names_that_are_not_in_the_suite_are_refused() {
    for (from, to, hint) in [
        (
            "engine = \"random\"",
            "engine = \"randm\"",
            "did you mean `random`",
        ),
        (
            "held-back = [\"himmelblau\"]",
            "held-back = [\"himelblau\"]",
            "did you mean `himmelblau`",
        ),
        ("held-back", "held-bak", "held-bak"),
    ] {
        let error = Suite::parse("mine", &SUITE.replace(from, to))
            .and_then(|suite| Plan::new(suite, &Catalogue::bundled()))
            .err()
            .unwrap();
        assert!(error.to_string().contains(hint), "{error}");
    }
}
