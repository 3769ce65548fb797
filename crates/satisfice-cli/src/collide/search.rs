//! The methods that search: an engine on each pair of bodies that can have a hit, with its share of the budget.

use std::sync::Arc;
use std::time::Duration;

use satisfice::report::SourceTrace;
use satisfice::{Cancel, Completeness, Method, Report, SatisficingProblem, StopReason};
use satisfice_catalogue::{Progress, RunControl, RunReport, RunSpec, run};
use serde_json::json;

use super::building;
use super::couples::{Couples, PairProblem, Problems};
use super::exact::capped;
use super::limit::Limit;
use super::pairs::Pairs;
use super::scene::{Measure, World};
use crate::progress::Bar;

/// What an engine found.
pub(super) struct Searched {
    /// The report of all couples together; its solutions, trace and sources are left out.
    pub(super) report: RunReport,
    pub(super) pairs: Pairs,
    /// Pairs of bodies that were not searched because their boxes are farther apart than the threshold.
    pub(super) apart: u64,
}

/// Searches each couple of bodies in turn. What is left of time and evaluations is divided evenly among the couples that are left.
pub(super) fn find(
    world: &Arc<World>,
    spec: &RunSpec,
    witnesses: bool,
    cancel: &Cancel,
) -> anyhow::Result<Searched> {
    let limit = Limit::new(spec.budget.time, cancel);
    let pairs = Pairs {
        witnesses: witnesses.then(Vec::new),
        found: Some(Vec::new()),
        ..Pairs::default()
    };
    let mut search = CoupleSearch {
        world,
        spec,
        limit: &limit,
        pairs,
        report: nothing(spec)?,
        searched: 0,
    };
    let (built, world) = (Arc::clone(world), Arc::clone(world));
    let build = move || -> anyhow::Result<(Measure, Couples)> {
        let mut measure = built.measure()?;
        let couples = Couples::of(&built, &mut measure)?;
        Ok((measure, couples))
    };
    let found = building::within_limit(world.features(), || limit.is_reached(), build)?;
    let (apart, is_whole) = match found.transpose()? {
        Some((measure, couples)) => {
            let is_whole = search.all(&measure, &couples.near, cancel)?;
            (couples.apart, is_whole)
        }
        None => {
            search.report.stop_reason = limit.reason();
            (0, false)
        }
    };
    if search.report.stop_reason != StopReason::Covered && search.report.counts.evaluations == 0 {
        building::say_nothing_compared("the features of the meshes were still being put in order");
    }
    let (report, pairs) = search.ended(is_whole);
    Ok(Searched { report, pairs, apart })
}

/// The report of a search through nothing, which has found all there is.
fn nothing(spec: &RunSpec) -> anyhow::Result<RunReport> {
    // Threads do not change a report, and JSON does not keep them.
    let spec = RunSpec {
        threads: 1,
        ..spec.clone().complete()?
    };
    let none: [Report<(u32, u32)>; 0] = [];
    Ok(RunReport {
        stop_reason: StopReason::Covered,
        completeness: Completeness::Proved,
        unseen_estimate: Some(0.0),
        unseen_interval: Some((0.0, Some(0.0))),
        unseen_confidence: Some(1.0),
        unseen_method: Some(Method::Proved),
        ..RunReport::of_slices(spec, &none, serde_json::to_value)?
    })
}

/// A search through couples.
struct CoupleSearch<'a> {
    world: &'a Arc<World>,
    spec: &'a RunSpec,
    limit: &'a Limit<'a>,
    pairs: Pairs,
    report: RunReport,
    /// The couples that were searched.
    searched: usize,
}

