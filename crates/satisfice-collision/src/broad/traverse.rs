//! The descent of two box trees, or of one with itself: which items can be within the threshold.

use std::cmp::Ordering;

use super::boxes::{BoxTree, Dirty, Group};
use super::frame::Filter;
use super::gaps::FarBoxes;
use super::relative::Relative;
use crate::simd::{Eight, Lanes, Work};

/// A group of one tree against a group of the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Visit {
    pub(super) level_a: u8,
    pub(super) level_b: u8,
    pub(super) a: u32,
    pub(super) b: u32,
}

impl Visit {
    /// Of two groups of items.
    #[inline(always)]
    fn leaf(a: u32, b: u32) -> Self {
        Self {
            level_a: 0,
            level_b: 0,
            a,
            b,
        }
    }
}

/// The work of a traversal.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct TreeWork {
    /// Pairs of groups of eight boxes compared.
    pub visits: u64,
    /// Pairs of features whose boxes are within the threshold.
    pub candidates: u64,
    /// Pairs that the distance itself had to decide.
    pub decisions: u64,
    /// Candidates that were left out because they share a vertex.
    pub neighbours: u64,
}

/// What boxes say of a pair of items.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Known {
    /// It is within the threshold.
    Within,
    /// It may be.
    Nothing,
    /// It may be, and the frame is too coarse for one of the two.
    Far,
}

/// Receives the pairs of items that can be within the threshold.
pub(crate) trait CandidateSink {
    /// Whether items are points, so that the squared distance itself is known.
    const POINTS: bool;
    /// Receives a pair of items.
    fn candidate(&mut self, a: u32, b: u32, known: Known);
    /// Receives how many pairs were left out because they share a vertex.
    fn neighbours(&mut self, count: u32);
    /// Whether enough has been found.
    fn enough(&self) -> bool {
        false
    }
}

/// For a group with itself: each pair of different lanes once.
const DIFFERENT: u64 = 0x0080_c0e0_f0f8_fcfe;

/// Two trees and their relative pose.
#[derive(Clone, Copy)]
pub(crate) struct Trees<'a> {
    pub(crate) a: &'a BoxTree,
    pub(crate) b: &'a BoxTree,
    pub(crate) relative: &'a Relative,
    pub(crate) filter: &'a Filter,
    /// If there are far coordinates, for which the filter does not hold.
    pub(crate) far: Option<&'a FarBoxes>,
    /// Whether both are the same tree, and each pair of different items is wanted once.
    pub(crate) one_body: bool,
    /// Pairs of which neither item moved are not visited.
    pub(crate) moved: [Dirty; 2],
    /// The vertices of the items of both, if items that share one are not wanted.
    pub(crate) neighbours: Option<[LaneCorners<'a>; 2]>,
}

/// The vertices of the items of a tree in its order, eight side by side: as many arrays a group as an item has vertices.
#[derive(Clone, Copy)]
pub(crate) struct LaneCorners<'a> {
    pub(crate) lanes: &'a [[u32; 8]],
    pub(crate) each: usize,
}

impl<'a> LaneCorners<'a> {
    #[inline(always)]
    fn group(self, group: u32) -> &'a [[u32; 8]] {
        &self.lanes[group as usize * self.each..][..self.each]
    }
}

impl Trees<'_> {
    /// Pushes the start of a traversal; nothing if a tree is empty.
    pub(crate) fn start(&self, to: &mut Vec<Visit>) {
        if let (Some(level_a), Some(level_b)) = (self.a.root(), self.b.root()) {
            to.push(Visit {
                level_a,
                level_b,
                a: 0,
                b: 0,
            });
        }
    }

    /// The groups of a visit; `rooms` are for those of points.
    #[inline(always)]
    pub(super) fn groups<'g>(&'g self, at: Visit, rooms: &'g mut [Group; 2]) -> [&'g Group; 2] {
        let [room_a, room_b] = rooms;
        [
            self.a.group(at.level_a, at.a, room_a),
            self.b.group(at.level_b, at.b, room_b),
        ]
    }

    /// The pairs of boxes of a visit that may be within the threshold, if it has far coordinates.
    #[cold]
    #[inline(never)]
    fn far_within(&self, at: Visit) -> Option<u64> {
        let far = self.far?;
        far.concern(self, at).then(|| far.within(self, at))
    }

    /// The pairs of lanes of two groups that count: bit `8 i + j` is lane `i` of the first and lane `j` of the second.
    #[inline(always)]
    pub(super) fn wanted(&self, at: Visit) -> u64 {
        let (lanes_a, lanes_b) = (self.a.lanes(at.level_a, at.a), self.b.lanes(at.level_b, at.b));
        let row = 0xff >> (8 - lanes_b);
        let mut wanted = (row * 0x0101_0101_0101_0101) & (u64::MAX >> (64 - 8 * lanes_a));
        if self.one_body && at.a == at.b && at.level_a == at.level_b {
            // each pair of children once, and a child with itself for its descendants; but no item with itself
            wanted &= if at.level_a == 0 {
                DIFFERENT
            } else {
                0x80c0_e0f0_f8fc_feff
            };
        }
        let moved_a = self.a.moved(self.moved[0], at.level_a, at.a);
        if moved_a != 0xff {
            let moved_b = self.b.moved(self.moved[1], at.level_b, at.b);
            for i in (0..8).filter(|i| moved_a >> i & 1 == 0) {
                wanted &= !(0xff << (8 * i)) | u64::from(moved_b) << (8 * i);
            }
        }
        wanted
    }
}

