//! The JSON form of a run: what it did and found, of one slice or several.

use serde::{Deserialize, Serialize};

use super::{Completeness, Counts, Report, SourceTrace, TracePoint};
use crate::archive::Archive;
use crate::best::Best;
use crate::budget::StopReason;
use crate::identity::Identity;
use crate::unseen::{Method, Unseen};

/// The report of a run, as plain data: the JSON of a [`Report`], of the command's `--json`, of sweeps and of `verify`.
///
/// `Spec` says what was run; its keys come first. `S` is a solution. Everything but times is the same for the same
/// specification under a budget of evaluations.
///
/// ```
/// use satisfice::{from_fn, Budget, RunReport, Search, Space};
/// let problem = from_fn(Space::lattice(2, 50)?, 3.0, |x: &[f64]| x[0] + x[1]);
/// let (mut search, budget) = (Search::new(), Budget::evaluations(2_000));
/// let slices = [search.run(&problem, &budget)?, search.run(&problem, &budget)?];
/// let run = RunReport::of_slices((), &slices, |hit| Ok::<_, satisfice::Error>(hit.clone()))?;
/// assert_eq!((run.hits, run.counts.evaluations), (6, 4_000));
/// assert_eq!(run.slices[1].new_hits, 0);
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunReport<Spec, S> {
    /// The specification, with all parameters.
    #[serde(flatten)]
    pub spec: Spec,
    /// `f32` or `f64`.
    pub scalar: String,
    /// delta: a hit is F < delta. `null` where it is infinite.
    pub threshold: Option<f64>,
    /// The share of the evaluations spent on uniform probes.
    pub probe_share: f64,
    /// The counts, summed over the slices.
    #[serde(flatten)]
    pub counts: Counts,
    /// Evaluations that gave no value: a program that failed, an exception that was caught. They are non-finite as well, and
    /// nothing is proved with them: see [`set_failed`](RunReport::set_failed).
    #[serde(default, skip_serializing_if = "is_zero")]
    pub failed: u64,
    /// Wall time in seconds, summed over the slices.
    pub elapsed_seconds: f64,
    /// The time beyond the time budget, in seconds, summed over the slices.
    pub overshoot_seconds: f64,
    /// Why the last slice ended.
    pub stop_reason: StopReason,
    /// The message of the problem's panic, if that ended it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub panic: Option<String>,
    /// The number of distinct hits, of all slices together.
    pub hits: u64,
    /// The number of all hits of the problem, where it is known.
    pub reference_hits: Option<u64>,
    /// `hits / reference_hits`, where that is known and not 0 / 0.
    pub recall: Option<f64>,
    /// Whether all hits are known to be listed.
    pub completeness: Completeness,
    /// The estimated number of hits not seen; 0 if completeness is proved, `null` where nothing was probed.
    pub unseen_estimate: Option<f64>,
    /// Its interval; no upper end where nothing bounds it.
    pub unseen_interval: Option<(f64, Option<f64>)>,
    /// The least probability with which the interval contains the true number.
    pub unseen_confidence: Option<f64>,
    /// The method of estimation.
    pub unseen_method: Option<Method>,
    /// Interval for the share of the space whose points are hits that the engine has not found, of the last slice.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unseen_mass: Option<(f64, f64)>,
    /// Probes of the last slice that hit what the engine had found, and probes that hit what it had not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub probe_hits: Option<(u64, u64)>,
    /// The least fitness of all slices, and where; `null` if no fitness was finite or none is known but that of the hits.
    /// Its evaluation is counted over all slices.
    #[serde(default = "Option::default")]
    pub best: Option<Best<S>>,
    /// Distinct hits against evaluations and time, over all slices.
    pub trace: Vec<TracePoint>,
    /// What the sources of the engine proposed and found, over all slices, for an engine that has several.
    #[serde(default, skip_serializing_if = "SourceTrace::is_empty")]
    pub sources: SourceTrace,
    /// The slices one by one, where several were asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub slices: Vec<SliceReport>,
    /// The hits, in the order found.
    pub solutions: Vec<FoundSolution<S>>,
    /// Version of the framework.
    pub version: String,
}

/// One slice of several.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SliceReport {
    /// The counts.
    #[serde(flatten)]
    pub counts: Counts,
    /// Wall time in seconds.
    pub elapsed_seconds: f64,
    /// The time beyond the time budget, in seconds.
    pub overshoot_seconds: f64,
    /// Why it ended.
    pub stop_reason: StopReason,
    /// |C|: the distinct hits of this slice.
    pub hits: u64,
    /// The number of them that no earlier slice had found.
    pub new_hits: u64,
    /// Whether it proved that all hits are listed.
    pub completeness: Completeness,
}

