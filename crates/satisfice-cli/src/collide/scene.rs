//! The scene of the command: bodies, and which of them can have pairs with which.

use std::path::PathBuf;
use std::sync::OnceLock;

use anyhow::{Context, bail};
use satisfice_catalogue::Settings;
use satisfice_collision::broad::Method;
use satisfice_collision::distance::Proximity;
use satisfice_collision::distance::{PairKind, Threshold};
use satisfice_collision::scene::{self, Body, BodyId, Contact};
use satisfice_collision::solid::Solid;
use satisfice_collision::{Aabb, FeatureKind};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::arguments::Find;
use super::body::NamedBody;
use super::inputs::Inputs;
use super::overlaps;
use super::report::BodyLine;

/// A feature of a body: a vertex, an edge or a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Feature {
    /// Number of the body, from 0, in the order of the command line and of the files.
    pub(super) body: u32,
    /// Number of the feature in its mesh, from 0.
    pub(super) feature: u32,
}

/// A pair of features: what a solution is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct Pair {
    pub(super) a: Feature,
    pub(super) b: Feature,
}

impl Pair {
    /// The order of lists: by bodies, then by features.
    pub(super) fn order(&self) -> [u32; 4] {
        [self.a.body, self.b.body, self.a.feature, self.b.feature]
    }

    /// The bodies of the first and of the second feature.
    pub(super) fn bodies(&self) -> [usize; 2] {
        [self.a.body as usize, self.b.body as usize]
    }
}

impl std::fmt::Display for Pair {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { a, b } = self;
        write!(
            f,
            "{} of body {} and {} of body {}",
            a.feature, a.body, b.feature, b.body
        )
    }
}

/// What makes a scene.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Request {
    pub(super) inputs: Inputs,
    pub(super) kind: PairKind,
    /// Infinite if only the closest pairs count.
    pub(super) threshold: f64,
    pub(super) within: bool,
    pub(super) ring_width: Option<usize>,
    pub(super) find: Find,
    /// Whether bodies are solids: closed, with all that they enclose.
    pub(super) solid: bool,
}

/// Bodies and what is asked of them.
#[derive(Debug)]
pub(super) struct World {
    pub(super) request: Request,
    pub(super) bodies: Vec<NamedBody>,
    /// Every file that was read for the bodies.
    pub(super) files: Vec<PathBuf>,
    pub(super) threshold: Threshold,
    solids: OnceLock<Vec<Solid>>,
}

impl World {
    pub(super) fn read(request: Request) -> anyhow::Result<Self> {
        let (bodies, files) = request.inputs.read()?;
        if bodies.is_empty() {
            bail!("the scene has no body: no node has a mesh");
        }
        if bodies.len() < 2 && !request.within {
            bail!("one body has no partner: name a second mesh, or look for pairs within it by --self");
        }
        let world = Self {
            threshold: Threshold::new(request.threshold.min(f64::MAX))?,
            solids: OnceLock::new(),
            request,
            bodies,
            files,
        };
        if world.couples().next().is_none() {
            let (a, b) = world.kinds();
            let having = |kind: FeatureKind| world.bodies.iter().filter(move |body| body.count(kind) > 0);
            let missing = if having(a).next().is_none() { a } else { b };
            let plural = missing.plural();
            let lacking: Vec<usize> = world.without(missing).collect();
            let why = match (having(missing).next(), &lacking[..]) {
                (None, _) => format!("no mesh has any {plural}"),
                (Some(_), &[one]) => format!("{} has no {plural}", world.bodies[one].name),
                (Some(only), _) => format!("only {} has {plural}", only.name),
            };
            bail!(
                "there are no {} pairs to look for, since {why}: choose other features by --pairs",
                world.request.kind
            );
        }
        Ok(world)
    }

    /// The scene with these [settings](Self::settings), read again.
    pub(super) fn of_settings(parameters: &Settings) -> anyhow::Result<Self> {
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
        let optional = |name| parameters.get(name).cloned().unwrap_or(Value::Null);
        let inputs = Inputs {
            paths: serde_json::from_value(parameter("meshes")?.clone())
                .context("`meshes` is no list of files")?,
            format: None,
            at: serde_json::from_value::<Option<_>>(optional("at"))
                .context("`at` is no list of placements")?
                .unwrap_or_default(),
            weld: serde_json::from_value(optional("weld")).context("`weld` is no number")?,
        };
        if inputs.reads_stdin() {
            bail!("a mesh was read from standard input, which cannot be read again");
        }
        Self::read(Request {
            inputs,
            kind: text("pairs")?.parse()?,
            threshold: match parameter("threshold")? {
                Value::Null => f64::INFINITY,
                threshold => threshold.as_f64().context("`threshold` is no number")?,
            },
            within: parameter("self")?
                .as_bool()
                .context("`self` is neither true nor false")?,
            ring_width: Some(
                parameter("ring_width")?
                    .as_u64()
                    .and_then(|width| usize::try_from(width).ok())
                    .context("`ring_width` is no whole number")?,
            ),
            find: Find::of_name(text("find")?, optional("closest").as_u64())?,
            solid: optional("solid").as_bool().unwrap_or_default(),
        })
    }

