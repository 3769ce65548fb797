//! The report of a collision run: what was asked, how complete the answer is, and its pairs.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use satisfice::{Completeness, Method as Estimate, StopReason};
use satisfice_catalogue::report::{Best, recall};
use satisfice_catalogue::{Limits, RunReport, Settings};
use satisfice_collision::broad::Method;
use satisfice_collision::scene::Skips;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::PROBLEM;
use super::body::NamedBody;
use super::exact::{Exact, Found};
use super::overlaps::Overlap;
use super::pairs::{Line, Pairs};
use super::scene::World;

/// What is said of the run as a whole.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Head {
    pub(super) problem: String,
    pub(super) problem_parameters: Settings,
    /// The exact method or the engine.
    pub(super) engine: String,
    pub(super) engine_parameters: Settings,
    /// In the unit of the meshes; infinite, `null` in JSON, where the closest pairs are asked for at any distance.
    #[serde(deserialize_with = "or_infinite")]
    pub(super) threshold: f64,
    pub(super) seed: u64,
    pub(super) budget: Limits,
    /// Distances that were computed; by an engine, also lower bounds and repeated pairs.
    pub(super) evaluations: u64,
    /// Seconds from the start to the last distance.
    pub(super) elapsed_seconds: f64,
    /// How much of that was beyond the time limit.
    pub(super) overshoot_seconds: f64,
    pub(super) stop_reason: StopReason,
    /// How many pairs are listed.
    pub(super) hits: u64,
    /// How many pairs there are, if that is known.
    pub(super) reference_hits: Option<u64>,
    pub(super) recall: Option<f64>,
    /// Whether all pairs are listed, as was proved.
    pub(super) completeness: Completeness,
    /// Whether what was asked for is proved: that these are all pairs, no other bodies touch, no other pair is closer, or one pair.
    pub(super) answer: Completeness,
    /// The closest pair that an engine saw, within the threshold or not.
    pub(super) best: Option<Best>,
    /// Listed pairs without a distance, because the time ended.
    pub(super) unmeasured: u64,
    pub(super) unseen_estimate: Option<f64>,
    pub(super) unseen_interval: Option<(f64, Option<f64>)>,
    pub(super) unseen_confidence: Option<f64>,
    pub(super) unseen_method: Option<Estimate>,
    pub(super) version: String,
}

fn or_infinite<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or(f64::INFINITY))
}

impl Head {
    /// Of an exact method.
    pub(super) fn of_exact(name: &str, how: &Exact<'_>, found: &Found, world: &World) -> Self {
        let listed = found.pairs.len() as u64;
        // Brute force measures every pair, the others those that they find.
        let evaluations = match found.complete && how.method == Method::BruteForce {
            true => world.size() - found.skips.mesh_neighbours,
            false => listed - found.pairs.unmeasured() as u64,
        };
        let late = how
            .time
            .map_or(Duration::ZERO, |time| found.elapsed.saturating_sub(time));
        let is_answered = world.request.find.is_answered(listed, found.complete, found.stop);
        let proved = |is_proved| match is_proved {
            true => Completeness::Proved,
            false => Completeness::Unknown,
        };
        Self {
            problem: PROBLEM.to_owned(),
            problem_parameters: world.settings(),
            engine: name.to_owned(),
            engine_parameters: Settings::default(),
            threshold: world.request.threshold,
            seed: 0,
            budget: Limits {
                time: how.time,
                hits: how.hits,
                ..Limits::default()
            },
            evaluations,
            elapsed_seconds: found.elapsed.as_secs_f64(),
            overshoot_seconds: late.as_secs_f64(),
            stop_reason: found.stop,
            hits: listed,
            reference_hits: found.count,
            recall: found.count.and_then(|count| recall(listed, count)),
            completeness: proved(found.complete),
            answer: proved(is_answered),
            best: None,
            unmeasured: found.pairs.unmeasured() as u64,
            unseen_estimate: found.complete.then_some(0.0),
            unseen_interval: found.complete.then_some((0.0, Some(0.0))),
            unseen_confidence: found.complete.then_some(1.0),
            unseen_method: found.complete.then_some(Estimate::Proved),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        }
    }

