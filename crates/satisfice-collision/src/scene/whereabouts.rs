//! Where a body is and where it goes: what a frame reads of a rigid body that moves, on two lines of memory.

use super::extent::is_small;
use crate::mesh::Point;
use crate::{Aabb, CompactPlacement, Placement};

/// The number of the rotation that does not turn; the others are kept elsewhere.
const UPRIGHT: u8 = 2;

/// A body's place of the present frame and that of the next one, which becomes the present one when the frames are counted on:
/// a body that stays in its box need not be touched again then.
#[repr(C, align(128))]
pub(super) struct Whereabouts {
    pub(super) generation: u32,
    /// Whether the body is rigid: whether it may be placed.
    pub(super) is_rigid: bool,
    /// Whether only a large translation takes a vertex out of the range of numbers.
    is_small: bool,
    /// Whether it is listed among those that leave their boxes.
    pub(super) leaves: bool,
    /// Which of the two places was given last.
    last: bool,
    /// The frame in which the place given last is the present one.
    pub(super) moved_at: u64,
    /// The same of the place before that, where the one given last is that of the next frame.
    moved_before: u64,
    /// Translations.
    at: [Point; 2],
    /// Where the translation may be so that the body's box in the tree still holds it, turned as it was given last.
    room: Aabb,
    /// The numbers of the rotations.
    turns: [u8; 2],
}

/// Two rotations, of which bodies that never turn use none.
#[derive(Clone, Copy)]
pub(super) struct Rotations([[f64; 4]; 2]);

impl Rotations {
    pub(super) const NONE: Self = Self([CompactPlacement::IDENTITY.quaternion(); 2]);

    fn get(&self, turn: u8) -> &[f64; 4] {
        const IDENTITY: [f64; 4] = CompactPlacement::IDENTITY.quaternion();
        self.0.get(usize::from(turn)).unwrap_or(&IDENTITY)
    }
}

/// What a new place means for a body.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Movement {
    /// It is where it is.
    Rests,
    /// It moves, and was not to move before.
    Begins,
    /// It was to move already.
    Continues,
}

impl Whereabouts {
    pub(super) fn new(generation: u32, is_rigid: bool, is_small: bool) -> Self {
        Self {
            generation,
            is_rigid,
            is_small,
            leaves: false,
            last: false,
            moved_at: 0,
            moved_before: 0,
            at: [[0.0; 3]; 2],
            room: NOWHERE,
            turns: [UPRIGHT; 2],
        }
    }

    /// Puts a body that has just been added into its place.
    pub(super) fn begin(&mut self, rotations: &mut Rotations, placement: &Placement) {
        self.at = [placement.translation(); 2];
        if !is_upright(&placement.quaternion()) {
            rotations.0[0] = placement.quaternion();
            self.turns = [0; 2];
        }
    }

    /// Whether a translation certainly leaves every vertex in the range of numbers.
    #[inline(always)]
    pub(super) fn allows(&self, translation: &Point) -> bool {
        self.is_small && is_small(translation)
    }

    /// The number of the present place, where the world is in this frame.
    #[inline]
    pub(super) fn present(&self, frame: u64) -> usize {
        usize::from(self.last ^ self.is_pending(frame))
    }

    /// Whether the place given last is that of the next frame.
    #[inline]
    pub(super) fn is_pending(&self, frame: u64) -> bool {
        self.moved_at > frame
    }

    /// The frame in which it came to its present place.
    pub(super) fn came_at(&self, frame: u64) -> u64 {
        match self.is_pending(frame) {
            true => self.moved_before,
            false => self.moved_at,
        }
    }

    /// The number of the place given last.
    #[inline]
    pub(super) fn last(&self) -> usize {
        usize::from(self.last)
    }

    #[inline]
    pub(super) fn translation(&self, place: usize) -> Point {
        self.at[place]
    }

    /// Whether a place does not turn the body.
    #[inline]
    pub(super) fn is_upright(&self, place: usize) -> bool {
        self.turns[place] == UPRIGHT
    }

    /// One of the two places. Cost: that of a matrix if it turns the body.
    pub(super) fn placement(&self, rotations: &Rotations, place: usize) -> Placement {
        match self.is_upright(place) {
            true => Placement::IDENTITY.at(self.at[place]),
            false => CompactPlacement::new(*rotations.get(self.turns[place]), self.at[place]).into(),
        }
    }