    /// What a report repeats.
    pub(super) fn settings(&self) -> Settings {
        let mut settings = Settings::default();
        let inputs = &self.request.inputs;
        let paths = inputs.paths.iter();
        let meshes: Vec<Value> = paths.map(|path| path.to_string_lossy().into()).collect();
        settings.set("meshes", meshes);
        if !inputs.at.is_empty() {
            settings.set("at", inputs.at.iter().map(|at| json!(at)).collect::<Vec<Value>>());
        }
        if let Some(distance) = inputs.weld {
            settings.set("weld", distance);
        }
        settings.set("pairs", self.request.kind.name());
        settings.set("threshold", self.request.threshold);
        settings.set("self", self.request.within);
        settings.set("ring_width", self.ring_width());
        settings.set("find", self.request.find.name());
        if let Find::Closest(wanted) = self.request.find {
            settings.set("closest", wanted);
        }
        if self.request.solid {
            settings.set("solid", true);
        }
        settings
    }

    /// The bodies as solids, if they are, made when they are first asked for.
    ///
    /// # Errors
    /// If one is not closed.
    pub(super) fn solids(&self) -> anyhow::Result<&[Solid]> {
        if !self.request.solid {
            return Ok(&[]);
        }
        if let Some(solids) = self.solids.get() {
            return Ok(solids);
        }
        let solids = overlaps::solids(&self.bodies)?;
        Ok(self.solids.get_or_init(|| solids))
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

    /// The bodies as a report lists them.
    pub(super) fn body_lines(&self) -> Vec<BodyLine> {
        self.bodies.iter().map(BodyLine::new).collect()
    }

    /// Whether a file holds several bodies, so that names say more than numbers.
    pub(super) fn has_scenes(&self) -> bool {
        self.bodies.len() > self.request.inputs.paths.len()
    }

    /// The bodies with a feature of this kind.
    pub(super) fn with(&self, kind: FeatureKind) -> impl Iterator<Item = usize> {
        let bodies = 0..self.bodies.len();
        bodies.filter(move |&body| self.bodies[body].count(kind) > 0)
    }

    /// The bodies of the first and of the second feature, for every combination that can have pairs.
    pub(super) fn couples(&self) -> impl Iterator<Item = [usize; 2]> {
        let (kind_a, kind_b) = self.kinds();
        self.with(kind_a)
            .flat_map(move |a| self.with(kind_b).map(move |b| [a, b]))
            .filter(|&bodies| self.is_couple(bodies))
    }

    /// How many [couples](Self::couples) there are.
    pub(super) fn couple_count(&self) -> u64 {
        let (kind_a, kind_b) = self.kinds();
        let bodies = |kind| self.with(kind).count() as u64;
        let both = self
            .with(kind_a)
            .filter(|&body| self.bodies[body].count(kind_b) > 0);
        let both = both.count() as u64;
        let all = bodies(kind_a) * bodies(kind_b);
        let of_two = if kind_a == kind_b {
            (all - both) / 2
        } else {
            all - both
        };
        of_two + if self.request.within { both } else { 0 }
    }

    /// Whether the body of the first feature and that of the second may be these.
    pub(super) fn is_couple(&self, [a, b]: [usize; 2]) -> bool {
        let (kind_a, kind_b) = self.kinds();
        (a != b || self.request.within) && (a <= b || kind_a != kind_b)
    }

    /// The number of features over which there are trees.
    pub(super) fn features(&self) -> usize {
        let (kind_a, kind_b) = self.kinds();
        let second = (kind_b != kind_a).then_some(kind_b);
        let kinds = || [kind_a].into_iter().chain(second);
        let bodies = self.bodies.iter();
        bodies
            .map(|body| kinds().map(|kind| body.count(kind)).sum::<usize>())
            .sum()
    }

    /// The bodies without a feature of this kind.
    pub(super) fn without(&self, kind: FeatureKind) -> impl Iterator<Item = usize> {
        let bodies = self.bodies.iter().enumerate();
        bodies.filter_map(move |(number, body)| (body.count(kind) == 0).then_some(number))
    }

    /// The bodies that have a feature of a pair. They are the bodies of the scene, in this order.
    fn present(&self) -> Vec<usize> {
        let (kind_a, kind_b) = self.kinds();
        let has = |body: &usize| {
            [kind_a, kind_b]
                .iter()
                .any(|kind| self.bodies[*body].count(*kind) > 0)
        };
        (0..self.bodies.len()).filter(has).collect()
    }

    /// The scene for the exact methods.
    pub(super) fn scene(&self, method: Method) -> anyhow::Result<scene::World> {
        let mut scene = scene::World::new(self.request.kind, self.threshold).with_method(method);
        for body in self.present() {
            let body = &self.bodies[body];
            scene.add(if self.request.within {
                Body::deforming(body.placed()?.into_owned()).beyond_ring(self.ring_width())
            } else {
                body.fixed()
            })?;
        }
        Ok(scene)
    }

    /// Measures pairs that are known.
    pub(super) fn measure(&self) -> anyhow::Result<Measure> {
        let mut scene = scene::World::new(self.request.kind, self.threshold);
        let mut ids = vec![None; self.bodies.len()];
        for body in self.present() {
            ids[body] = Some(scene.add(self.bodies[body].fixed())?);
        }
        let bodies = self.present();
        Ok(Measure { scene, ids, bodies })
    }

    /// Contacts of a [scene](Self::scene) as pairs of features of the bodies.
    pub(super) fn pairs(&self, contacts: impl Iterator<Item = Contact>) -> impl Iterator<Item = Pair> {
        let present = self.present();
        contacts.map(move |contact| {
            let side = |body: BodyId, feature| Feature {
                body: present[body.index()] as u32,
                feature,
            };
            Pair {
                a: side(contact.body_a, contact.a),
                b: side(contact.body_b, contact.b),
            }
        })
    }

    /// How many pairs of features there are, excluded ones of one body included.
    pub(super) fn size(&self) -> u64 {
        let (kind_a, kind_b) = self.kinds();
        let counts = || {
            let of = |kind: FeatureKind, body: &NamedBody| body.count(kind) as u128;
            self.bodies
                .iter()
                .map(move |body| (of(kind_a, body), of(kind_b, body)))
        };
        let sum = |part: fn((u128, u128)) -> u128| counts().map(part).sum::<u128>();
        let (all, own) = (sum(|(m, _)| m) * sum(|(_, n)| n), sum(|(m, n)| m * n));
        let between = if kind_a == kind_b {
            (all - own) / 2
        } else {
            all - own
        };
        let within = match self.request.within {
            false => 0,
            true if kind_a == kind_b => sum(|(m, _)| m * m.saturating_sub(1) / 2),
            true => own,
        };
        u64::try_from(between + within).unwrap_or(u64::MAX)
    }
}

/// Distances of pairs, without the memory that a search for them needs.
pub(super) struct Measure {
    scene: scene::World,
    ids: Vec<Option<BodyId>>,
    /// The number of each body of the scene.
    bodies: Vec<usize>,
}

impl Measure {
    /// Distance and closest points of a pair of features.
    pub(super) fn proximity(&self, pair: &Pair) -> anyhow::Result<Proximity> {
        let id = |body: u32| self.ids.get(body as usize).copied().flatten();
        let (Some(body_a), Some(body_b)) = (id(pair.a.body), id(pair.b.body)) else {
            bail!("{pair}: no pair of this scene");
        };
        Ok(self.scene.proximity(Contact {
            body_a,
            body_b,
            a: pair.a.feature,
            b: pair.b.feature,
        })?)
    }

    /// The bodies whose boxes are within a distance of the box of this one, itself included, in order.
    pub(super) fn near(&mut self, body: usize, distance: Threshold) -> anyhow::Result<Vec<usize>> {
        let Some(id) = self.ids[body] else {
            return Ok(Vec::new());
        };
        let Aabb { min, max } = self.scene.bounds(id)?;
        let region = Aabb {
            min: min.map(|c| (c - distance.get()).next_down()),
            max: max.map(|c| (c + distance.get()).next_up()),
        };
        let near = self.scene.bodies_in(&region)?.into_iter();
        Ok(near.map(|near| self.bodies[near.index()]).collect())
    }
}
