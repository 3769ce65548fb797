//! The report of a collision run: the record, its pairs by body and feature, and what was skipped.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use satisfice::StopReason;
use satisfice_catalogue::RunReport;
use satisfice_catalogue::report::Solution;
use satisfice_catalogue::verify::{self, LISTED_BEFORE, Mismatch};
use satisfice_collision::FeatureKind;
use satisfice_collision::scene::Skips;
use serde::{Deserialize, Serialize};

use super::arguments::Find;
use super::scene::{Feature, Pair, World};
use crate::summary;

/// What `collide --json` writes.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Report {
    #[serde(flatten)]
    pub(super) run: RunReport,
    /// The pairs found, in the order of the solutions.
    pairs: Vec<Found>,
    /// Bodies of which a pair is listed, `[a, b]` with `a <= b`.
    touching: BTreeSet<[usize; 2]>,
    /// Why pairs of bodies or of features were left out, and how many.
    skipped: BTreeMap<String, u64>,
}

/// A pair with its distance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Found {
    a: Listed,
    b: Listed,
    distance: f64,
}

/// A feature, with its ends if it is an edge: files do not number those.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Listed {
    #[serde(flatten)]
    feature: Feature,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    vertices: Option<[u32; 2]>,
}

impl Listed {
    fn new(feature: Feature, kind: FeatureKind, world: &World) -> Self {
        let edges = || {
            world
                .bodies
                .get(feature.body)?
                .edges()
                .get(feature.feature as usize)
        };
        let vertices = if kind == FeatureKind::Edge {
            edges().copied()
        } else {
            None
        };
        Self { feature, vertices }
    }
}

impl Found {
    fn new(solution: &Solution, world: &World) -> Result<Self, serde_json::Error> {
        let Pair { a, b } = Pair::deserialize(&solution.solution)?;
        let (kind_a, kind_b) = world.kinds();
        Ok(Self {
            a: Listed::new(a, kind_a, world),
            b: Listed::new(b, kind_b, world),
            distance: solution.fitness,
        })
    }

    fn bodies(&self) -> [usize; 2] {
        let (a, b) = (self.a.feature.body, self.b.feature.body);
        [a.min(b), a.max(b)]
    }
}

impl Report {
    pub(super) fn new(record: RunReport, skips: &Skips, world: &World) -> anyhow::Result<Self> {
        let solutions = record.solutions.iter();
        let pairs = solutions
            .map(|solution| Found::new(solution, world))
            .collect::<Result<Vec<_>, _>>()?;
        let reasons = skips.by_reason().into_iter();
        Ok(Self {
            touching: pairs.iter().map(Found::bodies).collect(),
            skipped: reasons
                .filter(|(_, count)| *count > 0)
                .map(|(reason, count)| (reason.to_owned(), count))
                .collect(),
            run: record,
            pairs,
        })
    }

    /// The pairs as CSV with a head line.
    pub(super) fn csv(&self) -> String {
        let mut text = "a_body,a_feature,b_body,b_feature,distance\n".to_owned();
        for Found { a, b, distance } in &self.pairs {
            let (a, b) = (a.feature, b.feature);
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "{},{},{},{},{distance}",
                a.body, a.feature, b.body, b.feature
            );
        }
        text
    }

    /// What a person reads.
    pub(super) fn summary(&self, world: &World) -> String {
        let (kind_a, kind_b) = world.kinds();
        let name = |kind: FeatureKind, listed: &Listed| {
            let Feature { body, feature } = listed.feature;
            let ends = listed
                .vertices
                .map_or_else(String::new, |[v, w]| format!(" (vertices {v} and {w})"));
            format!("{} {feature}{ends} of body {body}", kind.name())
        };
        let mut text = summary::summary_with(&self.run, |solution| match Found::new(solution, world) {
            Ok(found) => format!("{} and {}", name(kind_a, &found.a), name(kind_b, &found.b)),
            Err(_) => solution.solution.to_string(),
        });
        let mut line = |name: &str, value: String| {
            let _ = writeln!(text, "  {name:<13} {value}");
        };
        let was_stopped = matches!(self.run.stop_reason, StopReason::Cancelled | StopReason::Time);
        let asked = match world.request.find {
            Find::All => None,
            Find::Touching if was_stopped => {
                Some("one pair of each two bodies that were found to touch; others may touch as well")
            }
            Find::Touching => {
                Some("one pair of each two bodies that touch; no other bodies do, that is proved")
            }
            Find::First => Some("one pair, whichever is found first"),
            Find::Closest(_) if was_stopped => Some("the closest of the pairs found; others may be closer"),
            Find::Closest(_) => Some("the closest pairs, that is proved"),
        };
        if let Some(asked) = asked {
            line("listed", asked.to_owned());
        }
        if world.bodies.len() > 1 && !self.pairs.is_empty() {
            let shown: Vec<_> = self
                .touching
                .iter()
                .take(10)
                .map(|[a, b]| format!("{a}-{b}"))
                .collect();
            let more = if self.touching.len() > shown.len() {
                " ..."
            } else {
                ""
            };
            line("bodies", format!("{}{more}", shown.join(", ")));
        }
        for (reason, count) in &self.skipped {
            line("skipped", format!("{count} {reason}"));
        }
        text
    }

    /// What of the report is not true of the scene.
    pub(super) fn verify(&self, world: &World) -> anyhow::Result<Vec<Mismatch>> {
        let mut mismatches = verify::accounting(&self.run);
        let mut seen = BTreeSet::new();
        // Made here, so that what fails is told as an error.
        world.jobs()?;
        mismatches.extend(verify::solutions_by(
            &self.run,
            world.request.threshold,
            |listed| {
                let pair = Pair::deserialize(&listed.solution).map_err(|error| error.to_string())?;
                let known = world.has(&pair).map_err(|error| error.to_string())?;
                if !known {
                    return Err("a pair of features of this scene, the lesser first".to_owned());
                }
                if !seen.insert(pair) {
                    return Err(LISTED_BEFORE.to_owned());
                }
                world.fitness(&pair).map_err(|error| error.to_string())
            },
        ));
        mismatches.extend(verify::best_by(&self.run, |solution| {
            let pair = Pair::deserialize(solution).map_err(|error| error.to_string())?;
            world.fitness(&pair).map_err(|error| error.to_string())
        }));
        let solutions = self.run.solutions.iter();
        let listed: Vec<_> = solutions
            .filter_map(|solution| Found::new(solution, world).ok())
            .collect();
        if self.pairs != listed {
            let place = self.pairs.iter().zip(&listed).position(|(a, b)| a != b);
            let place = place.map_or_else(|| "pairs".to_owned(), |index| format!("pairs[{index}]"));
            mismatches.push(Mismatch::new(
                place,
                "another pair or distance",
                "what the solutions say",
            ));
        }
        let touching: BTreeSet<_> = listed.iter().map(Found::bodies).collect();
        if self.touching != touching {
            mismatches.push(Mismatch::new("touching", "other bodies", "those of the pairs"));
        }
        // Where deciding every pair takes too long, what the report says of the number of pairs stays as it is.
        let reference = match world.is_small() {
            true => Some(world.reference_hits()?),
            false => self.run.reference_hits,
        };
        mismatches.extend(verify::reference(&self.run, reference));
        Ok(mismatches)
    }
}
