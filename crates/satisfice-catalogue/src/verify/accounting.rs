//! The accounting of a report: counts, orders, limits and trace against each other.

use satisfice::{Completeness, StopReason};

use super::{Mismatch, shown};
use crate::report::{RunReport, SliceReport};

/// Checks everything that can be checked without the problem.
#[must_use]
pub fn accounting(report: &RunReport) -> Vec<Mismatch> {
    let mut wrong = Vec::new();
    counts(report, &mut wrong);
    limits(report, &mut wrong);
    order(report, &mut wrong);
    trace(report, &mut wrong);
    slices(report, &mut wrong);
    wrong
}

fn counts(report: &RunReport, wrong: &mut Vec<Mismatch>) {
    let counts = &report.counts;
    if report.hits != report.solutions.len() as u64 {
        let expected = format!("{}, the number of solutions", report.solutions.len());
        wrong.push(Mismatch::new("hits", report.hits, expected));
    }
    if counts.fitness_calls > counts.evaluations {
        let expected = format!("at most {} evaluations", counts.evaluations);
        wrong.push(Mismatch::new("fitness_calls", counts.fitness_calls, expected));
    } else if counts.duplicates < counts.evaluations - counts.fitness_calls {
        let expected = format!(
            "at least the {} evaluations without a call of the fitness",
            counts.evaluations - counts.fitness_calls
        );
        wrong.push(Mismatch::new("duplicates", counts.duplicates, expected));
    }
    let all = [report.hits, counts.duplicates, counts.non_finite]
        .iter()
        .try_fold(0_u64, |sum, &n| sum.checked_add(n));
    if all.is_none_or(|all| all > counts.evaluations) {
        let found = format!(
            "{} hits, {} duplicates and {} non-finite",
            report.hits, counts.duplicates, counts.non_finite
        );
        let expected = format!("no more than the {} evaluations together", counts.evaluations);
        wrong.push(Mismatch::new("evaluations", found, expected));
    }
    if report.completeness == Completeness::Proved
        && (report.unseen_estimate != Some(0.0) || report.unseen_interval != Some((0.0, Some(0.0))))
    {
        let interval = report.unseen_interval.map_or_else(
            || "null".to_owned(),
            |(low, high)| format!("[{low}, {}]", shown(high)),
        );
        let found = format!("{} in {interval}", shown(report.unseen_estimate));
        wrong.push(Mismatch::new(
            "unseen_estimate",
            found,
            "0 in [0, 0], since completeness is proved",
        ));
    }
}

fn limits(report: &RunReport, wrong: &mut Vec<Mismatch>) {
    let budget = &report.spec.budget;
    let evaluations = report.counts.evaluations;
    if let Some(limit) = budget.evaluations.map(|n| n.saturating_mul(budget.slices)) {
        if evaluations > limit {
            wrong.push(Mismatch::new(
                "evaluations",
                evaluations,
                format!("at most the budget of {limit}"),
            ));
        }
        // A bound is paid like an evaluation; the last call may ask for some more.
        let spent = evaluations.saturating_add(report.counts.bound_calls);
        if report.stop_reason == StopReason::Evaluations && budget.slices == 1 && spent < limit {
            wrong.push(Mismatch::new(
                "evaluations",
                spent,
                format!("the whole budget of {limit}, with bounds, since it was spent"),
            ));
        }
    }
    if let Some(limit) = budget.hits
        && budget.slices == 1
        && report.hits > limit
    {
        wrong.push(Mismatch::new(
            "hits",
            report.hits,
            format!("at most the budget of {limit}"),
        ));
    }
    if let Some(limit) = budget.patience
        && budget.slices == 1
        && report.spec.islands == 1
    {
        let found = report.solutions.iter().map(|solution| solution.evaluation);
        let ends = found.chain([evaluations]);
        let longest = ends
            .scan(0, |last, evaluation| {
                Some(evaluation.saturating_sub(std::mem::replace(last, evaluation)))
            })
            .max();
        if let Some(gap) = longest.filter(|&gap| gap > limit) {
            let expected = format!("at most the patience of {limit}");
            wrong.push(Mismatch::new("evaluations without a hit", gap, expected));
        }
    }
    for (place, seconds) in [
        ("elapsed_seconds", report.elapsed_seconds),
        ("overshoot_seconds", report.overshoot_seconds),
    ] {
        // JSON has no NaN.
        if seconds < 0.0 {
            wrong.push(Mismatch::new(place, seconds, "a time that is not negative"));
        }
    }
}

