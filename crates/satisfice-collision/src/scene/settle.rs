//! Going to the next frame: what moves, which boxes meet now, and which records have to be looked at. Linear in what moves.

use super::World;
use super::body::{BodyId, Motion};
use super::pairs::{NONE, Status};
use super::verlet::VerletList;
use crate::broad::inflate;
use crate::distance::{Point, Threshold};
use crate::{Aabb, CompactPlacement, Error, Placement};

/// The box of a moving body is widened by so many frames of its motion...
const FRAMES: f64 = 4.0;
/// ...but by at most this share of its size.
const MOST: f64 = 0.25;
/// The tree is built anew if more than this share of the bodies leave their boxes in a frame.
const REBUILT: f64 = 0.3;
/// All pairs of bodies are found anew, in one traversal, if more than this share of the bodies leave their boxes.
const ALL_PARTNERS: f64 = 0.1;
/// All records are looked through, in their order in memory, if more than this share of the bodies moves.
const ALL_RECORDS: f64 = 0.2;

/// A body that moves in the next frame.
pub(super) struct Pending {
    /// [`NONE`] if that was taken back.
    slot: u32,
    /// Where a rigid body goes.
    to: Option<CompactPlacement>,
}

impl World {
    /// Places a rigid body in the next frame. The last call before a query counts.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is no such body or it is not rigid; [`Error::NonFiniteVertex`] if a vertex would leave the
    /// range of numbers. The world is then as before.
    pub fn place(&mut self, body: BodyId, placement: Placement) -> Result<(), Error> {
        let state = self.known(body)?;
        if state.kind != Motion::Rigid {
            return Err(Error::parameter(
                "body",
                "not rigid",
                "only a rigid body has a moving placement",
            ));
        }
        state.check_placement(&placement)?;
        self.move_to(body.slot, &placement);
        Ok(())
    }

    pub(super) fn move_to(&mut self, slot: u32, placement: &Placement) {
        self.pend(slot).to = Some(placement.into());
    }

    /// Where a rigid body goes in the next frame, if it was placed since the last query.
    pub(super) fn next_placement(&self, slot: u32) -> Option<Placement> {
        let pending = self.pending.get(self.state(slot).pending as usize)?;
        pending.to.map(Placement::from)
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
        self.pend(body.slot);
        Ok(())
    }

