//! The report of a collision run: the record, its pairs by body and feature, and what was skipped.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use satisfice_bench::verify::{self, LISTED_BEFORE, Mismatch};
use satisfice_bench::{Record, record};
use serde::{Deserialize, Serialize};

use super::scene::{Feature, Pair, Scene};
use crate::summary;

/// What `collide --json` writes.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Report {
    #[serde(flatten)]
    pub(super) record: Record,
    /// The pairs found, in the order of the solutions.
    pairs: Vec<Found>,
    /// Why pairs of features were left out, and how many.
    skipped: BTreeMap<String, u64>,
}

/// A pair with its distance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Found {
    a: Feature,
    b: Feature,
    distance: f64,
}

impl Found {
    fn new(solution: &record::Solution) -> Result<Self, serde_json::Error> {
        let Pair { a, b } = Pair::deserialize(&solution.solution)?;
        Ok(Self {
            a,
            b,
            distance: solution.fitness,
        })
    }
}

impl Report {
    pub(super) fn new(record: Record, scene: &Scene) -> anyhow::Result<Self> {
        let pairs = record
            .solutions
            .iter()
            .map(Found::new)
            .collect::<Result<Vec<_>, _>>()?;
        let joined = scene.jobs.iter().map(super::scene::Job::joined).sum();
        let skipped = BTreeMap::from([("vertices of one body that an edge joins".to_owned(), joined)]);
        Ok(Self {
            record,
            pairs,
            skipped,
        })
    }

    /// The pairs as CSV with a head line.
    pub(super) fn csv(&self) -> String {
        let mut text = "a_body,a_feature,b_body,b_feature,distance\n".to_owned();
        for Found { a, b, distance } in &self.pairs {
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
    pub(super) fn summary(&self) -> String {
        let mut text = summary::summary_with(&self.record, |solution| match Found::new(solution) {
            Ok(Found { a, b, .. }) => format!(
                "vertex {} of body {} and vertex {} of body {}",
                a.feature, a.body, b.feature, b.body
            ),
            Err(_) => solution.solution.to_string(),
        });
        for (reason, count) in self.skipped.iter().filter(|(_, count)| **count > 0) {
            let _ = writeln!(text, "  skipped       {count} pairs: {reason}");
        }
        text
    }

    /// What of the report is not true of the scene.
    pub(super) fn verify(&self, scene: &Scene) -> Vec<Mismatch> {
        let mut mismatches = verify::books(&self.record);
        let mut seen = BTreeSet::new();
        mismatches.extend(verify::solutions_by(&self.record, scene.threshold, |listed| {
            let pair = Pair::deserialize(&listed.solution).map_err(|error| error.to_string())?;
            let distance = scene
                .distance(&pair)
                .ok_or("a pair of features of this scene, the lesser first")?;
            if seen.insert(pair) {
                Ok(distance)
            } else {
                Err(LISTED_BEFORE.to_owned())
            }
        }));
        let listed: Vec<_> = self
            .record
            .solutions
            .iter()
            .filter_map(|solution| Found::new(solution).ok())
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
        let reference = scene.is_small().then(|| scene.reference_hits());
        mismatches.extend(verify::reference(&self.record, reference));
        mismatches
    }
}