/// Whether `seconds` is after `limit`. Times of hits are kept to 7 digits, and rounded again where slices are added up.
fn later(seconds: f64, limit: f64) -> bool {
    seconds > limit * (1.0 + 2.0 * f64::from(f32::EPSILON))
}

fn order(report: &RunReport, wrong: &mut Vec<Mismatch>) {
    // An exact method lists several hits at one evaluation.
    let (mut evaluation, mut seconds) = (1, 0.0);
    for (index, solution) in report.solutions.iter().enumerate() {
        if solution.evaluation < evaluation || solution.evaluation > report.counts.evaluations {
            wrong.push(Mismatch::new(
                format!("solutions[{index}].evaluation"),
                solution.evaluation,
                format!("at least {evaluation} and at most {}", report.counts.evaluations),
            ));
        }
        if later(seconds, solution.seconds) || later(solution.seconds, report.elapsed_seconds) {
            wrong.push(Mismatch::new(
                format!("solutions[{index}].seconds"),
                solution.seconds,
                format!("from {seconds} to {}", report.elapsed_seconds),
            ));
        }
        (evaluation, seconds) = (solution.evaluation, solution.seconds);
    }
}

fn trace(report: &RunReport, wrong: &mut Vec<Mismatch>) {
    let mut before = (0, 0.0);
    for (index, point) in report.trace.iter().enumerate() {
        if point.evaluations < before.0 || point.evaluations > report.counts.evaluations {
            wrong.push(Mismatch::new(
                format!("trace[{index}].evaluations"),
                point.evaluations,
                format!("from {} to {}", before.0, report.counts.evaluations),
            ));
        }
        if point.elapsed_seconds < before.1 || later(point.elapsed_seconds, report.elapsed_seconds) {
            wrong.push(Mismatch::new(
                format!("trace[{index}].elapsed_seconds"),
                point.elapsed_seconds,
                format!("from {} to {}", before.1, report.elapsed_seconds),
            ));
        }
        let hits = report
            .solutions
            .partition_point(|s| s.evaluation <= point.evaluations) as u64;
        if point.hits != hits {
            wrong.push(Mismatch::new(
                format!("trace[{index}].hits"),
                point.hits,
                format!("{hits}, as the solutions say"),
            ));
        }
        before = (point.evaluations, point.elapsed_seconds);
    }
    if report.counts.evaluations > 0 && before.0 != report.counts.evaluations {
        wrong.push(Mismatch::new(
            "trace",
            format!("an end at evaluation {}", before.0),
            format!("one at {}", report.counts.evaluations),
        ));
    }
}

fn slices(report: &RunReport, wrong: &mut Vec<Mismatch>) {
    if report.slices.is_empty() {
        return;
    }
    let count = report.slices.len() as u64;
    if count > report.spec.budget.slices {
        wrong.push(Mismatch::new(
            "slices",
            count,
            format!("at most {}", report.spec.budget.slices),
        ));
    }
    let sum = |part: fn(&SliceReport) -> u64| {
        report
            .slices
            .iter()
            .fold(0_u64, |sum, slice| sum.saturating_add(part(slice)))
    };
    for (place, found, expected) in [
        ("hits", report.hits, sum(|slice| slice.new_hits)),
        (
            "evaluations",
            report.counts.evaluations,
            sum(|slice| slice.counts.evaluations),
        ),
        (
            "fitness_calls",
            report.counts.fitness_calls,
            sum(|slice| slice.counts.fitness_calls),
        ),
        (
            "duplicates",
            report.counts.duplicates,
            sum(|slice| slice.counts.duplicates),
        ),
    ] {
        if found != expected {
            wrong.push(Mismatch::new(
                place,
                found,
                format!("{expected}, the sum over the slices"),
            ));
        }
    }
}