/// Descends from the visits on `stack`, which ends empty; at most `most` visits, the rest stays on the stack.
pub(crate) struct Descend<'a, C> {
    pub(crate) trees: Trees<'a>,
    pub(crate) stack: &'a mut Vec<Visit>,
    pub(crate) most: usize,
    pub(crate) visit: &'a mut C,
}

impl<C: CandidateSink> Work for Descend<'_, C> {
    /// Visits made.
    type Output = u64;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> u64 {
        let mut visits = 0;
        let room = &mut [Leaf::default(); 64];
        while visits < self.most as u64
            && !self.visit.enough()
            && let Some(at) = self.stack.pop()
        {
            visits += 1;
            if at.level_a == 0 && at.level_b == 0 {
                let one = Leaf {
                    near: near_in_leaf::<L, C>(lanes, self.trees, at),
                    a: at.a,
                    b: at.b,
                };
                deliver(lanes, self.trees, one, self.visit);
                continue;
            }
            let mut near = boxes_within(lanes, self.trees, at) & self.trees.wanted(at);
            // the taller tree alone, if their heights differ
            match at.level_a.cmp(&at.level_b) {
                Ordering::Equal if at.level_a == 1 => {
                    visits += leaves(lanes, self.trees, at, near, room, self.visit, self.stack);
                }
                Ordering::Equal => {
                    while near != 0 {
                        let (i, j) = next(&mut near);
                        self.stack.push(Visit {
                            level_a: at.level_a - 1,
                            level_b: at.level_b - 1,
                            a: at.a * 8 + i as u32,
                            b: at.b * 8 + j as u32,
                        });
                    }
                }
                Ordering::Greater => {
                    for i in (0..8).filter(|i| near >> (8 * i) & 0xff != 0) {
                        self.stack.push(Visit {
                            level_a: at.level_a - 1,
                            a: at.a * 8 + i,
                            ..at
                        });
                    }
                }
                Ordering::Less => {
                    let any = near.to_le_bytes().iter().fold(0, |any, row| any | row);
                    for j in (0..8).filter(|j| any >> j & 1 != 0) {
                        self.stack.push(Visit {
                            level_b: at.level_b - 1,
                            b: at.b * 8 + j,
                            ..at
                        });
                    }
                }
            }
        }
        visits
    }
}

/// A group of items of one tree against a group of the other: which of them are near.
#[derive(Debug, Clone, Copy, Default)]
struct Leaf {
    near: u64,
    a: u32,
    b: u32,
}

/// Compares the leaves in `below` under a visit without using the stack. Returns their number.
///
/// All are compared before any is delivered: only one in several has near items, and a mispredicted branch costs as much as a
/// comparison. `found` is scratch space.
#[inline(always)]
fn leaves<L: Lanes, C: CandidateSink>(
    lanes: L,
    trees: Trees<'_>,
    at: Visit,
    mut below: u64,
    found: &mut [Leaf; 64],
    visit: &mut C,
    stack: &mut Vec<Visit>,
) -> u64 {
    let visits = u64::from(below.count_ones());
    let mut count = 0;
    while below != 0 {
        let (i, j) = next(&mut below);
        let (a, b) = (at.a * 8 + i as u32, at.b * 8 + j as u32);
        let near = near_in_leaf::<L, C>(lanes, trees, Visit::leaf(a, b));
        found[count & 63] = Leaf { near, a, b };
        count += usize::from(near != 0);
    }
    for (n, &leaf) in found.iter().enumerate().take(count) {
        if visit.enough() {
            // the rest stays on the stack
            stack.extend(found[n..count].iter().map(|leaf| Visit::leaf(leaf.a, leaf.b)));
            break;
        }
        deliver(lanes, trees, leaf, visit);
    }
    visits
}

