//! How a batch is filled.

use super::Sources;
use super::dry::Dry;
use super::proposals::SCANNED;
use crate::batch::Batch;
use crate::context::Context;
use crate::engine::Ask;
use crate::engine::portfolio::guests::GuestAnswer;
use crate::engine::portfolio::source::Source;
use crate::engine::portfolio::visited::Visited;
use crate::scalar::Real;
use crate::seed::SearchRng;

/// After this many choices of a source that gave no candidate a batch ends; while it is empty, the sources of those choices are left out of it, and
/// others go on. A batch for which sources were left out halves the number, down to `LEAST_REJECTED`, so that a search which knows nearly all hits
/// does not try in vain; each other batch doubles it.
pub(super) const REJECTED: usize = 100;
const LEAST_REJECTED: usize = 10;
/// Fewest points of the first batch, in which no point can learn from another. With a model of F it is a single point.
const FIRST: usize = 4;
/// Batches grow by one point every `SLOW` evaluations, up to `LARGEST`: small ones learn sooner, large ones cost less time.
const SLOW: usize = 2048;
const LARGEST: usize = 32;
/// F is quick below so many seconds: then batches are of that size at once, and choices last longer. Known only where time alone is limited.
const QUICK: f64 = 2e-6;

impl<S: Real> Sources<S> {
    /// Where time alone is limited, notes whether F is quick.
    fn look_at_price(&mut self, context: &dyn Context<S>) {
        self.is_quick = false;
        if context.is_timed() {
            self.is_quick = context.seconds_an_evaluation().is_some_and(|price| price < QUICK);
            self.credits.remember(self.is_quick);
        }
    }

    /// Fills a batch.
    pub(super) fn fill(&mut self, context: &dyn Context<S>, rng: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        self.dry = Dry::default();
        self.swarms.begin_batch();
        self.descended = 0;
        let in_any_order = context.is_in_any_order();
        if !in_any_order {
            self.guests.begin_batch();
        }
        // With fewer than `wanted` candidates, workers would wait.
        let made = usize::try_from(self.credits.whole.evaluations()).unwrap_or(usize::MAX);
        let first = if made == 0 && !self.guests.has_model() {
            FIRST
        } else {
            1
        };
        let at_once = context.parallel().max(first);
        let wanted = self.asked_for.unwrap_or(if in_any_order { 1 } else { at_once });
        self.has_neighbours = context.offers_neighbours();
        self.look_at_price(context);
        let usual = if self.is_quick {
            LARGEST
        } else {
            (made / SLOW).clamp(1, LARGEST)
        };
        self.batch = self.asked_for.unwrap_or(usual.max(wanted));
        let at_work = if in_any_order { at_once } else { self.batch };
        self.block = at_work.div_ceil(4);
        self.grow_descents(self.block);
        self.guests.look_at_price(context);
        self.guests.grow(context);
        let awaited = self.awaited.len();
        if let Some(visited) = &self.visited
            && self
                .scan
                .goes_on(context, visited, awaited, SCANNED, &self.credits.whole)
        {
            return self.enumerate(context, rng, out);
        }
        let mut rejected = 0;
        while out.len() < self.batch && !context.is_out_of_time() {
            if rejected >= self.patience {
                if !out.is_empty() || !self.dry.leave_out() {
                    break;
                }
                self.chosen = None;
                rejected = 0;
            }
            let (tag, left) = self.next_source(context, rng);
            let before = out.len();
            let room = (self.batch - before).min(usize::try_from(left).unwrap_or(usize::MAX));
            let place = self.place(tag);
            let watch = self.pace.proposes(place);
            if tag.0 == Source::Guest {
                let (credit, idle_cost) = (&mut self.credits[place], self.pace.idle_cost(place));
                let answer = self.guests.ask(
                    tag.1,
                    context,
                    rng,
                    out,
                    (wanted, self.batch - before, idle_cost),
                    credit,
                );
                self.tags.resize(out.len(), tag);
                let cost = match answer {
                    GuestAnswer::Worked(cost) => cost,
                    GuestAnswer::Covered | GuestAnswer::Nothing => 1,
                };
                self.pace.proposed(place, watch, cost);
                match answer {
                    GuestAnswer::Covered => return Ask::Covered,
                    GuestAnswer::Worked(cost) if out.len() >= wanted || out.is_empty() => {
                        self.chosen = Some((tag, left.saturating_sub(cost.max(1))));
                        self.pace.sends();
                        return Ask::More;
                    }
                    GuestAnswer::Worked(_) => self.chosen = None,
                    GuestAnswer::Nothing => {
                        self.chosen = None;
                        self.dry.note(place);
                        rejected += 1;
                    }
                }
                continue;
            }
            self.rejections = 0;
            let mut has_more = true;
            for _ in 0..room {
                has_more = self.propose(tag, context, rng, out);
                if !has_more {
                    break;
                }
            }
            let made = (out.len() - before) as u64;
            self.pace.proposed(place, watch, made + self.rejections);
            // A source that takes turns with itself goes on in the next batch where choosing costs more than F, and so do descents outside
            // lattices, whose turn a batch of several points would cut after one or two.
            let takes_turns = self.is_quick || tag.0 == Source::Descent && self.visited.is_none();
            if takes_turns && !has_more && made > 0 && left > made && out.len() >= wanted {
                self.chosen = Some((tag, left - made));
                break;
            }
            // Around hits of the model most points are known: steps go on to where they are not.
            let goes_on = made > 0 || tag.0 == Source::Step && self.guests.modelled();
            self.chosen = (has_more && goes_on).then_some((tag, left - made));
            // A source with nothing left ends the batch, so that worse sources do not fill it, unless workers would wait.
            if out.len() == before {
                if !out.is_empty() && out.len() >= wanted {
                    break;
                }
                self.dry.note(place);
                rejected += 1;
            }
        }
        if out.is_empty() && self.visited.as_ref().is_some_and(Visited::is_all) {
            return Ask::Covered;
        }
        self.patience = if self.dry.has_any() {
            (self.patience / 2).max(LEAST_REJECTED)
        } else {
            (self.patience * 2).min(REJECTED)
        };
        // No source has anything new. Propose uniform points, known or not.
        let least = if self.visited.is_some() { 1 } else { wanted };
        while out.len() < least {
            rng.position(context.space(), &mut self.position);
            if let Some(visited) = &mut self.visited {
                visited.insert(context.space(), &self.position);
            }
            out.push(&self.position);
            self.tags.push((Source::Uniform, 0));
        }
        self.pace.sends();
        Ask::More
    }
}
