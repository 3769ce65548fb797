//! The candidates of each source, and the enumeration of a lattice.

use super::Sources;
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::engine::Ask;
use crate::engine::local::recombination::recombine;
use crate::engine::portfolio::source::{Source, Tag};
use crate::engine::portfolio::visited::Visited;
use crate::scalar::Real;
use crate::seed::SearchRng;

/// Points that an enumeration proposes at once.
pub(super) const SCANNED: usize = 256;
/// A descent is asked so many times for a point that is not known.
const DESCENT_TRIES: usize = 64;
/// Pairs of hits that are recombined for a point that is not known. Of a product of sets most recombinations become known.
const CROSS_TRIES: usize = 4;

impl<S: Real> Sources<S> {
    /// Whether a position is inside and worth an evaluation: no known hit, and on a lattice not proposed before. Elsewhere an evaluation of
    /// a quick F costs less than the look-up among many close hits.
    pub(super) fn is_fresh(&mut self, context: &dyn Context<S>) -> bool {
        let space = context.space();
        let has_others = self.has_hits_of_others(context);
        let inside = space.axes().iter().zip(&self.position).all(|(axis, &x)| {
            axis.start() <= x
                && if axis.is_integer() {
                    x < axis.end()
                } else {
                    x <= axis.end()
                }
        });
        inside
            && match &mut self.visited {
                Some(visited) => {
                    visited.insert(space, &self.position)
                        && !(has_others && context.is_deleted(&self.position))
                }
                None => self.is_quick || !context.is_deleted(&self.position),
            }
    }

    /// Proposes one candidate; `false` where the source has none left for this batch.
    pub(super) fn propose(
        &mut self,
        tag: Tag,
        context: &dyn Context<S>,
        rng: &mut SearchRng,
        out: &mut Batch<S>,
    ) -> bool {
        let (source, index) = tag;
        let proposed = match source {
            Source::Swarm => {
                self.swarms
                    .propose(context.space(), self.visited.as_ref(), &mut self.even, rng, out)
            }
            Source::Descent => {
                if self.descended == self.block {
                    return false;
                }
                self.descended += 1;
                let mut turns = (0..self.block).map(|k| (self.next_descent + k) % self.block);
                let Some(index) = turns.find(|&index| !self.waiting[index]) else {
                    return false;
                };
                self.next_descent = (index + 1) % self.block;
                // At a point that is known it goes on at once: its turn is not for other sources.
                let mut tries = 0;
                while tries < DESCENT_TRIES && !context.is_out_of_time() {
                    self.descents[index].propose(context, rng, out);
                    if !self.is_repeated(context, (source, index), out) {
                        self.tags.push((source, index));
                        self.waiting[index] = true;
                        break;
                    }
                    tries += 1;
                }
                return true;
            }
            Source::Guest => return false,
            Source::Uniform => {
                if self.visited.as_ref().is_some_and(Visited::is_dense) {
                    if !self.scan_on(context, rng) {
                        return false;
                    }
                } else {
                    let space = context.space();
                    // Of random keys the order counts, and most points of a grid have keys in common.
                    let is_blind = !self.has_slopes() && !self.has_neighbours;
                    let is_in_grid = is_blind && self.grid.draw(space, self.planned, rng, &mut self.position);
                    if !is_in_grid {
                        self.even.draw_inwards(space, rng, &mut self.position);
                    }
                    if !self.is_fresh(context) {
                        return true; // this draw was rejected, the next may be accepted
                    }
                }
                out.push(&self.position);
                Some(0)
            }
            Source::Step => {
                let Some(steps) = &mut self.steps else {
                    return false;
                };
                if !steps.apply(index, &self.hits, &mut self.position) {
                    return false;
                }
                if !self.is_fresh(context) {
                    return true;
                }
                out.push(&self.position);
                Some(index)
            }
            Source::Trial => {
                if !self.draw_trial(rng) || !self.is_fresh(context) {
                    // Counts as a miss; otherwise an exhausted source would be asked forever.
                    self.rejected(Source::Trial);
                    return true;
                }
                out.push(&self.position);
                self.trials
                    .truncate((self.trials.len() / self.position.len()) * self.position.len());
                Some(self.trials.len() / self.position.len() - 1)
            }
            Source::Cross => {
                let is_new = (0..CROSS_TRIES)
                    .any(|_| recombine(&self.hits, rng, &mut self.position) && self.is_fresh(context));
                if !is_new {
                    self.rejected(Source::Cross);
                    return true;
                }
                out.push(&self.position);
                Some(0)
            }
            Source::Neighbour | Source::NearMiss => {
                let position = &mut self.position;
                let is_there = match source {
                    Source::Neighbour => {
                        let visited = self.visited.as_ref();
                        self.neighbourhoods.propose(context, visited, position)
                    }
                    _ => self.near_misses.propose(position),
                };
                if !is_there {
                    return false;
                }
                if !self.is_fresh(context) {
                    return true;
                }
                out.push(&self.position);
                Some(0)
            }
        };
        let Some(index) = proposed else {
            return false;
        };
        if source == Source::Swarm && self.is_repeated(context, (source, index), out) {
            return true;
        }
        self.tags.push((source, index));
        true
    }