/// Removes and returns the next pair of lanes of a mask that is not 0.
#[inline(always)]
pub(super) fn next(mask: &mut u64) -> (usize, usize) {
    let at = mask.trailing_zeros() as usize & 63;
    *mask &= *mask - 1;
    (at >> 3, at & 7)
}

#[inline(always)]
fn columns(of: &[Eight; 3]) -> [&Eight; 3] {
    [&of[0], &of[1], &of[2]]
}

#[inline(always)]
fn boxes_within<L: Lanes>(lanes: L, trees: Trees<'_>, at: Visit) -> u64 {
    if trees.far.is_some()
        && let Some(near) = trees.far_within(at)
    {
        return near;
    }
    let mut rooms = [Group::EMPTY; 3];
    let [room_a, room_b, room] = &mut rooms;
    let a = trees
        .relative
        .boxes(trees.a.group(at.level_a, at.a, room_a), room);
    let b = trees.b.group(at.level_b, at.b, room_b);
    let (lower, upper) = (columns(&b.lower), columns(&b.upper));
    lanes.boxes_within(
        lower,
        upper,
        &a.lower,
        &a.upper,
        trees.filter.definitely_outside_sq,
    )
}

/// Which pairs of items of two leaves are within the threshold, or their boxes are.
#[inline(always)]
fn near_in_leaf<L: Lanes, C: CandidateSink>(lanes: L, trees: Trees<'_>, at: Visit) -> u64 {
    if !C::POINTS {
        return boxes_within(lanes, trees, at);
    }
    if trees.far.is_some()
        && let Some(near) = trees.far_within(at)
    {
        return near;
    }
    let Trees { a, b, filter, .. } = trees;
    let mut room = [[0.0; 8]; 3];
    let points_a = trees.relative.points(a.points(at.a), &mut room);
    let near = lanes.all_closer(columns(b.points(at.b)), points_a, filter.definitely_outside_sq);
    // no item with itself: usually nothing else is near
    let is_one = trees.one_body && at.a == at.b;
    near & if is_one { DIFFERENT } else { u64::MAX }
}

/// Delivers the near and wanted pairs of a leaf.
#[inline(always)]
fn deliver<L: Lanes, C: CandidateSink>(
    lanes: L,
    trees: Trees<'_>,
    Leaf {
        mut near,
        a: at_a,
        b: at_b,
    }: Leaf,
    visit: &mut C,
) {
    let Trees { a, b, filter, .. } = trees;
    if near != 0 {
        near &= trees.wanted(Visit::leaf(at_a, at_b));
    }
    if let Some([of_a, of_b]) = trees.neighbours
        && near != 0
    {
        let shared = near & sharing(lanes, near, of_a.group(at_a), of_b.group(at_b));
        visit.neighbours(shared.count_ones());
        near &= !shared;
    }
    if near == 0 {
        return;
    }
    let is_far = trees.far.is_some() && trees.far_within(Visit::leaf(at_a, at_b)).is_some();
    let mut room = [[0.0; 8]; 3];
    let (points_a, points_b) = if C::POINTS {
        (trees.relative.points(a.points(at_a), &mut room), b.points(at_b))
    } else {
        (&room, &[[0.0; 8]; 3])
    };
    let (ids_a, ids_b) = (&a.order[at_a as usize * 8..], &b.order[at_b as usize * 8..]);
    while near != 0 {
        let (i, j) = next(&mut near);
        let sure = C::POINTS && !is_far && {
            let d: [f32; 3] = std::array::from_fn(|k| points_b[k][j] - points_a[k][i]);
            d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < filter.definitely_inside_sq
        };
        let known = match (sure, is_far) {
            (true, _) => Known::Within,
            (false, true) => Known::Far,
            (false, false) => Known::Nothing,
        };
        visit.candidate(ids_a[i], ids_b[j], known);
    }
}

/// The pairs of lanes that share a vertex, in the rows in which any are near.
#[inline(always)]
fn sharing<L: Lanes>(lanes: L, near: u64, a: &[[u32; 8]], b: &[[u32; 8]]) -> u64 {
    let mut shared = 0;
    for i in 0..8 {
        if near >> (8 * i) & 0xff != 0 {
            for own in a {
                for other in b {
                    shared |= u64::from(lanes.equal_ids(other, own[i])) << (8 * i);
                }
            }
        }
    }
    shared
}
