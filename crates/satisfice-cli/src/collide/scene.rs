//! The scene of the command: bodies, and which of them may have pairs with which.

use std::path::PathBuf;
use std::sync::OnceLock;

use anyhow::{Context, bail};
use satisfice::SatisficingProblem;
use satisfice_catalogue::{RunReport, Settings};
use satisfice_collision::FeatureKind;
use satisfice_collision::broad::Method;
use satisfice_collision::distance::{PairKind, Threshold};
use satisfice_collision::problem::FeaturePairs;
use satisfice_collision::scene::{self, Body, BodyId, Contact};
use satisfice_collision::{Mesh, io};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::arguments::Find;

/// Up to so many nanoseconds of brute force are spent on checking a report.
const PATIENCE: u64 = 5_000_000_000;

/// A feature of a body: a vertex, an edge or a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Feature {
    /// Number of the mesh on the command line, from 0.
    pub(super) body: usize,
    /// Number of the feature in its mesh, from 0.
    pub(super) feature: u32,
}

/// A pair of features: what a solution is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Pair {
    pub(super) a: Feature,
    pub(super) b: Feature,
}

/// The pairs of two bodies, or of one with itself, as a problem for an engine.
#[derive(Debug)]
pub(super) struct Job {
    pub(super) bodies: [usize; 2],
    pub(super) problem: FeaturePairs,
}

impl Job {
    /// The pair of features that a solution of this job is.
    pub(super) fn pair(&self, (a, b): (u32, u32)) -> Pair {
        let [body_a, body_b] = self.bodies;
        Pair {
            a: Feature {
                body: body_a,
                feature: a,
            },
            b: Feature {
                body: body_b,
                feature: b,
            },
        }
    }
}

/// What makes a scene.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Request {
    pub(super) paths: Vec<PathBuf>,
    pub(super) kind: PairKind,
    pub(super) threshold: f64,
    pub(super) within: bool,
    pub(super) ring_width: Option<usize>,
    pub(super) find: Find,
}

/// Bodies and what is asked of them.
#[derive(Debug)]
pub(super) struct World {
    pub(super) request: Request,
    pub(super) bodies: Vec<Mesh>,
    pub(super) threshold: Threshold,
    jobs: OnceLock<Vec<Job>>,
}

impl World {
    pub(super) fn read(request: Request) -> anyhow::Result<Self> {
        if request.paths.len() < 2 && !request.within {
            bail!("one mesh has no partner: name a second one, or look for pairs within it by --self");
        }
        let bodies = request
            .paths
            .iter()
            .map(io::read)
            .collect::<Result<Vec<Mesh>, _>>()?;
        let world = Self {
            threshold: Threshold::new(request.threshold)?,
            request,
            bodies,
            jobs: OnceLock::new(),
        };
        if world.couples().is_empty() {
            let (a, b) = world.kinds();
            let lacks = |kind: FeatureKind| world.bodies.iter().all(|mesh| kind.count(mesh) == 0);
            let missing = if lacks(a) { a } else { b };
            let plural = missing.plural();
            bail!(
                "there are no {} pairs to look for, since {} {plural}: choose other features by --pairs",
                world.request.kind,
                if lacks(missing) {
                    "no mesh has any"
                } else {
                    "no other mesh has"
                }
            );
        }
        Ok(world)
    }

    /// The scene that a report tells of.
    pub(super) fn of_report(record: &RunReport) -> anyhow::Result<Self> {
        let parameters = &record.spec.problem_parameters;
        let parameter = |name| {
            parameters
                .get(name)
                .with_context(|| format!("it has no parameter `{name}`"))
        };
        let text = |name| {
            parameter(name)?
                .as_str()
                .with_context(|| format!("`{name}` is no text"))
        };
        Self::read(Request {
            paths: serde_json::from_value(parameter("meshes")?.clone())
                .context("`meshes` is no list of files")?,
            kind: text("pairs")?.parse()?,
            threshold: parameter("threshold")?
                .as_f64()
                .context("`threshold` is no number")?,
            within: parameter("self")?
                .as_bool()
                .context("`self` is neither true nor false")?,
            ring_width: Some(
                parameter("ring_width")?
                    .as_u64()
                    .and_then(|width| usize::try_from(width).ok())
                    .context("`ring_width` is no whole number")?,
            ),
            find: if text("find")? == Find::All.name() {
                Find::All
            } else {
                Find::First
            },
        })
    }

    /// What a report repeats.
    pub(super) fn settings(&self) -> Settings {
        let mut settings = Settings::default();
        let paths = self.request.paths.iter();
        let meshes: Vec<Value> = paths.map(|path| path.to_string_lossy().into()).collect();
        settings.set("meshes", meshes);
        settings.set("pairs", self.request.kind.name());
        settings.set("threshold", self.request.threshold);
        settings.set("self", self.request.within);
        settings.set("ring_width", self.ring_width());
        settings.set("find", self.request.find.name());
        settings
    }

    /// Vertices that so many edges join belong to no pair of one body.
    pub(super) fn ring_width(&self) -> usize {
        let usual = usize::from(self.request.kind == PairKind::VertexVertex);
        self.request.ring_width.unwrap_or(usual)
    }

    /// The kinds of the first and the second feature.
    pub(super) fn kinds(&self) -> (FeatureKind, FeatureKind) {
        self.request.kind.features()
    }

    /// The bodies of the first and of the second feature, for every combination that can have pairs.
    fn couples(&self) -> Vec<[usize; 2]> {
        let (kind_a, kind_b) = self.kinds();
        let all = 0..self.bodies.len();
        let couples = all.clone().flat_map(|a| all.clone().map(move |b| [a, b]));
        couples
            .filter(|&[a, b]| (a != b || self.request.within) && (a <= b || kind_a != kind_b))
            .filter(|&[a, b]| kind_a.count(&self.bodies[a]) > 0 && kind_b.count(&self.bodies[b]) > 0)
            .collect()
    }

