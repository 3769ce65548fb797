//! Going to the next frame: which bodies move, whose boxes meet now, and which records to examine. Linear in the bodies that
//! move.

use super::ahead::Ahead;
use super::body_tree::{Change, Meeting};
use super::pairs::{NONE, Status};
use super::{BodyId, World};
use crate::Aabb;
use crate::broad::{Box32, inflate};
use crate::distance::{Point, Threshold};
use crate::simd::dispatch;

/// The box of a moving body is widened by so many frames of its motion, where it goes...
pub(super) const FRAMES: f64 = 8.0;
/// ...and by so many in every direction...
pub(super) const ASIDE: f64 = 6.0;
/// ...but by at most these shares of its size.
pub(super) const MOST: f64 = 0.25;
pub(super) const MOST_ASIDE: f64 = 1.0 / 16.0;
/// A body that meets no other one has so many times as much room in every direction.
pub(super) const ALONE: f64 = 1.5;
/// All pairs are looked through, in their order in memory, if more than this share of the bodies leave their boxes.
const ALL_PAIRS: f64 = 1.0 / 64.0;
/// Pairs are looked through so many at a time: first for changed bodies, without a branch, then those.
const AT_A_TIME: usize = 1024;

impl World {
    /// Changes the threshold for the next frame, which searches all pairs of bodies again.
    pub fn set_threshold(&mut self, threshold: Threshold) {
        if threshold == self.threshold {
            return;
        }
        self.changing();
        let grows = threshold.get() > self.threshold.get();
        self.threshold = threshold;
        let records: Vec<u32> = self.pairs.iter().map(|(record, _)| record).collect();
        for record in records {
            let known = &mut self.pairs[record];
            known.slack = None;
            if known.status != Status::New {
                known.status = Status::Stale;
            }
            self.mark_dirty(record);
        }
        if grows {
            self.unpaired.clear();
            self.unpaired.extend(
                (0..)
                    .zip(&self.states)
                    .filter_map(|(slot, state)| state.as_ref().map(|_| slot)),
            );
        }
    }

    /// Lists a record to be examined.
    fn mark_dirty(&mut self, record: u32) {
        if !std::mem::replace(&mut self.pairs[record].is_dirty, true) {
            self.dirty.push(record);
        }
    }

    /// The known contacts are about to change: the changes of the last update are forgotten.
    pub(super) fn changing(&mut self) {
        self.answers += 1;
        self.log.begin();
    }

    /// Goes to the next frame, if anything has changed.
    pub(super) fn settle(&mut self) {
        self.clean_unpaired();
        if self.movers.is_empty() && self.unpaired.is_empty() {
            return;
        }
        self.changing();
        self.frame += 1;
        // not for records of which nothing is known, which pile up while nobody asks for contacts
        let is_known = std::mem::take(&mut self.has_known_dirty);
        let known = if is_known { self.dirty.len() } else { 0 };
        for at in 0..known {
            let record = self.dirty[at];
            let known = &mut self.pairs[record];
            if matches!(known.status, Status::Behind | Status::Partial) {
                (known.status, known.slack) = (Status::Stale, None);
            }
        }
        let frame = self.frame;
        let (states, whereabouts) = (&self.states, &self.whereabouts);
        self.movers.clean(|slot| {
            let slot = slot as usize;
            states[slot].is_some() && (whereabouts[slot].moved_at() == frame || whereabouts[slot].leaves())
        });
        let mut changes = Vec::new();
        self.move_rigid(&mut changes);
        self.move_deforming(&mut changes);
        self.add_unpaired(&mut changes);
        if self.tree.is_empty() || (!changes.is_empty() && self.tree.has_left_frame()) {
            changes = self.build_tree();
        } else if !changes.is_empty() {
            self.tree.follow(&mut changes);
        }
        self.note_movers();
        self.end_pairs(&changes);
        self.begin_pairs(&changes);
        self.movers.placed.clear();
        self.movers.deformed.clear();
    }

