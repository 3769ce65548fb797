//! The engine `surrogate`: a Gaussian process says where the next hit probably is.

use super::local::{Given, Model, ModelProposal, PendingPoint, design_size};
use super::one_answer::OneAnswer;
use super::promise::Promise;
use super::record::{PointKind, Record};
use super::skill::{Skill, Yardstick};
use super::units::Units;
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::compiled::both_scalars;
use crate::engine::low_discrepancy::EvenPoints;
use crate::engine::{Answers, Ask, Engine, EngineConfig, Origin};
use crate::engine_settings;
use crate::error::Error;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::state::{Part, Reader, State};

engine_settings! {
    /// After a low-discrepancy design of `d + 2` points, at most 12 on up to 1,000 axes, each proposal is the candidate with the highest probability of
    /// `F < delta` under a Gaussian process with a Matérn 5/2 kernel and a length scale for each axis:
    ///
    /// - Candidates are half uniform, half near hits and points of least F at several scales, then around the best candidate, closer and
    ///   closer; these are kept for two proposals.
    /// - A candidate that is a known point, or the same as a hit, is excluded; so is one within the separation radius of a point that is
    ///   proposed, not told yet, and probably a hit. Where such points will say more of a candidate, it waits: its probability p counts
    ///   `p (1 - (1 - s) (1 - p))`, where s is the share of its variance that their values will leave. The design goes on until as many points
    ///   are told.
    /// - The model learns `F - delta`, clipped at the 80 % quantile of the misses. Where F takes few values, such as a number of violated
    ///   constraints, delta is taken to be halfway between those of hits and of misses.
    /// - A point without a finite F counts as bad if most of the eight points next to it have none either, or fewer are known. Elsewhere it
    ///   failed by chance and is left out.
    /// - Where the problem tells the [components](crate::Components) of F, each is modelled, with length scales in common, and the score
    ///   is the probability that all are within their limits; that the sum of their squares is at most 1, where F turns out to be their
    ///   Euclidean norm or its square. Damped Gauss-Newton steps lead from candidates to roots of the models.
    /// - Points that turn out to be the same as a hit only once they are evaluated are no part of the model; from them the
    ///   engine learns how far apart distinct hits are.
    /// - Logarithmic axes are seen by their logarithm, periodic ones as circles, permutations by the ranks of their keys. Integers are rounded
    ///   before the kernel sees them, and any two categories are equally far apart.
    /// - Where hits are represented by other points (the middle of what counts as the same as the first hit is not that hit), all hits around
    ///   a point are one answer. The probability of a hit beside such a region counts as far as the model's word was true there.
    /// - Scales are the likeliest ones under a weak prior, found anew whenever the points are an eighth more, or 40.
    /// - Beyond `points` points a model knows the 128 points next to a hit, and the next one those next to another.
    ///
    /// Cost of a proposal: O(n²) for n points that a model knows; see `docs/results/expensive.md`. For an F that takes a
    /// millisecond or more, and 20 to 500 evaluations.
    ///
    /// ```
    /// use satisfice::{Budget, Search, Space, engine::Surrogate, from_fn};
    /// // Where a curve of two parameters is nearly 0; suppose that each point takes a minute.
    /// let problem = from_fn(Space::cube(2, -2.0, 2.0)?, 0.1, |x: &[f64]| (x[0] * x[0] + x[1]).abs()).separation(0.2);
    /// let report = Search::with(Surrogate::default()).run(&problem, &Budget::evaluations(40))?;
    /// assert!(report.hit_count() >= 10);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    pub struct Surrogate {
        /// Points proposed at once, for evaluation in parallel; more if the search asks for more.
        pub batch: usize = 1, 1..=1024;
        /// Candidates that compete for each proposal.
        pub candidates: usize = 1024, 32..=1 << 20;
        /// Points that one model knows at most; beyond, models are local.
        pub points: usize = 500, 16..=5000;
    }
}

impl EngineConfig for Surrogate {
    const NAME: &'static str = "surrogate";
    const SUMMARY: &'static str =
        "Gaussian process that proposes where a hit is most probable, for 20 to 500 expensive evaluations";
    const CITATION: &'static str = "after Bryan et al. 2005, NIPS 18, and Gotovos et al. 2013, IJCAI 23; Matérn kernels: Rasmussen, Williams 2006, ISBN 026218253X";
    const EXPENSIVE_PROPOSALS: bool = true;

