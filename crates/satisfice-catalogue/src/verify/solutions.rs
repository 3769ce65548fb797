//! Every solution of a report, decoded and evaluated again by the problem.

use std::panic::{AssertUnwindSafe, catch_unwind};

use satisfice::{Archive, Real, SatisficingProblem};
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::Mismatch;
use crate::report::{FoundSolution, RunReport};

/// Two evaluations of one solution may differ by this much of delta, or of F where that is greater: mathematical
/// functions are rounded differently on different platforms.
const ROUNDING: f64 = 1e-9;

/// Checks that every solution belongs to the problem, is a hit, has the fitness listed, and is listed once.
///
/// Cost: one evaluation and one look-up per solution.
#[must_use]
pub fn solutions<P>(problem: &P, report: &RunReport) -> Vec<Mismatch>
where
    P: SatisficingProblem + ?Sized,
    P::Solution: DeserializeOwned,
{
    let mut mismatches = Vec::new();
    if report.scalar != P::Scalar::NAME {
        mismatches.push(Mismatch::new("scalar", &report.scalar, P::Scalar::NAME));
    }
    let mut seen = Archive::default();
    mismatches.extend(solutions_by(report, problem.threshold().f64(), |listed| {
        let (solution, fitness) = evaluate(problem, &listed.solution)?;
        if seen.insert(solution, fitness, listed.evaluation, listed.seconds) {
            Ok(fitness)
        } else {
            Err(LISTED_BEFORE.to_owned())
        }
    }));
    mismatches.extend(best_by(report, |solution| {
        evaluate(problem, solution).map(|(_, fitness)| fitness)
    }));
    mismatches
}

/// The solution and its fitness, or what is expected instead.
fn evaluate<P>(problem: &P, solution: &Value) -> Result<(P::Solution, f64), String>
where
    P: SatisficingProblem + ?Sized,
    P::Solution: DeserializeOwned,
{
    let solution: P::Solution =
        serde_json::from_value(solution.clone()).map_err(|error| error.to_string())?;
    // A file may contain anything, and a problem may panic on solutions that its own `decode` never returns.
    let evaluated = catch_unwind(AssertUnwindSafe(|| {
        is_inside(problem, &solution).then(|| problem.fitness(&solution).f64())
    }));
    let fitness = evaluated
        .ok()
        .flatten()
        .ok_or("a solution inside the space of the problem")?;
    Ok((solution, fitness))
}

/// Checks that the best candidate of a report has the fitness listed and is no worse than any hit.
pub fn best_by(report: &RunReport, evaluate: impl FnOnce(&Value) -> Result<f64, String>) -> Vec<Mismatch> {
    let least = report.solutions.iter().map(|hit| hit.fitness);
    let least = least.fold(f64::INFINITY, f64::min);
    let Some(best) = &report.best else {
        let missing =
            (report.hits > 0).then(|| Mismatch::new("best", "null", format!("F = {least} or less")));
        return missing.into_iter().collect();
    };
    let mut mismatches = Vec::new();
    match evaluate(&best.solution) {
        Err(expected) => mismatches.push(Mismatch::new("best.solution", &best.solution, expected)),
        Ok(fitness) if !agree(fitness, best.fitness, report.threshold) => {
            mismatches.push(Mismatch::new("best.fitness", best.fitness, fitness));
        }
        Ok(_) => {}
    }
    if best.fitness > least && !agree(best.fitness, least, report.threshold) {
        let expected = format!("at most {least}, the fitness of a hit");
        mismatches.push(Mismatch::new("best.fitness", best.fitness, expected));
    }
    if !(1..=report.counts.evaluations).contains(&best.evaluation) {
        let expected = format!("from 1 to {}", report.counts.evaluations);
        mismatches.push(Mismatch::new("best.evaluation", best.evaluation, expected));
    }
    mismatches
}

/// Whether two values of F differ only by rounding. NaN agrees with nothing.
fn agree(a: f64, b: f64, threshold: Option<f64>) -> bool {
    let scale = a.abs().max(threshold.map_or(0.0, f64::abs));
    (a - b).abs() <= ROUNDING * scale
}

/// The expectation instead of a solution that a report lists twice.
pub const LISTED_BEFORE: &str = "a solution that is not listed before";

/// The same with a given evaluation: `evaluate` returns F, or what it expected instead of a solution that is not one or is
/// listed twice.
pub fn solutions_by(
    report: &RunReport,
    threshold: f64,
    mut evaluate: impl FnMut(&FoundSolution) -> Result<f64, String>,
) -> Vec<Mismatch> {
    let mut mismatches = Vec::new();
    if report.threshold != threshold.is_finite().then_some(threshold) {
        mismatches.push(Mismatch::new(
            "threshold",
            super::shown(report.threshold),
            threshold,
        ));
    }
    for (index, listed) in report.solutions.iter().enumerate() {
        let place = |part: &str| format!("solutions[{index}].{part}");
        let fitness = match evaluate(listed) {
            Ok(fitness) => fitness,
            Err(expected) => {
                mismatches.push(Mismatch::new(place("solution"), &listed.solution, expected));
                continue;
            }
        };
        if !(fitness.is_finite() && fitness < threshold) {
            let found = format!("{} with F = {fitness}", listed.solution);
            mismatches.push(Mismatch::new(
                place("solution"),
                found,
                format!("F < {threshold}"),
            ));
        }
        if !agree(fitness, listed.fitness, report.threshold) {
            mismatches.push(Mismatch::new(place("fitness"), listed.fitness, fitness));
        }
    }
    mismatches
}

/// Whether a solution is within the bounds, where the problem can encode it.
fn is_inside<P: SatisficingProblem + ?Sized>(problem: &P, solution: &P::Solution) -> bool {
    let axes = problem.space().axes();
    let mut values = vec![P::Scalar::default(); axes.len()];
    !problem
        .encoding()
        .is_some_and(|encoding| encoding.encode(solution, &mut values))
        || axes.iter().zip(&values).all(|(axis, &value)| {
            let whole = !axis.is_integer() || axis.value(value) == value;
            (axis.lower()..=axis.upper()).contains(&value) && whole
        })
}
