//! Records whose bodies have moved, noted in the frame where few bodies move among many records, and else when somebody asks for
//! contacts: until then, kept pairs are not looked through.

use super::World;
use super::pairs::{NONE, Record, Status};
use super::whereabouts::MEMORY;

/// Records are marked at once if at most this share of the bodies moves, and there are more records than that.
const FEW: f64 = 0.2;

impl World {
    /// Marks the records of the bodies that have moved, or puts that off.
    pub(super) fn note_movers(&mut self) {
        if let Some(since) = self.unmarked_since {
            if self.frame - since > MEMORY {
                self.mark_moved();
            }
            return;
        }
        if self.pairs.len() == 0 {
            return;
        }
        let movers = self.movers.placed.iter().chain(&self.movers.deformed);
        let are_fewer = self.pairs.end() as usize <= self.movers.len();
        if are_fewer || self.movers.len() as f64 > FEW * self.len() as f64 {
            self.unmarked_since = Some(self.frame - 1);
            return;
        }
        for &slot in movers {
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
    }

    /// Marks the records that have not been marked yet, although their bodies have moved.
    pub(super) fn mark_moved(&mut self) {
        let Some(since) = self.unmarked_since.take() else {
            return;
        };
        let is_next = self.frame == since + 1;
        for id in 0..self.pairs.end() {
            let Some(bodies) = self.pairs.bodies_of(id) else {
                continue;
            };
            if !self.has_moved_since(bodies, since) || self.stays_apart(id) {
                continue;
            }
            let known = &mut self.pairs[id];
            if is_next {
                self.has_known_dirty |= known.has_moved();
            } else if known.status != Status::New {
                (known.status, known.slack) = (Status::Stale, None);
            }
            if !std::mem::replace(&mut known.is_dirty, true) {
                self.dirty.push(id);
            }
        }
    }

    /// Whether the boxes of a record were apart, and still are: nothing is to be found.
    fn stays_apart(&self, id: u32) -> bool {
        let record = &self.pairs[id];
        record.apart && record.status == Status::Current && self.hulls_apart(record.bodies)
    }

    /// Whether the contacts of a record are those of the present frame.
    pub(super) fn is_shown(&self, record: &Record) -> bool {
        record.status.is_shown()
            && self
                .unmarked_since
                .is_none_or(|since| !self.has_moved_since(record.bodies, since))
    }

    fn has_moved_since(&self, bodies: [u32; 2], frame: u64) -> bool {
        let moved_at = |slot: u32| self.whereabouts[slot as usize].came_at(self.frame);
        bodies.into_iter().any(|slot| moved_at(slot) > frame)
    }
}