    both_scalars!();
}

impl Surrogate {
    fn engine<S: Real>(&self) -> Box<dyn Engine<S>> {
        Box::new(ModelledSearch::new(self.clone()))
    }
}

/// So many points that are awaited, the latest, count as told with the values expected: each takes as long as a point that is known.
const MOST_BELIEVED: usize = 32;
/// Uniform points that are tried where no candidate is left.
const TRIES: usize = 64;
/// Spaces of at most so many points are searched to the last one.
const ENUMERABLE: f64 = 1e6;

/// The engine of [`Surrogate`].
#[derive(Debug)]
pub(in crate::engine) struct ModelledSearch<S> {
    settings: Surrogate,
    units: Units,
    record: Record,
    /// The first points.
    design: EvenPoints,
    /// First points that were looked at.
    started: usize,
    /// Points that are proposed and not told yet.
    pending: Vec<PendingPoint>,
    model: Option<Model>,
    skill: Skill,
    /// What it expects of its proposals.
    promise: Promise,
    /// The regions of hits that are one answer.
    one_answer: OneAnswer,
    /// The next proposal, from [`Self::expectation`] until it is asked for or more is told.
    prepared: Option<ModelProposal>,
    position: Vec<S>,
    /// Points to be proposed at once, where that is not left to the settings and the search.
    at_once: Option<usize>,
    /// Points of the enumeration that were looked at.
    enumerated: usize,
}

impl<S: Real> ModelledSearch<S> {
    pub(in crate::engine) fn new(settings: Surrogate) -> Self {
        Self {
            settings,
            units: Units::default(),
            record: Record::default(),
            design: EvenPoints::default(),
            started: 0,
            pending: Vec::new(),
            model: None,
            skill: Skill::default(),
            promise: Promise::default(),
            one_answer: OneAnswer::default(),
            prepared: None,
            position: Vec::new(),
            at_once: None,
            enumerated: 0,
        }
    }

    /// How many points it is to propose at once from now on.
    pub(in crate::engine) fn set_batch(&mut self, points: usize) {
        self.at_once = Some(points.max(1));
    }

    /// Whether the model predicts F better than this mean does; `None` before that is known.
    pub(in crate::engine) fn is_useful(&self, yardstick: Yardstick) -> Option<bool> {
        self.skill.is_useful(yardstick)
    }

    /// Whether it expects no hit of its latest proposals.
    pub(in crate::engine) fn promises_little(&self) -> bool {
        self.promise.is_little()
    }

    /// How probable a hit of this probability is, as far as the model's word can be trusted.
    pub(in crate::engine) fn believed(&self, probability: f64) -> f64 {
        self.promise.believed(probability)
    }

    /// Prepares the next proposal, unless that is done: how probable a hit is, as far as the model's word can be trusted. `None` while there
    /// is no model.
    pub(in crate::engine) fn expectation(
        &mut self,
        context: &dyn Context<S>,
        rng: &mut SearchRng,
    ) -> Option<f64> {
        if self.prepared.is_none() {
            self.prepared = self.modelled(context, rng);
        }
        let proposal = self.prepared.as_ref()?;
        Some(self.believed(proposal.probability))
    }

    /// Points that were told, those of known solutions aside.
    fn told(&self) -> usize {
        self.record.len() - self.record.duplicates.len()
    }

    /// The next point of the design that is new: the first one is the middle, where axes have one. Misses of others count for its points;
    /// while answers are awaited, it goes on.
    fn first_point(&mut self, context: &dyn Context<S>, rng: &mut SearchRng) -> Option<Vec<f64>> {
        let (axes, size) = (self.units.len(), design_size(self.units.len()));
        let mut x = Vec::new();
        let misses = self.told() - self.record.hits.len();
        for _ in 0..TRIES.max(size) {
            if self.started.max(misses) >= size && self.told() >= size {
                break;
            }
            x.clear();
            if self.started == 0 && self.units.are_ordered() {
                x.resize(axes, 0.5);
            } else {
                x.extend(self.design.next_point(axes, rng));
            }
            self.started += 1;
            self.units.round(&mut x);
            if self.is_new(context, &x) {
                return Some(x);
            }
        }
        None
    }

