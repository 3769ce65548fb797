//! The scene: bodies, and which of them may have pairs with which.

use std::path::PathBuf;

use anyhow::{Context, bail};
use satisfice::SatisficingProblem;
use satisfice_bench::{Record, Settings};
use satisfice_collision::{Mesh, VertexPairs, io};
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Vertices that so many edges join are no pair of one body.
const RING_WIDTH: usize = 1;
/// Up to so many pairs of features are counted by brute force, at about a nanosecond each.
const SMALL: u64 = 3_000_000_000;

/// A feature of a body: a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Feature {
    /// Number of the mesh on the command line, from 0.
    pub(super) body: usize,
    /// Number of the vertex in its mesh, from 0.
    pub(super) feature: u32,
}

/// A pair of features: what a solution is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Pair {
    pub(super) a: Feature,
    pub(super) b: Feature,
}

/// The pairs of two bodies, or of one with itself.
#[derive(Debug, Clone)]
pub(super) struct Job {
    bodies: [usize; 2],
    pub(super) problem: VertexPairs,
}

impl Job {
    /// The pair of features that a solution of this job is.
    pub(super) fn pair(&self, (i, j): (u32, u32)) -> Pair {
        let [a, b] = self.bodies;
        Pair {
            a: Feature { body: a, feature: i },
            b: Feature { body: b, feature: j },
        }
    }

    /// Pairs of features that are no pair since an edge joins them.
    pub(super) fn joined(&self) -> u64 {
        if self.bodies[0] == self.bodies[1] {
            self.problem.a().edges().len() as u64
        } else {
            0
        }
    }

    /// How many pairs there are to measure.
    pub(super) fn size(&self) -> u64 {
        let count = |mesh: &Mesh| mesh.vertices().len() as u64;
        let (a, b) = (count(self.problem.a()), count(self.problem.b()));
        if self.bodies[0] == self.bodies[1] {
            a * (a - 1) / 2 - self.joined()
        } else {
            a * b
        }
    }
}

/// Bodies and the threshold.
#[derive(Debug)]
pub(super) struct Scene {
    paths: Vec<PathBuf>,
    pub(super) threshold: f64,
    within: bool,
    pub(super) jobs: Vec<Job>,
}

impl Scene {
    pub(super) fn read(paths: &[PathBuf], threshold: f64, within: bool) -> anyhow::Result<Self> {
        if paths.len() < 2 && !within {
            bail!("one mesh has no partner: name a second one, or look for pairs within it by --self");
        }
        let bodies = paths.iter().map(io::read).collect::<Result<Vec<Mesh>, _>>()?;
        let mut jobs = Vec::new();
        for (a, first) in bodies.iter().enumerate() {
            if within {
                let problem = VertexPairs::within(first, threshold, RING_WIDTH)?;
                jobs.push(Job {
                    bodies: [a, a],
                    problem,
                });
            }
            for (b, second) in bodies.iter().enumerate().skip(a + 1) {
                let problem = VertexPairs::between(first, second, threshold)?;
                jobs.push(Job {
                    bodies: [a, b],
                    problem,
                });
            }
        }
        Ok(Self {
            paths: paths.to_vec(),
            threshold,
            within,
            jobs,
        })
    }

    /// The scene that a report tells of.
    pub(super) fn of_report(record: &Record) -> anyhow::Result<Self> {
        let parameters = &record.problem_parameters;
        let parameter = |name| {
            parameters
                .get(name)
                .with_context(|| format!("it has no parameter `{name}`"))
        };
        let paths = serde_json::from_value::<Vec<PathBuf>>(parameter("meshes")?.clone())
            .context("`meshes` is no list of files")?;
        let threshold = parameter("threshold")?
            .as_f64()
            .context("`threshold` is no number")?;
        let within = parameter("self")?
            .as_bool()
            .context("`self` is neither true nor false")?;
        Self::read(&paths, threshold, within)
    }

    /// What a report repeats.
    pub(super) fn settings(&self) -> Settings {
        let mut settings = Settings::default();
        let meshes: Vec<Value> = self
            .paths
            .iter()
            .map(|path| path.to_string_lossy().into())
            .collect();
        settings.set("meshes", meshes);
        settings.set("pairs", "vertex-vertex");
        settings.set("threshold", self.threshold);
        settings.set("self", self.within);
        settings
    }

    /// Whether brute force is a matter of seconds.
    pub(super) fn is_small(&self) -> bool {
        self.jobs
            .iter()
            .fold(0_u64, |sum, job| sum.saturating_add(job.size()))
            <= SMALL
    }

    /// How many pairs there are, by brute force.
    pub(super) fn reference_hits(&self) -> u64 {
        self.jobs
            .iter()
            .map(|job| job.problem.reference_pairs().len() as u64)
            .sum()
    }

    /// The distance of a pair; `None` for what is no pair of this scene.
    pub(super) fn distance(&self, pair: &Pair) -> Option<f64> {
        let job = self
            .jobs
            .iter()
            .find(|job| job.bodies == [pair.a.body, pair.b.body])?;
        let solution = (pair.a.feature, pair.b.feature);
        let known = |mesh: &Mesh, feature: u32| (feature as usize) < mesh.vertices().len();
        let is_pair = known(job.problem.a(), solution.0)
            && known(job.problem.b(), solution.1)
            && job.problem.canonical(solution) == solution;
        is_pair.then(|| job.problem.fitness(&solution))
    }
}
