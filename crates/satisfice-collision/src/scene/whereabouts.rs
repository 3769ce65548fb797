//! Where a body is and where it goes: what a frame reads of a rigid body that moves, on one line of memory, and the room that it has.

use super::body_tree::TreeFrame;
use super::extent::is_small;
use crate::broad::Box32;
use crate::mesh::Point;
use crate::{CompactPlacement, Placement};

/// The number of the rotation that does not turn; the others are kept elsewhere.
const UPRIGHT: u8 = 2;

/// It is rigid: it may be placed.
const RIGID: u8 = 1;
/// Only a large translation takes a vertex out of the range of numbers.
const SMALL: u8 = 2;
/// It is listed among those that leave their boxes.
const LEAVES: u8 = 4;

/// A body's place of the present frame and that of the next one, which becomes the present one when the frames are counted on:
/// a body that stays in its box need not be touched again then.
#[repr(C, align(64))]
pub(super) struct Whereabouts {
    /// Translations.
    at: [Point; 2],
    /// The frame in which the place given last is the present one.
    moved_at: u64,
    pub(super) generation: u32,
    /// So many frames before that it came to the place before, or more, where this is [`LONG`].
    rested: u16,
    /// [`RIGID`], [`SMALL`], [`LEAVES`].
    flags: u8,
    /// Which of the two places was given last: a bit; above it two bits for each, the numbers of the rotations.
    turns: u8,
}

/// The longest rest that is counted.
const LONG: u16 = u16::MAX;
/// Questions about the rests of bodies do not go back further than so many frames.
pub(super) const MEMORY: u64 = LONG as u64 - 2;

/// Two rotations, which bodies that never turn do not have.
pub(super) struct Rotations(Option<Box<[[f64; 4]; 2]>>);

impl Rotations {
    pub(super) const NONE: Self = Self(None);

    /// The one of this number; the identity for [`UPRIGHT`].
    fn get(&self, turn: u8) -> &[f64; 4] {
        const IDENTITY: [f64; 4] = CompactPlacement::IDENTITY.quaternion();
        let kept = self.0.as_ref().and_then(|both| both.get(usize::from(turn)));
        kept.unwrap_or(&IDENTITY)
    }

    /// Keeps one, unless it is that of bodies that do not turn.
    fn set(&mut self, turn: u8, rotation: &[f64; 4]) {
        if turn != UPRIGHT {
            let both = self.0.get_or_insert_with(|| Box::new([*rotation; 2]));
            both[usize::from(turn)] = *rotation;
        }
    }

