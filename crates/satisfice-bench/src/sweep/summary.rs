//! A summary of the runs of a sweep: a table for each problem and budget of each part.

use std::fmt::Write;

use serde::{Deserialize, Serialize};

use super::metrics::{Cost, RECALLS};
use super::plan::Plan;
use super::row::Row;
use crate::statistics::{Estimate, Paired};
use crate::table;
use satisfice_catalogue::RunSpec;
use satisfice_catalogue::options::OPTIONS;
use satisfice_catalogue::quantity::shown;

/// One problem of one part under its budget.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Group {
    /// The part of the suite.
    pub part: String,
    /// The problem with the parameters that the suite sets.
    pub problem: String,
    /// The budget in words.
    pub budget: String,
    /// Whether a clock limits it.
    pub timed: bool,
    /// The number of all hits, where it is known.
    pub reference_hits: Option<u64>,
    /// Evaluations at which hits are counted.
    pub at_evaluations: Vec<u64>,
    /// Times in seconds at which hits are counted.
    pub at_seconds: Vec<f64>,
    /// Label of the engine that the others are compared with.
    pub against: String,
    /// Text that the suite prints with the figures.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub beside: Option<String>,
    /// One line per engine, in the order of the suite.
    pub lines: Vec<Line>,
}

/// One engine of a group, over its seeds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// The engine with the parameters that the suite sets.
    pub engine: String,
    /// Runs that have ended.
    pub runs: usize,
    /// Distinct hits at the end.
    pub hits: Estimate,
    /// Recall at the end.
    pub recall: Option<Estimate>,
    /// Evaluations.
    pub evaluations: Estimate,
    /// Seconds, where nothing ran beside it.
    pub seconds: Option<Estimate>,
    /// The cost of the first hit.
    pub first_hit: Reached,
    /// The cost of each of [`RECALLS`].
    pub to_recall: Vec<Reached>,
    /// Hits at the group's evaluations.
    pub at_evaluations: Vec<Estimate>,
    /// Hits at the group's times.
    pub at_seconds: Vec<Estimate>,
    /// The paper's r(t) at the group's times.
    pub r: Vec<Estimate>,
    /// Mean recall over the budget's evaluations.
    pub area_evaluations: Option<Estimate>,
    /// Mean recall over the budget's time.
    pub area_seconds: Option<Estimate>,
    /// The share of the evaluations that were repetitions.
    pub duplicates: Estimate,
    /// Distinct hits per fitness call.
    pub precision: Estimate,
    /// Hits seed by seed against the engine the group is compared with; `None` for itself.
    pub paired: Option<Paired>,
}

/// The cost of reaching something, over the runs; infinite in runs that did not reach it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Reached {
    /// The number of runs that reached it.
    pub runs: usize,
    /// Evaluations.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub evaluations: Option<Estimate>,
    /// Seconds.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub seconds: Option<Estimate>,
}

/// The groups of a plan's rows, in its order; a group without a finished run is left out.
#[must_use]
pub fn groups(plan: &Plan, rows: &[Row]) -> Vec<Group> {
    let mut groups = Vec::new();
    for (at, part) in plan.suite.parts.iter().enumerate() {
        let cells = || plan.cells.iter().filter(move |cell| cell.part == at);
        let keys = unique(cells().map(|cell| (cell.problem_label.as_str(), budget(&cell.spec))));
        let engines = unique(cells().map(|cell| cell.engine_label.as_str()));
        for (problem, budget) in &keys {
            let of_group: Vec<&Row> = rows
                .iter()
                .filter(|row| belongs(row, &part.name, problem, budget))
                .collect();
            groups.extend(
                group(&of_group, &engines, part.against.as_deref()).map(|group| Group {
                    beside: part.beside.get(*problem).cloned(),
                    ..group
                }),
            );
        }
    }
    groups
}

