//! The bodies at both ends of a step.

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::{Context, bail};
use satisfice_catalogue::Settings;
use satisfice_collision::continuous::{Separation, Step};
use satisfice_collision::distance::PairKind;
use satisfice_collision::{Error, Mesh};
use serde_json::json;

use super::super::body::NamedBody;
use super::ends::{Ends, EndsRead};

/// What makes a step.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct MotionRequest {
    pub(super) ends: Ends,
    /// The kind of pairs; without one, all in which surfaces, wires and points first meet.
    pub(super) pairs: Option<PairKind>,
    /// 0 asks for touching.
    pub(super) threshold: f64,
    /// Whether bodies also collide with themselves.
    pub(super) within: bool,
    /// Whether only the earliest impact is wanted.
    pub(super) first: bool,
}

/// Bodies in motion and what is asked of them.
#[derive(Debug)]
pub(super) struct Frames {
    pub(super) request: MotionRequest,
    /// The bodies at the start.
    pub(super) bodies: Vec<NamedBody>,
    /// The same bodies at the end.
    pub(super) ends: Vec<NamedBody>,
    /// Every file that was read for them.
    pub(super) files: Vec<PathBuf>,
    /// Shared with the thread that builds its trees.
    pub(super) step: Arc<Step>,
    pub(super) kinds: Vec<PairKind>,
    pub(super) separation: Separation,
    is_at_rest: bool,
    /// What is said if the bodies of an animation do not move straight during the step.
    pub(super) bent: Option<String>,
}

impl Frames {
    pub(super) fn read(request: MotionRequest) -> anyhow::Result<Self> {
        let separation = Separation::new(request.threshold)?;
        let EndsRead {
            bodies: [bodies, ends],
            files,
            bent,
        } = request.ends.read()?;
        check_partners(&request, &bodies, &ends)?;
        if bodies.len() < 2 && !request.within {
            bail!("one body has no partner: name a second mesh, or look for pairs within it by --self");
        }
        let mut step = Step::new();
        for (body, end) in bodies.iter().zip(&ends) {
            let (from, to) = (body.placed()?, end.placed()?);
            let added = match request.within {
                true => step.add_deforming(&from, to.vertices()),
                false => step.add_rigid(&from, to.vertices()),
            };
            added.with_context(|| end.name.clone())?;
        }
        let kinds = request.pairs.map_or_else(|| step.kinds(), |kind| vec![kind]);
        let is_at_rest = bodies
            .iter()
            .zip(&ends)
            .all(|(body, end)| body.vertices().eq(end.vertices()));
        let frames = Self {
            request,
            bodies,
            ends,
            files,
            step: Arc::new(step),
            kinds,
            separation,
            is_at_rest,
            bent,
        };
        frames.check_features()?;
        Ok(frames)
    }

    /// The step with these [settings](Self::settings), read again.
    pub(super) fn of_settings(settings: &Settings) -> anyhow::Result<Self> {
        let value = |name: &str| {
            settings
                .get(name)
                .cloned()
                .with_context(|| format!("it has no parameter `{name}`"))
        };
        let pairs = value("pairs")?;
        let pairs = pairs.as_str().context("`pairs` is no text")?;
        Self::read(MotionRequest {
            ends: Ends::of_settings(settings)?,
            pairs: (pairs != "all").then(|| pairs.parse()).transpose()?,
            threshold: value("threshold")?.as_f64().context("`threshold` is no number")?,
            within: value("self")?
                .as_bool()
                .context("`self` is neither true nor false")?,
            first: value("find")? == json!("first"),
        })
    }

    /// The number of vertices of all bodies.
    pub(super) fn vertices(&self) -> usize {
        self.ends.iter().map(|end| end.unplaced().vertices().len()).sum()
    }

    /// What a report repeats.
    pub(super) fn settings(&self) -> Settings {
        let mut settings = Settings::default();
        self.request.ends.describe(&mut settings);
        settings.set("pairs", self.request.pairs.map_or("all", PairKind::name));
        settings.set("threshold", self.request.threshold);
        settings.set("self", self.request.within);
        settings.set("find", if self.request.first { "first" } else { "all" });
        settings
    }

    /// Whether every vertex stays where it is.
    pub(super) fn is_at_rest(&self) -> bool {
        self.is_at_rest
    }

    /// There must be two features that can be a pair.
    fn check_features(&self) -> anyhow::Result<()> {
        // The kinds that a motion does not decide are refused here.
        for &kind in &self.kinds {
            let asked = self.step.hits_until(kind, self.separation, &mut || true);
            asked.map_err(|error| match error {
                Error::Parameter { allowed, .. } => {
                    anyhow::anyhow!("--pairs {kind} is not allowed: {allowed}")
                }
                error => error.into(),
            })?;
        }
        let Some(kind) = self.request.pairs else {
            return Ok(());
        };
        let (a, b) = kind.features();
        for feature in [a, b] {
            if self.bodies.iter().all(|body| body.count(feature) == 0) {
                bail!(
                    "there are no {kind} pairs to look for, since no mesh has any {}: choose other features by --pairs",
                    feature.plural()
                );
            }
        }
        Ok(())
    }
}

/// Every body needs a partner of the same topology.
fn check_partners(request: &MotionRequest, from: &[NamedBody], to: &[NamedBody]) -> anyhow::Result<()> {
    if from.len() != to.len() {
        let [from_files, to_files] = request.ends.files();
        bail!(
            "--from has {} and --to has {}: name every body at both ends of the step, in the same order",
            bodies(from.len(), from_files),
            bodies(to.len(), to_files)
        );
    }
    if from.is_empty() {
        bail!("the step has no body: no node of the scenes has a mesh");
    }
    from.iter()
        .zip(to)
        .try_for_each(|(from, to)| check_topology(from, to))
}

fn bodies(bodies: usize, files: usize) -> String {
    let plural = |count: usize, one: &str, many: &str| match count {
        1 => format!("1 {one}"),
        _ => format!("{count} {many}"),
    };
    let bodies_are = plural(bodies, "body", "bodies");
    match bodies == files {
        true => bodies_are,
        false => format!("{bodies_are} in {}", plural(files, "file", "files")),
    }
}

fn check_topology(from: &NamedBody, to: &NamedBody) -> anyhow::Result<()> {
    let wrong = |difference: String| {
        Err(anyhow::anyhow!(
            "{} and {} differ in topology: {difference}; both ends of a step need the same vertices, edges and triangles",
            from.name,
            to.name
        ))
    };
    let counts = |mesh: &Mesh| {
        [
            (mesh.vertices().len(), "vertices"),
            (mesh.triangles().len(), "triangles"),
            (mesh.edges().len(), "edges"),
        ]
    };
    let [one, two] = [from, to].map(NamedBody::unplaced);
    for ((m, what), (n, _)) in counts(one).into_iter().zip(counts(two)) {
        if m != n {
            return wrong(format!("{m} and {n} {what}"));
        }
    }
    let triangles = one.triangles().iter().zip(two.triangles());
    for (number, (p, q)) in triangles.enumerate() {
        if p != q {
            return wrong(format!("triangle {number} joins the vertices {p:?} and {q:?}"));
        }
    }
    let edges = one.edges().iter().zip(two.edges());
    for (number, (p, q)) in edges.enumerate() {
        if p != q {
            return wrong(format!("edge {number} joins the vertices {p:?} and {q:?}"));
        }
    }
    Ok(())
}
