//! Which bodies are in a world, and which of them may collide: adding, removing, groups and exclusions.

use std::collections::{BTreeMap, BTreeSet};

use super::body::{Body, BodyId, Motion};
use super::narrow::Workspace;
use super::pairs::{self, Status};
use super::state::State;
use super::whereabouts::{Room, Whereabouts};
use super::{SharedMesh, World};
use crate::broad::Box32;
use crate::{Error, FeatureKind};

/// Counts from which the number of pairs that may not collide follows.
#[derive(Default)]
pub(super) struct Membership {
    /// Excluded pairs of slots, both ways.
    excluded: BTreeSet<(u32, u32)>,
    /// The number of bodies with these groups and this mask.
    classes: BTreeMap<(u32, u32), u64>,
    /// Pairs of bodies that may not collide and pairs that may, if counted since the last change.
    counted: Option<(u64, u64)>,
    /// Fixed and rigid bodies.
    pub(super) rigid: u64,
    /// Deforming bodies that never collide with themselves.
    aloof: u64,
}

impl Membership {
    pub(super) fn is_excluded(&self, a: u32, b: u32) -> bool {
        !self.excluded.is_empty() && self.excluded.contains(&(a, b))
    }

    fn exclude(&mut self, a: u32, b: u32, excluded: bool) -> bool {
        self.counted = None;
        match excluded {
            true => self.excluded.insert((a, b)) | self.excluded.insert((b, a)),
            false => self.excluded.remove(&(a, b)) | self.excluded.remove(&(b, a)),
        }
    }

    /// A body with these groups and this mask comes or goes.
    fn count(&mut self, state: &State, comes: bool) {
        self.counted = None;
        let class = self.classes.entry((state.groups, state.mask)).or_default();
        if comes {
            *class += 1;
        } else {
            *class -= 1;
            if *class == 0 {
                self.classes.remove(&(state.groups, state.mask));
            }
        }
        let counter = match &state.deforming {
            None => &mut self.rigid,
            Some(own) if !own.collides_with_itself() => &mut self.aloof,
            Some(_) => return,
        };
        *counter = if comes { *counter + 1 } else { *counter - 1 };
    }

    /// Forgets the exclusions of a slot.
    fn forget(&mut self, slot: u32) {
        let others: Vec<u32> = self
            .excluded
            .range((slot, 0)..=(slot, u32::MAX))
            .map(|&(_, other)| other)
            .collect();
        for other in others {
            self.exclude(slot, other, false);
        }
    }
}

fn match_groups([groups_a, mask_a]: [u32; 2], [groups_b, mask_b]: [u32; 2]) -> bool {
    groups_a & mask_b != 0 && groups_b & mask_a != 0
}

impl World {
    /// Adds a body, which counts from the next query on. Cost: constant; for a deforming body, linear in its size.
    ///
    /// # Errors
    /// [`Error::NoFeature`] if the mesh has no feature that the world's pairs are made of, such as a mesh without triangles where
    /// pairs of triangles are looked for; [`Error::NonFiniteVertex`] if the placement takes a vertex out of the range of numbers.
    /// The world is then as before.
    pub fn add(&mut self, body: Body) -> Result<BodyId, Error> {
        self.check_features(&body.mesh)?;
        let vacant = self.free.last().copied();
        let slot = vacant.map_or(self.states.len() as u32, |id| id.slot);
        if slot == u32::MAX / 2 {
            return Err(Error::parameter(
                "number of bodies",
                self.len(),
                "less than 2^31 - 1",
            ));
        }
        let generation = vacant.map_or(0, |id| id.generation);
        let (state, whereabouts) = State::new(body, generation)?;
        let id = BodyId { slot, generation };
        self.changing();
        self.membership.count(&state, true);
        let collides_with_itself = state
            .deforming
            .as_ref()
            .is_some_and(|own| own.collides_with_itself());
        if vacant.is_some() {
            self.free.pop();
        } else {
            super::push(&mut self.states, None);
            super::push(&mut self.whereabouts, Whereabouts::new(generation, false, false));
            super::push(&mut self.rooms, Room::NONE);
            super::push(&mut self.hulls, Box32::EMPTY);
        }
        self.put(slot, state, whereabouts);
        if collides_with_itself {
            self.add_record([slot; 2]);
        }
        self.unpair(slot);
        Ok(id)
    }