    /// Bytes held elsewhere.
    pub(super) fn bytes(&self) -> usize {
        self.0.as_ref().map_or(0, |both| size_of_val(&**both))
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
            at: [[0.0; 3]; 2],
            moved_at: 0,
            generation,
            rested: 0,
            flags: if is_rigid { RIGID } else { 0 } | if is_small { SMALL } else { 0 },
            turns: UPRIGHT << 1 | UPRIGHT << 3,
        }
    }

    /// Whether the body is rigid: whether it may be placed.
    #[inline(always)]
    pub(super) fn is_rigid(&self) -> bool {
        self.flags & RIGID != 0
    }

    /// Whether it is listed among those that leave their boxes.
    #[inline(always)]
    pub(super) fn leaves(&self) -> bool {
        self.flags & LEAVES != 0
    }

    /// Notes whether it is listed so, and returns whether it was.
    #[inline(always)]
    pub(super) fn set_leaves(&mut self, leaves: bool) -> bool {
        let before = self.leaves();
        self.flags = self.flags & !LEAVES | if leaves { LEAVES } else { 0 };
        before
    }

    /// The frame in which it moved last, or that in which it will move.
    #[inline(always)]
    pub(super) fn moved_at(&self) -> u64 {
        self.moved_at
    }

    /// A body without a placement has moved in this frame.
    pub(super) fn note_motion(&mut self, frame: u64) {
        self.moved_at = frame;
    }

    /// The number of the rotation of a place.
    #[inline(always)]
    fn turn_of(&self, place: usize) -> u8 {
        self.turns >> (1 + 2 * place) & 3
    }

    /// Gives a place a rotation, and says that it was given last.
    #[inline(always)]
    fn set_last(&mut self, place: usize, turn: u8) {
        let others = self.turns & !(1 | 3 << (1 + 2 * place));
        self.turns = others | place as u8 | turn << (1 + 2 * place);
    }

    /// Puts a body that has just been added into its place.
    pub(super) fn begin(&mut self, rotations: &mut Rotations, placement: &Placement) {
        self.at = [placement.translation(); 2];
        if !is_upright(&placement.quaternion()) {
            rotations.set(0, &placement.quaternion());
            self.turns = 0;
        }
    }

    /// Whether a translation certainly leaves every vertex in the range of numbers.
    #[inline(always)]
    pub(super) fn allows(&self, translation: &Point) -> bool {
        self.flags & SMALL != 0 && is_small(translation)
    }

    /// The number of the present place, where the world is in this frame.
    #[inline]
    pub(super) fn present(&self, frame: u64) -> usize {
        self.last() ^ usize::from(self.is_pending(frame))
    }

    /// Whether the place given last is that of the next frame.
    #[inline]
    pub(super) fn is_pending(&self, frame: u64) -> bool {
        self.moved_at > frame
    }

    /// The frame in which it came to its present place.
    pub(super) fn came_at(&self, frame: u64) -> u64 {
        match self.is_pending(frame) {
            true => self.came_before(),
            false => self.moved_at,
        }
    }

    /// The frame in which it came to the place before the one given last, or one of long ago.
    fn came_before(&self) -> u64 {
        match self.rested {
            LONG => 0,
            rested => self.moved_at - u64::from(rested),
        }
    }

    /// The number of the place given last.
    #[inline(always)]
    pub(super) fn last(&self) -> usize {
        usize::from(self.turns & 1)
    }

    #[inline]
    pub(super) fn translation(&self, place: usize) -> Point {
        self.at[place]
    }

    /// Whether a place does not turn the body.
    #[inline]
    pub(super) fn is_upright(&self, place: usize) -> bool {
        self.turn_of(place) == UPRIGHT
    }

    /// One of the two places. Cost: that of a matrix if it turns the body.
    pub(super) fn placement(&self, rotations: &Rotations, place: usize) -> Placement {
        match self.is_upright(place) {
            true => Placement::IDENTITY.at(self.at[place]),
            false => CompactPlacement::new(*rotations.get(self.turn_of(place)), self.at[place]).into(),
        }
    }

    /// The rotation given last, if it turns the body.
    #[inline]
    pub(super) fn rotation<'a>(&self, rotations: &'a Rotations) -> Option<&'a [f64; 4]> {
        match self.turn_of(self.last()) {
            UPRIGHT => None,
            turn => Some(rotations.get(turn)),
        }
    }

    /// Whether a rotation differs from that given last.
    #[inline(always)]
    pub(super) fn turns_to(&self, rotations: &Rotations, rotation: &[f64; 4]) -> bool {
        match self.turn_of(self.last()) {
            UPRIGHT => !is_upright(rotation),
            turn => rotation != rotations.get(turn),
        }
    }

    /// Turns the body in the next frame.
    pub(super) fn turn(&mut self, rotations: &mut Rotations, rotation: &[f64; 4], frame: u64) -> Movement {
        let present = self.turn_of(self.present(frame));
        let turn = match present {
            _ if is_upright(rotation) => UPRIGHT,
            _ if rotation == rotations.get(present) => present,
            0 => 1,
            _ => 0,
        };
        rotations.set(turn, rotation);
        let to = self.at[self.last()];
        self.go(to, turn, frame)
    }

    /// Moves the body in the next frame, turned as it was given last.
    #[inline(always)]
    pub(super) fn shift(&mut self, to: Point, frame: u64) -> Movement {
        self.go(to, self.turn_of(self.last()), frame)
    }

    #[inline(always)]
    fn go(&mut self, to: Point, turn: u8, frame: u64) -> Movement {
        let was_pending = self.is_pending(frame);
        let present = self.present(frame);
        if !was_pending && self.turn_of(present) == turn && !differ(&self.at[present], &to) {
            return Movement::Rests;
        }
        let next = 1 - present;
        self.at[next] = to;
        self.set_last(next, turn);
        if was_pending {
            return Movement::Continues;
        }
        self.rested = (frame + 1 - self.moved_at).min(u64::from(LONG)) as u16;
        self.moved_at = frame + 1;
        Movement::Begins
    }

    /// The last two translations, the older one first, if neither place turns the body.
    #[inline]
    pub(super) fn upright_way(&self) -> Option<[Point; 2]> {
        let last = self.last();
        (self.turns | 1 == (1 | UPRIGHT << 1 | UPRIGHT << 3)).then(|| [self.at[1 - last], self.at[last]])
    }

    /// The translation given last.
    #[inline(always)]
    pub(super) fn next(&self) -> &Point {
        &self.at[self.last()]
    }
}

/// Where the translation of a body may be so that its box in the tree still holds it, turned as it was given last: in the frame of the
/// tree, rounded inwards.
#[derive(Clone, Copy)]
pub(super) struct Room(Box32);

impl Room {
    /// No translation is in it.
    pub(super) const NONE: Self = Self(Box32::EMPTY);

    /// From the sides in the frame, correct up to a rounding of theirs.
    #[inline(always)]
    pub(super) fn within(min: &[f64; 3], max: &[f64; 3]) -> Self {
        Self(Box32::inside(min, max))
    }

    /// Whether a translation is in it.
    #[inline(always)]
    pub(super) fn holds(&self, frame: &TreeFrame, translation: &Point) -> bool {
        (0..3).fold(true, |inside, k| {
            let at = (translation[k] - frame.origin[k]) * frame.scale;
            inside & (f64::from(self.0.min[k]) <= at) & (at <= f64::from(self.0.max[k]))
        })
    }
}

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