impl CoupleSearch<'_> {
    /// Searches the couples in turn until a limit ends it. Returns whether all were searched.
    fn all(&mut self, measure: &Measure, couples: &[[usize; 2]], cancel: &Cancel) -> anyhow::Result<bool> {
        let bar = Bar::new();
        let mut problems = Problems::new(self.world, couples);
        let parts = couples.len() as u64;
        for (part, &bodies) in (0..).zip(couples) {
            let evaluations = self.evaluations(parts - part);
            if evaluations == Some(0) {
                self.report.stop_reason = StopReason::Evaluations;
                return Ok(false);
            }
            let job = match self.limit.is_reached() {
                true => None,
                false => problems.next(bodies, self.limit)?,
            };
            let Some(job) = job else {
                self.report.stop_reason = self.limit.reason();
                return Ok(false);
            };
            let mut share = self.spec.clone();
            share.budget.evaluations = evaluations;
            let couples_left = u32::try_from(parts - part).unwrap_or(u32::MAX);
            share.budget.time = self
                .limit
                .left()
                .map(|left| (left / couples_left).max(Duration::from_nanos(1)));
            share.budget.hits = self.spec.budget.hits.map(|wanted| wanted - self.report.hits);
            let mut watch = |progress: &Progress| bar.show(progress, part, parts);
            let control = RunControl {
                watch: Some(&mut watch),
                ..RunControl::until(cancel)
            };
            let begun = self.limit.elapsed();
            let report = run(&job.problem, share, control)?;
            let stop = report.stop_reason;
            self.add(&job, measure, report, begun)?;
            if matches!(stop, StopReason::Cancelled | StopReason::Hits) {
                return Ok(part + 1 == parts);
            }
        }
        Ok(true)
    }

    /// The share of the next one of so many couples, 0 where nothing is left; `None` where evaluations are not limited.
    fn evaluations(&self, couples: u64) -> Option<u64> {
        let total = self.spec.budget.evaluations?;
        let left = total.saturating_sub(self.report.counts.evaluations);
        Some(left.div_ceil(couples))
    }

    /// Adds what was found by a run that began at this time.
    fn add(
        &mut self,
        job: &PairProblem,
        measure: &Measure,
        mut report: RunReport,
        begun: Duration,
    ) -> anyhow::Result<()> {
        let threshold = self.world.request.threshold;
        let (evaluations, seconds) = (self.report.counts.evaluations, begun.as_secs_f64());
        for solution in report.solutions.drain(..) {
            let pair = job.pair(serde_json::from_value(solution.solution)?);
            // As the exact methods give it: to the last digit, where F has ten.
            let near = measure.proximity(&pair)?;
            self.pairs.pairs.push(pair);
            self.pairs.distances.push(capped(near.distance, threshold));
            if let Some(witnesses) = &mut self.pairs.witnesses {
                witnesses.push(Some(near));
            }
            if let Some(found) = &mut self.pairs.found {
                found.push((evaluations + solution.evaluation, seconds + solution.seconds));
            }
        }
        if let Some(best) = &mut report.best {
            let pair = serde_json::from_value(best.solution.take())?;
            let pair = job.pair(job.problem.canonical(&pair).unwrap_or(pair));
            best.solution = json!(pair);
            if best.fitness < threshold {
                best.fitness = capped(measure.proximity(&pair)?.distance, threshold);
            }
        }
        // They would take memory for every couple, and no report of a scene has them.
        report.trace = Vec::new();
        report.sources = SourceTrace::default();
        match self.searched {
            0 => self.report = report,
            _ => self.report.append(report),
        }
        self.searched += 1;
        Ok(())
    }

    /// The report and the pairs at the end of all.
    fn ended(self, is_whole: bool) -> (RunReport, Pairs) {
        let elapsed = self.limit.elapsed();
        let mut report = self.report;
        report.spec.budget = self.spec.budget;
        report.elapsed_seconds = elapsed.as_secs_f64();
        report.overshoot_seconds = self.limit.late(elapsed).as_secs_f64();
        if !is_whole {
            report.completeness = Completeness::Unknown;
            report.unseen_estimate = None;
            report.unseen_interval = None;
            report.unseen_confidence = None;
            report.unseen_method = None;
        }
        (report, self.pairs)
    }
}
