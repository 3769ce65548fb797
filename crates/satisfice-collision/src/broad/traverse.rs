//! Two box trees, or one with itself, descended together: which items can be within the threshold.

use super::boxes::{BoxTree, Group, Moved};
use super::frame::Filter;
use super::lanes::{Lanes, Work};
use super::relative::Relative;

/// A group of one tree against a group of the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Visit {
    level_a: u8,
    level_b: u8,
    a: u32,
    b: u32,
}

/// What happens to a pair of items that can be within the threshold.
pub(crate) trait Candidates {
    /// Whether items are points, so that the squared distance itself is known.
    const POINTS: bool;
    /// Takes a pair of items; `sure` if it is within the threshold for certain.
    fn candidate(&mut self, a: u32, b: u32, sure: bool);
    /// Whether enough has been found.
    fn enough(&self) -> bool {
        false
    }
}

/// Two trees and how they lie.
#[derive(Clone, Copy)]
pub(crate) struct Trees<'a> {
    pub(crate) a: &'a BoxTree,
    pub(crate) b: &'a BoxTree,
    pub(crate) relative: &'a Relative,
    pub(crate) filter: &'a Filter,
    /// Whether both are the same tree, and each pair of different items is wanted once.
    pub(crate) one_body: bool,
    /// Pairs of which neither item moved are not visited.
    pub(crate) moved: [Moved; 2],
}

impl Trees<'_> {
    /// Where a traversal starts; nothing if a tree is empty.
    pub(crate) fn start(&self, to: &mut Vec<Visit>) {
        let (Some(level_a), Some(level_b)) = (
            self.a.levels.len().checked_sub(1),
            self.b.levels.len().checked_sub(1),
        ) else {
            return;
        };
        to.push(Visit {
            level_a: level_a as u8,
            level_b: level_b as u8,
            a: 0,
            b: 0,
        });
    }
}

/// Descends from the visits on `stack`, which ends empty; at most `most` visits, the rest stays on the stack.
pub(crate) struct Descend<'a, C> {
    pub(crate) trees: Trees<'a>,
    pub(crate) stack: &'a mut Vec<Visit>,
    pub(crate) most: usize,
    pub(crate) visit: &'a mut C,
}

impl<C: Candidates> Work for Descend<'_, C> {
    /// Visits made.
    type Output = u64;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> u64 {
        let Trees {
            a,
            b,
            relative,
            filter,
            one_body,
            moved,
            ..
        } = self.trees;
        let mut visits = 0;
        while visits < self.most as u64
            && !self.visit.enough()
            && let Some(at) = self.stack.pop()
        {
            visits += 1;
            let group_a = &a.levels[at.level_a as usize][at.a as usize];
            let group_b = &b.levels[at.level_b as usize][at.b as usize];
            let same = one_body && at.a == at.b && at.level_a == at.level_b;
            let lanes_a = (level_len(a, at.level_a) - at.a as usize * 8).min(8);
            let moved_a = a.moved(moved[0], at.level_a, at.a);
            let moved_b = b.moved(moved[1], at.level_b, at.b);
            if at.level_a == 0 && at.level_b == 0 {
                leaf(lanes, self.trees, at, group_a, group_b, lanes_a, same, self.visit);
                continue;
            }
            let turned = relative.boxes(group_a);
            let mut any = 0;
            for i in 0..lanes_a {
                let (min, max) = lane(&turned, i);
                let mut mask = lanes.boxes_within(lower(group_b), upper(group_b), min, max, filter.limit);
                if same {
                    mask &= !((1 << i) - 1);
                }
                if moved_a >> i & 1 == 0 {
                    mask &= moved_b;
                }
                any |= mask;
                if at.level_b > at.level_a {
                    continue;
                }
                // the taller tree alone, if their heights differ
                let child_a = at.a * 8 + i as u32;
                if at.level_a > at.level_b {
                    if mask != 0 {
                        self.stack.push(Visit {
                            level_a: at.level_a - 1,
                            a: child_a,
                            ..at
                        });
                    }
                    continue;
                }
                while mask != 0 {
                    let child_b = at.b * 8 + mask.trailing_zeros();
                    mask &= mask - 1;
                    self.stack.push(Visit {
                        level_a: at.level_a - 1,
                        level_b: at.level_b - 1,
                        a: child_a,
                        b: child_b,
                    });
                }
            }
            if at.level_b > at.level_a {
                while any != 0 {
                    let b = at.b * 8 + any.trailing_zeros();
                    any &= any - 1;
                    self.stack.push(Visit {
                        level_b: at.level_b - 1,
                        b,
                        ..at
                    });
                }
            }
        }
        visits
    }
}

fn level_len(tree: &BoxTree, level: u8) -> usize {
    match level {
        0 => tree.len(),
        _ => tree.levels[level as usize - 1].len(),
    }
}

#[inline(always)]
fn lane(of: &Group, lane: usize) -> ([f32; 3], [f32; 3]) {
    (
        std::array::from_fn(|k| of.lower[k][lane]),
        std::array::from_fn(|k| of.upper[k][lane]),
    )
}

#[inline(always)]
fn lower(of: &Group) -> [&[f32; 8]; 3] {
    [&of.lower[0], &of.lower[1], &of.lower[2]]
}

#[inline(always)]
fn upper(of: &Group) -> [&[f32; 8]; 3] {
    [&of.upper[0], &of.upper[1], &of.upper[2]]
}

#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "one call, inlined")]
fn leaf<L: Lanes, C: Candidates>(
    lanes: L,
    trees: Trees<'_>,
    at: Visit,
    group_a: &Group,
    group_b: &Group,
    lanes_a: usize,
    same: bool,
    visit: &mut C,
) {
    let Trees {
        a,
        b,
        relative,
        filter,
        moved,
        ..
    } = trees;
    let moved_a = a.moved(moved[0], 0, at.a);
    let moved_b = b.moved(moved[1], 0, at.b);
    let (ids_a, ids_b) = (&a.order[at.a as usize * 8..], &b.order[at.b as usize * 8..]);
    let points = if C::POINTS {
        relative.points(&group_a.lower)
    } else {
        [[0.0; 8]; 3]
    };
    let turned = if C::POINTS {
        *group_a
    } else {
        relative.boxes(group_a)
    };
    for i in 0..lanes_a {
        let q: [f32; 3] = std::array::from_fn(|k| points[k][i]);
        let mut mask = if C::POINTS {
            lanes.closer(lower(group_b), q, filter.limit)
        } else {
            let (min, max) = lane(&turned, i);
            lanes.boxes_within(lower(group_b), upper(group_b), min, max, filter.limit)
        };
        if same {
            mask &= !1 << i;
        }
        if moved_a >> i & 1 == 0 {
            mask &= moved_b;
        }
        while mask != 0 {
            let j = mask.trailing_zeros() as usize & 7;
            mask &= mask - 1;
            let sure = C::POINTS && {
                let d: [f32; 3] = std::array::from_fn(|k| group_b.lower[k][j] - q[k]);
                d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < filter.sure
            };
            visit.candidate(ids_a[i], ids_b[j], sure);
        }
    }
}
