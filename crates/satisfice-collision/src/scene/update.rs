//! Bringing the contacts up to date, and reading them.

use super::narrow::{Found, Workspace};
use super::pairs::Status;
use super::plan::Plan;
use super::{Completeness, Contact, Frame, Skips, Update, World};
use crate::Error;
use crate::broad::{Method, Watch};

/// Records a thread, from which on threads share them instead of working on one together.
const SHARED: usize = 4;
/// Records handed out at once, so that one answer to `stop` holds for few.
const CHUNK: usize = 4096;

impl World {
    /// Brings the contacts up to date with what was added, removed and moved since the last query. Cost: linear in the bodies
    /// that moved and the pairs of bodies that they meet; constant if nothing changed.
    ///
    /// # Errors
    /// Only what `add`, `place` and `deform` would have refused; never for a world that was built through them.
    pub fn update(&mut self) -> Result<Update, Error> {
        self.refresh(&Watch::none())
    }

    /// The same until `stop` says so. `stop` is asked every 20 us to 10 ms from every thread that works, and told how many pairs
    /// there are by now (those that a filter will leave out included). What is known then is among the contacts; which ones these
    /// are depends on the time, on the method and on the threads, unlike those of a [`Pass`](super::Pass). The next call goes
    /// on with the pairs of bodies that are left.
    ///
    /// Two parts ask no `stop`. Trees that do not exist yet are built first; [`World::build_trees`] does so beforehand. What
    /// was found of two bodies is put in order at the end: on one thread, which takes about a fifth of the processor time of the search where
    /// most features of two bodies are near each other, and little else.
    ///
    /// # Errors
    /// As [`World::update`].
    pub fn update_until(&mut self, stop: &(dyn Fn(usize) -> bool + Sync)) -> Result<Update, Error> {
        self.refresh(&Watch::until(stop))
    }

    /// Builds or refits the trees that the next answer about the present frame needs, which is the part of an answer that asks no
    /// `stop`: for callers with a deadline, who can leave it to a thread that they need not wait for. No answer depends on it.
    ///
    /// ```
    /// use satisfice_collision::distance::{PairKind, Threshold};
    /// use satisfice_collision::generate;
    /// use satisfice_collision::scene::{Body, World};
    /// let mut world = World::new(PairKind::TriangleTriangle, Threshold::new(0.2)?);
    /// world.add(Body::fixed(generate::icosphere(1.0, 3)?))?;
    /// world.add(Body::fixed(generate::icosphere(1.1, 3)?))?;
    /// world.build_trees()?;
    /// assert!(!world.frame()?.contacts.is_empty());
    /// # Ok::<(), satisfice_collision::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`World::update`].
    pub fn build_trees(&mut self) -> Result<(), Error> {
        self.settle();
        if self.method == Method::Grid {
            return Ok(());
        }
        self.dirty = self.take_dirty();
        for at in 0..self.dirty.len() {
            let bodies = self.pairs[self.dirty[at]].bodies;
            if !self.boxes_apart(bodies) {
                self.ensure_trees(bodies)?;
                // the grid needs none
                if self.situation(&self.pairs[self.dirty[at]]).plan() != Plan::Grid {
                    self.build_shared_trees(bodies);
                }
            }
        }
        Ok(())
    }

    /// [`World::update`] and the sorted list of all contacts. Cost: that of the update, and linear in all contacts.
    ///
    /// # Errors
    /// As [`World::update`].
    pub fn frame(&mut self) -> Result<Frame, Error> {
        let update = self.update()?;
        Ok(self.as_frame(update))
    }

    /// [`World::update_until`] and the sorted list of what is known then.
    ///
    /// # Errors
    /// As [`World::update`].
    pub fn frame_until(&mut self, stop: &(dyn Fn(usize) -> bool + Sync)) -> Result<Frame, Error> {
        let update = self.update_until(stop)?;
        Ok(self.as_frame(update))
    }