    /// Whether there are hits that the engine is not told of, such as those of other islands: they are not among the visited points.
    fn has_hits_of_others(&self, context: &dyn Context<S>) -> bool {
        context.hits() > self.hits.rows()
    }

    /// Whether points of a source are remembered among those visited, and no point is proposed twice. Of a large lattice that takes longer
    /// than a quick F, and descents seldom repeat a point.
    fn remembers(&self, source: Source) -> bool {
        let may_forget = source == Source::Descent && self.is_quick;
        !(may_forget && self.visited.as_ref().is_some_and(Visited::is_large))
    }

    /// Takes back the last proposal of a swarm or a descent if that point was visited before. Its source is told of a point
    /// without a new hit, and a miss is counted.
    fn is_repeated(&mut self, context: &dyn Context<S>, (source, index): Tag, out: &mut Batch<S>) -> bool {
        let space = context.space();
        let has_others = self.has_hits_of_others(context);
        let last = out.len() - 1;
        if !self.remembers(source) {
            space.keep_inside(out.point_mut(last));
            return false;
        }
        let Some(visited) = &mut self.visited else {
            return false;
        };
        space.keep_inside(out.point_mut(last));
        // A descent has looked whether it is a known hit.
        let may_be_known = has_others && source != Source::Descent;
        if visited.insert(space, out.point(last)) && !(may_be_known && context.is_deleted(out.point(last))) {
            return false;
        }
        match source {
            Source::Swarm => self.swarms.tell(index, out.point(last), Outcome::NonFinite),
            _ => self.descents[index].learn(out.point(last), Outcome::NonFinite),
        }
        self.rejected(source);
        out.truncate(last);
        true
    }

    /// Counts a miss of a point that is not evaluated.
    fn rejected(&mut self, source: Source) {
        self.rejections += 1;
        self.credits[source as usize].count(false, 1.0);
    }

    /// Writes the next point of the lattice that is not visited; `false` at its end.
    fn scan_on(&mut self, context: &dyn Context<S>, rng: &mut SearchRng) -> bool {
        let Some(visited) = &mut self.visited else {
            return false;
        };
        let space = context.space();
        let found = self.scan.next(space, visited, rng, &mut self.position);
        if found {
            visited.insert(space, &self.position);
        }
        found
    }

    /// Enumerates the rest of the lattice, a block at a time.
    pub(super) fn enumerate(
        &mut self,
        context: &dyn Context<S>,
        rng: &mut SearchRng,
        out: &mut Batch<S>,
    ) -> Ask {
        while out.len() < SCANNED && self.scan_on(context, rng) {
            out.push(&self.position);
        }
        self.tags
            .resize(out.len(), (Source::Uniform, usize::from(self.scan.is_sample())));
        if self.scan.is_over() || self.visited.as_ref().is_some_and(Visited::is_all) {
            Ask::Covered
        } else {
            Ask::More
        }
    }

    /// Writes a hit moved by the difference of two others, and appends that difference to `trials`; `false` where it is zero.
    /// Half of the pairs are neighbours in the order found, which are near to each other in space.
    fn draw_trial(&mut self, rng: &mut SearchRng) -> bool {
        let dimension = self.position.len();
        let count = self.hit_count();
        let (a, b) = (rng.below(count), rng.below(count));
        let (reach, far) = rng.uniform_and_sign();
        let c = if far {
            rng.below(count)
        } else {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 7")]
            let apart = 1 + (8.0 * reach) as usize;
            if b >= apart {
                b - apart
            } else {
                (b + apart).min(count - 1)
            }
        };
        let mut moves = false;
        let start = self.trials.len();
        for j in 0..dimension {
            let difference = self.hits.row(b)[j] - self.hits.row(c)[j];
            moves |= difference != S::zero();
            self.trials.push(difference);
            self.position[j] = self.hits.row(a)[j] + difference;
        }
        if !moves {
            self.trials.truncate(start);
        }
        moves
    }
}
