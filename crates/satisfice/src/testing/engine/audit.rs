//! Whether a report is true to what it is about, and to itself.

use super::super::Violation;
use super::EngineLaw;
use crate::budget::StopReason;
use crate::identity::Located;
use crate::problem::SatisficingProblem;
use crate::report::{Completeness, Report};
use crate::scalar::Real;
use crate::testing::case::{Case, Poison};

/// Adds what is wrong with a report on a case whose fitness was called this often.
pub(super) fn audit<S: Real>(
    case: &Case<S>,
    report: &Report<Located<S>>,
    calls: u64,
    violations: &mut Vec<Violation<EngineLaw>>,
) {
    let mut say = |law, what: String| {
        violations.push(Violation {
            law,
            case: case.name.clone(),
            what,
        });
    };
    if let Some(values) = case.outside() {
        say(EngineLaw::Inside, format!("{values} was decoded"));
    }
    let counts = report.counts;
    if calls != counts.fitness_calls {
        say(
            EngineLaw::Accounting,
            format!("{} fitness calls counted, {calls} made", counts.fitness_calls),
        );
    }
    if counts.fitness_calls > counts.evaluations || counts.duplicates > counts.evaluations {
        say(EngineLaw::Accounting, format!("{counts:?}"));
    }
    let mut last = 0;
    for hit in report.hits() {
        let fitness = case.value(&hit.solution.coordinates);
        if !(fitness < case.threshold() && fitness.is_finite()) {
            say(
                EngineLaw::Accounting,
                format!("{:?} with F = {fitness} is no hit", hit.solution),
            );
        }
        if hit.evaluation <= last || hit.evaluation > counts.evaluations {
            say(
                EngineLaw::Accounting,
                format!("a hit at {} after one at {last}", hit.evaluation),
            );
        }
        last = hit.evaluation;
    }
    let hits: Vec<_> = report.hits().map(|hit| hit.solution).collect();
    if let Some(i) = (1..hits.len()).find(|&i| hits[..i].contains(&hits[i])) {
        say(EngineLaw::Accounting, format!("{:?} is listed twice", hits[i]));
    }
    let end = report.trace.last().map(|point| (point.evaluations, point.hits));
    if end != Some((counts.evaluations, hits.len() as u64))
        || !report
            .trace
            .is_sorted_by_key(|point| (point.evaluations, point.hits))
    {
        say(
            EngineLaw::Accounting,
            format!("the trace ends at {end:?}, {} hits in {counts:?}", hits.len()),
        );
    }
    if !budget_is_kept(report) {
        let (limit, spent) = (report.budget.evaluations, counts.evaluations);
        say(
            EngineLaw::Budget,
            format!("{spent} of {limit:?} evaluations, {}", report.stop_reason),
        );
    }
    let countable = case.space.cardinality().is_some_and(|points| points < 1e5);
    if report.completeness == Completeness::Proved && countable && case.poison == Poison::Never {
        let (found, all) = (hits.len() as u64, case.count());
        if found != all {
            say(
                EngineLaw::Covered,
                format!("{found} hits of {all} said to be all"),
            );
        }
    }
}

fn budget_is_kept<T>(report: &Report<T>) -> bool {
    let spent = report.counts.evaluations;
    report
        .budget
        .evaluations
        .is_none_or(|limit| match report.stop_reason {
            StopReason::Evaluations => spent == limit,
            StopReason::Exhausted | StopReason::Covered | StopReason::Patience => spent <= limit,
            _ => false,
        })
}