    /// Changes the threshold for the next frame. Cost of that frame: if the threshold shrinks, one decision a contact; if it
    /// grows, that of a new world.
    pub fn set_threshold(&mut self, threshold: Threshold) {
        if threshold == self.threshold {
            return;
        }
        self.changing();
        let margin = (self.threshold.get() - threshold.get()) * (1.0 - 1e-9);
        let grows = margin < 0.0;
        self.threshold = threshold;
        let records: Vec<u32> = self.pairs.iter().map(|(record, _)| record).collect();
        for record in records {
            if grows {
                let known = &mut self.pairs[record];
                (known.verlet, known.slack) = (None, None);
                if known.status != Status::New {
                    known.status = Status::Stale;
                }
            } else {
                self.narrow_down(record, margin);
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

    /// The threshold has shrunk by `margin`: the contacts of before are a list with that margin.
    fn narrow_down(&mut self, record: u32, margin: f64) {
        let known = &mut self.pairs[record];
        known.slack = None;
        if known.status == Status::Current {
            known.status = Status::Stale;
            if known.verlet.is_none() {
                known.verlet = Some(Box::new(VerletList::new(known.pairs.clone(), margin)));
            }
        } else if known.status != Status::New {
            known.status = Status::Stale;
        }
    }

    /// A record has to be looked at.
    fn mark_dirty(&mut self, record: u32) {
        if !std::mem::replace(&mut self.pairs[record].is_dirty, true) {
            self.dirty.push(record);
        }
    }

    fn pend(&mut self, slot: u32) -> &mut Pending {
        let at = match self.state(slot).pending {
            NONE => {
                let at = self.pending.len();
                self.state_mut(slot).pending = at as u32;
                super::push(&mut self.pending, Pending { slot, to: None });
                at
            }
            at => at as usize,
        };
        &mut self.pending[at]
    }

    pub(super) fn forget_pending(&mut self, slot: u32) {
        let at = std::mem::replace(&mut self.state_mut(slot).pending, NONE);
        if at != NONE {
            self.pending[at as usize].slot = NONE;
        }
        self.unpaired.retain(|&other| other != slot);
    }

    /// The known contacts are about to change: what the last update changed is no longer of interest.
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
        for at in 0..self.dirty.len() {
            let record = self.dirty[at];
            let known = &mut self.pairs[record];
            if matches!(known.status, Status::Behind | Status::Partial) {
                (known.status, known.slack) = (Status::Stale, None);
            }
        }
        let mut left = self.move_bodies();
        let half = self.half_threshold();
        for slot in std::mem::take(&mut self.unpaired) {
            left.push((slot, inflate(&self.state(slot).bounds, half)));
        }
        left.sort_by_key(|(slot, _)| *slot);
        // of a body that is there twice, the box that predicts its motion comes first
        left.dedup_by_key(|(slot, _)| *slot);
        if left.is_empty() {
            return;
        }
        self.put_into_tree(&left);
        if left.len() as f64 > ALL_PARTNERS * self.len() as f64 {
            self.find_all_partners();
        } else {
            let mut room = Room::default();
            for (slot, bounds) in &left {
                self.find_partners(*slot, bounds, &mut room);
            }
        }
    }

    /// Moves what moves, and lists the bodies that leave their boxes in the tree with new ones.
    fn move_bodies(&mut self) -> Vec<(u32, Aabb)> {
        let (frame, half) = (self.frame, self.half_threshold());
        let mut left = Vec::new();
        let mut pending = std::mem::take(&mut self.pending);
        self.came_from.clear();
        let many = pending.len() as f64 > ALL_RECORDS * self.len() as f64;
        for Pending { slot, to } in pending.drain(..).filter(|pending| pending.slot != NONE) {
            let state = self.state_mut(slot);
            state.pending = NONE;
            let (placement, bounds) = (state.placement, state.bounds);
            let motion = match to {
                Some(to) => state.go_to(&to.into()),
                None => state.advance(),
            };
            let Some(motion) = motion else { continue };
            (state.moved_at, state.motion) = (frame, motion);
            let (new, is_rigid) = (state.bounds, state.deforming.is_none());
            let wanted = inflate(&new, half);
            if !self.tree.holds(slot, &wanted) {
                left.push((slot, fattened(&wanted, &bounds, &new, motion)));
            }
            if is_rigid && self.predicts {
                self.came_from.push((slot, (&placement).into()));
            }
            if !many {
                self.mark_records(slot, motion);
            }
        }
        self.pending = pending;
        if many {
            self.mark_all_records();
        }
        left
    }

    /// The same as [`World::mark_records`] for every body that has moved.
    fn mark_all_records(&mut self) {
        let (pairs, dirty) = (&mut self.pairs, &mut self.dirty);
        for (id, record) in pairs.iter_mut() {
            let [one, two] = record.bodies.map(|slot| {
                let state = self.states[slot as usize].as_ref();
                state
                    .filter(|state| state.moved_at == self.frame)
                    .map(|state| state.motion)
            });
            if one.is_some() || two.is_some() {
                let motion = one.unwrap_or(0.0) + two.unwrap_or(0.0);
                record.has_moved(motion);
                if !std::mem::replace(&mut record.is_dirty, true) {
                    dirty.push(id);
                }
            }
        }
    }

    /// A body has moved: its records are no longer current.
    fn mark_records(&mut self, slot: u32, motion: f64) {
        let mut member = self.pairs.first(slot);
        while member != NONE {
            let record = member / 2;
            member = self.pairs.next(member);
            let known = &mut self.pairs[record];
            let ways = if known.bodies[0] == known.bodies[1] {
                2.0
            } else {
                1.0
            };
            known.has_moved(ways * motion);
            if !std::mem::replace(&mut known.is_dirty, true) {
                self.dirty.push(record);
            }
        }
    }

    /// Two boxes inflated by this meet if their bodies can be within the threshold.
    fn half_threshold(&self) -> f64 {
        self.threshold.get() * 0.5 * (1.0 + 1e-9)
    }

    fn put_into_tree(&mut self, left: &[(u32, Aabb)]) {
        let many = left.len() as f64 > REBUILT * self.len() as f64;
        if !many && !self.tree.is_worn() {
            for (slot, bounds) in left {
                self.tree.put(*slot, bounds);
            }
            return;
        }
        let half = self.half_threshold();
        let mut moved = left.iter().copied().peekable();
        let mut boxes = Vec::with_capacity(self.len());
        for (slot, state) in (0..).zip(&self.states) {
            let Some(state) = state else { continue };
            let new = moved.next_if(|(other, _)| *other == slot);
            boxes.push(new.unwrap_or_else(|| (slot, inflate(&state.bounds, half))));
        }
        self.tree.build(&boxes);
    }

    /// Brings the records of all bodies in line with the tree: one traversal, and one sort of what was known and what meets now.
    fn find_all_partners(&mut self) {
        let mut known: Vec<([u32; 2], u32)> = self
            .pairs
            .iter()
            .filter(|(_, record)| record.bodies[0] != record.bodies[1])
            .map(|(id, record)| (ordered(record.bodies), id))
            .collect();
        known.sort_unstable();
        let mut met: Vec<[u32; 2]> = Vec::with_capacity(known.len());
        self.tree.pairs(|a, b| met.push(ordered([a, b])));
        if !known.is_empty() {
            met.sort_unstable();
        }
        let mut known = known.into_iter().peekable();
        for bodies in met {
            while let Some((_, record)) = known.next_if(|(other, _)| *other < bodies) {
                self.remove_record(record);
            }
            let mut is_known = false;
            while known.next_if(|(other, _)| *other == bodies).is_some() {
                is_known = true;
            }
            let [a, b] = bodies;
            if !is_known && self.collides(a, b) {
                self.pair_up(a, b);
            }
        }
        for (_, record) in known {
            self.remove_record(record);
        }
    }

    /// Brings the records of a body that has another box in line with the tree.
    fn find_partners(&mut self, slot: u32, bounds: &Aabb, room: &mut Room) {
        if self.marks.len() < self.states.len() {
            self.marks.resize(self.states.len(), 0);
        }
        if self.mark == u32::MAX {
            self.marks.fill(0);
            self.mark = 0;
        }
        self.mark += 1;
        let mark = self.mark;
        self.marks[slot as usize] = mark;
        let mut member = self.pairs.first(slot);
        while member != NONE {
            let record = member / 2;
            let [a, b] = self.pairs[record].bodies;
            member = self.pairs.next(member);
            if a == b {
                continue;
            }
            let other = if a == slot { b } else { a };
            if self.tree.overlap(a, b) {
                self.marks[other as usize] = mark;
            } else {
                self.remove_record(record);
            }
        }
        room.partners.clear();
        let (marks, partners) = (&mut self.marks, &mut room.partners);
        self.tree.overlapping(bounds, &mut room.stack, |other| {
            if std::mem::replace(&mut marks[other as usize], mark) != mark {
                partners.push(other);
            }
        });
        for &other in &room.partners {
            if self.collides(slot, other) {
                self.pair_up(slot, other);
            }
        }
    }
}

/// Two bodies, the lower one first.
fn ordered([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Room for the queries of a frame.
#[derive(Default)]
struct Room {
    stack: Vec<u32>,
    partners: Vec<u32>,
}

/// A box that will hold a body for some frames if it goes on as from `old` to `new`, and for about one if it turns.
fn fattened(wanted: &Aabb, old: &Aabb, new: &Aabb, motion: f64) -> Aabb {
    let most = MOST * new.size();
    let mut fat = inflate(wanted, motion.min(most));
    for k in 0..3 {
        let way = new.min[k] / 2.0 - old.min[k] / 2.0 + (new.max[k] / 2.0 - old.max[k] / 2.0);
        let way = (FRAMES * way).clamp(-most, most);
        fat.min[k] = (fat.min[k] + way.min(0.0)).max(f64::MIN);
        fat.max[k] = (fat.max[k] + way.max(0.0)).min(f64::MAX);
    }
    fat
}
