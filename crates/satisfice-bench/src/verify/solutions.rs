//! Every solution of a record, decoded and evaluated by the problem itself.

use std::panic::{AssertUnwindSafe, catch_unwind};

use satisfice::{Archive, Real, SatisficingProblem};
use serde::de::DeserializeOwned;

use super::Mismatch;
use crate::record::Record;

/// Two evaluations of one solution may differ by this much of delta, or of F where that is greater: mathematical
/// functions are rounded differently on different platforms.
const ROUNDING: f64 = 1e-9;

/// Checks that every solution is one of the problem, is a hit, has the fitness that is given, and is listed once.
///
/// Cost: one evaluation and one look-up a solution.
#[must_use]
pub fn solutions<P>(problem: &P, record: &Record) -> Vec<Mismatch>
where
    P: SatisficingProblem,
    P::Solution: DeserializeOwned,
{
    let threshold = problem.threshold().f64();
    let mut mismatches = Vec::new();
    if record.threshold != threshold.is_finite().then_some(threshold) {
        let found = super::shown(record.threshold);
        mismatches.push(Mismatch::new("threshold", found, threshold));
    }
    if record.scalar != P::Scalar::NAME {
        mismatches.push(Mismatch::new("scalar", &record.scalar, P::Scalar::NAME));
    }
    let mut seen = Archive::default();
    for (index, listed) in record.solutions.iter().enumerate() {
        let place = |part: &str| format!("solutions[{index}].{part}");
        let solution = match serde_json::from_value::<P::Solution>(listed.solution.clone()) {
            Ok(solution) => solution,
            Err(error) => {
                mismatches.push(Mismatch::new(place("solution"), &listed.solution, error));
                continue;
            }
        };
        // A file may hold anything, and a problem need not stand what its own `decode` never gives.
        let evaluated = catch_unwind(AssertUnwindSafe(|| {
            is_inside(problem, &solution).then(|| problem.fitness(&solution).f64())
        }));
        match evaluated.ok().flatten() {
            None => {
                let expected = "a solution inside the space of the problem";
                mismatches.push(Mismatch::new(place("solution"), &listed.solution, expected));
                continue;
            }
            Some(fitness) => {
                if !(fitness.is_finite() && fitness < threshold) {
                    let found = format!("{} with F = {fitness}", listed.solution);
                    let expected = format!("F < {threshold}");
                    mismatches.push(Mismatch::new(place("solution"), found, expected));
                }
                let scale = fitness.abs().max(if threshold.is_finite() {
                    threshold.abs()
                } else {
                    0.0
                });
                // Written so that NaN does not pass.
                let agrees = (fitness - listed.fitness).abs() <= ROUNDING * scale;
                if !agrees {
                    mismatches.push(Mismatch::new(place("fitness"), listed.fitness, fitness));
                }
            }
        }
        if !seen.insert(solution, listed.evaluation, listed.seconds) {
            let expected = "a solution that is not listed before";
            mismatches.push(Mismatch::new(place("solution"), &listed.solution, expected));
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