    fn is_new(&mut self, context: &dyn Context<S>, x: &[f64]) -> bool {
        let space = context.space();
        let mut rounded = Vec::new();
        self.units.to_position(space, x, &mut self.position);
        self.units.of_position(space, &self.position, &mut rounded);
        let pending = self.pending.iter().any(|pending| pending.x == rounded);
        !pending && !self.record.has(&rounded) && !context.is_deleted(&self.position)
    }

    /// The best candidate of the model.
    fn modelled(&mut self, context: &dyn Context<S>, rng: &mut SearchRng) -> Option<ModelProposal> {
        if self.told() < design_size(self.units.len()) {
            return None;
        }
        self.one_answer
            .follow(context, &self.units, &self.record, &mut self.position);
        let mut given = Given {
            context,
            units: &self.units,
            record: &self.record,
            one_answer: &self.one_answer,
            position: &mut self.position,
        };
        let mut model = match self.model.take() {
            Some(model) if !model.is_due(&self.record) => model,
            old => Model::fit(
                &mut given,
                old,
                (self.settings.points, self.settings.candidates),
                rng,
            ),
        };
        model.follow(&self.record, &self.units, &mut self.skill);
        model.refresh(&mut given, rng);
        let known = model.process.len();
        let first = self.pending.len().saturating_sub(MOST_BELIEVED);
        for pending in &self.pending[first..] {
            model.process.believe(&pending.x);
        }
        let chosen = model.choose(&mut given, &self.pending, rng);
        if !self.pending.is_empty() {
            model.process.truncate(known);
            model.pool.truncate(&model.process, known);
        }
        self.model = Some(model);
        chosen
    }

    /// The next proposal of the model, and how probable it takes a hit to be.
    fn proposal(&mut self, context: &dyn Context<S>, rng: &mut SearchRng) -> Option<(Vec<f64>, f64)> {
        let prepared = self.prepared.take();
        let proposal = prepared.or_else(|| self.modelled(context, rng))?;
        self.promise.count(proposal.probability);
        if proposal.beside {
            self.one_answer.count(proposal.probability);
        }
        Some((proposal.x, proposal.probability))
    }

    /// A uniform point that is new, or the next new one of a small space.
    fn any_new(&mut self, context: &dyn Context<S>, rng: &mut SearchRng) -> Option<Vec<f64>> {
        let small = self.units.cardinality() <= ENUMERABLE;
        let mut x = vec![0.0; self.units.len()];
        for _ in 0..TRIES {
            x.iter_mut().for_each(|x| *x = rng.uniform());
            self.units.round(&mut x);
            if self.is_new(context, &x) {
                return Some(x);
            }
        }
        if !small {
            return Some(x);
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a million at most"
        )]
        let all = self.units.cardinality() as usize;
        while self.enumerated < all {
            self.units.nth(self.enumerated, &mut x);
            if self.is_new(context, &x) {
                return Some(x);
            }
            self.enumerated += 1;
        }
        None
    }

    /// Whether every point of the space was told.
    fn is_covered(&self) -> bool {
        #[expect(clippy::cast_precision_loss, reason = "below a million where it matters")]
        let told = self.record.distinct() as f64;
        told >= self.units.cardinality()
    }
}

impl<S: Real> Engine<S> for ModelledSearch<S> {
    fn begin(&mut self, context: &dyn Context<S>) {
        self.units = Units::of(context.space());
        self.record.clear(self.units.len());
        self.design = EvenPoints::default();
        self.started = 0;
        self.pending.clear();
        self.model = None;
        self.skill = Skill::default();
        self.promise = Promise::default();
        self.one_answer = OneAnswer::default();
        self.prepared = None;
        self.enumerated = 0;
        self.position = vec![S::zero(); context.space().dimension()];
    }

