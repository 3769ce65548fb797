//! What came out of a run: plain data, the JSON of `--json`, of sweeps and of `verify`.

use satisfice::{Completeness, Counts, Method, StopReason, TracePoint, Unseen};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::spec::RunSpec;

/// What one run did and found: all that is needed to repeat and to verify it. Everything but times is the same for the
/// same specification under a budget of evaluations.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunReport {
    /// What was run, with all parameters.
    #[serde(flatten)]
    pub spec: RunSpec,
    /// `f32` or `f64`.
    pub scalar: String,
    /// delta: a hit is F < delta. `null` where it is infinite.
    pub threshold: Option<f64>,
    /// The share of the evaluations spent on uniform probes.
    pub probe_share: f64,
    /// What was counted, summed over the slices.
    #[serde(flatten)]
    pub counts: Counts,
    /// Wall time in seconds, summed over the slices.
    pub elapsed_seconds: f64,
    /// How much longer than the time budget it took, in seconds, summed over the slices.
    pub overshoot_seconds: f64,
    /// Why the last slice ended.
    pub stop_reason: StopReason,
    /// The number of distinct hits, of all slices together.
    pub hits: u64,
    /// The number of all hits of the problem, where it is known.
    pub reference_hits: Option<u64>,
    /// `hits / reference_hits`, where that is known and not 0 / 0.
    pub recall: Option<f64>,
    /// Whether all hits are known to be listed.
    pub completeness: Completeness,
    /// The estimated number of hits not seen; 0 where completeness is proved, `null` where nothing was probed.
    pub unseen_estimate: Option<f64>,
    /// Its interval; no upper end where nothing bounds it.
    pub unseen_interval: Option<(f64, Option<f64>)>,
    /// The least probability with which the interval contains the true number.
    pub unseen_confidence: Option<f64>,
    /// How it was estimated.
    pub unseen_method: Option<Method>,
    /// The least fitness of all slices, and where; `null` if no fitness was finite or none is known but that of the hits.
    #[serde(default)]
    pub best: Option<Best>,
    /// Distinct hits against evaluations and time, over all slices.
    pub trace: Vec<TracePoint>,
    /// The slices one by one, where there are several.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub slices: Vec<Slice>,
    /// The hits, in the order found.
    pub solutions: Vec<Solution>,
    /// Version of the framework.
    pub version: String,
}

/// One slice of several.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Slice {
    /// What was counted.
    #[serde(flatten)]
    pub counts: Counts,
    /// Wall time in seconds.
    pub elapsed_seconds: f64,
    /// How much longer than the time budget it took, in seconds.
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

/// The candidate with the least fitness.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Best {
    /// The candidate.
    pub solution: Value,
    /// F of it.
    pub fitness: f64,
    /// The evaluation that found it, counted from 1 over all slices.
    pub evaluation: u64,
}

impl Best {
    /// The best of some hits, for methods that see nothing else.
    #[must_use]
    pub fn of(hits: &[Solution]) -> Option<Self> {
        let best = hits.iter().min_by(|a, b| a.fitness.total_cmp(&b.fitness))?;
        Some(Self {
            solution: best.solution.clone(),
            fitness: best.fitness,
            evaluation: best.evaluation,
        })
    }
}

/// One hit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Solution {
    /// What was found.
    pub solution: Value,
    /// F of it.
    pub fitness: f64,
    /// The evaluation that found it, counted from 1 over all slices.
    pub evaluation: u64,
    /// When, in seconds of running time over all slices.
    pub seconds: f64,
}

impl RunReport {
    /// The report of a run that has found nothing yet.
    #[must_use]
    pub fn new(spec: RunSpec) -> Self {
        Self {
            spec,
            scalar: "f64".to_owned(),
            threshold: None,
            probe_share: 0.0,
            counts: Counts::default(),
            elapsed_seconds: 0.0,
            overshoot_seconds: 0.0,
            stop_reason: StopReason::Exhausted,
            hits: 0,
            reference_hits: None,
            recall: None,
            completeness: Completeness::Unknown,
            unseen_estimate: None,
            unseen_interval: None,
            unseen_confidence: None,
            unseen_method: None,
            best: None,
            trace: Vec::new(),
            slices: Vec::new(),
            solutions: Vec::new(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        }
    }

    /// The report of a method that has all its hits when it ends, after this many evaluations and seconds: every hit is
    /// listed with them, and the trace is one point.
    #[must_use]
    pub fn at_once(
        spec: RunSpec,
        threshold: f64,
        hits: impl IntoIterator<Item = (Value, f64)>,
        (evaluations, seconds): (u64, f64),
    ) -> Self {
        let listed = hits.into_iter().map(|(solution, fitness)| Solution {
            solution,
            fitness,
            evaluation: evaluations,
            seconds,
        });
        let solutions: Vec<Solution> = listed.collect();
        let hits = solutions.len() as u64;
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
            best: Best::of(&solutions),
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

    /// Enters the number of hits estimated to be missing from the last archive, when `found_elsewhere` further hits are listed.
    #[expect(clippy::cast_precision_loss, reason = "an estimate")]
    pub(crate) fn set_unseen(&mut self, unseen: Option<&Unseen>, found_elsewhere: u64) {
        // The estimated total stays the same: hits listed beyond the archive are no longer missing.
        let less = |missing: f64| (missing - found_elsewhere as f64).max(0.0);
        self.unseen_estimate = unseen.map(|unseen| less(unseen.estimate));
        self.unseen_interval = unseen.map(|Unseen { interval: (a, b), .. }| (less(*a), b.map(less)));
        self.unseen_confidence = unseen.map(|unseen| unseen.confidence);
        self.unseen_method = unseen.map(|unseen| unseen.method);
    }

    /// Enters the number of all hits, and the recall that follows.
    pub fn set_reference(&mut self, reference: Option<u64>) {
        self.reference_hits = reference;
        self.recall = reference.and_then(|reference| recall(self.hits, reference));
    }

    /// Adds the report of a run on another problem, whose solutions are all different, as if it had followed this one.
    pub fn append(&mut self, next: Self) {
        let (evaluations, seconds, hits) = (self.counts.evaluations, self.elapsed_seconds, self.hits);
        self.trace.extend(next.trace.into_iter().map(|point| TracePoint {
            evaluations: evaluations + point.evaluations,
            elapsed_seconds: seconds + point.elapsed_seconds,
            hits: hits + point.hits,
        }));
        self.solutions
            .extend(next.solutions.into_iter().map(|found| Solution {
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
        self.elapsed_seconds += next.elapsed_seconds;
        self.overshoot_seconds += next.overshoot_seconds;
        self.stop_reason = next.stop_reason;
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