    fn as_frame(&self, update: Update) -> Frame {
        Frame {
            contacts: self.sorted_contacts(),
            completeness: update.completeness,
            skips: update.skips,
        }
    }

    /// The contacts as of the last update, in no particular order of bodies; those of two bodies are sorted. After another question that
    /// took in changes, some may be missing: see [`World`].
    pub fn contacts(&self) -> impl Iterator<Item = Contact> {
        let shown = self.pairs.iter().filter(|(_, record)| self.is_shown(record));
        shown.flat_map(|(_, record)| record.pairs.iter().map(|&pair| self.contact(record, pair)))
    }

    /// [`World::contacts`], sorted.
    #[must_use]
    pub fn sorted_contacts(&self) -> Vec<Contact> {
        let shown = self.pairs.iter().map(|(_, record)| record);
        let mut records: Vec<_> = shown
            .filter(|record| !record.pairs.is_empty() && self.is_shown(record))
            .collect();
        records.sort_unstable_by_key(|record| record.bodies);
        let mut contacts = Vec::with_capacity(records.iter().map(|record| record.pairs.len()).sum());
        for record in records {
            contacts.extend(record.pairs.iter().map(|&pair| self.contact(record, pair)));
        }
        contacts
    }

    fn refresh(&mut self, watch: &Watch<'_>) -> Result<Update, Error> {
        self.log.begin();
        self.log.clean();
        self.settle();
        let mut skips = Skips::default();
        let mut lent = self.without_dirty();
        if !lent.dirty.is_empty() {
            lent.world.answers += 1;
        }
        let result = lent.world.look_at(&lent.dirty, &mut lent.done, &mut skips, watch);
        let is_met = |record: &&u32| !lent.world.pairs[**record].apart;
        let meeting = lent.dirty.iter().filter(is_met).count();
        let done = lent.done;
        lent.is_over = true;
        drop(lent);
        result?;
        self.log.end();
        Ok(Update {
            completeness: match self.dirty.is_empty() {
                true => Completeness::Proved,
                false => Completeness::Unknown,
            },
            recomputed: done,
            skips: self.with_counts(skips, meeting),
        })
    }

    /// Finds the pairs of these records; `done` counts those that are current then.
    fn look_at(
        &mut self,
        dirty: &[u32],
        done: &mut usize,
        skips: &mut Skips,
        watch: &Watch<'_>,
    ) -> Result<(), Error> {
        let threads = if self.parallel {
            rayon::current_num_threads()
        } else {
            1
        };
        if threads > 1 && dirty.len() >= SHARED * threads {
            return self.look_at_shared(dirty, done, skips, watch, threads);
        }
        let mut workspaces = std::mem::take(&mut self.workspaces);
        let result = dirty.iter().try_for_each(|&record| {
            if watch.stopped() {
                return Ok(());
            }
            let plan = self.prepare(record)?;
            if plan == Plan::Apart {
                self.part(record);
                *done += 1;
                return Ok(());
            }
            let found = self.find(&self.pairs[record], plan, &mut workspaces[0], watch)?;
            self.take(record, found, skips, watch.stopped());
            *done += usize::from(!watch.stopped());
            Ok(())
        });
        self.workspaces = workspaces;
        result
    }

