//! Every solution of a report, decoded and evaluated by the problem itself.

use std::panic::{AssertUnwindSafe, catch_unwind};

use satisfice::{Archive, Real, SatisficingProblem};
use serde::de::DeserializeOwned;

use super::Mismatch;
use crate::report::{RunReport, Solution};

/// Two evaluations of one solution may differ by this much of delta, or of F where that is greater: mathematical
/// functions are rounded differently on different platforms.
const ROUNDING: f64 = 1e-9;

/// Checks that every solution is one of the problem, is a hit, has the fitness that is given, and is listed once.
///
/// Cost: one evaluation and one look-up a solution.
#[must_use]
pub fn solutions<P>(problem: &P, report: &RunReport) -> Vec<Mismatch>
where
    P: SatisficingProblem,
    P::Solution: DeserializeOwned,
{
    let mut mismatches = Vec::new();
    if report.scalar != P::Scalar::NAME {
        mismatches.push(Mismatch::new("scalar", &report.scalar, P::Scalar::NAME));
    }
    let mut seen = Archive::default();
    mismatches.extend(solutions_by(report, problem.threshold().f64(), |listed| {
        let solution: P::Solution =
            serde_json::from_value(listed.solution.clone()).map_err(|error| error.to_string())?;
        // A file may hold anything, and a problem need not stand what its own `decode` never gives.
        let evaluated = catch_unwind(AssertUnwindSafe(|| {
            is_inside(problem, &solution).then(|| problem.fitness(&solution).f64())
        }));
        let fitness = evaluated
            .ok()
            .flatten()
            .ok_or("a solution inside the space of the problem")?;
        if seen.insert(solution, listed.evaluation, listed.seconds) {
            Ok(fitness)
        } else {
            Err(LISTED_BEFORE.to_owned())
        }
    }));
    mismatches
}

/// What is expected of a solution that stands in a report for the second time.
pub const LISTED_BEFORE: &str = "a solution that is not listed before";

/// The same where the evaluation is given: `evaluate` returns F, or what it had expected of a solution that is none or is
/// listed twice.
pub fn solutions_by(
    report: &RunReport,
    threshold: f64,
    mut evaluate: impl FnMut(&Solution) -> Result<f64, String>,
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
        let scale = if threshold.is_finite() {
            fitness.abs().max(threshold.abs())
        } else {
            fitness.abs()
        };
        // Written so that NaN does not pass.
        let agrees = (fitness - listed.fitness).abs() <= ROUNDING * scale;
        if !agrees {
            mismatches.push(Mismatch::new(place("fitness"), listed.fitness, fitness));
        }
    }
    mismatches
}

/// Whether a solution is within the bounds, where the problem can say at which values it is.
fn is_inside<P: SatisficingProblem>(problem: &P, solution: &P::Solution) -> bool {
    let axes = problem.space().axes();
    let mut values = vec![P::Scalar::default(); axes.len()];
    !problem.encode(solution, &mut values)
        || axes.iter().zip(&values).all(|(axis, &value)| {
            (axis.lower()..=axis.upper()).contains(&value) && axis.value(value) == value
        })
}
