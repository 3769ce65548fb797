//! What moves in the next frame: bodies are placed and deformed.

use super::body::BodyId;
use super::settle::half_of;
use super::whereabouts::{Movement, Room, is_upright};
use super::{World, unknown};
use crate::distance::Point;
use crate::{Error, Placement};

/// Bodies that move in the next frame.
#[derive(Default)]
pub(super) struct Movers {
    /// Rigid bodies that were placed elsewhere.
    pub(super) placed: Vec<u32>,
    /// Those of them that may leave their boxes in the tree.
    pub(super) leaving: Vec<u32>,
    /// Deforming bodies that got vertices.
    pub(super) deformed: Vec<u32>,
    /// Whether some may have been removed since, or be listed twice.
    is_stale: bool,
}

impl Movers {
    pub(super) fn is_empty(&self) -> bool {
        self.placed.is_empty() && self.deformed.is_empty()
    }

    pub(super) fn len(&self) -> usize {
        self.placed.len() + self.deformed.len()
    }

    pub(super) fn bytes(&self) -> usize {
        (self.placed.capacity() + self.leaving.capacity() + self.deformed.capacity()) * 4
    }

    /// Bodies may have been removed.
    pub(super) fn forget(&mut self) {
        self.is_stale = !self.is_empty();
    }

    /// Leaves out what is not `wanted`, and what is there twice.
    pub(super) fn clean(&mut self, wanted: impl Fn(u32) -> bool) {
        if std::mem::take(&mut self.is_stale) {
            for list in [&mut self.placed, &mut self.deformed] {
                list.sort_unstable();
                list.dedup();
                list.retain(|&slot| wanted(slot));
            }
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
        self.go_to(body, Some(&placement.quaternion()), placement.translation())
    }

    /// Places a rigid body in the next frame, turned as it is there already: as [`World::place`] with its rotation and this
    /// translation, faster. The translation is that of its placement, where it will be, and not a step from where it is.
    ///
    /// ```
    /// use satisfice_collision::distance::{PairKind, Threshold};
    /// use satisfice_collision::scene::{Body, World};
    /// use satisfice_collision::{Placement, generate};
    /// let mut world = World::new(PairKind::VertexVertex, Threshold::new(0.1)?);
    /// let turned = Placement::from_axis_angle([0.0, 0.0, 1.0], 0.5)?;
    /// let ball = world.add(Body::rigid(generate::icosphere(1.0, 2)?).at(turned.moved([5.0, 0.0, 1.0])?))?;
    /// world.translate(ball, [5.0, 0.0, 3.0])?; // from z = 1 to z = 3
    /// world.update()?;
    /// assert_eq!(world.placement(ball)?, turned.moved([5.0, 0.0, 3.0])?);
    /// # Ok::<(), satisfice_collision::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`World::place`], and [`Error::Parameter`] if the translation is not finite.
    pub fn translate(&mut self, body: BodyId, translation: [f64; 3]) -> Result<(), Error> {
        self.go_to(body, None, translation)
    }

    #[inline(always)]
    fn go_to(
        &mut self,
        body: BodyId,
        rotation: Option<&[f64; 4]>,
        translation: [f64; 3],
    ) -> Result<(), Error> {
        // a body is looked up once, and not when the frame begins if it stays in its box
        let slot = body.slot as usize;
        let whereabouts = match self.whereabouts.get_mut(slot) {
            Some(whereabouts) if whereabouts.generation == body.generation => whereabouts,
            _ => return Err(unknown(body)),
        };
        if !whereabouts.is_rigid() {
            return Err(not_rigid(body));
        }
        // what is in the room is in the range of numbers
        let mut stays = rotation.is_none() && self.rooms[slot].holds(self.tree.frame(), &translation);
        if !stays
            && !whereabouts.allows(&translation)
            && let Some(state) = &self.states[slot]
        {
            state.check_place(whereabouts, rotation, &translation)?;
        }
        let mut step = Movement::Rests;
        if let Some(rotation) = rotation
            && !(whereabouts.is_upright(whereabouts.last()) && is_upright(rotation))
            && let Some(state) = &mut self.states[slot]
        {
            step = state.turn(whereabouts, rotation, self.frame);
        }
        let turns = step != Movement::Rests;
        let shifted = whereabouts.shift(translation, self.frame);
        if !turns {
            step = shifted;
        }
        if step == Movement::Rests {
            return Ok(());
        }
        if turns && let Some(state) = &self.states[slot] {
            // the room was that of the last rotation, and who turns may go on to turn
            self.rooms[slot] = Room::NONE;
            let (bounds, half) = (self.tree.box_of(body.slot), half_of(self.threshold));
            stays = state.stays(whereabouts, &self.tree, &bounds, half);
        } else if rotation.is_some() {
            stays = self.rooms[slot].holds(self.tree.frame(), &translation);
        }
        if step == Movement::Begins {
            super::push(&mut self.movers.placed, body.slot);
        }
        if !stays && !whereabouts.set_leaves(true) {
            super::push(&mut self.movers.leaving, body.slot);
        }
        Ok(())
    }

    /// Where a rigid body goes in the next frame, if it was placed since the last query.
    pub(super) fn next_placement(&self, slot: u32) -> Option<Placement> {
        let whereabouts = &self.whereabouts[slot as usize];
        let is_pending = whereabouts.is_pending(self.frame);
        is_pending.then(|| self.state(slot).state().last_placement(whereabouts))
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
                body,
                "it is not deforming, and only a deforming body has moving vertices",
            ));
        };
        deforming.deform(vertices)?;
        let whereabouts = &mut self.whereabouts[body.slot as usize];
        if !whereabouts.set_leaves(true) {
            super::push(&mut self.movers.deformed, body.slot);
        }
        Ok(())
    }

    /// The partners of a body must be found again.
    pub(super) fn unpair(&mut self, slot: u32) {
        self.unpaired.push(slot);
        // many changes of few bodies must not fill the memory
        if self.unpaired.len() > 2 * self.states.len() + 64 {
            self.clean_unpaired();
        }
    }

    /// Leaves out bodies that have been removed since, and what is there twice.
    pub(super) fn clean_unpaired(&mut self) {
        let states = &self.states;
        self.unpaired.retain(|&slot| states[slot as usize].is_some());
        self.unpaired.sort_unstable();
        self.unpaired.dedup();
    }
}

#[cold]
fn not_rigid(body: BodyId) -> Error {
    Error::parameter(
        "body",
        body,
        "it is not rigid, and only a rigid body has a moving placement",
    )
}