fn belongs(row: &Row, part: &str, problem: &str, budget_in_words: &str) -> bool {
    row.part == part && row.problem_label == problem && budget(&row.report.spec) == budget_in_words
}

/// Rows of a group, by engine.
#[must_use]
pub fn rows_of<'a>(rows: &'a [Row], group: &Group, engine: &str) -> Vec<&'a Row> {
    rows.iter()
        .filter(|row| row.engine_label == engine && belongs(row, &group.part, &group.problem, &group.budget))
        .collect()
}

/// The values without repetitions, in order.
pub(super) fn unique<T: PartialEq>(all: impl Iterator<Item = T>) -> Vec<T> {
    let mut seen = Vec::new();
    all.for_each(|one| {
        if !seen.contains(&one) {
            seen.push(one);
        }
    });
    seen
}

fn group(rows: &[&Row], engines: &[&str], against: Option<&str>) -> Option<Group> {
    let first = rows.first()?;
    let of = |engine: &str| -> Vec<&Row> {
        rows.iter()
            .copied()
            .filter(|row| row.engine_label == engine)
            .collect()
    };
    let against = engines
        .iter()
        .find(|&&label| against.is_some_and(|name| label == name || label.split(' ').next() == Some(name)))
        .or(engines.first())?;
    let base = of(against);
    let mut lines: Vec<Line> = engines
        .iter()
        .filter_map(|engine| line(&of(engine), (engine != against).then_some(base.as_slice())))
        .collect();
    Paired::correct(
        &mut lines
            .iter_mut()
            .filter_map(|line| line.paired.as_mut())
            .collect::<Vec<_>>(),
    );
    let spec = &first.report.spec;
    Some(Group {
        part: first.part.clone(),
        problem: first.problem_label.clone(),
        budget: budget(spec),
        timed: spec.budget.time.is_some(),
        reference_hits: first.report.reference_hits,
        at_evaluations: first.at_evaluations.clone(),
        at_seconds: first.at_seconds.clone(),
        against: (*against).to_owned(),
        beside: None,
        lines,
    })
}

/// The budget and the other options of a run, in words.
fn budget(spec: &RunSpec) -> String {
    let limits = &spec.budget;
    let mut words: Vec<String> = Vec::new();
    words.extend(limits.time.map(|time| shown::seconds(time.as_secs_f64())));
    words.extend(
        limits
            .evaluations
            .map(|count| format!("{} evaluations", shown::count(count))),
    );
    words.extend(limits.hits.map(|hits| format!("{hits} hits")));
    let others = OPTIONS
        .iter()
        .filter(|option| !["time", "evaluations", "hits", "seed"].contains(&option.name));
    let shown = others.filter_map(|option| Some(format!(", {} {}", option.name, option.shown(spec)?)));
    words.join(" or ") + &shown.collect::<String>()
}