    /// The rotation given last, if it turns the body.
    #[inline]
    pub(super) fn rotation<'a>(&self, rotations: &'a Rotations) -> Option<&'a [f64; 4]> {
        rotations.0.get(usize::from(self.turns[self.last()]))
    }

    /// Whether a rotation differs from that given last.
    #[inline(always)]
    pub(super) fn turns_to(&self, rotations: &Rotations, rotation: &[f64; 4]) -> bool {
        match self.turns[self.last()] {
            UPRIGHT => !is_upright(rotation),
            turn => rotation != rotations.get(turn),
        }
    }

    /// Turns the body in the next frame.
    pub(super) fn turn(&mut self, rotations: &mut Rotations, rotation: &[f64; 4], frame: u64) -> Movement {
        let present = self.turns[self.present(frame)];
        let turn = match present {
            _ if is_upright(rotation) => UPRIGHT,
            _ if rotation == rotations.get(present) => present,
            0 => 1,
            _ => 0,
        };
        if let Some(kept) = rotations.0.get_mut(usize::from(turn)) {
            *kept = *rotation;
        }
        let to = self.at[self.last()];
        self.go(to, turn, frame)
    }

    /// Moves the body in the next frame, turned as it was given last.
    #[inline(always)]
    pub(super) fn shift(&mut self, to: Point, frame: u64) -> Movement {
        self.go(to, self.turns[self.last()], frame)
    }

    #[inline(always)]
    fn go(&mut self, to: Point, turn: u8, frame: u64) -> Movement {
        let was_pending = self.is_pending(frame);
        let present = self.present(frame);
        if !was_pending && self.turns[present] == turn && !differ(&self.at[present], &to) {
            return Movement::Rests;
        }
        let next = 1 - present;
        (self.at[next], self.turns[next]) = (to, turn);
        self.last = next == 1;
        if was_pending {
            return Movement::Continues;
        }
        (self.moved_before, self.moved_at) = (self.moved_at, frame + 1);
        Movement::Begins
    }

    /// Tells where the centre of the body, which is so far from its origin, may go.
    #[inline]
    pub(super) fn give_room(&mut self, centre_room: &Aabb, offset: &Point) {
        // each side is rounded twice, and the centre once
        let slack = |side: f64, off: f64| 1e-15 * (side.abs() + off.abs()) + f64::MIN_POSITIVE;
        let low = |k: usize| (centre_room.min[k] - offset[k]) + slack(centre_room.min[k], offset[k]);
        let high = |k: usize| (centre_room.max[k] - offset[k]) - slack(centre_room.max[k], offset[k]);
        self.room = Aabb {
            min: std::array::from_fn(low),
            max: std::array::from_fn(high),
        };
    }

    /// Tells where the body, turned as it is, may go.
    #[inline]
    pub(super) fn set_room(&mut self, room: Aabb) {
        self.room = room;
    }

    /// The last two translations, the older one first, if neither place turns the body.
    #[inline]
    pub(super) fn upright_way(&self) -> Option<[Point; 2]> {
        let last = self.last();
        (self.turns == [UPRIGHT; 2]).then(|| [self.at[1 - last], self.at[last]])
    }

    /// Whether the place given last lies in the room.
    #[inline(always)]
    pub(super) fn is_in_room(&self) -> bool {
        let at = &self.at[self.last()];
        (0..3).fold(true, |inside, k| {
            inside & (self.room.min[k] <= at[k]) & (at[k] <= self.room.max[k])
        })
    }
}

/// No point is in it.
pub(super) const NOWHERE: Aabb = Aabb {
    min: [f64::INFINITY; 3],
    max: [f64::NEG_INFINITY; 3],
};

/// Whether a rotation does not turn.
#[inline]
pub(super) fn is_upright(rotation: &[f64; 4]) -> bool {
    !differ(rotation, &CompactPlacement::IDENTITY.quaternion())
}

/// `!=` without a branch for each number.
#[inline]
fn differ<const N: usize>(a: &[f64; N], b: &[f64; N]) -> bool {
    (0..N).fold(false, |differ, k| differ | (a[k] != b[k]))
}
