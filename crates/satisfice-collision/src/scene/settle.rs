//! Going to the next frame: which bodies move, whose boxes meet now, and which records to examine. Linear in the bodies that
//! move.

use super::body::{BodyId, Motion};
use super::body_tree::{BodyTree, Change};
use super::pairs::{NONE, Status};
use super::state::State;
use super::{World, unknown};
use crate::broad::{Box32, inflate};
use crate::distance::{Point, Threshold};
use crate::{Aabb, CompactPlacement, Error, Placement};

/// The box of a moving body is widened by so many frames of its motion...
const FRAMES: f64 = 8.0;
/// ...but by at most this share of its size.
const MOST: f64 = 0.25;
/// All records are looked through, in their order in memory, if more than this share of the bodies moves.
const ALL_RECORDS: f64 = 0.2;

/// A body that moves in the next frame.
pub(super) struct Pending {
    /// [`NONE`] if the body was removed since.
    slot: u32,
    /// Whether the body is rigid and goes there.
    is_placed: bool,
    to: CompactPlacement,
}

impl Pending {
    #[inline]
    fn place(slot: u32, placement: &Placement) -> Self {
        Self {
            slot,
            is_placed: true,
            to: placement.into(),
        }
    }

    /// Lists what a body does in the next frame, in the place of what it was to do.
    #[inline]
    fn add(list: &mut Vec<Self>, state: &mut State, next: Self) {
        match state.pending {
            NONE => {
                state.pending = list.len() as u32;
                super::push(list, next);
            }
            at => list[at as usize] = next,
        }
    }
}

impl World {
    /// Places a rigid body in the next frame. The last call before a query counts.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is no such body or it is not rigid; [`Error::NonFiniteVertex`] if a vertex would leave the
    /// range of numbers. The world is then as before.
    pub fn place(&mut self, body: BodyId, placement: Placement) -> Result<(), Error> {
        // the world is looked up once: a frame calls this for every body that moves
        let state = match self.states.get_mut(body.slot as usize) {
            Some(Some(state)) if state.generation == body.generation => state,
            _ => return Err(unknown(body)),
        };
        if state.kind != Motion::Rigid {
            return Err(Error::parameter(
                "body",
                "not rigid",
                "only a rigid body has a moving placement",
            ));
        }
        state.check_placement(&placement)?;
        Pending::add(&mut self.pending, state, Pending::place(body.slot, &placement));
        Ok(())
    }

    pub(super) fn move_to(&mut self, slot: u32, placement: &Placement) {
        self.pend(Pending::place(slot, placement));
    }

    /// Where a rigid body goes in the next frame, if it was placed since the last query.
    pub(super) fn next_placement(&self, slot: u32) -> Option<Placement> {
        let pending = self.pending.get(self.state(slot).pending as usize)?;
        pending.is_placed.then(|| pending.to.into())
    }

    /// Gives the vertices of a deforming body in the next frame. The last call before a query counts. Cost: linear in them.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is no such body, or it is not deforming or has another number of vertices;
    /// [`Error::NonFiniteVertex`]. The world is then as before.
    pub fn deform(&mut self, body: BodyId, vertices: &[Point]) -> Result<(), Error> {
        self.known(body)?;
        let Some(deforming) = self.state_mut(body.slot).deforming.as_mut() else {
            return Err(Error::parameter(
                "body",
                "not deforming",
                "only a deforming body has moving vertices",
            ));
        };
        deforming.deform(vertices)?;
        self.pend(Pending {
            slot: body.slot,
            is_placed: false,
            to: CompactPlacement::IDENTITY,
        });
        Ok(())
    }

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

    fn pend(&mut self, next: Pending) {
        if let Some(state) = self.states[next.slot as usize].as_mut() {
            Pending::add(&mut self.pending, state, next);
        }
    }

    pub(super) fn forget_pending(&mut self, slot: u32) {
        let at = std::mem::replace(&mut self.state_mut(slot).pending, NONE);
        if at != NONE {
            self.pending[at as usize].slot = NONE;
        }
        self.unpaired.retain(|&other| other != slot);
    }

    /// The known contacts are about to change: the changes of the last update are forgotten.
    pub(super) fn changing(&mut self) {
        self.answers += 1;
        self.log.begin();
    }

