//! The accounting of a report: counts, orders, limits and trace against each other.

use satisfice::{Completeness, StopReason};

use super::{Mismatch, slices, sources, unseen};
use crate::report::RunReport;

/// Checks everything that can be checked without the problem.
#[must_use]
pub fn accounting(report: &RunReport) -> Vec<Mismatch> {
    let mut wrong = Vec::new();
    counts(report, &mut wrong);
    limits(report, &mut wrong);
    end(report, &mut wrong);
    order(report, &mut wrong);
    trace(report, &mut wrong);
    slices::check(report, &mut wrong);
    sources::check(report, &mut wrong);
    unseen::check(report, &mut wrong);
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
    for (place, count) in [
        ("probes", counts.probes),
        ("verified", counts.verified),
        ("failed", report.failed),
    ] {
        if count > counts.evaluations {
            let expected = format!("at most the {} evaluations", counts.evaluations);
            wrong.push(Mismatch::new(place, count, expected));
        }
    }
}

/// Whether the run can have ended like that.
fn end(report: &RunReport, wrong: &mut Vec<Mismatch>) {
    let budget = &report.spec.budget;
    let is_proved = report.completeness == Completeness::Proved;
    let could_be = match report.stop_reason {
        StopReason::Time => budget.time.is_some(),
        StopReason::Evaluations => budget.evaluations.is_some(),
        StopReason::Patience => budget.patience.is_some(),
        StopReason::Hits => budget
            .hits
            .is_some_and(|hits| budget.slices > 1 || report.hits >= hits),
        // Only a hit that the engine has missed, or a bound, can make that no proof; a budget that is spent is the likelier end.
        StopReason::Covered => {
            let missed = report.probe_hits.is_some_and(|(_, fresh)| fresh > 0);
            let bounds = report.counts.bound_calls;
            let spent = report.counts.evaluations.saturating_add(bounds);
            let limit = budget.evaluations.map(|n| n.saturating_mul(budget.slices));
            is_proved || missed || (bounds > 0 && limit.is_none_or(|limit| spent < limit))
        }
        _ => true,
    };
    let stop = format!("{:?}", report.stop_reason);
    if !could_be {
        let expected = "an end that the limits and the other counts allow";
        wrong.push(Mismatch::new("stop_reason", &stop, expected));
    }
    if is_proved && report.stop_reason != StopReason::Covered {
        wrong.push(Mismatch::new(
            "stop_reason",
            stop,
            "Covered, since completeness is proved",
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
