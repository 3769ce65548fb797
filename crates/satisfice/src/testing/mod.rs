//! For authors of engines and problems: suites that report broken laws, and a comparison of reports.

use core::fmt::Debug;

use crate::report::Report;

mod case;
mod context;
pub mod engine;
pub mod problem;

pub use context::BareContext;

/// A law that was broken.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Violation<L> {
    /// Which one.
    pub law: L,
    /// Where: what was run, or which point was examined.
    pub case: String,
    /// What was seen.
    pub what: String,
}

impl<L: Debug> core::fmt::Display for Violation<L> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{:?} broken on {}: {}", self.law, self.case, self.what)
    }
}

/// The first difference between two reports apart from times; `None` if there is none.
///
/// Under a time budget, traces and counts differ.
#[must_use]
pub fn difference<T: PartialEq + Debug>(a: &Report<T>, b: &Report<T>) -> Option<String> {
    let budget = |r: &Report<T>| {
        (
            r.budget.evaluations,
            r.budget.hits,
            r.budget.patience,
            r.budget.horizon,
            r.budget.time,
        )
    };
    let trace = |r: &Report<T>| -> Vec<_> { r.trace.iter().map(|p| (p.evaluations, p.hits)).collect() };
    differ("problem", &a.problem, &b.problem)
        .or_else(|| differ("engine", &a.engine, &b.engine))
        .or_else(|| differ("scalar", &a.scalar, &b.scalar))
        .or_else(|| differ("seed", &a.seed, &b.seed))
        .or_else(|| differ("slice", &a.slice, &b.slice))
        .or_else(|| differ("budget", &budget(a), &budget(b)))
        .or_else(|| difference_in_hits(a, b, u64::MAX))
        .or_else(|| differ("counts", &a.counts, &b.counts))
        .or_else(|| differ("trace", &trace(a), &trace(b)))
        .or_else(|| differ("sources", &a.sources, &b.sources))
        .or_else(|| differ("stop reason", &a.stop_reason, &b.stop_reason))
        .or_else(|| differ("completeness", &a.completeness, &b.completeness))
}

fn differ<V: PartialEq + Debug>(what: &str, a: &V, b: &V) -> Option<String> {
    (a != b).then(|| format!("{what}: {a:?} and {b:?}"))
}

/// The first difference between the hits of two reports up to an evaluation.
fn difference_in_hits<T: PartialEq + Debug>(a: &Report<T>, b: &Report<T>, until: u64) -> Option<String> {
    let mut hits = [a, b].map(|report| report.hits().take_while(move |hit| hit.evaluation <= until));
    for number in 1.. {
        match hits.each_mut().map(Iterator::next) {
            [None, None] => break,
            [Some(a), Some(b)] if a.solution == b.solution && a.evaluation == b.evaluation => {}
            [a, b] => {
                let show = |hit: Option<crate::Hit<'_, T>>| {
                    hit.map_or_else(
                        || "none".to_owned(),
                        |hit| format!("{:?} at evaluation {}", hit.solution, hit.evaluation),
                    )
                };
                return Some(format!("hit {number}: {} and {}", show(a), show(b)));
            }
        }
    }
    None
}