#[expect(clippy::cast_precision_loss, reason = "counts below 2^53")]
fn line(rows: &[&Row], base: Option<&[&Row]>) -> Option<Line> {
    let engine = rows.first()?.engine_label.clone();
    let over = |value: &dyn Fn(&Row) -> Option<f64>| -> Option<Estimate> {
        let all: Option<Vec<f64>> = rows.iter().map(|row| value(row)).collect();
        Estimate::of(&all?)
    };
    let reached = |cost: &dyn Fn(&Row) -> Option<Cost>| {
        let costs: Vec<Option<Cost>> = rows.iter().map(|row| cost(row)).collect();
        let by = |value: &dyn Fn(&Cost) -> Option<f64>| {
            let all: Option<Vec<f64>> = costs
                .iter()
                .map(|cost| cost.as_ref().map_or(Some(f64::INFINITY), value))
                .collect();
            // JSON has no infinity: more than half of the runs did not reach it.
            Estimate::of(&all?).filter(|estimate| estimate.median.is_finite())
        };
        Reached {
            runs: costs.iter().flatten().count(),
            evaluations: by(&|cost| Some(cost.evaluations as f64)),
            seconds: by(&|cost| cost.seconds),
        }
    };
    let list = |values: &dyn Fn(&Row) -> Vec<f64>| -> Vec<Estimate> {
        let all: Vec<Vec<f64>> = rows.iter().map(|row| values(row)).collect();
        let columns = all.iter().map(Vec::len).min().unwrap_or(0);
        (0..columns)
            .filter_map(|column| Estimate::of(&all.iter().map(|row| row[column]).collect::<Vec<_>>()))
            .collect()
    };
    let counts = |all: &[u64]| all.iter().map(|&count| count as f64).collect();
    Some(Line {
        engine,
        runs: rows.len(),
        hits: over(&|row| Some(row.report.hits as f64))?,
        recall: over(&|row| row.report.recall),
        evaluations: over(&|row| Some(row.report.counts.evaluations as f64))?,
        seconds: over(&|row| row.alone.then_some(row.report.elapsed_seconds)),
        first_hit: reached(&|row| row.metrics.first_hit),
        to_recall: (0..RECALLS.len())
            .map(|at| reached(&|row| row.metrics.to_recall.get(at).copied().flatten()))
            .collect(),
        at_evaluations: list(&|row| counts(&row.metrics.at_evaluations)),
        at_seconds: list(&|row| counts(&row.metrics.at_seconds)),
        r: list(&|row| row.metrics.r.clone()),
        area_evaluations: over(&|row| row.metrics.area_evaluations),
        area_seconds: over(&|row| row.metrics.area_seconds),
        duplicates: over(&|row| Some(row.metrics.duplicates))?,
        precision: over(&|row| Some(row.metrics.precision))?,
        paired: base.map(|base| {
            let pairs: Vec<(f64, f64)> = rows
                .iter()
                .filter_map(|row| {
                    let other = base
                        .iter()
                        .find(|other| other.report.spec.seed == row.report.spec.seed)?;
                    Some((row.report.hits as f64, other.report.hits as f64))
                })
                .collect();
            Paired::of(&pairs)
        }),
    })
}

/// The groups as text for a terminal.
#[must_use]
pub fn table(groups: &[Group]) -> String {
    let mut text = String::new();
    for group in groups {
        let all = group
            .reference_hits
            .map_or_else(|| "not known".to_owned(), shown::count);
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{}: {}, {}; all hits: {all}",
            group.part, group.problem, group.budget
        );
        if let Some(beside) = &group.beside {
            let _ = writeln!(text, "  beside them: {beside}");
        }
        let mut rows = vec![heading(group)];
        rows.extend(group.lines.iter().map(|line| cells(group, line)));
        text.push_str(&table::plain(&rows, 2, 1));
        text.push('\n');
    }
    for legend in unique(groups.iter().filter_map(legend)) {
        let _ = writeln!(text, "{legend}");
    }
    text
}

/// Names of the columns of a group.
#[must_use]
pub fn heading(group: &Group) -> Vec<String> {
    let mut cells = vec!["engine".to_owned(), "runs".to_owned()];
    cells.extend(
        group
            .at_evaluations
            .iter()
            .map(|&count| format!("at {}", shown::count(count))),
    );
    if group.timed {
        cells.extend(
            group
                .at_seconds
                .iter()
                .map(|&time| format!("at {}", shown::seconds(time))),
        );
    }
    // The interval of the median of fewer runs is their range.
    let few = group.lines.iter().all(|line| line.runs < 6);
    let hits = if few {
        "hits (least to most)"
    } else {
        "hits (95 %)"
    };
    cells.extend([hits, "recall"].map(str::to_owned));
    if group.reference_hits.is_some() {
        let unit = if group.timed { "time" } else { "evaluations" };
        cells.extend(RECALLS.map(|share| format!("{unit} to {} %", 100.0 * share)));
    }
    cells.push(if group.timed { "evaluations" } else { "repeated" }.to_owned());
    cells.push(format!("against {}", group.against));
    cells
}

