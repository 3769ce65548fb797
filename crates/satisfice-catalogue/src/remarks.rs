//! What a run tells its user beside the report: options that changed little.

use crate::spec::RunSpec;

/// The note for runs in which several threads had little to share.
pub(crate) fn idle_threads(spec: &RunSpec, calls: u64, shared: u64) -> Option<String> {
    let idle = spec.threads != 1 && spec.islands == 1 && calls > 0 && shared < calls / 2;
    idle.then(|| {
        format!(
            "threads shared {shared} of {calls} calls of the fitness: the batches of {} are too small for them, or the fitness \
             is too cheap; islands run several engines side by side",
            spec.engine
        )
    })
}

/// The note for runs of so many evaluations of which few were proposed as many at a time as
/// [`Budget::parallel`](satisfice::Budget::parallel) asks for: `full`.
#[must_use]
pub fn small_batches(spec: &RunSpec, evaluations: u64, full: u64) -> Option<String> {
    let wanted = spec.budget.parallel?;
    let is_short = spec.islands == 1 && full < evaluations / 2 && evaluations >= 2 * wanted as u64;
    is_short.then(|| {
        format!(
            "{} proposed {full} of {evaluations} points at least {wanted} at a time, as --parallel asks: its \
             other batches are smaller; islands run several engines side by side",
            spec.engine
        )
    })
}