    /// The bodies without a feature of this kind.
    pub(super) fn without(&self, kind: FeatureKind) -> impl Iterator<Item = usize> {
        let bodies = self.bodies.iter().enumerate();
        bodies.filter_map(move |(body, mesh)| (kind.count(mesh) == 0).then_some(body))
    }

    /// The meshes that have a feature of a pair. They are the bodies of the scene, in this order.
    fn present(&self) -> Vec<usize> {
        let (kind_a, kind_b) = self.kinds();
        let has = |&body: &usize| {
            [kind_a, kind_b]
                .iter()
                .any(|&kind| kind.count(&self.bodies[body]) > 0)
        };
        (0..self.bodies.len()).filter(has).collect()
    }

    /// The scene for the exact methods.
    pub(super) fn scene(&self, method: Method) -> anyhow::Result<scene::World> {
        let mut scene = scene::World::new(self.request.kind, self.threshold).with_method(method);
        for body in self.present() {
            let mesh = self.bodies[body].clone();
            scene.add(if self.request.within {
                Body::deforming(mesh).beyond_ring(self.ring_width())
            } else {
                Body::fixed(mesh)
            })?;
        }
        Ok(scene)
    }

    /// Contacts of the scene as pairs of features of meshes.
    pub(super) fn pairs(&self, contacts: &[Contact]) -> Vec<Pair> {
        let present = self.present();
        let feature = |body: BodyId, feature| Feature {
            body: present[body.index()],
            feature,
        };
        let contacts = contacts.iter();
        let pair = |contact: &Contact| Pair {
            a: feature(contact.body_a, contact.a),
            b: feature(contact.body_b, contact.b),
        };
        contacts.map(pair).collect()
    }

    /// Pairs of features of meshes as contacts of the scene; a mesh that is not there is a body that the scene refuses.
    pub(super) fn contacts(&self, pairs: &[Pair]) -> Vec<Contact> {
        let present = self.present();
        let body = |mesh: usize| {
            let place = present
                .binary_search(&mesh)
                .ok()
                .and_then(|at| u32::try_from(at).ok());
            BodyId::nth(place.unwrap_or(u32::MAX))
        };
        let contact = |pair: &Pair| Contact {
            body_a: body(pair.a.body),
            body_b: body(pair.b.body),
            a: pair.a.feature,
            b: pair.b.feature,
        };
        pairs.iter().map(contact).collect()
    }

    /// A problem for every combination of bodies, made when it is first asked for.
    pub(super) fn jobs(&self) -> anyhow::Result<&[Job]> {
        if let Some(jobs) = self.jobs.get() {
            return Ok(jobs);
        }
        let Request { kind, threshold, .. } = self.request;
        let jobs = self.couples().into_iter().map(|[a, b]| {
            let problem = if a == b {
                FeaturePairs::within(kind, &self.bodies[a], threshold, self.ring_width())
            } else {
                FeaturePairs::between(kind, &self.bodies[a], &self.bodies[b], threshold)
            };
            problem.map(|problem| Job {
                bodies: [a, b],
                problem,
            })
        });
        let jobs = jobs.collect::<Result<Vec<_>, _>>()?;
        Ok(self.jobs.get_or_init(|| jobs))
    }

    /// How many pairs of features there are, excluded ones of one body included.
    pub(super) fn size(&self) -> u64 {
        let (kind_a, kind_b) = self.kinds();
        self.couples().into_iter().fold(0, |sum, [a, b]| {
            let (m, n) = (
                kind_a.count(&self.bodies[a]) as u64,
                kind_b.count(&self.bodies[b]) as u64,
            );
            let pairs = if a == b && kind_a == kind_b {
                m * (m - 1) / 2
            } else {
                m.saturating_mul(n)
            };
            sum.saturating_add(pairs)
        })
    }

    /// Whether deciding every pair is a matter of seconds.
    pub(super) fn is_small(&self) -> bool {
        let cost = match self.request.kind {
            PairKind::VertexVertex => 10,
            PairKind::VertexEdge | PairKind::VertexTriangle | PairKind::EdgeEdge => 40,
            PairKind::EdgeTriangle | PairKind::TriangleTriangle => 200,
        };
        self.size().saturating_mul(cost) <= PATIENCE
    }

    /// How many pairs there are, by brute force.
    pub(super) fn reference_hits(&self) -> anyhow::Result<u64> {
        Ok(self.scene(Method::BruteForce)?.frame()?.contacts.len() as u64)
    }

    /// Whether this is a pair of features of this scene, the first one first.
    pub(super) fn has(&self, pair: &Pair) -> anyhow::Result<bool> {
        let jobs = self.jobs()?;
        let Some(job) = jobs.iter().find(|job| job.bodies == [pair.a.body, pair.b.body]) else {
            return Ok(false);
        };
        let solution = (pair.a.feature, pair.b.feature);
        let mut values = [0.0; 2];
        let encoding = job.problem.encoding();
        let exists = encoding.is_some_and(|encoding| encoding.encode(&solution, &mut values));
        Ok(exists && job.problem.canonical(&solution).is_none())
    }

    /// F of a pair that there is: its distance, or what a pair that counts as none has.
    pub(super) fn fitness(&self, pair: &Pair) -> anyhow::Result<f64> {
        let jobs = self.jobs()?;
        let job = jobs.iter().find(|job| job.bodies == [pair.a.body, pair.b.body]);
        let job = job.context("a pair of bodies of this scene")?;
        Ok(job.problem.fitness(&(pair.a.feature, pair.b.feature)))
    }
}
