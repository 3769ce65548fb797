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

/// The first difference between two reports; `None` if there is none.
///
/// Everything is compared but times, which no two runs share: `elapsed`, `overshoot`, and the seconds of hits and of the trace. The
/// cancellation of the budget is no part of what was run. Under a time budget, traces and counts differ.
#[must_use]
pub fn difference<T: PartialEq + Debug>(a: &Report<T>, b: &Report<T>) -> Option<String> {
    let budget = |r: &Report<T>| {
        (
            r.budget.evaluations,
            r.budget.hits,
            r.budget.patience,
            r.budget.horizon,
            r.budget.time,
            r.budget.parallel,
        )
    };
    let probe_shares = |r: &Report<T>| (r.requested_probe_share, r.probe_share);
    let trace = |r: &Report<T>| -> Vec<_> { r.trace.iter().map(|p| (p.evaluations, p.hits)).collect() };
    differ("problem", &a.problem, &b.problem)
        .or_else(|| differ("engine", &a.engine, &b.engine))
        .or_else(|| differ("scalar", &a.scalar, &b.scalar))
        .or_else(|| differ("seed", &a.seed, &b.seed))
        .or_else(|| differ("islands", &a.islands, &b.islands))
        .or_else(|| differ("slice", &a.slice, &b.slice))
        .or_else(|| differ("budget", &budget(a), &budget(b)))
        .or_else(|| differ("threshold", &a.threshold, &b.threshold))
        .or_else(|| differ("probe share", &probe_shares(a), &probe_shares(b)))
        .or_else(|| difference_in_hits(a, b, u64::MAX))
        .or_else(|| differ("best", &a.best, &b.best))
        .or_else(|| differ("counts", &a.counts, &b.counts))
        .or_else(|| differ("trace", &trace(a), &trace(b)))
        .or_else(|| differ("sources", &a.sources, &b.sources))
        .or_else(|| differ("stop reason", &a.stop_reason, &b.stop_reason))
        .or_else(|| differ("panic", &a.panic, &b.panic))
        .or_else(|| differ("completeness", &a.completeness, &b.completeness))
        .or_else(|| differ("unseen", &a.unseen, &b.unseen))
        .or_else(|| differ("version", &a.version, &b.version))
}

fn differ<V: PartialEq + Debug>(what: &str, a: &V, b: &V) -> Option<String> {
    (a != b).then(|| format!("{what}: {a:?} and {b:?}"))
}

/// The first difference between the hits of two reports up to an evaluation.
fn difference_in_hits<T: PartialEq + Debug>(a: &Report<T>, b: &Report<T>, until: u64) -> Option<String> {
    let same = |a: &crate::Hit<'_, T>, b: &crate::Hit<'_, T>| {
        a.solution == b.solution && a.fitness == b.fitness && a.evaluation == b.evaluation
    };
    let mut hits = [a, b].map(|report| report.hits().take_while(move |hit| hit.evaluation <= until));
    for number in 1.. {
        match hits.each_mut().map(Iterator::next) {
            [None, None] => break,
            [Some(a), Some(b)] if same(&a, &b) => {}
            [a, b] => {
                let show = |hit: Option<crate::Hit<'_, T>>| {
                    hit.map_or_else(
                        || "none".to_owned(),
                        |hit| {
                            let (solution, fitness) = (hit.solution, hit.fitness);
                            format!("{solution:?} with F = {fitness} at evaluation {}", hit.evaluation)
                        },
                    )
                };
                return Some(format!("hit {number}: {} and {}", show(a), show(b)));
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use core::time::Duration;
    use std::sync::Arc;

    use super::difference;
    use crate::{Archive, Budget, Completeness, Located, Report, Search, Space, StopReason, from_fn};

    /// A change of a report.
    type Change = fn(&mut Report<Located<f64>>);

    fn report(shift: f64) -> Report<Located<f64>> {
        let sum = move |x: &[f64]| x[0] + x[1] + shift;
        let problem = from_fn(Space::lattice(2, 50).unwrap(), 3.0, sum).boxed();
        let mut search = Search::new().probes(0.2);
        search.run(&problem, &Budget::evaluations(400)).unwrap()
    }

    #[test]
    fn reports_differ_by_everything_but_times() {
        let report = report(0.0);
        assert!(report.hit_count() > 1 && report.unseen.is_some() && !report.trace.is_empty());
        let changes: [(&str, Change); 23] = [
            ("problem", |r| r.problem.name.push('x')),
            ("engine", |r| r.engine.parameters.clear()),
            ("scalar", |r| r.scalar = "f32".into()),
            ("seed", |r| r.seed += 1),
            ("islands", |r| r.islands += 1),
            ("slice", |r| r.slice += 1),
            ("budget", |r| r.budget.parallel = Some(7)),
            ("budget", |r| r.budget.patience = Some(7)),
            ("threshold", |r| r.threshold = None),
            ("probe share", |r| r.probe_share += 0.1),
            ("probe share", |r| r.requested_probe_share = None),
            ("hit 1", |r| r.archive = Arc::default()),
            ("hit 1", |r| {
                let mut other = Archive::default();
                for hit in r.hits() {
                    other.insert(
                        hit.solution.clone(),
                        hit.fitness - 0.5,
                        hit.evaluation,
                        hit.seconds,
                    );
                }
                r.archive = Arc::new(other);
            }),
            ("best", |r| r.best = None),
            ("best", |r| r.best.as_mut().unwrap().fitness -= 0.5),
            ("counts", |r| r.counts.duplicates += 1),
            ("trace", |r| r.trace[0].hits += 1),
            ("sources", |r| r.sources = crate::SourceTrace::default()),
            ("stop reason", |r| r.stop_reason = StopReason::Observer),
            ("panic", |r| r.panic = Some("no".into())),
            ("completeness", |r| r.completeness = Completeness::Proved),
            ("unseen", |r| r.unseen = None),
            ("version", |r| r.version.push('x')),
        ];
        for (what, change) in changes {
            let mut other = report.clone();
            change(&mut other);
            for found in [difference(&report, &other), difference(&other, &report)] {
                assert!(
                    found.as_ref().is_some_and(|found| found.starts_with(what)),
                    "{what}: {found:?}"
                );
            }
        }
    }

    #[test]
    fn times_are_no_difference() {
        let report = report(0.0);
        let mut other = report.clone();
        other.elapsed += Duration::from_secs(1);
        other.overshoot += Duration::from_secs(1);
        other.trace[0].elapsed_seconds += 1.0;
        let mut later = Archive::default();
        for hit in report.hits() {
            later.insert(
                hit.solution.clone(),
                hit.fitness,
                hit.evaluation,
                hit.seconds + 1.0,
            );
        }
        other.archive = Arc::new(later);
        assert_eq!(difference(&report, &other), None);
    }

    #[test]
    fn another_fitness_is_another_report() {
        assert_eq!(difference(&report(0.0), &report(0.0)), None);
        assert!(difference(&report(0.0), &report(-0.5)).is_some());
    }
}
