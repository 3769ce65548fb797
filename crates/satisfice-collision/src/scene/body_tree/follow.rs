//! Changed boxes: many at once, from the bottom up, and the pairs that meet now and did not before.

use super::{BodyTree, NONE, lane_in, lanes, node_of};
use crate::broad::Box32;
use crate::simd::{Lanes, Work, dispatch};

/// The tree is rebuilt if more than this share of the bodies change their leaf in a frame.
const REBUILT: f64 = 0.3;
/// A body stays in its leaf unless the box of the leaf grows to more than this many times its size.
const STAYS: f32 = 1.5;

/// A body whose box changes, or whose partners must be found again.
#[derive(Clone, Copy)]
pub(in crate::scene) struct Change {
    pub(in crate::scene) body: u32,
    /// Whether it may have partners that it had not before although no box has changed.
    pub(in crate::scene) is_recheck: bool,
    /// Its next box in the tree.
    pub(in crate::scene) to: Box32,
    /// The one before; empty for a body that was not in the tree.
    pub(in crate::scene) before: Box32,
}

impl Change {
    /// A body that gets this box.
    pub(in crate::scene) fn to(body: u32, to: Box32) -> Self {
        Self {
            body,
            is_recheck: false,
            to,
            before: Box32::EMPTY,
        }
    }
}

impl BodyTree {
    /// Whether the tree is empty, so that a frame has to be chosen for it.
    pub(in crate::scene) fn is_empty(&self) -> bool {
        self.root.is_none()
    }

    /// Gives bodies other boxes, and notes what their boxes were. A body is among `changes` once. Cost: linear in the changes, and
    /// logarithmic in the bodies.
    pub(in crate::scene) fn follow(&mut self, changes: &mut [Change]) {
        let mut strangers = 0;
        for change in changes.iter_mut() {
            change.before = self.box_of(change.body);
            strangers += usize::from(!self.stays(change));
        }
        let is_worn = self.moves + strangers > 4 * self.bodies + 64;
        if is_worn || strangers as f64 > REBUILT * self.bodies as f64 {
            self.rebuild(changes);
        } else if strangers > 0 {
            // first, so that lanes are what they will be
            self.moves += strangers;
            for change in changes.iter() {
                if !self.stays(change) {
                    self.remove(change.body);
                    self.insert(change.body, &change.to);
                }
            }
        }
        self.changed.clear();
        for change in changes.iter() {
            if let Some(place) = self.place_of(change.body) {
                let node = &mut self.nodes[node_of(place) as usize];
                node.set_box(lane_in(place), &change.to);
                self.mark(place);
            }
        }
        let mut next = 0;
        // leaves, then the nodes above them: all leaves have one depth
        while let Some(&node) = self.changed.get(next) {
            next += 1;
            let parent = self.nodes[node as usize].parent;
            if parent != NONE {
                let bounds = self.nodes[node as usize].bounds();
                self.set_box(parent, &bounds);
                self.mark(parent);
            }
        }
    }

    /// Notes that a box has changed.
    fn mark(&mut self, place: u32) {
        let node = &mut self.nodes[node_of(place) as usize];
        if node.changed == 0 {
            self.changed.push(node_of(place));
        }
        node.changed |= 1 << lane_in(place);
    }

    /// Whether the leaf of a body can hold its next box.
    fn stays(&self, change: &Change) -> bool {
        let Some(place) = self.place_of(change.body) else {
            return false;
        };
        let parent = self.nodes[node_of(place) as usize].parent;
        if parent == NONE {
            return true;
        }
        let known = self.box_at(parent);
        known.union(&change.to).sum_of_sides() <= STAYS * known.sum_of_sides()
    }

    /// Rebuilds the tree in its frame.
    fn rebuild(&mut self, changes: &[Change]) {
        let mut boxes = Vec::with_capacity(self.bodies + changes.len());
        for change in changes {
            match self.place_of(change.body) {
                Some(place) => self.nodes[node_of(place) as usize].set_box(lane_in(place), &change.to),
                None => boxes.push((change.body, change.to)),
            }
        }
        for (body, &place) in (0..).zip(&self.places) {
            if place != NONE {
                boxes.push((body, self.box_at(place)));
            }
        }
        self.arrange(&boxes);
    }

    /// Whether the boxes lie so far from the middle of the frame that another frame would hold them better.
    pub(in crate::scene) fn has_left_frame(&self) -> bool {
        let Some(root) = self.root else { return false };
        let whole = self.nodes[root as usize].bounds();
        let farthest = (0..3).fold(0.0, |most: f64, k| {
            most.max(f64::from(whole.max[k]).abs())
                .max(f64::from(whole.min[k]).abs())
        });
        farthest > 64.0 * f64::from(whole.sum_of_sides()) || farthest > 1e30
    }

    /// Visits every pair of overlapping boxes of which one has changed at the last [`follow`](Self::follow), each once.
    pub(in crate::scene) fn changed_pairs(&self, visit: impl FnMut(u32, u32)) {
        dispatch(ChangedPairs { tree: self, visit });
    }

    /// No box counts as changed any more.
    pub(in crate::scene) fn forget_changes(&mut self) {
        for node in self.changed.drain(..) {
            self.nodes[node as usize].changed = 0;
        }
    }
}

struct ChangedPairs<'a, V> {
    tree: &'a BodyTree,
    visit: V,
}

impl<V: FnMut(u32, u32)> Work for ChangedPairs<'_, V> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self, unit: L) {
        let nodes = &self.tree.nodes;
        // two nodes and what their boxes have in common, outside of which no pair of children meets
        let mut stack: Vec<(u32, u32, Box32)> = Vec::new();
        stack.extend(self.tree.root.map(|root| (root, root, Box32::EMPTY)));
        while let Some((a, b, common)) = stack.pop() {
            let (one, two) = (&nodes[a as usize], &nodes[b as usize]);
            let near = match a == b {
                true => [0xff; 2],
                false => [one.overlaps(unit, &common), two.overlaps(unit, &common)],
            };
            let changed = [u32::from(one.changed) & near[0], u32::from(two.changed) & near[1]];
            let mut meet = |lane: usize, other: usize| match one.level {
                0 => (self.visit)(one.child[lane], two.child[other]),
                _ => {
                    let common = one.lane_box(lane).intersection(&two.lane_box(other));
                    stack.push((one.child[lane], two.child[other], common));
                }
            };
            for lane in lanes(changed[0]) {
                let mut mask = two.overlaps(unit, &one.lane_box(lane)) & near[1];
                if a == b {
                    // each pair once; a node with itself for its descendants, but no body
                    let later = u32::MAX << (lane + usize::from(one.level == 0));
                    mask &= later | !changed[0];
                }
                for other in lanes(mask) {
                    meet(lane, other);
                }
            }
            if a != b {
                for lane in lanes(changed[1]) {
                    let mask = one.overlaps(unit, &two.lane_box(lane)) & near[0] & !changed[0];
                    for other in lanes(mask) {
                        meet(other, lane);
                    }
                }
            }
        }
    }
}
