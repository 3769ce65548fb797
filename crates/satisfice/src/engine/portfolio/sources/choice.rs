//! Which source is next.

use super::Sources;
use crate::context::Context;
use crate::engine::portfolio::Omitted;
use crate::engine::portfolio::credit::{Trial, draw};
use crate::engine::portfolio::guests::{Expectation, Seekers};
use crate::engine::portfolio::source::{Role, Source, Tag};
use crate::scalar::Real;
use crate::seed::SearchRng;

/// A choice of source lasts for one more candidate every `TURN` evaluations, up to `LONGEST_TURN`: choosing costs time.
const TURN: u64 = 128;
const LONGEST_TURN: u64 = 8;
const LONGEST_TURN_WHERE_QUICK: u64 = 32;
/// Weights of uniform points and of swarms where F is a step function, which has no slope to descend.
const BLIND: f64 = 4.0;
const BLIND_SWARMS: f64 = 20.0;
/// The weight of swarms that have not converged yet.
const UNCONVERGED: f64 = 4.0;
/// Share of the choices that is niching's while no source finds anything.
const NICHING: f64 = 0.5;

impl<S: Real> Sources<S> {
    /// The source chosen last while its turn lasts, otherwise a new choice; and how many candidates are to come from it.
    pub(super) fn next_source(&mut self, context: &dyn Context<S>, rng: &mut SearchRng) -> (Tag, u64) {
        if let Some((tag, left @ 1..)) = self.chosen
            && (tag.0 != Source::Guest || self.guests.is_ready(tag.1))
        {
            return (tag, left);
        }
        let longest = if self.is_quick {
            LONGEST_TURN_WHERE_QUICK
        } else {
            LONGEST_TURN
        };
        let all = &self.credits.whole;
        let turn = (all.evaluations() / TURN).min(longest);
        let seekers = self.seekers();
        let expectation = if seekers.is_some() || self.has_slopes() && self.guests.model_leads(all) {
            self.guests.expectation(seekers, context, rng)
        } else {
            None
        };
        let chosen = (
            self.choose(seekers, expectation, rng),
            turn.max(self.block as u64),
        );
        self.chosen = Some(chosen);
        chosen
    }

    /// Who looks for the first hit beside a model, while that goes on.
    fn seekers(&self) -> Option<Seekers> {
        if !self.has_slopes() {
            return None;
        }
        self.guests.seekers(&self.credits.whole, self.planned)
    }

    /// Whether F may have slopes: it is not known to be a step function.
    pub(super) fn has_slopes(&self) -> bool {
        !self.levels.are_few()
    }

    /// Chooses a source, with the index of the step for [`Source::Step`].
    fn choose(&self, seekers: Option<Seekers>, expectation: Option<Expectation>, rng: &mut SearchRng) -> Tag {
        let all = &self.credits.whole;
        if let Some(seekers) = seekers {
            let seeker = seekers.draw(all.evaluations(), expectation, rng);
            return match seekers.guest(seeker) {
                Some(guest) => (Source::Guest, guest),
                None => (Source::Descent, 0),
            };
        }
        if self.drought.is_long(self.position.len(), self.hit_count())
            && let Some(niching) = self.guests.niching()
            && rng.uniform() < NICHING
        {
            return (Source::Guest, niching);
        }
        let trial = if self.guests.model_leads(all) || !self.has_slopes() {
            Trial::beside_model(self.barren(), all.missed())
        } else {
            Trial::alone()
        };
        let drawn = self.draw(trial, expectation, rng);
        drawn
            .or_else(|| self.draw(Trial::free(), expectation, rng))
            .unwrap_or((Source::Uniform, 0))
    }