    /// Puts a body into its slot.
    fn put(&mut self, slot: u32, state: State, whereabouts: Whereabouts) {
        let slot = slot as usize;
        self.hulls[slot] = match state.kind {
            Motion::Fixed | Motion::Rigid => state.mesh.extent().hull(),
            Motion::Deforming => Box32::EMPTY,
        };
        self.states[slot] = Some(state);
        self.whereabouts[slot] = whereabouts;
        self.rooms[slot] = Room::NONE;
    }

    /// Removes a body with its contacts, groups and exclusions. Cost: linear in its kept pairs.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is no such body. The world is then as before.
    pub fn remove(&mut self, body: BodyId) -> Result<(), Error> {
        self.known(body)?;
        self.changing();
        let slot = body.slot;
        let records: Vec<u32> = self.pairs.of(slot).collect();
        records.into_iter().for_each(|record| self.remove_record(record));
        self.tree.remove(slot);
        self.membership.forget(slot);
        self.movers.forget();
        if let Some(state) = self.states[slot as usize].take() {
            self.membership.count(&state, false);
            self.hulls[slot as usize] = Box32::EMPTY;
            // no handle names the place until it is given to another body
            let generation = body.generation.wrapping_add(1);
            self.whereabouts[slot as usize].generation = generation;
            self.free.push(BodyId { slot, generation });
        }
        Ok(())
    }

    /// Gives a body another mesh, in its placement; a deforming body starts from the vertices of the new mesh, whatever was given
    /// for the next frame. Its vertex predicate is forgotten, and its contacts are found again.
    ///
    /// # Errors
    /// As [`World::add`], and [`Error::Parameter`] if there is no such body. The world is then as before.
    pub fn replace(&mut self, body: BodyId, mesh: impl Into<SharedMesh>) -> Result<(), Error> {
        let (known, mesh) = (self.known(body)?, mesh.into());
        self.check_features(&mesh)?;
        let new = Body {
            mesh,
            motion: known.kind,
            placement: known.placement(),
            groups: known.groups,
            mask: known.mask,
            ring: known.deforming.as_ref().and_then(|own| own.ring),
            counted: None,
        };
        let (state, whereabouts) = State::new(new, body.generation)?;
        let next = self.next_placement(body.slot);
        if let Some(placement) = &next {
            state.check_place(
                &whereabouts,
                Some(&placement.quaternion()),
                &placement.translation(),
            )?;
        }
        self.changing();
        self.workspaces.iter_mut().for_each(Workspace::forget);
        self.movers.forget();
        let records: Vec<u32> = self.pairs.of(body.slot).collect();
        for record in records {
            let bodies = self.pairs[record].bodies;
            self.remove_record(record);
            self.add_record(bodies);
        }
        self.put(body.slot, state, whereabouts);
        self.unpair(body.slot);
        if let Some(placement) = &next {
            self.place(body, *placement)?;
        }
        Ok(())
    }

    /// Sets the groups and the mask of a body, as [`Body::in_groups`] does.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is no such body.
    pub fn set_groups(&mut self, body: BodyId, groups: u32, mask: u32) -> Result<(), Error> {
        let known = self.known(body)?;
        if (known.groups, known.mask) == (groups, mask) {
            return Ok(());
        }
        self.changing();
        if let Some(mut state) = self.states[body.slot as usize].take() {
            self.membership.count(&state, false);
            (state.groups, state.mask) = (groups, mask);
            self.membership.count(&state, true);
            self.states[body.slot as usize] = Some(state);
        }
        let records: Vec<u32> = self.pairs.of(body.slot).collect();
        for record in records {
            let [a, b] = self.pairs[record].bodies;
            if a != b && !self.collides(a, b) {
                self.remove_record(record);
            }
        }
        self.unpair(body.slot);
        Ok(())
    }

    /// Excludes contacts of two bodies, or of one with itself. Cost: linear in the kept pairs of the first body and logarithmic in
    /// the excluded pairs; and the next update goes through all excluded pairs once, to count them.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is no such body.
    pub fn exclude(&mut self, a: BodyId, b: BodyId) -> Result<(), Error> {
        self.known(a)?;
        self.known(b)?;
        if !self.membership.exclude(a.slot, b.slot, true) {
            return Ok(());
        }
        self.changing();
        let records = self.pairs.of(a.slot);
        let both = |&record: &u32| {
            let [one, two] = self.pairs[record].bodies;
            [one, two] == [a.slot, b.slot] || [one, two] == [b.slot, a.slot]
        };
        let records: Vec<u32> = records.filter(both).collect();
        for record in records {
            self.remove_record(record);
        }
        Ok(())
    }