/// One hit of a [`RunReport`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FoundSolution<S> {
    /// The hit.
    pub solution: S,
    /// F of it.
    pub fitness: f64,
    /// The evaluation that found it, counted from 1 over all slices.
    pub evaluation: u64,
    /// When, in seconds of running time over all slices.
    pub seconds: f64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_zero(count: &u64) -> bool {
    *count == 0
}

/// Tells new hits from those of slices before.
trait Known<T> {
    /// Whether this hit is new.
    fn enter(&mut self, solution: &T) -> bool;
}

/// The hits of one slice are distinct.
struct OneSlice;

impl<T> Known<T> for OneSlice {
    fn enter(&mut self, _: &T) -> bool {
        true
    }
}

impl<T: Identity + Clone> Known<T> for Archive<T> {
    fn enter(&mut self, solution: &T) -> bool {
        self.insert(solution.clone(), 0.0, 0, 0.0)
    }
}

impl<Spec, S> RunReport<Spec, S> {
    /// The slices of one search, in their order, as one run, with each solution as `form` writes it. Each hit stands at the
    /// evaluation and time that found it first, counted from the start of the first slice. Cost: linear in the hits of all
    /// slices.
    ///
    /// # Errors
    /// The first that `form` returns.
    pub fn of_slices<'a, T: Identity + Clone, E>(
        spec: Spec,
        reports: &'a [Report<T>],
        form: impl FnMut(&'a T) -> Result<S, E>,
    ) -> Result<Self, E> {
        Self::unite(spec, reports, &mut Archive::default(), form)
    }

    /// One slice as a run, which lists no slices.
    pub(super) fn of_slice<'a, T, E>(
        spec: Spec,
        report: &'a Report<T>,
        form: impl FnMut(&'a T) -> Result<S, E>,
    ) -> Result<Self, E> {
        let run = Self::unite(spec, core::slice::from_ref(report), &mut OneSlice, form)?;
        Ok(Self {
            slices: Vec::new(),
            ..run
        })
    }

    fn unite<'a, T, E>(
        spec: Spec,
        reports: &'a [Report<T>],
        known: &mut impl Known<T>,
        mut form: impl FnMut(&'a T) -> Result<S, E>,
    ) -> Result<Self, E> {
        let mut run = Self::new(spec);
        for report in reports {
            run.add_slice(report, known, &mut form)?;
        }
        if let Some(first) = reports.first() {
            run.scalar.clone_from(&first.scalar);
            run.threshold = first.threshold;
            run.probe_share = first.probe_share;
            run.version.clone_from(&first.version);
        }
        if let Some(last) = reports.last() {
            run.stop_reason = last.stop_reason;
            run.panic.clone_from(&last.panic);
            // A slice that has covered the space is the last one.
            run.completeness = last.completeness;
            // Two hits of the last slice may both be the same as one of an earlier slice: it then has more than the run.
            let elsewhere = run.hits.saturating_sub(last.hit_count() as u64);
            run.set_unseen(last.unseen.as_ref(), elsewhere);
        }
        Ok(run)
    }

    fn add_slice<'a, T, E>(
        &mut self,
        report: &'a Report<T>,
        known: &mut impl Known<T>,
        form: &mut impl FnMut(&'a T) -> Result<S, E>,
    ) -> Result<(), E> {
        let (before, seconds, hits) = (self.counts.evaluations, self.elapsed_seconds, self.hits);
        for hit in report.hits() {
            if known.enter(hit.solution) {
                self.solutions.push(FoundSolution {
                    solution: form(hit.solution)?,
                    fitness: hit.fitness,
                    evaluation: before + hit.evaluation,
                    seconds: seconds + hit.seconds,
                });
            }
        }
        self.hits = self.solutions.len() as u64;
        self.sources.append(&report.sources, before);
        let solutions = &self.solutions;
        self.trace.extend(report.trace.iter().map(|point| {
            let evaluations = before + point.evaluations;
            TracePoint {
                evaluations,
                elapsed_seconds: seconds + point.elapsed_seconds,
                hits: solutions.partition_point(|found| found.evaluation <= evaluations) as u64,
            }
        }));
        if let Some(best) = report.best()
            && self
                .best
                .as_ref()
                .is_none_or(|least| best.fitness < least.fitness)
        {
            self.best = Some(Best {
                solution: form(&best.solution)?,
                fitness: best.fitness,
                evaluation: before + best.evaluation,
            });
        }
        let slice = SliceReport {
            counts: report.counts,
            elapsed_seconds: report.elapsed.as_secs_f64(),
            overshoot_seconds: report.overshoot.as_secs_f64(),
            stop_reason: report.stop_reason,
            hits: report.hit_count() as u64,
            new_hits: self.hits - hits,
            completeness: report.completeness,
        };
        self.counts += slice.counts;
        self.elapsed_seconds += slice.elapsed_seconds;
        self.overshoot_seconds += slice.overshoot_seconds;
        self.slices.push(slice);
        Ok(())
    }

