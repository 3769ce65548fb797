//! Which of eight moving boxes meet which of eight others, and when, on the vector unit.
//!
//! A gap between two boxes on an axis is linear in the time. It is a difference of two numbers, so its sign is right and its value off by
//! one rounding; a quotient of gaps is off by less than four. A gap above 0 that shrinks is above 0 until a time if it is so, as computed
//! with four roundings, until one that is later by a hundred roundings.

use super::tree::{LANES, MovingBox, MovingGroup};
use crate::simd::{self, Eight, Floats};

/// When the boxes of two groups first meet.
#[derive(Debug, Clone)]
pub(super) struct Meetings {
    /// For each box of the first group those of the second that are not apart from it until the time asked for, a bit each.
    pub(super) masks: [u32; LANES],
    /// Lower bounds of the times at which they first meet, where the bit is set.
    pub(super) first: [Eight; LANES],
}

/// Two groups, the first one grown by a margin.
pub(super) struct Meet<'g> {
    pub(super) a: &'g MovingGroup,
    /// The number of boxes in it.
    pub(super) lanes: usize,
    pub(super) b: &'g MovingGroup,
    /// The box around the second group; `None` if the groups are one.
    pub(super) around_b: Option<MovingBox>,
    pub(super) margin: f32,
    /// The vertices of the features in both, a lane each; features that share one do not meet. `None` for groups of groups.
    pub(super) corners: Option<[&'g [[u32; LANES]]; 2]>,
}

impl Meet<'_> {
    /// When each box of the first group meets the boxes of the second, if it does by the time `until`.
    #[inline]
    pub(super) fn until(self, until: f32) -> Meetings {
        simd::dispatch(Until { of: self, until })
    }

    /// For each box of the first group those of the second that are not apart from it in the same order at both ends.
    #[inline]
    pub(super) fn masks(self) -> [u32; LANES] {
        simd::dispatch(Masks(self))
    }
}

impl MovingGroup {
    /// The lanes that are not apart from a box in the same order at both ends, a bit each.
    #[inline]
    pub(super) fn candidates(&self, of: &MovingBox) -> u32 {
        simd::dispatch(Candidates { group: self, of })
    }
}

struct Until<'g> {
    of: Meet<'g>,
    until: f32,
}

struct Masks<'g>(Meet<'g>);

struct Candidates<'g> {
    group: &'g MovingGroup,
    of: &'g MovingBox,
}

impl simd::Work for Until<'_> {
    type Output = Meetings;

    #[inline(always)]
    fn run<L: simd::Lanes>(self, lanes: L) -> Meetings {
        let s = lanes.single();
        let (of, until) = (self.of, Some(self.until * (1.0 + 100.0 * f32::EPSILON)));
        let mut meetings = Meetings {
            masks: [0; LANES],
            first: [[0.0; LANES]; LANES],
        };
        let mut own = own_lanes(s, &of, until);
        while own != 0 {
            let lane = own.trailing_zeros() as usize;
            own &= own - 1;
            let grown = of.a.lane(lane).grown(of.margin);
            let mask = row(s, of.b, &grown, until);
            let mask = without_neighbours(lanes, &of, lane, mask);
            meetings.masks[lane] = mask;
            // most meet from the start, and divisions are slow
            if mask != 0 && mask & late(s, of.b, &grown) != 0 {
                meetings.first[lane] = first(s, of.b, &grown);
            }
        }
        meetings
    }
}

impl simd::Work for Masks<'_> {
    type Output = [u32; LANES];

    #[inline(always)]
    fn run<L: simd::Lanes>(self, lanes: L) -> [u32; LANES] {
        let (s, of) = (lanes.single(), &self.0);
        let mut masks = [0; LANES];
        let mut own = own_lanes(s, of, None);
        while own != 0 {
            let lane = own.trailing_zeros() as usize;
            own &= own - 1;
            let mask = row(s, of.b, &of.a.lane(lane).grown(of.margin), None);
            masks[lane] = without_neighbours(lanes, of, lane, mask);
        }
        masks
    }
}