/// The cells of one engine in the columns of [`heading`].
#[must_use]
pub fn cells(group: &Group, line: &Line) -> Vec<String> {
    let mut cells = vec![line.engine.clone(), line.runs.to_string()];
    cells.extend(line.at_evaluations.iter().map(|hits| shown::number(hits.median)));
    if group.timed {
        let missing = group.at_seconds.len().saturating_sub(line.at_seconds.len());
        cells.extend(line.at_seconds.iter().map(|hits| shown::number(hits.median)));
        cells.extend(std::iter::repeat_n("-".to_owned(), missing));
    }
    cells.push(format!(
        "{} ({} to {})",
        shown::number(line.hits.median),
        shown::number(line.hits.low),
        shown::number(line.hits.high)
    ));
    cells.push(line.recall.map_or_else(
        || "-".to_owned(),
        |recall| format!("{:.1} %", 100.0 * recall.median),
    ));
    if group.reference_hits.is_some() {
        cells.extend(line.to_recall.iter().map(|reached| {
            let cost = if group.timed {
                reached.seconds.map(|seconds| shown::seconds(seconds.median))
            } else {
                reached
                    .evaluations
                    .map(|evaluations| shown::number(evaluations.median))
            };
            match cost {
                Some(cost) if reached.runs == line.runs => cost,
                Some(cost) => format!("{cost} ({} of {})", reached.runs, line.runs),
                None => format!("never ({} of {})", reached.runs, line.runs),
            }
        }));
    }
    cells.push(if group.timed {
        shown::number(line.evaluations.median)
    } else {
        format!("{:.1} %", 100.0 * line.duplicates.median)
    });
    cells.push(line.paired.as_ref().map_or_else(|| "-".to_owned(), compared));
    cells
}

/// From this probability on, a difference may be chance.
const CHANCE: f64 = 0.05;

/// On how many seeds an engine found more than the one it is compared with, and on how many less.
fn compared(paired: &Paired) -> String {
    let counts = format!("{} more, {} fewer", paired.wins, paired.losses);
    match paired.p_holm {
        _ if paired.wins + paired.losses == 0 => "equal".to_owned(),
        p if p >= CHANCE => format!("{counts}; may be chance"),
        p => format!("{counts}; p = {}", shown::number(p)),
    }
}

/// What the last column says; `None` if no engine is compared.
#[must_use]
pub(super) fn legend(group: &Group) -> Option<String> {
    let is_compared = group.lines.iter().any(|line| line.paired.is_some());
    is_compared.then(|| {
        format!(
            "against {}: seeds on which more hits were found, and fewer; p is the probability of such a difference by chance \
             (sign test, corrected for the engines of the table)",
            group.against
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_other_options_are_other_groups() {
        let spec = RunSpec::new("random").evaluations(5000);
        assert_eq!(budget(&spec), "5,000 evaluations");
        for option in OPTIONS.iter().filter(|option| option.name != "seed") {
            let mut other = spec.clone();
            let value = match option.name {
                "time" => "3s",
                "probes" => "0.25",
                _ => "7",
            };
            option.set(&mut other, value).unwrap();
            assert_ne!(budget(&other), budget(&spec), "{}", option.name);
        }
        let spec = spec.slices(2).hits(9);
        assert_eq!(budget(&spec), "5,000 evaluations or 9 hits, slices 2");
    }

    #[test]
    fn a_comparison_is_in_words() {
        let of = |wins, losses, p_holm| {
            compared(&Paired {
                wins,
                losses,
                ties: 2,
                p: p_holm,
                p_holm,
            })
        };
        assert_eq!(of(3, 0, 1.0), "3 more, 0 fewer; may be chance");
        assert_eq!(of(1, 15, 0.0039), "1 more, 15 fewer; p = 3.9e-3");
        assert_eq!(of(0, 0, 1.0), "equal");
    }
}