    /// Of a search by an engine.
    pub(super) fn of_search(report: RunReport, world: &World) -> Self {
        Self {
            problem: PROBLEM.to_owned(),
            problem_parameters: world.settings(),
            engine: report.spec.engine,
            engine_parameters: report.spec.engine_parameters,
            threshold: world.request.threshold,
            seed: report.spec.seed,
            budget: report.spec.budget,
            evaluations: report.counts.evaluations,
            elapsed_seconds: report.elapsed_seconds,
            overshoot_seconds: report.overshoot_seconds,
            stop_reason: report.stop_reason,
            hits: report.hits,
            reference_hits: report.reference_hits,
            recall: report.recall,
            completeness: report.completeness,
            answer: report.completeness,
            best: report.best,
            unmeasured: 0,
            unseen_estimate: report.unseen_estimate,
            unseen_interval: report.unseen_interval,
            unseen_confidence: report.unseen_confidence,
            unseen_method: report.unseen_method,
            version: report.version,
        }
    }
}

/// A body as a report names it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct BodyLine {
    name: String,
    file: String,
    vertices: usize,
    edges: usize,
    triangles: usize,
}

impl BodyLine {
    pub(super) fn new(body: &NamedBody) -> Self {
        Self {
            name: body.name.clone(),
            file: body.file.to_string_lossy().into_owned(),
            vertices: body.unplaced().vertices().len(),
            edges: body.unplaced().edges().len(),
            triangles: body.unplaced().triangles().len(),
        }
    }
}

/// A whole report.
pub(super) struct Report<'a> {
    pub(super) head: Head,
    pub(super) pairs: Pairs,
    /// Bodies that overlap as solids, if that was asked for.
    pub(super) overlaps: Option<Vec<Overlap>>,
    /// Bodies that are closer than the threshold, since a pair of theirs is listed, or that overlap: `[a, b]` with `a <= b`. Without a
    /// threshold, those that overlap.
    pub(super) touching: BTreeSet<[usize; 2]>,
    /// Why pairs of bodies or of features were left out, and how many.
    pub(super) skipped: BTreeMap<String, u64>,
    pub(super) world: &'a World,
}

impl<'a> Report<'a> {
    pub(super) fn new(
        head: Head,
        pairs: Pairs,
        overlaps: Option<Vec<Overlap>>,
        skips: &Skips,
        world: &'a World,
    ) -> Self {
        let reasons = skips.by_reason().into_iter();
        let within = head.threshold.is_finite();
        // pairs of the same bodies are listed one after another
        let same_bodies = pairs.pairs.chunk_by(|one, two| one.bodies() == two.bodies());
        let bodies = same_bodies.filter(|_| within).map(|same| {
            let [a, b] = same[0].bodies();
            [a.min(b), a.max(b)]
        });
        let overlapping = overlaps.iter().flatten().map(|overlap| [overlap.a, overlap.b]);
        Self {
            touching: bodies.chain(overlapping).collect(),
            skipped: reasons
                .filter(|(_, count)| *count > 0)
                .map(|(reason, count)| (reason.to_owned(), count))
                .collect(),
            head,
            pairs,
            overlaps,
            world,
        }
    }
}

/// What `collide --json` writes. The pairs are made one by one while they are written.
impl Serialize for Report<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        struct PairsOf<'r>(&'r Report<'r>);
        impl Serialize for PairsOf<'_> {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                self.0.pairs.serialize(self.0.world, serializer)
            }
        }
        #[derive(Serialize)]
        struct Whole<'r> {
            #[serde(flatten)]
            head: &'r Head,
            bodies: Vec<BodyLine>,
            pairs: PairsOf<'r>,
            #[serde(skip_serializing_if = "Option::is_none")]
            overlaps: Option<&'r [Overlap]>,
            touching: &'r BTreeSet<[usize; 2]>,
            skipped: &'r BTreeMap<String, u64>,
        }
        Whole {
            head: &self.head,
            bodies: self.world.body_lines(),
            pairs: PairsOf(self),
            overlaps: self.overlaps.as_deref(),
            touching: &self.touching,
            skipped: &self.skipped,
        }
        .serialize(serializer)
    }
}

/// The lists of a report that was read.
#[derive(Debug, Deserialize)]
pub(super) struct ReadLists {
    pub(super) bodies: Vec<BodyLine>,
    pub(super) pairs: Vec<Line>,
    #[serde(default)]
    pub(super) overlaps: Vec<Overlap>,
    pub(super) touching: BTreeSet<[usize; 2]>,
    pub(super) skipped: BTreeMap<String, u64>,
}
