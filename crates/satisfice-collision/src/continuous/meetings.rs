//! Which of eight moving boxes meet which of eight others, and when, on the vector unit.
//!
//! A gap between two boxes on an axis is linear in the time. It is a difference of two numbers, so its sign is right and its value off by
//! one rounding; a quotient of gaps is off by less than four. A gap above 0 that shrinks is above 0 until a time if it is so, as computed
//! with four roundings, until one that is later by a hundred roundings.

use super::boxes::{LANES, MovingBox, MovingGroup};
use crate::simd::{self, Eight, Floats};

/// The pairs of boxes of one group with another, a bit each: bit `8 i + j` is the pair of box `i` of the first and box `j` of the second.
pub(super) type PairBits = u64;

/// Pairs of a group with itself, each once.
pub(super) const ONCE: PairBits = 0x80c0_e0f0_f8fc_feff;
/// The same without the pairs of a box with itself.
pub(super) const ONCE_APART: PairBits = ONCE & !0x8040_2010_0804_0201;

/// The lanes of the pairs whose bits are set.
pub(super) fn pairs(mut bits: PairBits) -> impl Iterator<Item = [usize; 2]> {
    std::iter::from_fn(move || {
        let place = bits.trailing_zeros() as usize;
        (bits != 0).then(|| {
            bits &= bits - 1;
            [place / LANES, place % LANES]
        })
    })
}

/// Lower bounds of the times at which boxes of two groups first meet, for the pairs that were found.
pub(super) type FirstTimes = [Eight; LANES];

/// Two groups, the first one grown by a margin.
pub(super) struct Meet<'g> {
    pub(super) a: &'g MovingGroup,
    pub(super) b: &'g MovingGroup,
    /// Where the box around the second group is; `None` if the groups are one, or if there is no such box.
    pub(super) around_b: Option<(&'g MovingGroup, usize)>,
    pub(super) margin: f32,
    /// The vertices of the features in both, a lane each; features that share one do not meet. `None` for groups of groups.
    pub(super) corners: Option<[&'g [[u32; LANES]]; 2]>,
}

impl Meet<'_> {
    /// The pairs that are not apart until the time `until`, and when they first meet.
    #[inline]
    pub(super) fn until(self, until: f32, first: &mut FirstTimes) -> PairBits {
        simd::dispatch(Until {
            of: self,
            until,
            first,
        })
    }

    /// The pairs that are not apart in the same order at both ends.
    #[inline]
    pub(super) fn pairs(self) -> PairBits {
        simd::dispatch(Pairs(self))
    }
}

impl MovingGroup {
    /// The lanes that are not apart from a box in the same order at both ends, a bit each.
    #[inline]
    pub(super) fn candidates(&self, of: &MovingBox) -> u32 {
        simd::dispatch(Candidates { group: self, of })
    }
}

struct Until<'g, 'f> {
    of: Meet<'g>,
    until: f32,
    first: &'f mut FirstTimes,
}

struct Pairs<'g>(Meet<'g>);

struct Candidates<'g> {
    group: &'g MovingGroup,
    of: &'g MovingBox,
}

impl simd::Work for Until<'_, '_> {
    type Output = PairBits;

    #[inline(always)]
    fn run<L: simd::Lanes>(self, lanes: L) -> PairBits {
        let s = lanes.single();
        let (of, until) = (self.of, Some(s.splat(self.until * (1.0 + 100.0 * f32::EPSILON))));
        let (mut bits, mut own) = (0, own_lanes(s, &of, until));
        while own != 0 {
            let lane = own.trailing_zeros() as usize;
            own &= own - 1;
            let grown = in_all_lanes(s, of.a, lane, of.margin);
            let mask = row(s, of.b, &grown, until);
            let mask = without_neighbours(lanes, &of, lane, mask);
            if mask != 0 {
                bits |= u64::from(mask) << (LANES * lane);
                // most meet from the start, and divisions are slow
                self.first[lane] = match mask & late(s, of.b, &grown) {
                    0 => [0.0; LANES],
                    _ => first(s, of.b, &grown),
                };
            }
        }
        bits
    }
}

