//! The books of a record against each other: counts, orders, limits, trace.

use satisfice::{Completeness, StopReason};

use super::Mismatch;
use crate::record::Record;

/// Checks everything that can be checked without the problem.
#[must_use]
pub fn books(record: &Record) -> Vec<Mismatch> {
    let mut wrong = Vec::new();
    counts(record, &mut wrong);
    limits(record, &mut wrong);
    order(record, &mut wrong);
    trace(record, &mut wrong);
    slices(record, &mut wrong);
    wrong
}

fn counts(record: &Record, wrong: &mut Vec<Mismatch>) {
    let counts = &record.counts;
    if record.hits != record.solutions.len() as u64 {
        let expected = format!("{}, the number of solutions", record.solutions.len());
        wrong.push(Mismatch::new("hits", record.hits, expected));
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
    let all = [record.hits, counts.duplicates, counts.non_finite]
        .iter()
        .try_fold(0_u64, |sum, &n| sum.checked_add(n));
    if all.is_none_or(|all| all > counts.evaluations) {
        let found = format!(
            "{} hits, {} duplicates and {} non-finite",
            record.hits, counts.duplicates, counts.non_finite
        );
        let expected = format!("no more than the {} evaluations together", counts.evaluations);
        wrong.push(Mismatch::new("evaluations", found, expected));
    }
    if record.completeness == Completeness::Proved
        && (record.unseen_estimate != Some(0.0) || record.unseen_interval != Some((0.0, Some(0.0))))
    {
        let found = format!("{:?} in {:?}", record.unseen_estimate, record.unseen_interval);
        wrong.push(Mismatch::new(
            "unseen_estimate",
            found,
            "0 in [0, 0], since completeness is proved",
        ));
    }
}

fn limits(record: &Record, wrong: &mut Vec<Mismatch>) {
    let budget = &record.budget;
    let evaluations = record.counts.evaluations;
    if let Some(limit) = budget.evaluations.map(|n| n.saturating_mul(budget.slices)) {
        if evaluations > limit {
            wrong.push(Mismatch::new(
                "evaluations",
                evaluations,
                format!("at most the budget of {limit}"),
            ));
        }
        if record.stop_reason == StopReason::Evaluations && budget.slices == 1 && evaluations != limit {
            wrong.push(Mismatch::new(
                "evaluations",
                evaluations,
                format!("the whole budget of {limit}, since it was spent"),
            ));
        }
    }
    if let Some(limit) = budget.hits
        && budget.slices == 1
        && record.hits > limit
    {
        wrong.push(Mismatch::new(
            "hits",
            record.hits,
            format!("at most the budget of {limit}"),
        ));
    }
    for (place, seconds) in [
        ("elapsed_seconds", record.elapsed_seconds),
        ("overshoot_seconds", record.overshoot_seconds),
    ] {
        // NaN is not there: JSON has none.
        if seconds < 0.0 {
            wrong.push(Mismatch::new(place, seconds, "no negative time"));
        }
    }
}

/// Whether `seconds` is after `limit`. Times of hits are kept to 7 digits, and rounded again where slices are added up.
fn later(seconds: f64, limit: f64) -> bool {
    seconds > limit * (1.0 + 2.0 * f64::from(f32::EPSILON))
}

fn order(record: &Record, wrong: &mut Vec<Mismatch>) {
    // Several hits may come with one evaluation of an exact method.
    let (mut evaluation, mut seconds) = (1, 0.0);
    for (index, solution) in record.solutions.iter().enumerate() {
        if solution.evaluation < evaluation || solution.evaluation > record.counts.evaluations {
            wrong.push(Mismatch::new(
                format!("solutions[{index}].evaluation"),
                solution.evaluation,
                format!("more than {evaluation} and at most {}", record.counts.evaluations),
            ));
        }
        if later(seconds, solution.seconds) || later(solution.seconds, record.elapsed_seconds) {
            wrong.push(Mismatch::new(
                format!("solutions[{index}].seconds"),
                solution.seconds,
                format!("from {seconds} to {}", record.elapsed_seconds),
            ));
        }
        (evaluation, seconds) = (solution.evaluation, solution.seconds);
    }
}

fn trace(record: &Record, wrong: &mut Vec<Mismatch>) {
    let mut before = (0, 0.0);
    for (index, point) in record.trace.iter().enumerate() {
        if point.evaluations < before.0 || point.evaluations > record.counts.evaluations {
            wrong.push(Mismatch::new(
                format!("trace[{index}].evaluations"),
                point.evaluations,
                format!("from {} to {}", before.0, record.counts.evaluations),
            ));
        }
        if point.elapsed_seconds < before.1 || later(point.elapsed_seconds, record.elapsed_seconds) {
            wrong.push(Mismatch::new(
                format!("trace[{index}].elapsed_seconds"),
                point.elapsed_seconds,
                format!("from {} to {}", before.1, record.elapsed_seconds),
            ));
        }
        let hits = record
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
    if record.counts.evaluations > 0 && before.0 != record.counts.evaluations {
        wrong.push(Mismatch::new(
            "trace",
            format!("an end at evaluation {}", before.0),
            format!("one at {}", record.counts.evaluations),
        ));
    }
}

fn slices(record: &Record, wrong: &mut Vec<Mismatch>) {
    if record.slices.is_empty() {
        return;
    }
    let count = record.slices.len() as u64;
    if count > record.budget.slices {
        wrong.push(Mismatch::new(
            "slices",
            count,
            format!("at most {}", record.budget.slices),
        ));
    }
    let sum = |part: fn(&crate::record::Slice) -> u64| {
        record
            .slices
            .iter()
            .fold(0_u64, |sum, slice| sum.saturating_add(part(slice)))
    };
    for (place, found, expected) in [
        ("hits", record.hits, sum(|slice| slice.new_hits)),
        (
            "evaluations",
            record.counts.evaluations,
            sum(|slice| slice.counts.evaluations),
        ),
        (
            "fitness_calls",
            record.counts.fitness_calls,
            sum(|slice| slice.counts.fitness_calls),
        ),
        (
            "duplicates",
            record.counts.duplicates,
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