    /// Lists the rigid bodies that leave their boxes in the tree, with new boxes.
    fn move_rigid(&mut self, changes: &mut Vec<Change>) {
        self.came_from.clear();
        if self.predicts {
            for &slot in &self.movers.placed {
                if let Some(state) = self.states[slot as usize].as_mut() {
                    let whereabouts = &self.whereabouts[slot as usize];
                    let from = state.placement_before(whereabouts);
                    let to = state.last_placement(whereabouts);
                    state.motion = state.mesh.extent().motion(&from, &to);
                    let generation = whereabouts.generation;
                    self.came_from.push((BodyId { slot, generation }, (&from).into()));
                }
            }
        }
        let half = self.half_threshold();
        let leaving = std::mem::take(&mut self.movers.leaving);
        changes.reserve(leaving.len());
        let others = dispatch(Ahead {
            leaving: &leaving,
            whereabouts: &mut self.whereabouts,
            rooms: &mut self.rooms,
            hulls: &self.hulls,
            tree: &self.tree,
            pairs: &self.pairs,
            half,
            changes,
        });
        for slot in others {
            self.leave(slot, half, changes);
        }
        self.movers.leaving = leaving;
        self.movers.leaving.clear();
    }

    /// Gives a rigid body another box in the tree, unless it is in the one that it has.
    fn leave(&mut self, slot: u32, half: f64, changes: &mut Vec<Change>) {
        let Some(state) = &self.states[slot as usize] else {
            return;
        };
        let whereabouts = &self.whereabouts[slot as usize];
        let new = state.at(whereabouts, self.frame).bounds();
        // a ball that fitted fills the box about as well as the body does
        if state.fits || !self.tree.holds(slot, &inflate(&new, half)) {
            let (from, motion) = state.came_from(whereabouts);
            let fat = fattened(&new, half, from, motion);
            let fat = self.tree.place(&fat);
            self.give_room(slot, &fat, half);
            changes.push(Change::to(slot, fat));
        }
    }

    /// Moves the deforming bodies, and lists those that leave their boxes. What does not move is no mover.
    fn move_deforming(&mut self, changes: &mut Vec<Change>) {
        let (half, frame) = (self.half_threshold(), self.frame);
        let mut deformed = std::mem::take(&mut self.movers.deformed);
        deformed.retain(|&slot| {
            let from = middle(&self.state(slot).bounds());
            self.whereabouts[slot as usize].set_leaves(false);
            let state = self.state_mut(slot);
            let motion = state.deforming.as_mut().and_then(|deforming| deforming.advance());
            let Some(motion) = motion else { return false };
            state.motion = motion;
            self.whereabouts[slot as usize].note_motion(frame);
            let new = self.state(slot).bounds();
            if !self.tree.holds(slot, &inflate(&new, half)) {
                let fat = fattened(&new, half, from, motion);
                changes.push(Change::to(slot, self.tree.place(&fat)));
            }
            true
        });
        self.movers.deformed = deformed;
    }

    /// Adds the bodies whose partners must be found again.
    fn add_unpaired(&mut self, changes: &mut Vec<Change>) {
        if self.unpaired.is_empty() {
            return;
        }
        let half = self.half_threshold();
        for body in std::mem::take(&mut self.unpaired) {
            let bounds = self.tree.place(&inflate(&self.state(body).bounds(), half));
            self.give_room(body, &bounds, half);
            changes.push(Change {
                is_recheck: self.tree.contains(body),
                ..Change::to(body, bounds)
            });
        }
        changes.sort_by_key(|change| change.body);
        // if a body is there twice, the box that predicts its motion comes first
        changes.dedup_by(|again, first| {
            let is_same = again.body == first.body;
            first.is_recheck |= is_same && again.is_recheck;
            is_same
        });
    }

    /// Rebuilds the tree over bodies in another frame.
    fn build_tree(&mut self) -> Vec<Change> {
        let half = self.half_threshold();
        let boxes: Vec<(u32, Aabb)> = self
            .bodies()
            .map(|body| (body.slot, inflate(&self.state(body.slot).bounds(), half)))
            .collect();
        let change = |&(body, _): &(u32, Aabb)| Change {
            is_recheck: self.tree.contains(body),
            ..Change::to(body, Box32::EMPTY)
        };
        let mut changes: Vec<Change> = boxes.iter().map(change).collect();
        self.tree.build(&boxes);
        for change in &mut changes {
            change.to = self.tree.box_of(change.body);
            self.give_room(change.body, &change.to, half);
        }
        changes
    }