    fn ask(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        if self.is_covered() {
            return Ask::Covered;
        }
        let at_once = self
            .at_once
            .unwrap_or(self.settings.batch.max(context.parallel()));
        for proposed in 0..at_once {
            if proposed > 0 && context.is_out_of_time() {
                break;
            }
            let unknown = |x| (x, 0.0);
            let next = (self.first_point(context, rng).map(unknown))
                .or_else(|| self.proposal(context, rng))
                .or_else(|| self.any_new(context, rng).map(unknown));
            let Some((x, probability)) = next else { break };
            let mut rounded = Vec::new();
            self.units.to_position(context.space(), &x, &mut self.position);
            self.units
                .of_position(context.space(), &self.position, &mut rounded);
            out.push(&self.position);
            self.pending.push(PendingPoint {
                x: rounded,
                probability,
                is_lost: false,
            });
        }
        if out.is_empty() { Ask::Exhausted } else { Ask::More }
    }

    fn tell(&mut self, context: &dyn Context<S>, batch: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        let is_own = matches!(origin, Origin::Engine | Origin::Single { .. });
        let mut x = Vec::new();
        let mut components = vec![S::nan(); context.component_count()];
        for (point, outcome) in batch.points().zip(outcomes) {
            self.units.of_position(context.space(), point, &mut x);
            let place = self.pending.iter().position(|pending| pending.x == x);
            if *outcome == Outcome::NotEvaluated {
                // Somebody else may have proposed it: until more is known it would be the next proposal again.
                if let Some(place) = place {
                    self.pending[place].is_lost = true;
                    self.prepared = None;
                }
                continue;
            }
            if let Some(place) = place {
                self.pending.remove(place);
            }
            self.pending.retain(|pending| !pending.is_lost);
            self.prepared = None;
            match *outcome {
                Outcome::Hit(f) => {
                    self.record.add(&x, f.f64(), PointKind::Hit);
                    if is_own && self.model.is_some() {
                        self.promise.keep();
                        if self.one_answer.is_beside(&self.units, &x) {
                            self.one_answer.keep();
                        }
                    }
                }
                Outcome::Miss(f) => self.record.add(&x, f.f64(), PointKind::Miss),
                Outcome::Known(f) => self.record.add(&x, f.f64(), PointKind::Duplicate),
                Outcome::Deleted => self.record.add(&x, f64::NAN, PointKind::Duplicate),
                Outcome::NonFinite => self.record.add(&x, f64::NAN, PointKind::Miss),
                Outcome::NotEvaluated => {}
            }
            if !components.is_empty() {
                context.components(point, &mut components);
                let all: Vec<f64> = components.iter().map(|x| x.f64()).collect();
                self.record.add_components(&all);
            }
        }
    }

    fn answers(&self) -> Answers {
        Answers::AnyOrder
    }

    fn save(&self, state: &mut State) {
        self.record.save(state);
        Part::save(&self.design, state);
        Part::save(&self.started, state);
        Part::save(&self.pending, state);
        Part::save(&self.enumerated, state);
        Part::save(&self.position, state);
        Part::save(&self.units.saved(), state);
        Part::save(&(self.skill.saved(), self.promise.saved()), state);
        self.one_answer.save(state);
        Part::save(&self.prepared, state);
        Part::save(&self.model.is_some(), state);
        if let Some(model) = &self.model {
            model.save(state);
        }
    }

    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        self.record.restore(from)?;
        self.design = from.read()?;
        self.started = from.read()?;
        self.pending = from.read()?;
        self.enumerated = from.read()?;
        self.position = from.read()?;
        self.units = Units::restored(&from.read::<Vec<f64>>()?)
            .filter(|units| units.len() == self.record.axes())
            .ok_or_else(|| Error::State("its axes do not fit".to_owned()))?;
        let (skill, promise) = from.read()?;
        (self.skill, self.promise) = (Skill::restored(skill), Promise::restored(promise));
        self.one_answer = OneAnswer::restored(self.units.len(), from)?;
        self.prepared = from.read()?;
        if self
            .prepared
            .as_ref()
            .is_some_and(|proposal| proposal.x.len() != self.units.len())
        {
            return Err(Error::State("its next proposal does not fit".to_owned()));
        }
        self.model = if from.read()? {
            Some(Model::restore(&self.record, &self.units, from)?)
        } else {
            None
        };
        Ok(())
    }
}