    /// Enters the number of hits estimated to be missing from the last archive, when `found_elsewhere` further hits are listed.
    #[expect(clippy::cast_precision_loss, reason = "an estimate")]
    fn set_unseen(&mut self, unseen: Option<&Unseen>, found_elsewhere: u64) {
        // The estimated total stays the same: hits listed beyond the archive are no longer missing.
        let less = |missing: f64| (missing - found_elsewhere as f64).max(0.0);
        self.unseen_estimate = unseen.map(|unseen| less(unseen.estimate));
        self.unseen_interval = unseen.map(|Unseen { interval: (a, b), .. }| (less(*a), b.map(less)));
        self.unseen_confidence = unseen.map(|unseen| unseen.confidence);
        self.unseen_method = unseen.map(|unseen| unseen.method);
        self.unseen_mass = unseen.map(|unseen| unseen.mass);
        self.probe_hits = unseen.map(|unseen| (unseen.recaptures, unseen.fresh));
    }

    /// The report of a run that has found nothing yet.
    #[must_use]
    pub fn new(spec: Spec) -> Self {
        Self {
            spec,
            scalar: "f64".to_owned(),
            threshold: None,
            probe_share: 0.0,
            counts: Counts::default(),
            failed: 0,
            elapsed_seconds: 0.0,
            overshoot_seconds: 0.0,
            stop_reason: StopReason::Exhausted,
            panic: None,
            hits: 0,
            reference_hits: None,
            recall: None,
            completeness: Completeness::Unknown,
            unseen_estimate: None,
            unseen_interval: None,
            unseen_confidence: None,
            unseen_method: None,
            unseen_mass: None,
            probe_hits: None,
            best: None,
            trace: Vec::new(),
            sources: SourceTrace::default(),
            slices: Vec::new(),
            solutions: Vec::new(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        }
    }

    /// The report of a method that has all its hits when it ends, after this many evaluations and seconds: every hit is
    /// listed with them, and the trace is one point.
    #[must_use]
    pub fn at_once(
        spec: Spec,
        threshold: f64,
        hits: impl IntoIterator<Item = (S, f64)>,
        (evaluations, seconds): (u64, f64),
    ) -> Self
    where
        S: Clone,
    {
        let listed = hits.into_iter().map(|(solution, fitness)| FoundSolution {
            solution,
            fitness,
            evaluation: evaluations,
            seconds,
        });
        let solutions: Vec<FoundSolution<S>> = listed.collect();
        let hits = solutions.len() as u64;
        let best = solutions.iter().min_by(|a, b| a.fitness.total_cmp(&b.fitness));
        Self {
            threshold: Some(threshold),
            counts: Counts {
                evaluations,
                fitness_calls: evaluations,
                ..Counts::default()
            },
            elapsed_seconds: seconds,
            hits,
            trace: vec![TracePoint {
                evaluations,
                elapsed_seconds: seconds,
                hits,
            }],
            best: best.map(|best| Best {
                solution: best.solution.clone(),
                fitness: best.fitness,
                evaluation: best.evaluation,
            }),
            solutions,
            ..Self::new(spec)
        }
    }

    /// Enters that all hits are listed.
    pub fn set_proved(&mut self) {
        self.completeness = Completeness::Proved;
        self.unseen_estimate = Some(0.0);
        self.unseen_interval = Some((0.0, Some(0.0)));
        self.unseen_confidence = Some(1.0);
        self.unseen_method = Some(Method::Proved);
    }

    /// Enters how many evaluations gave no value. Each of them may have been a hit, so that nothing is proved if there is one.
    pub fn set_failed(&mut self, failed: u64) {
        self.failed = failed;
        if failed == 0 {
            return;
        }
        self.completeness = Completeness::Unknown;
        for slice in &mut self.slices {
            slice.completeness = Completeness::Unknown;
        }
        if self.unseen_method == Some(Method::Proved) {
            self.set_unseen(None, 0);
        }
    }

    /// Enters the number of all hits, and the recall that follows.
    pub fn set_reference(&mut self, reference: Option<u64>) {
        self.reference_hits = reference;
        self.recall = reference.and_then(|reference| recall(self.hits, reference));
    }

    /// Adds the report of a run on another problem, whose solutions are all different, as if it had followed this one.
    pub fn append(&mut self, next: Self) {
        let (evaluations, seconds, hits) = (self.counts.evaluations, self.elapsed_seconds, self.hits);
        self.sources.append(&next.sources, evaluations);
        self.trace.extend(next.trace.into_iter().map(|point| TracePoint {
            evaluations: evaluations + point.evaluations,
            elapsed_seconds: seconds + point.elapsed_seconds,
            hits: hits + point.hits,
        }));
        self.solutions
            .extend(next.solutions.into_iter().map(|found| FoundSolution {
                evaluation: evaluations + found.evaluation,
                seconds: seconds + found.seconds,
                ..found
            }));
        let next_best = next.best.map(|best| Best {
            evaluation: evaluations + best.evaluation,
            ..best
        });
        self.best = [self.best.take(), next_best]
            .into_iter()
            .flatten()
            .min_by(|a, b| a.fitness.total_cmp(&b.fitness));
        self.counts += next.counts;
        self.failed += next.failed;
        self.elapsed_seconds += next.elapsed_seconds;
        self.overshoot_seconds += next.overshoot_seconds;
        self.stop_reason = next.stop_reason;
        self.panic = next.panic;
        self.hits += next.hits;
        if next.completeness == Completeness::Unknown {
            self.completeness = Completeness::Unknown;
        }
        self.unseen_estimate = self.unseen_estimate.zip(next.unseen_estimate).map(|(a, b)| a + b);
        self.unseen_interval = self
            .unseen_interval
            .zip(next.unseen_interval)
            .map(|((a, b), (c, d))| (a + c, b.zip(d).map(|(b, d)| b + d)));
        // Both intervals contain the true number at once at least this often.
        self.unseen_confidence = self
            .unseen_confidence
            .zip(next.unseen_confidence)
            .map(|(a, b)| (a + b - 1.0).max(0.0));
        if self.unseen_method == Some(Method::Proved) || next.unseen_method.is_none() {
            self.unseen_method = next.unseen_method;
        }
        // Shares of two spaces do not add up.
        self.unseen_mass = None;
        self.probe_hits = self
            .probe_hits
            .zip(next.probe_hits)
            .map(|(a, b)| (a.0 + b.0, a.1 + b.1));
        let reference = self.reference_hits.zip(next.reference_hits).map(|(a, b)| a + b);
        self.set_reference(reference);
    }
}

/// `hits / reference`, `None` for a reference of 0.
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "a share")]
pub fn recall(hits: u64, reference: u64) -> Option<f64> {
    (reference > 0).then(|| hits as f64 / reference as f64)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use std::sync::Arc;

    use super::*;
    use crate::{Axis, Budget, Search, Space, from_fn};

    /// Two hits apart may both be within the separation of a third.
    #[test]
    fn a_slice_with_more_hits_than_the_run_lists_leaves_none_elsewhere() {
        let space = Space::new([Axis::continuous(0.0, 1.0)]).unwrap();
        let problem = from_fn(space, 0.9, |x: &[f64]| x[0]).separation(0.05);
        let mut search = Search::new().probes(0.2);
        let budget = Budget::evaluations(200);
        let mut slices = [
            search.run(&problem, &budget).unwrap(),
            search.run(&problem, &budget).unwrap(),
        ];
        let any = slices[0].hits().next().unwrap().solution.clone();
        for (slice, places) in slices.iter_mut().zip([&[0.5][..], &[0.46, 0.54]]) {
            let mut archive = Archive::default();
            for &place in places {
                let mut hit = any.clone();
                hit.coordinates = vec![place];
                assert!(archive.insert(hit, place, 1, 0.0));
            }
            slice.archive = Arc::new(archive);
        }
        let unseen = slices[1].unseen.as_ref().unwrap().estimate;
        let run = RunReport::of_slices((), &slices, |hit| Ok::<_, crate::Error>(hit.clone())).unwrap();
        assert_eq!((run.hits, run.slices[1].hits, run.slices[1].new_hits), (1, 2, 0));
        assert_eq!(run.unseen_estimate, Some(unseen));
    }
}