    /// Draws a source by its yield, among those which `trial` allows and which are not left out of this batch.
    fn draw(&self, trial: Trial, expectation: Option<Expectation>, rng: &mut SearchRng) -> Option<Tag> {
        let uses = |source: Omitted| self.without != source;
        let all = &self.credits.whole;
        let price = all.price();
        let modelled = self.guests.model_leads(all);
        let steps = !self.has_slopes();
        let is_lattice = self.visited.is_some();
        let [uniform, swarm] = if steps { [BLIND, BLIND_SWARMS] } else { [0.3, 0.5] };
        let mut best = None;
        let mut offer = |yields: f64, tag: Tag| {
            let worth = self.patches.worth(self.role(tag), yields);
            if !self.dry.has(self.place(tag)) && best.is_none_or(|(most, _)| worth > most) {
                best = Some((worth, tag));
            }
        };
        let credit = |source: Source| &self.credits[source as usize];
        let is_worth = |source: Source| credit(source).is_worth_trying(&self.credits.whole, trial);
        let yields =
            |source: Source, weight: f64, rng: &mut SearchRng| credit(source).draw(price, weight, rng);
        if steps || is_worth(Source::Uniform) {
            offer(yields(Source::Uniform, uniform, rng), (Source::Uniform, 0));
        }
        if uses(Omitted::Descents) && ((is_lattice && !modelled) || is_worth(Source::Descent)) {
            offer(yields(Source::Descent, 4.0, rng), (Source::Descent, 0));
        }
        let converges = !modelled && !steps && !is_lattice && credit(Source::Swarm).is_converging(all);
        if uses(Omitted::Swarms) && (steps || converges || is_worth(Source::Swarm)) {
            let swarm = if converges { UNCONVERGED } else { swarm };
            offer(yields(Source::Swarm, swarm, rng), (Source::Swarm, 0));
        }
        let hits = self.hit_count();
        if uses(Omitted::Learning) && hits >= 3 && is_worth(Source::Trial) {
            offer(yields(Source::Trial, 1.0, rng), (Source::Trial, 0));
        }
        if uses(Omitted::Recombination) && hits >= 2 && self.position.len() > 1 && is_worth(Source::Cross) {
            offer(yields(Source::Cross, 1.0, rng), (Source::Cross, 0));
        }
        if uses(Omitted::Steps)
            && (!modelled || is_worth(Source::Step))
            && let Some(index) = self.steps.as_ref().and_then(|steps| steps.best(hits))
        {
            offer(yields(Source::Step, 2.0, rng), (Source::Step, index));
        }
        if self.neighbourhoods.has_more() && (!modelled || is_worth(Source::Neighbour)) {
            offer(yields(Source::Neighbour, 2.0, rng), (Source::Neighbour, 0));
        }
        if uses(Omitted::NearMisses)
            && let Some((good, all)) = self.near_misses.posterior()
        {
            offer(draw(rng, good, all), (Source::NearMiss, 0));
        }
        for (index, weight) in self.guests.weights(&self.credits, trial, modelled, steps) {
            let yields = match expectation {
                Some(expectation) if expectation.index == index => expectation.hit,
                _ => self.credits[self.guests.place(index)].draw(price, weight, rng),
            };
            offer(yields, (Source::Guest, index));
        }
        best.map(|(_, tag)| tag)
    }

    /// Number of sources without a hit, of those that are drawn by their yield.
    fn barren(&self) -> usize {
        const DRAWN: [Source; 7] = [
            Source::Uniform,
            Source::Swarm,
            Source::Step,
            Source::Trial,
            Source::Cross,
            Source::Neighbour,
            Source::Descent,
        ];
        let drawn = DRAWN.iter().map(|&source| source as usize);
        let places = drawn.chain(self.guests.drawn());
        places.filter(|&place| self.credits[place].is_barren()).count()
    }

    /// The index of a source among the names of all.
    pub(super) fn place(&self, (source, index): Tag) -> usize {
        match source {
            Source::Guest => self.guests.place(index),
            _ => source as usize,
        }
    }

    pub(super) fn role(&self, (source, index): Tag) -> Role {
        match source {
            Source::Guest => self.guests.role(index),
            _ => source.role(),
        }
    }
}