    /// The same, each thread with records of its own. They are taken over in their order.
    fn look_at_shared(
        &mut self,
        dirty: &[u32],
        done: &mut usize,
        skips: &mut Skips,
        watch: &Watch<'_>,
        threads: usize,
    ) -> Result<(), Error> {
        use rayon::prelude::*;
        let mut workspaces = std::mem::take(&mut self.workspaces);
        // the first one works on all threads, for records that are examined one by one
        workspaces.resize_with(threads + 1, || Workspace::new(false));
        let result = dirty.chunks(CHUNK).try_for_each(|chunk| {
            if watch.stopped() {
                return Ok(());
            }
            let mut tasks = Vec::with_capacity(chunk.len());
            for &record in chunk {
                tasks.push((record, self.prepare(record)?));
            }
            let world = &*self;
            let share = tasks.len().div_ceil(threads);
            let found: Vec<Vec<Result<Found, Error>>> = tasks
                .par_chunks(share)
                .zip(&mut workspaces[1..])
                .map(|(tasks, space)| {
                    let tasks = tasks.iter().take_while(|_| !watch.stopped());
                    tasks
                        .map(|&(record, plan)| world.find(&world.pairs[record], plan, space, watch))
                        .collect()
                })
                .collect();
            // a stop may have cut off the last record of each share
            let stopped = watch.stopped();
            for (tasks, found) in tasks.chunks(share).zip(found) {
                for (&(record, _), found) in tasks.iter().zip(found) {
                    self.take(record, found?, skips, stopped);
                    *done += usize::from(!stopped);
                }
            }
            Ok(())
        });
        self.workspaces = workspaces;
        result
    }

    /// Chooses how to find the pairs of a record, and sees to the trees for it.
    fn prepare(&mut self, record: u32) -> Result<Plan, Error> {
        let known = &self.pairs[record];
        let bodies = known.bodies;
        // most of those whose boxes are apart need nothing else
        let plan = match known.status != Status::Current && self.hulls_apart(bodies) {
            true => Plan::Apart,
            false => self.situation(known).plan(),
        };
        if matches!(plan, Plan::Tree | Plan::All) {
            self.ensure_trees(bodies)?;
        }
        self.pairs.set_apart(record, plan == Plan::Apart);
        Ok(plan)
    }

    /// Notes that a record has no contacts, for its boxes are apart.
    fn part(&mut self, record: u32) {
        let known = &mut self.pairs[record];
        (known.status, known.is_dirty, known.slack) = (Status::Current, false, None);
        if !known.pairs.is_empty() {
            let before = std::mem::take(&mut known.pairs);
            let bodies = known.bodies.map(|slot| self.id(slot));
            self.log.note(bodies, record, before);
        }
    }

    /// Takes over what was found about a record; if `cut`, there may be more.
    fn take(&mut self, record: u32, found: Found, skips: &mut Skips, cut: bool) {
        skips.add(&found.skips);
        let bodies = self.pairs[record].bodies.map(|slot| self.id(slot));
        let known = &mut self.pairs[record];
        let before = std::mem::replace(&mut known.pairs, found.pairs);
        known.slack = None;
        if cut {
            known.status = Status::Partial;
            self.has_known_dirty = true;
        } else {
            known.status = Status::Current;
            known.is_dirty = false;
            known.note_sparse(found.sparse);
        }
        if !(before.is_empty() && known.pairs.is_empty()) {
            self.log.note(bodies, record, before);
        }
    }

    /// The records to examine, each once. The caller puts them back.
    pub(super) fn take_dirty(&mut self) -> Vec<u32> {
        self.mark_moved();
        let mut dirty = std::mem::take(&mut self.dirty);
        if std::mem::take(&mut self.has_removed_dirty) {
            dirty.retain(|&record| self.pairs.contains(record) && self.pairs[record].is_dirty);
            dirty.sort_unstable();
            dirty.dedup();
        }
        dirty
    }

    /// Adds the work that no record stands for; of so many records whose boxes meet, a body has moved.
    pub(super) fn with_counts(&mut self, skips: Skips, moved: usize) -> Skips {
        let (filtered, wanted) = self.counts();
        let (kind_a, kind_b) = self.feature_kinds();
        let orders = if kind_a == kind_b { 1 } else { 2 };
        let meeting = self.pairs.len() - self.pairs.apart();
        Skips {
            filtered_bodies: filtered,
            rigid_self: self.membership.rigid,
            boxes_apart: orders * wanted - (self.pairs.of_two() - self.pairs.apart()) as u64,
            unmoved_bodies: meeting.saturating_sub(moved) as u64,
            ..skips
        }
    }
}