impl simd::Work for Candidates<'_> {
    type Output = u32;

    #[inline(always)]
    fn run<L: simd::Lanes>(self, lanes: L) -> u32 {
        row(lanes.single(), self.group, self.of, None)
    }
}

/// The boxes of the first group that are not apart from the one around the second.
#[inline(always)]
fn own_lanes<F: Floats<Scalar = f32, Array = Eight>>(s: F, of: &Meet<'_>, until: Option<f32>) -> u32 {
    let all = (1 << of.lanes) - 1;
    match &of.around_b {
        Some(around) => all & row(s, of.a, &around.grown(of.margin), until),
        None => all,
    }
}

/// The bits of a mask of the second group whose features share no vertex with the feature in a lane of the first.
#[inline(always)]
fn without_neighbours<L: simd::Lanes>(lanes: L, of: &Meet<'_>, lane: usize, mut mask: u32) -> u32 {
    if let Some([a, b]) = of.corners
        && mask != 0
    {
        for own in a {
            for other in b {
                mask &= !lanes.equal_ids(other, own[lane]);
            }
        }
    }
    mask
}

/// The lanes of a group that are not apart from a box until a time, a bit each. Without a time, at both ends in the same order.
#[inline(always)]
fn row<F: Floats<Scalar = f32, Array = Eight>>(
    s: F,
    group: &MovingGroup,
    of: &MovingBox,
    until: Option<f32>,
) -> u32 {
    let zero = s.splat(0.0);
    let mut apart = s.splat(-1.0);
    for k in 0..3 {
        for side in 0..2 {
            let [from, to] = gap(s, group, of, k, side);
            let last = match until {
                Some(until) => s.mul_add(s.splat(until), s.sub(to, from), from),
                None => to,
            };
            // in this order an empty box, whose last gap is no number, is apart
            apart = s.max(s.min(last, from), apart);
        }
    }
    s.bits(s.at_most(apart, zero))
}

/// The lanes that are apart at the start.
#[inline(always)]
fn late<F: Floats<Scalar = f32, Array = Eight>>(s: F, group: &MovingGroup, of: &MovingBox) -> u32 {
    let mut late = s.splat(0.0);
    for k in 0..3 {
        for side in 0..2 {
            late = s.max(gap(s, group, of, k, side)[0], late);
        }
    }
    s.bits(s.less(s.splat(0.0), late))
}

/// Lower bounds of the times at which the boxes of a group first meet a box, where they do.
#[inline(always)]
fn first<F: Floats<Scalar = f32, Array = Eight>>(s: F, group: &MovingGroup, of: &MovingBox) -> Eight {
    let zero = s.splat(0.0);
    let mut first = zero;
    for k in 0..3 {
        for side in 0..2 {
            let [from, to] = gap(s, group, of, k, side);
            let from = s.max(from, zero);
            // NaN (of 0 / 0) is not greater.
            first = s.max(s.div(from, s.sub(from, to)), first);
        }
    }
    s.store(s.mul(first, s.splat(1.0 - 8.0 * f32::EPSILON)))
}

/// The gaps at both ends, on one side of a box along an axis.
#[inline(always)]
fn gap<F: Floats<Scalar = f32, Array = Eight>>(
    s: F,
    group: &MovingGroup,
    of: &MovingBox,
    k: usize,
    side: usize,
) -> [F::Number; 2] {
    if side == 0 {
        [
            s.sub(s.load(&group.min[0][k]), s.splat(of.max[0][k])),
            s.sub(s.load(&group.min[1][k]), s.splat(of.max[1][k])),
        ]
    } else {
        [
            s.sub(s.splat(of.min[0][k]), s.load(&group.max[0][k])),
            s.sub(s.splat(of.min[1][k]), s.load(&group.max[1][k])),
        ]
    }
}
