//! Regret: how one engine compares with the best of the others, on every problem under every budget.
//!
//! The figure is `(hits of the engine + 1/2) / (hits of the best other + 1/2)`, sums over all seeds; the best other is the one with
//! the most hits there. An engine that always knew which one to be would have 1 everywhere. The half keeps means finite where nothing is
//! found. Where the best other finds less than one hit a seed, chance decides: the figure stands in brackets, and no mean counts it.
//! The best of many engines is also the luckiest, so that equal engines have less than 1 where hits are few.

use std::fmt::Write;

use satisfice_catalogue::machine;
use satisfice_draw::plot::{Chart, Curve, Panel};

use super::plan::Plan;
use super::row::Row;
use super::summary::{Group, rows_of, unique};
use crate::finding::{Figure, Finding};
use satisfice_catalogue::quantity::shown;

/// Engine and best other on one problem under one budget.
#[derive(Debug, Clone, PartialEq)]
struct Comparison {
    problem: String,
    budget: String,
    held_back: bool,
    /// Mean hits of the engine.
    hits: f64,
    /// Mean hits of the best other, and its label.
    best: (f64, String),
    seeds: usize,
    beside: Option<String>,
}

impl Comparison {
    #[expect(clippy::cast_precision_loss, reason = "a number of seeds")]
    fn ratio(&self) -> f64 {
        let seeds = self.seeds as f64;
        (self.hits * seeds + 0.5) / (self.best.0 * seeds + 0.5)
    }

    /// Whether the best other finds a hit a seed.
    fn counts(&self) -> bool {
        self.best.0 >= 1.0
    }

    fn shown(&self) -> String {
        let ratio = in_digits(self.ratio());
        if self.counts() {
            ratio
        } else {
            format!("({ratio})")
        }
    }
}

/// A ratio for people: three decimals where two would leave one digit.
fn in_digits(ratio: f64) -> String {
    if ratio < 0.1 {
        format!("{ratio:.3}")
    } else {
        format!("{ratio:.2}")
    }
}

/// Tables and chart of a suite with a table `[regret]`; `None` for another one, and as long as no group has the engine and another.
#[must_use]
pub fn finding(plan: &Plan, groups: &[Group], rows: &[Row]) -> Option<Finding> {
    let regret = plan.suite.regret.as_ref()?;
    let all: Vec<Comparison> = groups
        .iter()
        .filter(|group| is_whole(plan, group))
        .filter_map(|group| compare(group, rows, &regret.engine, &regret.held_back))
        .collect();
    let budgets = unique(all.iter().map(|one| one.budget.as_str()));
    if all.is_empty() {
        return None;
    }
    let engine = &regret.engine;
    Some(Finding {
        title: format!("{engine} against the best of the other engines"),
        text: vec![format!(
            "Figures are hits of {engine} by those of the best other engine on the same problem and budget, each sum over the seeds plus a half. \
             1 everywhere is what an engine would have that always knew which one to be. In brackets, and in no mean: the best finds less than \
             one hit a seed. The best of many engines is also the luckiest, so that even equal engines have less than 1 where hits are few. \
             Tuning does not look at the problems held back."
        )],
        tables: vec![
            ("Least and geometric mean".to_owned(), summary(&all, &budgets)),
            ("Each problem; * is held back".to_owned(), ratios(&all, &budgets)),
            (
                format!("Mean hits: {engine} / best other (its name)"),
                hits(&all, &budgets),
            ),
        ],
        figures: vec![chart(engine, &all, &budgets)],
        pictures: Vec::new(),
    })
}

/// The finding as a document, with the command and the machine.
#[must_use]
pub fn markdown(finding: &Finding, command: &str) -> String {
    let mut text = format!("# {}\n\n```text\n{command}\n```\n", finding.title);
    // Writing to a string cannot fail.
    for paragraph in &finding.text {
        let _ = writeln!(text, "\n{paragraph}");
    }
    for (caption, rows) in &finding.tables {
        let _ = writeln!(text, "\n## {caption}\n");
        for (number, row) in rows.iter().enumerate() {
            let _ = writeln!(text, "| {} |", row.join(" | "));
            if number == 0 {
                let _ = writeln!(text, "|{}", "---|".repeat(row.len()));
            }
        }
    }
    text.push_str("\n## The machine\n\n");
    for (what, value) in machine() {
        let _ = writeln!(text, "- {what}: {value}");
    }
    text
}

/// Whether every engine of the part has run.
fn is_whole(plan: &Plan, group: &Group) -> bool {
    let cells = plan
        .cells
        .iter()
        .filter(|cell| plan.suite.parts[cell.part].name == group.part);
    unique(cells.map(|cell| cell.engine_label.as_str())).len() == group.lines.len()
}

fn compare(group: &Group, rows: &[Row], engine: &str, held_back: &[String]) -> Option<Comparison> {
    // Only seeds that every engine has run are compared.
    let of = |label: &str| rows_of(rows, group, label);
    let seeds = |label: &str| {
        of(label)
            .iter()
            .map(|row| row.report.spec.seed)
            .collect::<Vec<_>>()
    };
    let mut common = seeds(engine);
    for line in &group.lines {
        let has = seeds(&line.engine);
        common.retain(|seed| has.contains(seed));
    }
    if common.is_empty() {
        return None;
    }
    #[expect(clippy::cast_precision_loss, reason = "counts below 2^53")]
    let mean = |label: &str| {
        let rows = of(label);
        let hits = rows
            .iter()
            .filter(|row| common.contains(&row.report.spec.seed))
            .map(|row| row.report.hits);
        hits.sum::<u64>() as f64 / common.len() as f64
    };
    let others = group.lines.iter().filter(|line| line.engine != engine);
    // Of equal ones the first.
    let best = others
        .map(|line| (mean(&line.engine), line.engine.clone()))
        .reduce(|best, next| if next.0 > best.0 { next } else { best })?;
    Some(Comparison {
        problem: group.problem.clone(),
        budget: group.budget.clone(),
        held_back: held_back.contains(&group.problem),
        hits: mean(engine),
        best,
        seeds: common.len(),
        beside: group.beside.clone(),
    })
}