    /// Tells a body how far it may go in a box; a room that does not hold it says so.
    fn give_room(&mut self, slot: u32, bounds: &Box32, half: f64) {
        let slot = slot as usize;
        if let Some(state) = self.states[slot].as_mut() {
            let whereabouts = &self.whereabouts[slot];
            let room = state.room(whereabouts, &self.tree, bounds, half);
            state.fits = room.holds(self.tree.frame(), whereabouts.next());
            self.rooms[slot] = room;
        }
    }

    fn half_threshold(&self) -> f64 {
        half_of(self.threshold)
    }

    /// Removes the records of changed bodies whose boxes are apart now.
    fn end_pairs(&mut self, changes: &[Change]) {
        if self.pairs.len() == 0 {
            return;
        }
        if changes.len() as f64 > ALL_PAIRS * self.len() as f64 {
            self.end_among_all(changes);
            return;
        }
        for change in changes {
            let mut member = self.pairs.first(change.body);
            while member != NONE {
                let record = member / 2;
                let [a, b] = self.pairs[record].bodies;
                member = self.pairs.next(member);
                if a != b && !self.tree.overlap(a, b) {
                    self.remove_record(record);
                }
            }
        }
    }

    /// The same, looking through all pairs in their order in memory.
    fn end_among_all(&mut self, changes: &[Change]) {
        // one more, for removed records
        let none = self.states.len();
        let mut has_changed = vec![0_u8; none + 1];
        for change in changes {
            has_changed[change.body as usize] = 1;
        }
        let mut changed = [0; AT_A_TIME];
        for start in (0..self.pairs.end()).step_by(AT_A_TIME) {
            let mut count = 0;
            for (record, bodies) in (start..).zip(self.pairs.bodies_from(start).iter().take(AT_A_TIME)) {
                let [a, b] = bodies.map(|slot| has_changed[none.min(slot as usize)]);
                changed[count] = record;
                count += usize::from(a | b);
            }
            for &record in &changed[..count] {
                if let Some([a, b]) = self.pairs.bodies_of(record)
                    && a != b
                    && !self.tree.overlap(a, b)
                {
                    self.remove_record(record);
                }
            }
        }
    }

    /// Adds records for bodies whose boxes meet now and did not before. Two bodies that may collide have a record if their boxes in
    /// the tree meet, so that the boxes tell whether there was one.
    fn begin_pairs(&mut self, changes: &[Change]) {
        if changes.is_empty() {
            return;
        }
        let mut tree = std::mem::take(&mut self.tree);
        tree.begun(
            changes,
            |Meeting {
                 bodies: [a, b],
                 is_recheck,
             }| {
                let is_known = is_recheck
                    && self
                        .pairs
                        .of(a)
                        .any(|record| self.pairs[record].bodies.contains(&b));
                if !is_known && self.collides(a, b) {
                    self.pair_up(a, b);
                }
            },
        );
        tree.forget_changes();
        self.tree = tree;
    }
}

/// Two boxes inflated by this meet if their bodies can be within the threshold.
pub(super) fn half_of(threshold: Threshold) -> f64 {
    threshold.get() * 0.5 * (1.0 + 1e-9)
}

/// The middle of a box.
fn middle(bounds: &Aabb) -> Point {
    std::array::from_fn(|k| bounds.min[k] / 2.0 + bounds.max[k] / 2.0)
}

/// A box that will hold a body, and `half` around it, for some frames if it continues as from a box around `from` to `new`, and for some
/// fewer if it turns.
fn fattened(new: &Aabb, half: f64, from: Point, motion: f64) -> Aabb {
    let (most, to) = (MOST * new.size(), middle(new));
    let aside = (ASIDE * motion).min(MOST_ASIDE * new.size());
    let mut fat = inflate(new, (half + aside).next_up());
    for k in 0..3 {
        let way = (FRAMES * (to[k] - from[k])).clamp(-most, most);
        fat.min[k] = (fat.min[k] + way.min(0.0)).max(f64::MIN);
        fat.max[k] = (fat.max[k] + way.max(0.0)).min(f64::MAX);
    }
    fat
}
