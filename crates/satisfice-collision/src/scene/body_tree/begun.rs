//! Pairs of boxes that meet now and did not before: changed boxes go down the tree side by side.

use std::ops::Range;

use super::node::Node;
use super::{BodyTree, Change, lanes};
use crate::simd::{Lanes, Work, dispatch};

/// So many changes go down the tree together.
const PART: u32 = 1024;

/// Two bodies whose boxes meet.
pub(in crate::scene) struct Meeting {
    pub(in crate::scene) bodies: [u32; 2],
    /// Whether they may have met before.
    pub(in crate::scene) is_recheck: bool,
}

/// Memory of a search.
#[derive(Default)]
pub(super) struct Search {
    /// Numbers of changes, node by node.
    waiting: Vec<u32>,
    /// Open nodes, and where their changes begin and end.
    open: Vec<(u32, u32, u32)>,
    /// The lanes that each change of a node meets.
    masks: Vec<u8>,
}

impl Search {
    pub(super) fn bytes(&self) -> usize {
        4 * (self.waiting.capacity() + 3 * self.open.capacity()) + self.masks.capacity()
    }
}

impl BodyTree {
    /// Visits every pair of boxes that meet since the last [`follow`](Self::follow) of these changes and did not before, and those of
    /// bodies to be checked again, each once. Cost: linear in the changes and in the pairs of which one has changed, and logarithmic in the bodies.
    pub(in crate::scene) fn begun(&mut self, changes: &[Change], visit: impl FnMut(Meeting)) {
        let mut search = std::mem::take(&mut self.search);
        for (number, change) in (0..).zip(changes) {
            self.leaves[change.body as usize].number = number;
        }
        dispatch(Begun {
            tree: self,
            changes,
            search: &mut search,
            visit,
        });
        self.search = search;
    }
}

struct Begun<'a, V> {
    tree: &'a BodyTree,
    changes: &'a [Change],
    search: &'a mut Search,
    visit: V,
}

impl<V: FnMut(Meeting)> Work for Begun<'_, V> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self, unit: L) {
        // in parts, so that what waits stays in the cache
        for start in (0..self.changes.len() as u32).step_by(PART as usize) {
            self.part(
                unit,
                start..self.changes.len().min((start + PART) as usize) as u32,
            );
        }
    }
}

impl<V: FnMut(Meeting)> Begun<'_, V> {
    /// What some of the changes meet.
    #[inline(always)]
    fn part<L: Lanes>(&mut self, unit: L, numbers: Range<u32>) {
        let Some(root) = self.tree.root else { return };
        self.search.waiting.clear();
        self.search.waiting.extend(numbers);
        self.search.open.push((root, 0, self.search.waiting.len() as u32));
        while let Some((id, start, end)) = self.search.open.pop() {
            let node = &self.tree.nodes[id as usize];
            let Search {
                waiting, open, masks, ..
            } = &mut *self.search;
            let (start, end) = (start as usize, end as usize);
            waiting.truncate(end);
            if node.level == 0 {
                for at in start..end {
                    let number = self.search.waiting[at];
                    self.meet(unit, node, number);
                }
                continue;
            }
            masks.clear();
            let mut all = 0;
            for &number in &waiting[start..] {
                let mask = node.overlaps(unit, &self.changes[number as usize].to);
                all |= mask;
                masks.push(mask as u8);
            }
            for lane in lanes(all) {
                let from = waiting.len();
                waiting.resize(from + end - start, 0);
                let (known, next) = waiting.split_at_mut(from);
                let mut count = 0;
                // without a branch, which would be taken at random
                for (&number, &mask) in known[start..end].iter().zip(masks.iter()) {
                    next[count] = number;
                    count += usize::from(mask >> lane & 1);
                }
                waiting.truncate(from + count);
                open.push((node.child[lane], from as u32, (from + count) as u32));
            }
        }
    }

    /// What a change meets in a leaf.
    #[inline(always)]
    fn meet<L: Lanes>(&mut self, unit: L, node: &Node, number: u32) {
        let change = &self.changes[number as usize];
        let now = node.overlaps(unit, &change.to);
        if now == 0 {
            return;
        }
        let changed = match change.is_recheck {
            true => now,
            false => now & u32::from(node.changed),
        };
        // boxes that have not changed are where they were
        for lane in lanes(now & !changed & !node.overlaps(unit, &change.before)) {
            (self.visit)(Meeting {
                bodies: [change.body, node.child[lane]],
                is_recheck: false,
            });
        }
        for lane in lanes(changed) {
            let body = node.child[lane];
            let leaf = &self.tree.leaves[body as usize];
            let at = leaf.number;
            let other = self.changes.get(at as usize).filter(|other| other.body == body);
            let (before, is_recheck) = match other {
                // the other one tells it; a body does not meet itself
                Some(_) if at <= number => continue,
                Some(other) => (other.before, other.is_recheck | change.is_recheck),
                None => (leaf.bounds, change.is_recheck),
            };
            if is_recheck || !change.before.overlaps(&before) {
                (self.visit)(Meeting {
                    bodies: [change.body, body],
                    is_recheck,
                });
            }
        }
    }
}