/// Least and geometric mean for each budget, of the problems that tuning may look at and of those held back.
fn summary(all: &[Comparison], budgets: &[&str]) -> Vec<Vec<String>> {
    let heading = [
        "problems",
        "budget",
        "counted",
        "least",
        "where",
        "geometric mean",
        "seeds",
    ];
    let mut table = vec![heading.map(str::to_owned).to_vec()];
    for (name, held_back) in [("tuning", false), ("held back", true)] {
        for &budget in budgets {
            let counted: Vec<&Comparison> = all
                .iter()
                .filter(|one| one.budget == budget && one.held_back == held_back && one.counts())
                .collect();
            let Some(least) = counted.iter().min_by(|a, b| a.ratio().total_cmp(&b.ratio())) else {
                continue;
            };
            let seeds = counted.iter().map(|one| one.seeds).min().unwrap_or(0);
            table.push(vec![
                name.to_owned(),
                budget.to_owned(),
                counted.len().to_string(),
                in_digits(least.ratio()),
                least.problem.clone(),
                in_digits(geometric_mean(counted.iter().map(|one| one.ratio()))),
                seeds.to_string(),
            ]);
        }
    }
    table
}

#[expect(clippy::cast_precision_loss, reason = "a number of problems")]
fn geometric_mean(ratios: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = ratios.len() as f64;
    (ratios.map(f64::ln).sum::<f64>() / count).exp()
}

fn ratios(all: &[Comparison], budgets: &[&str]) -> Vec<Vec<String>> {
    by_problem(all, budgets, None, Comparison::shown)
}

fn hits(all: &[Comparison], budgets: &[&str]) -> Vec<Vec<String>> {
    let cell = |one: &Comparison| {
        format!(
            "{} / {} ({})",
            shown::number(one.hits),
            shown::number(one.best.0),
            one.best.1
        )
    };
    by_problem(all, budgets, Some("specialised method"), cell)
}

/// A row for each problem, a column for each budget.
fn by_problem(
    all: &[Comparison],
    budgets: &[&str],
    beside: Option<&str>,
    cell: impl Fn(&Comparison) -> String,
) -> Vec<Vec<String>> {
    let names = ["problem"]
        .into_iter()
        .chain(budgets.iter().copied())
        .chain(beside);
    let mut table = vec![names.map(str::to_owned).collect::<Vec<_>>()];
    for problem in unique(all.iter().map(|one| one.problem.as_str())) {
        let of_problem: Vec<&Comparison> = all.iter().filter(|one| one.problem == problem).collect();
        let mark = if of_problem.iter().any(|one| one.held_back) {
            " *"
        } else {
            ""
        };
        let cells = budgets.iter().map(|&budget| {
            let one = of_problem.iter().find(|one| one.budget == budget);
            one.map_or_else(|| "-".to_owned(), |one| cell(one))
        });
        let special = beside.map(|_| {
            of_problem
                .iter()
                .find_map(|one| one.beside.clone())
                .unwrap_or_default()
        });
        table.push(
            [format!("{problem}{mark}")]
                .into_iter()
                .chain(cells)
                .chain(special)
                .collect(),
        );
    }
    table
}

/// For each budget the share of the problems with at least so much.
#[expect(clippy::cast_precision_loss, reason = "a number of problems")]
fn chart(engine: &str, all: &[Comparison], budgets: &[&str]) -> Figure {
    let panel = |held_back: bool| {
        let curve = |&budget: &&str| {
            let of_budget = all
                .iter()
                .filter(|one| one.budget == budget && one.held_back == held_back && one.counts());
            let mut ratios: Vec<f64> = of_budget.map(Comparison::ratio).collect();
            ratios.sort_by(|a, b| b.total_cmp(a));
            let count = ratios.len() as f64;
            let points = ratios
                .iter()
                .enumerate()
                .map(|(i, &ratio)| (ratio, (i + 1) as f64 / count));
            Curve {
                label: Some(budget.to_owned()),
                points: points.collect(),
                ..Curve::default()
            }
        };
        Panel {
            x_label: if held_back {
                "held back: hits by those of the best other engine"
            } else {
                "tuning: hits by those of the best other engine"
            }
            .to_owned(),
            y_label: "share of the problems with at least as much".to_owned(),
            log_x: true,
            curves: budgets
                .iter()
                .map(curve)
                .filter(|curve| !curve.points.is_empty())
                .collect(),
            ..Panel::default()
        }
    };
    Figure {
        name: "regret",
        caption: format!(
            "For each budget, the share of the problems on which {engine} has at least so many of the hits of the best other engine. \
             Left of 1 another engine is better."
        ),
        chart: Chart {
            title: format!("{engine} against the best of the other engines"),
            panels: [false, true]
                .map(panel)
                .into_iter()
                .filter(|panel| !panel.curves.is_empty())
                .collect(),
        },
    }
}