impl simd::Work for Pairs<'_> {
    type Output = PairBits;

    #[inline(always)]
    fn run<L: simd::Lanes>(self, lanes: L) -> PairBits {
        let (s, of) = (lanes.single(), &self.0);
        let (mut bits, mut own) = (0, own_lanes(s, of, None));
        while own != 0 {
            let lane = own.trailing_zeros() as usize;
            own &= own - 1;
            let mask = row(s, of.b, &in_all_lanes(s, of.a, lane, of.margin), None);
            bits |= u64::from(without_neighbours(lanes, of, lane, mask)) << (LANES * lane);
        }
        bits
    }
}

impl simd::Work for Candidates<'_> {
    type Output = u32;

    #[inline(always)]
    fn run<L: simd::Lanes>(self, lanes: L) -> u32 {
        let s = lanes.single();
        row(s, self.group, &everywhere(s, self.of), None)
    }
}

/// A box in registers, the same in all lanes.
struct Everywhere<N> {
    min: [[N; 3]; 2],
    max: [[N; 3]; 2],
}

/// The box in one lane of a group, grown by a margin.
#[inline(always)]
fn in_all_lanes<F: Floats<Scalar = f32, Array = Eight>>(
    s: F,
    group: &MovingGroup,
    lane: usize,
    margin: f32,
) -> Everywhere<F::Number> {
    if margin != 0.0 {
        return everywhere(s, &group.lane(lane).grown(margin));
    }
    let mut of = Everywhere {
        min: [[s.splat(0.0); 3]; 2],
        max: [[s.splat(0.0); 3]; 2],
    };
    for end in 0..2 {
        for k in 0..3 {
            of.min[end][k] = s.splat(group.min[end][k][lane]);
            of.max[end][k] = s.splat(group.max[end][k][lane]);
        }
    }
    of
}

#[inline(always)]
fn everywhere<F: Floats<Scalar = f32, Array = Eight>>(s: F, of: &MovingBox) -> Everywhere<F::Number> {
    let mut all = Everywhere {
        min: [[s.splat(0.0); 3]; 2],
        max: [[s.splat(0.0); 3]; 2],
    };
    for end in 0..2 {
        for k in 0..3 {
            all.min[end][k] = s.splat(of.min[end][k]);
            all.max[end][k] = s.splat(of.max[end][k]);
        }
    }
    all
}

/// The boxes of the first group that are not apart from the one around the second.
#[inline(always)]
fn own_lanes<F: Floats<Scalar = f32, Array = Eight>>(s: F, of: &Meet<'_>, until: Option<F::Number>) -> u32 {
    match of.around_b {
        Some((group, lane)) => row(s, of.a, &in_all_lanes(s, group, lane, of.margin), until),
        None => (1 << LANES) - 1,
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
    of: &Everywhere<F::Number>,
    until: Option<F::Number>,
) -> u32 {
    let zero = s.splat(0.0);
    let mut apart = s.splat(-1.0);
    for k in 0..3 {
        for side in 0..2 {
            let [from, to] = gap(s, group, of, k, side);
            let last = match until {
                Some(until) => s.mul_add(until, s.sub(to, from), from),
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
fn late<F: Floats<Scalar = f32, Array = Eight>>(
    s: F,
    group: &MovingGroup,
    of: &Everywhere<F::Number>,
) -> u32 {
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
fn first<F: Floats<Scalar = f32, Array = Eight>>(
    s: F,
    group: &MovingGroup,
    of: &Everywhere<F::Number>,
) -> Eight {
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
    of: &Everywhere<F::Number>,
    k: usize,
    side: usize,
) -> [F::Number; 2] {
    if side == 0 {
        [
            s.sub(s.load(&group.min[0][k]), of.max[0][k]),
            s.sub(s.load(&group.min[1][k]), of.max[1][k]),
        ]
    } else {
        [
            s.sub(of.min[0][k], s.load(&group.max[0][k])),
            s.sub(of.min[1][k], s.load(&group.max[1][k])),
        ]
    }
}
