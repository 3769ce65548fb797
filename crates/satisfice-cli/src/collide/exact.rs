//! The exact method: every pair of features is measured.

use std::time::Instant;

use satisfice::{Completeness, Counts, Method, SatisficingProblem, StopReason, TracePoint};
use satisfice_bench::record::{Limits, Solution};
use satisfice_bench::{Record, Settings};
use serde_json::json;

use super::scene::{Job, Scene};
use super::{EXACT, PROBLEM};

/// All pairs of the scene, in the order of bodies and features.
pub(super) fn find(scene: &Scene) -> Record {
    let mut records = scene.jobs.iter().map(|job| find_in(job, scene));
    let first = records
        .next()
        .unwrap_or_else(|| complete(scene, 0, 0.0, Vec::new()));
    records.fold(first, |mut all, next| {
        all.append(next);
        all
    })
}

#[expect(
    clippy::disallowed_methods,
    reason = "an exact method has no budget; its time is only shown"
)]
fn find_in(job: &Job, scene: &Scene) -> Record {
    let start = Instant::now();
    let pairs = job.problem.reference_pairs();
    let seconds = start.elapsed().as_secs_f64();
    let solutions = pairs
        .into_iter()
        .map(|pair| Solution {
            solution: json!(job.pair(pair)),
            fitness: job.problem.fitness(&pair),
            // The pairs are there when all are measured.
            evaluation: job.size(),
            seconds,
        })
        .collect();
    complete(scene, job.size(), seconds, solutions)
}

/// A record whose solutions are all that there are.
fn complete(scene: &Scene, measured: u64, seconds: f64, solutions: Vec<Solution>) -> Record {
    let hits = solutions.len() as u64;
    let mut record = Record {
        problem: PROBLEM.to_owned(),
        problem_parameters: scene.settings(),
        engine: EXACT.to_owned(),
        engine_parameters: Settings::default(),
        scalar: "f64".to_owned(),
        threshold: Some(scene.threshold),
        seed: 0,
        budget: Limits {
            time_seconds: None,
            evaluations: None,
            hits: None,
            slices: 1,
        },
        probe_share: 0.0,
        counts: Counts {
            evaluations: measured,
            fitness_calls: measured,
            ..Counts::default()
        },
        elapsed_seconds: seconds,
        overshoot_seconds: 0.0,
        stop_reason: StopReason::Covered,
        hits,
        reference_hits: None,
        recall: None,
        completeness: Completeness::Proved,
        unseen_estimate: Some(0.0),
        unseen_interval: Some((0.0, Some(0.0))),
        unseen_confidence: Some(1.0),
        unseen_method: Some(Method::Proved),
        trace: vec![TracePoint {
            evaluations: measured,
            elapsed_seconds: seconds,
            hits,
        }],
        slices: Vec::new(),
        solutions,
        version: env!("CARGO_PKG_VERSION").to_owned(),
    };
    record.set_reference(Some(hits));
    record
}