    /// Removes an exclusion. Cost: logarithmic in the excluded pairs, and that of finding the partners of the first body again; the next
    /// update counts the excluded pairs as after [`World::exclude`].
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is no such body.
    pub fn include(&mut self, a: BodyId, b: BodyId) -> Result<(), Error> {
        self.known(a)?;
        self.known(b)?;
        if !self.membership.exclude(a.slot, b.slot, false) {
            return Ok(());
        }
        self.changing();
        if a != b {
            self.unpair(a.slot);
        } else if self
            .state(a.slot)
            .deforming
            .as_ref()
            .is_some_and(|own| own.collides_with_itself())
        {
            self.add_record([a.slot; 2]);
        }
        Ok(())
    }

    /// Whether two different bodies may collide.
    pub(super) fn collides(&self, a: u32, b: u32) -> bool {
        let (one, two) = (self.state(a), self.state(b));
        match_groups([one.groups, one.mask], [two.groups, two.mask]) && !self.membership.is_excluded(a, b)
    }

    /// Adds the record of two bodies that may collide; kinds with two different features have one for each order.
    pub(super) fn pair_up(&mut self, a: u32, b: u32) {
        let (kind_a, kind_b) = self.feature_kinds();
        self.add_record([a.min(b), a.max(b)]);
        if kind_a != kind_b {
            self.add_record([a.max(b), a.min(b)]);
        }
    }

    fn add_record(&mut self, bodies: [u32; 2]) {
        let record = self.pairs.add(bodies);
        self.pairs[record].is_dirty = true;
        self.dirty.push(record);
    }

    /// Removes a record; its contacts end with the next update.
    pub(super) fn remove_record(&mut self, record: u32) {
        let bodies = self.pairs[record].bodies.map(|slot| self.id(slot));
        let was_new = self.pairs[record].status == Status::New;
        self.has_removed_dirty |= self.pairs[record].is_dirty;
        let pairs = self.pairs.remove(record);
        if !was_new {
            self.log.note(bodies, pairs::NONE, pairs);
        }
    }

    fn check_features(&self, mesh: &SharedMesh) -> Result<(), Error> {
        let (kind_a, kind_b) = self.feature_kinds();
        if kind_a.count(mesh.mesh()) > 0 || kind_b.count(mesh.mesh()) > 0 {
            return Ok(());
        }
        // A kind with vertices lacks nothing: every mesh has one.
        let (missing, needed) = match (kind_a, kind_b) {
            (FeatureKind::Edge, FeatureKind::Triangle) => ("edge and no triangle", "an edge or a triangle"),
            (_, FeatureKind::Triangle) => ("triangle", "a triangle"),
            (_, FeatureKind::Edge) => ("edge", "an edge"),
            (_, FeatureKind::Vertex) => ("vertex", "a vertex"),
        };
        Err(Error::NoFeature {
            missing,
            needed,
            pairs: self.kind,
        })
    }

    /// Pairs of bodies, a body with itself included, that are kept from colliding, and pairs of two that may collide.
    pub(super) fn counts(&mut self) -> (u64, u64) {
        if let Some(counted) = self.membership.counted {
            return counted;
        }
        let classes: Vec<_> = self
            .membership
            .classes
            .iter()
            .map(|(&(g, m), &n)| ([g, m], n))
            .collect();
        let mut wanted = 0;
        for (at, (class, n)) in classes.iter().enumerate() {
            let others = classes[at + 1..]
                .iter()
                .filter(|(other, _)| match_groups(*class, *other));
            wanted += n * others.map(|(_, m)| m).sum::<u64>();
            wanted += if match_groups(*class, *class) {
                n * (n - 1) / 2
            } else {
                0
            };
        }
        let (mut excluded, mut own) = (0, self.membership.aloof);
        for &(a, b) in self.membership.excluded.iter().filter(|(a, b)| a <= b) {
            let (one, two) = (self.state(a), self.state(b));
            if a != b {
                excluded += u64::from(match_groups([one.groups, one.mask], [two.groups, two.mask]));
            } else if one
                .deforming
                .as_ref()
                .is_some_and(|own| own.collides_with_itself())
            {
                own += 1;
            }
        }
        let n = self.len() as u64;
        wanted -= excluded;
        let counted = (n * n.saturating_sub(1) / 2 - wanted + own, wanted);
        self.membership.counted = Some(counted);
        counted
    }
}
