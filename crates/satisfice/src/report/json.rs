//! A report is written and read as a [`RunReport`] of one slice.

use core::convert::Infallible;
use core::time::Duration;
use std::sync::Arc;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use super::{Report, RunReport};
use crate::archive::Archive;
use crate::budget::Budget;
use crate::catalogue::{Description, as_map};
use crate::identity::Identity;
use crate::unseen::Unseen;

/// The configuration of the run: the first keys.
#[derive(Serialize, Deserialize)]
struct Run {
    problem: String,
    #[serde(with = "as_map")]
    problem_parameters: Vec<(String, String)>,
    engine: String,
    #[serde(with = "as_map")]
    engine_parameters: Vec<(String, String)>,
    seed: u64,
    budget: Limits,
    requested_probe_share: Option<f64>,
    islands: usize,
    /// Left out for the first slice of a search.
    #[serde(default, skip_serializing_if = "is_zero")]
    slice: u64,
}

/// The budget of one slice.
#[derive(Serialize, Deserialize)]
struct Limits {
    time_seconds: Option<f64>,
    evaluations: Option<u64>,
    hits: Option<u64>,
    slices: u64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    patience: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    horizon: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    parallel: Option<usize>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_zero(slice: &u64) -> bool {
    *slice == 0
}

impl Run {
    fn of<T>(report: &Report<T>) -> Self {
        let Description { name, parameters } = report.engine.clone();
        let problem = report.problem.clone();
        Self {
            problem: problem.name,
            problem_parameters: problem.parameters,
            engine: name,
            engine_parameters: parameters,
            seed: report.seed,
            budget: Limits {
                time_seconds: report.budget.time.map(|time| time.as_secs_f64()),
                evaluations: report.budget.evaluations,
                hits: report.budget.hits,
                slices: 1,
                patience: report.budget.patience,
                horizon: report.budget.horizon,
                parallel: report.budget.parallel,
            },
            requested_probe_share: report.requested_probe_share,
            islands: report.islands,
            slice: report.slice,
        }
    }
}

impl<T: Serialize> Serialize for Report<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Ok(run) = RunReport::of_slice(Run::of(self), self, Ok::<_, Infallible>);
        run.serialize(serializer)
    }
}

impl<'de, T: Deserialize<'de> + Identity> Deserialize<'de> for Report<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let run = RunReport::<Run, T>::deserialize(deserializer)?;
        if run.spec.budget.slices != 1 {
            return Err(de::Error::custom(
                "a report of several slices: read it as a `RunReport`",
            ));
        }
        let duration = |seconds| Duration::try_from_secs_f64(seconds).map_err(de::Error::custom);
        let unseen = run.unseen_estimate.zip(run.unseen_interval);
        let how = run.unseen_confidence.zip(run.unseen_method);
        let probes = run.unseen_mass.zip(run.probe_hits);
        let mut archive = Archive::default();
        for found in run.solutions {
            archive.insert(found.solution, found.fitness, found.evaluation, found.seconds);
        }
        Ok(Self {
            problem: Description {
                name: run.spec.problem,
                parameters: run.spec.problem_parameters,
            },
            engine: Description {
                name: run.spec.engine,
                parameters: run.spec.engine_parameters,
            },
            scalar: run.scalar,
            seed: run.spec.seed,
            islands: run.spec.islands,
            slice: run.spec.slice,
            budget: Budget {
                time: run.spec.budget.time_seconds.map(duration).transpose()?,
                evaluations: run.spec.budget.evaluations,
                hits: run.spec.budget.hits,
                patience: run.spec.budget.patience,
                horizon: run.spec.budget.horizon,
                parallel: run.spec.budget.parallel,
                cancel: None,
            },
            threshold: run.threshold,
            requested_probe_share: run.spec.requested_probe_share,
            probe_share: run.probe_share,
            stop_reason: run.stop_reason,
            panic: run.panic,
            counts: run.counts,
            elapsed: duration(run.elapsed_seconds)?,
            overshoot: duration(run.overshoot_seconds)?,
            completeness: run.completeness,
            unseen: unseen.zip(how).zip(probes).map(
                |(((estimate, interval), (confidence, method)), (mass, (recaptures, fresh)))| Unseen {
                    estimate,
                    interval,
                    mass,
                    confidence,
                    method,
                    probes: run.counts.probes,
                    recaptures,
                    fresh,
                },
            ),
            best: run.best,
            trace: run.trace,
            sources: run.sources,
            version: run.version,
            archive: Arc::new(archive),
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::{Budget, Report, Search, Space, from_fn};

    #[test]
    fn a_report_comes_back_from_json() {
        let problem = from_fn(Space::lattice(2, 60).unwrap(), 4.0, |x: &[f64]| {
            (x[0] - 30.0).hypot(x[1] - 20.0)
        })
        .boxed();
        let mut search = Search::named("qpso").unwrap().seed(5).islands(2).probes(0.1);
        let budget = Budget::evaluations(2_000).and_hits(10_000).with_horizon(9_000);
        search.run(&problem, &budget).unwrap();
        let report = search.run(&problem, &budget).unwrap();
        assert!(report.hit_count() > 10 && report.unseen.is_some() && report.best().is_some());
        let text = serde_json::to_string(&report).unwrap();
        let back: Report<crate::Located<f64>> = serde_json::from_str(&text).unwrap();
        assert_eq!(serde_json::to_string(&back).unwrap(), text);
        let parts =
            |report: &Report<_>| format!("{:?} {:?} {:?}", report.budget, report.unseen, report.trace);
        assert_eq!(parts(&back), parts(&report));
        assert!(crate::testing::difference(&back, &report).is_none());
    }
}