    /// Goes to the next frame, if anything has changed.
    pub(super) fn settle(&mut self) {
        if self.pending.is_empty() && self.unpaired.is_empty() {
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
        let many = self.pending.len() as f64 > ALL_RECORDS * self.len() as f64;
        // by slot, if many move
        let mut has_moved = vec![false; if many { self.states.len() } else { 0 }];
        let mut changes = self.move_bodies(&mut has_moved);
        self.add_unpaired(&mut changes);
        if self.tree.is_empty() || self.tree.has_left_frame() {
            changes = self.build_tree();
        } else if !changes.is_empty() {
            self.tree.follow(&mut changes);
        }
        if many {
            self.go_through_records(&changes, &has_moved);
        } else {
            self.end_pairs(&changes);
        }
        self.begin_pairs(&changes);
    }

    /// Moves the bodies, and lists those that leave their boxes in the tree, with new boxes. Notes which bodies move, or
    /// marks their records if `has_moved` is empty.
    fn move_bodies(&mut self, has_moved: &mut [bool]) -> Vec<Change> {
        let half = self.half_threshold();
        let mut changes = Vec::new();
        let mut pending = std::mem::take(&mut self.pending);
        self.came_from.clear();
        for Pending { slot, is_placed, to } in pending.drain(..).filter(|pending| pending.slot != NONE) {
            let moved = match is_placed {
                true => self.move_rigid(slot, &to, half, &mut changes),
                false => self.move_deforming(slot, half, &mut changes),
            };
            if !moved {
                continue;
            }
            match has_moved.get_mut(slot as usize) {
                Some(has_moved) => *has_moved = true,
                None => self.mark_records(slot),
            }
        }
        self.pending = pending;
        changes
    }

    /// Moves a rigid body, and lists it if it leaves its box in the tree. Returns whether it moves.
    fn move_rigid(&mut self, slot: u32, to: &CompactPlacement, half: f64, changes: &mut Vec<Change>) -> bool {
        let Some(state) = self.states[slot as usize].as_mut() else {
            return false;
        };
        state.pending = NONE;
        let from = state.place;
        if !state.go_to(to) {
            return false;
        }
        state.moved_at = self.frame;
        if self.predicts {
            let from = Placement::from(from);
            state.motion = state.mesh.extent().motion(&from, &state.placement());
            self.came_from.push((slot, (&from).into()));
        }
        // the ball first: nothing else has to be known of a body that stays in its room
        if !self.tree.is_within(&state.room, state.centre()) {
            let placement = state.placement();
            let extent = state.mesh.extent();
            let new = extent.posed(&placement);
            // a ball that fitted fills the box about as well as the body does
            if state.fits || !self.tree.holds(slot, &inflate(&new, half)) {
                let from = Placement::from(from);
                let motion = extent.motion(&from, &placement);
                let fat = fattened(&new, half, from.apply(extent.centre()), motion);
                let fat = self.tree.place(&fat);
                // at once: the body may be far away in memory later
                give_room(&self.tree, state, &fat, half);
                changes.push(Change::to(slot, fat));
            }
        }
        true
    }

    /// The same for a deforming body.
    fn move_deforming(&mut self, slot: u32, half: f64, changes: &mut Vec<Change>) -> bool {
        let frame = self.frame;
        let state = self.state_mut(slot);
        state.pending = NONE;
        let from = middle(&state.bounds());
        let motion = state.deforming.as_mut().and_then(|deforming| deforming.advance());
        let Some(motion) = motion else { return false };
        (state.motion, state.moved_at) = (motion, frame);
        let new = state.bounds();
        let wanted = inflate(&new, half);
        if !self.tree.holds(slot, &wanted) {
            let fat = fattened(&new, half, from, motion);
            changes.push(Change::to(slot, self.tree.place(&fat)));
        }
        true
    }

    /// Adds the bodies whose partners must be found again.
    fn add_unpaired(&mut self, changes: &mut Vec<Change>) {
        if self.unpaired.is_empty() {
            return;
        }
        let half = self.half_threshold();
        for body in std::mem::take(&mut self.unpaired) {
            let bounds = self.tree.place(&inflate(&self.state(body).bounds(), half));
            if let Some(state) = self.states[body as usize].as_mut() {
                give_room(&self.tree, state, &bounds, half);
            }
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
        let states = (0..).zip(&self.states);
        let boxes: Vec<(u32, Aabb)> = states
            .filter_map(|(slot, state)| Some((slot, inflate(&state.as_ref()?.bounds(), half))))
            .collect();
        let change = |&(body, _): &(u32, Aabb)| Change {
            is_recheck: self.tree.contains(body),
            ..Change::to(body, Box32::EMPTY)
        };
        let changes = boxes.iter().map(change).collect();
        self.tree.build(&boxes);
        for (slot, state) in (0..).zip(&mut self.states) {
            if let Some(state) = state {
                give_room(&self.tree, state, &self.tree.box_of(slot), half);
            }
        }
        changes
    }

    /// Marks the records of all bodies that have moved, and removes those whose boxes are apart now.
    fn go_through_records(&mut self, changes: &[Change], has_moved: &[bool]) {
        let mut has_changed = vec![false; self.states.len()];
        for change in changes {
            has_changed[change.body as usize] = true;
        }
        for id in 0..self.pairs.end() {
            if !self.pairs.contains(id) {
                continue;
            }
            let record = &mut self.pairs[id];
            let [a, b] = record.bodies.map(|slot| slot as usize);
            if has_moved[a] || has_moved[b] {
                self.has_known_dirty |= record.has_moved();
                if !std::mem::replace(&mut record.is_dirty, true) {
                    self.dirty.push(id);
                }
            }
            if (has_changed[a] || has_changed[b]) && a != b && !self.tree.overlap(a as u32, b as u32) {
                self.remove_record(id);
            }
        }
    }

    /// A body has moved: its records are no longer current.
    fn mark_records(&mut self, slot: u32) {
        let mut member = self.pairs.first(slot);
        while member != NONE {
            let record = member / 2;
            member = self.pairs.next(member);
            let known = &mut self.pairs[record];
            self.has_known_dirty |= known.has_moved();
            if !std::mem::replace(&mut known.is_dirty, true) {
                self.dirty.push(record);
            }
        }
    }

    /// Two boxes inflated by this meet if their bodies can be within the threshold.
    fn half_threshold(&self) -> f64 {
        self.threshold.get() * 0.5 * (1.0 + 1e-9)
    }

    /// Removes the records of changed bodies whose boxes are apart now.
    fn end_pairs(&mut self, changes: &[Change]) {
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

    /// Adds records for bodies whose boxes meet now and did not before. Two bodies that may collide have a record if their boxes in
    /// the tree meet, so that the boxes tell whether there was one.
    fn begin_pairs(&mut self, changes: &[Change]) {
        if changes.is_empty() {
            return;
        }
        let mut numbers = std::mem::take(&mut self.numbers);
        numbers.resize(self.states.len(), 0);
        for (number, change) in (0..).zip(changes) {
            numbers[change.body as usize] = number;
        }
        let tree = std::mem::take(&mut self.tree);
        tree.changed_pairs(|a, b| {
            let [one, two] = [a, b].map(|body| {
                let change = changes.get(numbers[body as usize] as usize);
                change.filter(|change| change.body == body)
            });
            let had_record = if [one, two].into_iter().flatten().any(|change| change.is_recheck) {
                self.pairs
                    .of(a)
                    .any(|record| self.pairs[record].bodies.contains(&b))
            } else {
                let before = |change: Option<&Change>, body| {
                    change.map_or_else(|| tree.box_of(body), |change| change.before)
                };
                before(one, a).overlaps(&before(two, b))
            };
            if !had_record && self.collides(a, b) {
                self.pair_up(a, b);
            }
        });
        self.tree = tree;
        self.tree.forget_changes();
        self.numbers = numbers;
    }
}

/// The middle of a box.
fn middle(bounds: &Aabb) -> Point {
    std::array::from_fn(|k| bounds.min[k] / 2.0 + bounds.max[k] / 2.0)
}

/// Tells a body how far it may go in a box.
fn give_room(tree: &BodyTree, state: &mut State, bounds: &Box32, half: f64) {
    state.room = tree.room(bounds, state.mesh.extent(), half);
    state.fits = tree.is_within(&state.room, state.centre());
}

/// A box that will hold a body, and `half` around it, for some frames if it continues as from a box around `from` to `new`, and for about
/// one if it turns.
fn fattened(new: &Aabb, half: f64, from: Point, motion: f64) -> Aabb {
    let (most, to) = (MOST * new.size(), middle(new));
    let mut fat = inflate(new, (half + motion.min(most)).next_up());
    for k in 0..3 {
        let way = (FRAMES * (to[k] - from[k])).clamp(-most, most);
        fat.min[k] = (fat.min[k] + way.min(0.0)).max(f64::MIN);
        fat.max[k] = (fat.max[k] + way.max(0.0)).min(f64::MAX);
    }
    fat
}
