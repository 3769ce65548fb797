//! The methods that search: an engine on each pair of bodies, with its share of the budget.

use std::time::Duration;

use anyhow::bail;
use satisfice::{Cancel, SatisficingProblem, StopReason};
use satisfice_catalogue::{Limits, Progress, RunControl, RunReport, RunSpec, run};
use serde_json::json;

use super::exact::capped;
use super::pairs::Pairs;
use super::scene::World;
use crate::progress::Bar;

/// Searches each combination of bodies in turn. Time and evaluations are divided evenly. The solutions of the report are
/// moved into the pairs.
pub(super) fn find(
    world: &World,
    spec: &RunSpec,
    witnesses: bool,
    cancel: &Cancel,
) -> anyhow::Result<(RunReport, Pairs)> {
    // Combinations without any pair must not take time from the others.
    let all_jobs = world.jobs()?;
    let mut jobs: Vec<_> = all_jobs.iter().filter(|job| job.problem.has_pairs()).collect();
    if jobs.is_empty() {
        jobs = all_jobs.iter().collect();
    }
    let parts = jobs.len() as u64;
    let measure = world.measure()?;
    let bar = Bar::new();
    let mut pairs = Pairs {
        witnesses: witnesses.then(Vec::new),
        found: Some(Vec::new()),
        ..Pairs::default()
    };
    let mut all: Option<RunReport> = None;
    for (part, job) in (0..).zip(jobs) {
        let mut share = spec.clone();
        share.budget.time = spec
            .budget
            .time
            .map(|time| (time / u32::try_from(parts).unwrap_or(u32::MAX)).max(Duration::from_nanos(1)));
        share.budget.evaluations = spec
            .budget
            .evaluations
            .map(|total| (total / parts + u64::from(part < total % parts)).max(1));
        let found = all.as_ref().map_or(0, |all| all.hits);
        share.budget.hits = spec.budget.hits.map(|wanted| wanted - found);

        let mut watch = |progress: &Progress| bar.show(progress, part, parts);
        let control = RunControl {
            watch: Some(&mut watch),
            ..RunControl::until(cancel)
        };
        let mut report = run(&job.problem, share, control)?;
        let (evaluations, seconds) = all
            .as_ref()
            .map_or((0, 0.0), |all| (all.counts.evaluations, all.elapsed_seconds));
        for solution in report.solutions.drain(..) {
            let pair = job.pair(serde_json::from_value(solution.solution)?);
            // As the exact methods give it: to the last digit, where F has ten.
            let near = measure.proximity(&pair)?;
            pairs.pairs.push(pair);
            pairs
                .distances
                .push(capped(near.distance, world.request.threshold));
            if let Some(witnesses) = &mut pairs.witnesses {
                witnesses.push(Some(near));
            }
            if let Some(found) = &mut pairs.found {
                found.push((evaluations + solution.evaluation, seconds + solution.seconds));
            }
        }
        if let Some(best) = &mut report.best {
            let pair = serde_json::from_value(best.solution.take())?;
            let pair = job.pair(job.problem.canonical(&pair).unwrap_or(pair));
            best.solution = json!(pair);
            if best.fitness < world.request.threshold {
                best.fitness = capped(measure.proximity(&pair)?.distance, world.request.threshold);
            }
        }
        let stop = report.stop_reason;
        match &mut all {
            Some(all) => all.append(report),
            None => all = Some(report),
        }
        if matches!(stop, StopReason::Cancelled | StopReason::Hits) {
            break;
        }
    }
    let Some(all) = all else {
        bail!("the scene has no pair of bodies")
    };
    let budget = Limits {
        evaluations: spec.budget.evaluations.map(|total| total.max(parts)),
        ..spec.budget
    };
    let spec = RunSpec { budget, ..all.spec };
    Ok((RunReport { spec, ..all }, pairs))
}
