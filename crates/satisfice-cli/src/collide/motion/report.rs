//! The report of a motion.

use std::collections::BTreeSet;
use std::time::Duration;

use satisfice::{Completeness, Method as Estimate};
use satisfice_catalogue::Limits;
use satisfice_catalogue::report::recall;
use satisfice_collision::FeatureKind;
use satisfice_collision::continuous::{FeatureOf, Impact};
use serde::ser::SerializeSeq;
use serde::{Deserialize, Serialize, Serializer};

use super::super::PROBLEM;
use super::super::pairs::Side;
use super::super::report::{BodyLine, Head};
use super::TOLERANCE;
use super::answer::{Hit, Impacts, Search};
use super::frames::Frames;

/// The first impact of all pairs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct FirstImpact {
    /// A lower and an upper bound of its time, as parts of the step; `[1, 1]` if nothing comes near.
    pub(super) time: [f64; 2],
    /// The same in seconds of the animations, rounded, where the ends of the step are times of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) seconds: Option<[f64; 2]>,
    /// Whether the bounds are final: within a millionth of the step, or nothing comes near.
    pub(super) proved: bool,
}

/// A pair as a report has it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct ImpactLine {
    pub(super) kind: String,
    pub(super) a: Side,
    pub(super) b: Side,
    /// Bounds of the time of impact; `null` if the time ended before it was computed. So are the others.
    pub(super) time: Option<[f64; 2]>,
    /// Whether the pair is near at time 0 already.
    pub(super) at_start: Option<bool>,
    pub(super) point_a: Option<[f64; 3]>,
    pub(super) point_b: Option<[f64; 3]>,
    /// From a towards b just before the impact, of length 1, as at rest; `null` where the features leave it open.
    pub(super) normal: Option<[f64; 3]>,
}

/// A whole report.
pub(super) struct MotionReport<'a> {
    pub(super) head: Head,
    pub(super) pairs: Vec<Hit>,
    pub(super) first_impact: Option<FirstImpact>,
    /// Bodies of which a pair is listed, `[a, b]` with `a <= b`.
    pub(super) touching: BTreeSet<[usize; 2]>,
    pub(super) frames: &'a Frames,
}

impl<'a> MotionReport<'a> {
    pub(super) fn new(found: Impacts, search: &Search<'_>, frames: &'a Frames) -> Self {
        let listed = found.pairs.len() as u64;
        let untimed = found.pairs.iter().filter(|hit| !hit.is_timed()).count() as u64;
        let late = search
            .time
            .map_or(Duration::ZERO, |time| found.elapsed.saturating_sub(time));
        let proved = found.complete;
        let state = |is_proved| match is_proved {
            true => Completeness::Proved,
            false => Completeness::Unknown,
        };
        let head = Head {
            problem: PROBLEM.to_owned(),
            problem_parameters: frames.settings(),
            engine: "exact".to_owned(),
            engine_parameters: Default::default(),
            threshold: frames.request.threshold,
            seed: 0,
            budget: Limits {
                time: search.time,
                hits: search.hits,
                ..Limits::default()
            },
            evaluations: found.queries,
            elapsed_seconds: found.elapsed.as_secs_f64(),
            overshoot_seconds: late.as_secs_f64(),
            stop_reason: found.stop,
            hits: listed,
            reference_hits: found.count,
            recall: found.count.and_then(|count| recall(listed, count)),
            completeness: state(proved),
            answer: state(found.first.map_or(proved, |(_, proved)| proved)),
            best: None,
            unmeasured: untimed,
            unseen_estimate: proved.then_some(0.0),
            unseen_interval: proved.then_some((0.0, Some(0.0))),
            unseen_confidence: proved.then_some(1.0),
            unseen_method: proved.then_some(Estimate::Proved),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        };
        let times = frames.request.ends.times();
        let bodies = found.pairs.iter().map(|hit| {
            let [a, b] = [hit.contact.a.body as usize, hit.contact.b.body as usize];
            [a.min(b), a.max(b)]
        });
        Self {
            touching: bodies.collect(),
            head,
            pairs: found.pairs,
            first_impact: found.first.map(|(time, proved)| FirstImpact {
                time,
                seconds: times.map(|times| time.map(|part| times.at(part))),
                proved,
            }),
            frames,
        }
    }

    /// Whether `--max-pairs` left pairs out of the list.
    pub(super) fn is_cut(&self) -> bool {
        let head = &self.head;
        head.budget.hits.is_none() && head.reference_hits.is_some_and(|all| all > head.hits)
    }

    /// The first of the pairs whose bounds of the time are known, in full; computed again, so that little is kept of each pair.
    pub(super) fn impact(&self, hit: &Hit) -> Option<Impact> {
        let Frames {
            step,
            kinds,
            separation,
            ..
        } = self.frames;
        if !hit.is_timed() {
            return None;
        }
        step.impact_of(kinds[usize::from(hit.kind)], &hit.contact, *separation, TOLERANCE)
            .ok()
            .flatten()
    }

    pub(super) fn line(&self, hit: &Hit) -> ImpactLine {
        let kind = self.frames.kinds[usize::from(hit.kind)];
        let (kind_a, kind_b) = kind.features();
        let impact = self.impact(hit);
        ImpactLine {
            kind: kind.name().to_owned(),
            a: self.side(hit.contact.a, kind_a),
            b: self.side(hit.contact.b, kind_b),
            time: hit.is_timed().then_some(hit.time),
            at_start: impact.map(|impact| impact.at_start),
            point_a: impact.map(|impact| impact.point_a),
            point_b: impact.map(|impact| impact.point_b),
            normal: impact
                .map(|impact| impact.normal)
                .filter(|normal| *normal != [0.0; 3]),
        }
    }

    fn side(&self, feature: FeatureOf, kind: FeatureKind) -> Side {
        let body = feature.body as usize;
        let ends = || {
            let mesh = self.frames.bodies.get(body)?.unplaced();
            mesh.edges().get(feature.index as usize).copied()
        };
        Side {
            body,
            feature: feature.index,
            vertices: if kind == FeatureKind::Edge { ends() } else { None },
        }
    }
}

/// What `collide --from --to --json` writes. The pairs are made one by one while they are written.
impl Serialize for MotionReport<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        struct ListedImpacts<'r>(&'r MotionReport<'r>);
        impl Serialize for ListedImpacts<'_> {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                let pairs = &self.0.pairs;
                let mut list = serializer.serialize_seq(Some(pairs.len()))?;
                for hit in pairs {
                    list.serialize_element(&self.0.line(hit))?;
                }
                list.end()
            }
        }
        #[derive(Serialize)]
        struct WholeMotion<'r> {
            #[serde(flatten)]
            head: &'r Head,
            first_impact: Option<FirstImpact>,
            bodies: Vec<BodyLine>,
            pairs: ListedImpacts<'r>,
            touching: &'r BTreeSet<[usize; 2]>,
        }
        WholeMotion {
            head: &self.head,
            first_impact: self.first_impact,
            bodies: self.frames.bodies.iter().map(BodyLine::new).collect(),
            pairs: ListedImpacts(self),
            touching: &self.touching,
        }
        .serialize(serializer)
    }
}

/// The lists of a report that was read.
#[derive(Debug, Deserialize)]
pub(super) struct ImpactLists {
    pub(super) bodies: Vec<BodyLine>,
    pub(super) pairs: Vec<ImpactLine>,
    pub(super) touching: BTreeSet<[usize; 2]>,
    pub(super) first_impact: Option<FirstImpact>,
}
