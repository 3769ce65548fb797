//! What a slice found, and everything that is needed to replay it.

mod json;
mod run_report;
mod sources;

pub use run_report::{FoundSolution, RunReport, SliceReport, recall};
pub use sources::{SourceCount, SourceRow, SourceTrace};

use core::time::Duration;
use std::sync::Arc;

use crate::archive::{Archive, Hit};
use crate::best::Best;
use crate::budget::{Budget, StopReason};
use crate::catalogue::Description;
use crate::unseen::Unseen;

/// The completeness of the hits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Completeness {
    /// All hits of the space are listed: every region was evaluated or excluded by bounds.
    Proved,
    /// There may be more hits, also if none was found.
    Unknown,
}

/// One point of the curve of hits against evaluations and time.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct TracePoint {
    /// Evaluations so far.
    pub evaluations: u64,
    /// Seconds since the start of the slice.
    pub elapsed_seconds: f64,
    /// Hits so far.
    pub hits: u64,
}

/// The counts.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Counts {
    /// Candidates that reached the accounting, deleted ones included.
    pub evaluations: u64,
    /// Calls of the fitness.
    pub fitness_calls: u64,
    /// Candidates whose solution was in the archive already, before or after their fitness was called.
    pub duplicates: u64,
    /// Fitness values that were NaN or infinite.
    pub non_finite: u64,
    /// Hits of the slice before that were evaluated again at the start of this one.
    pub verified: u64,
    /// Uniform probes among the evaluations.
    #[serde(default)]
    pub probes: u64,
    /// Values [from elsewhere](crate::Tickets::inform), which the budget has not paid for.
    #[serde(default)]
    pub informed: u64,
    /// Calls of the problem's neighbours.
    pub neighbour_calls: u64,
    /// Calls of the problem's bounds that it answered; each uses up the budget like an evaluation.
    pub bound_calls: u64,
}

/// Adds the counts of several slices or searches.
impl core::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.evaluations += other.evaluations;
        self.fitness_calls += other.fitness_calls;
        self.duplicates += other.duplicates;
        self.non_finite += other.non_finite;
        self.verified += other.verified;
        self.probes += other.probes;
        self.informed += other.informed;
        self.neighbour_calls += other.neighbour_calls;
        self.bound_calls += other.bound_calls;
    }
}

/// The result of one time slice: plain data.
///
/// With serde it has the keys of a [`RunReport`], which are those of the command's `--json`. Reading needs a format that
/// describes itself, such as JSON.
///
/// ```
/// use satisfice::{from_fn, Budget, Search, Space};
/// let problem = from_fn(Space::lattice(2, 50)?, 3.0, |x: &[f64]| x[0] + x[1]);
/// let report = Search::new().run(&problem, &Budget::evaluations(2_000))?;
/// let json = serde_json::to_value(&report)?;
/// assert_eq!((&json["hits"], &json["evaluations"]), (&6.into(), &2_000.into()));
/// assert!(json["solutions"][0]["fitness"].as_f64() < Some(3.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Report<T> {
    /// The problem and its parameters.
    pub problem: Description,
    /// The engine and all its parameters.
    pub engine: Description,
    /// `f32` or `f64`.
    pub scalar: String,
    /// The seed.
    pub seed: u64,
    /// The number of islands.
    pub islands: usize,
    /// Which slice of the search this was, from 0.
    pub slice: u64,
    /// The budget.
    pub budget: Budget,
    /// delta: a hit is F < delta. `None` if it is infinite.
    pub threshold: Option<f64>,
    /// The share of probes that was asked for; `None` if it was left to the engine.
    pub requested_probe_share: Option<f64>,
    /// The share of the evaluations spent on uniform probes.
    pub probe_share: f64,
    /// Why it ended.
    pub stop_reason: StopReason,
    /// The message of the problem's panic, if that ended it.
    pub panic: Option<String>,
    /// The counts.
    pub counts: Counts,
    /// Wall time of the slice.
    pub elapsed: Duration,
    /// The time beyond the time budget.
    pub overshoot: Duration,
    /// Whether all hits are known to be listed.
    pub completeness: Completeness,
    /// An estimate of how many hits are missing; `None` if nothing was probed or proved.
    pub unseen: Option<Unseen>,
    /// The least fitness evaluated, and where; `None` if no fitness was finite.
    pub best: Option<Best<T>>,
    /// Hits at fixed evaluation counts (about ten a decade) and, under a time budget, at each hundredth of it.
    pub trace: Vec<TracePoint>,
    /// What the sources of the engine proposed and found, for an engine that has several.
    pub sources: SourceTrace,
    /// The version of this crate.
    pub version: String,
    /// The hits.
    pub archive: Arc<Archive<T>>,
}

impl<T> Report<T> {
    /// The hits, in the order found.
    pub fn hits(&self) -> impl ExactSizeIterator<Item = Hit<'_, T>> {
        self.archive.iter()
    }

    /// The candidate with the least fitness, also when nothing hit; `None` if no fitness was finite.
    #[must_use]
    pub fn best(&self) -> Option<&Best<T>> {
        self.best.as_ref()
    }

    /// The number of hits.
    #[must_use]
    pub fn hit_count(&self) -> usize {
        self.archive.len()
    }

    /// The share of `reference` hits that were found; `None` for a reference of 0.
    #[must_use]
    pub fn recall(&self, reference: u64) -> Option<f64> {
        recall(self.archive.len() as u64, reference)
    }
}

impl<T> core::fmt::Display for Report<T> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(
            f,
            "{} hits in {} evaluations ({} duplicates)",
            self.archive.len(),
            self.counts.evaluations,
            self.counts.duplicates,
        )?;
        if self.counts.bound_calls > 0 {
            write!(f, ", {} bounds", self.counts.bound_calls)?;
        }
        if self.counts.non_finite > 0 {
            write!(f, ", F not finite in {}", self.counts.non_finite)?;
        }
        write!(
            f,
            " and {:.3} s by {} on {}, seed {}; {}",
            self.elapsed.as_secs_f64(),
            self.engine.name,
            self.problem.name,
            self.seed,
            self.stop_reason,
        )?;
        if let Some(first) = self.panic.as_ref().and_then(|message| message.lines().next()) {
            write!(f, ": {first}")?;
        }
        if self.archive.is_empty()
            && let (Some(best), Some(threshold)) = (&self.best, self.threshold)
        {
            write!(f, "; least F {}, a hit needs F < {threshold}", best.fitness)?;
        }
        write!(f, "; completeness {:?}", self.completeness)?;
        match &self.unseen {
            Some(unseen) if self.completeness == Completeness::Unknown => {
                write!(f, ", {unseen} hits not seen")
            }
            _ => Ok(()),
        }
    }
}
