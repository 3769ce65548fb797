//! Changed boxes: many at once, from the bottom up.

use super::{BodyLeaf, BodyTree, NONE, Node, lane_in, node_of};
use crate::broad::Box32;

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
        let mut strangers = Vec::new();
        self.changed.clear();
        self.changed.resize(changes.len(), 0);
        let mut count = 0;
        for (number, change) in (0..).zip(changes.iter_mut()) {
            let leaf = self.leaves.get(change.body as usize).copied();
            let BodyLeaf { bounds, place, .. } = leaf.unwrap_or(BodyLeaf::NONE);
            change.before = bounds;
            if place != NONE && self.stays(place, &change.to) {
                self.leaves[change.body as usize].bounds = change.to;
                let node = &mut self.nodes[node_of(place) as usize];
                node.set_box(lane_in(place), &change.to);
                // as `mark`, without a branch that waits for the node
                self.changed[count] = node_of(place);
                count += usize::from(node.changed == 0);
                node.changed |= 1 << lane_in(place);
            } else {
                strangers.push(number);
            }
        }
        self.changed.truncate(count);
        let is_worn = self.moves + strangers.len() > 4 * self.bodies + 64;
        if is_worn || strangers.len() as f64 > REBUILT * self.bodies as f64 {
            self.rebuild(changes);
            return;
        }
        if !strangers.is_empty() {
            self.moves += strangers.len();
            for number in strangers {
                let change = &changes[number as usize];
                self.remove(change.body);
                self.insert(change.body, &change.to);
            }
            // leaves may have been emptied, and used again above
            let nodes = &self.nodes;
            let is_changed = |node: &Node| node.level == 0 && node.changed != 0;
            self.changed.retain(|&id| is_changed(&nodes[id as usize]));
        }
        self.refit();
    }

    /// Notes that a box has changed.
    pub(super) fn mark(&mut self, place: u32) {
        let node = &mut self.nodes[node_of(place) as usize];
        if node.changed == 0 {
            self.changed.push(node_of(place));
        }
        node.changed |= 1 << lane_in(place);
    }

    /// Bounds the nodes above changed boxes anew.
    fn refit(&mut self) {
        let mut next = 0;
        // leaves, then the nodes above them: all leaves have one depth
        while let Some(&id) = self.changed.get(next) {
            next += 1;
            let node = &self.nodes[id as usize];
            let (parent, bounds) = (node.parent, node.bounds());
            if parent != NONE && self.box_at(parent) != bounds {
                self.set_box(parent, &bounds);
                self.mark(parent);
            }
        }
    }

    /// Whether the leaf of a body can hold its next box.
    fn stays(&self, place: u32, to: &Box32) -> bool {
        let parent = self.nodes[node_of(place) as usize].parent;
        if parent == NONE {
            return true;
        }
        let known = self.box_at(parent);
        known.union(to).sum_of_sides() <= STAYS * known.sum_of_sides()
    }

    /// Rebuilds the tree in its frame.
    fn rebuild(&mut self, changes: &[Change]) {
        let mut boxes = Vec::with_capacity(self.bodies + changes.len());
        for change in changes {
            match self.contains(change.body) {
                true => self.leaves[change.body as usize].bounds = change.to,
                false => boxes.push((change.body, change.to)),
            }
        }
        for (body, leaf) in (0..).zip(&self.leaves) {
            if leaf.place != NONE {
                boxes.push((body, leaf.bounds));
            }
        }
        self.arrange(&boxes);
        self.mark_all();
    }

    /// Notes that every box has changed.
    pub(super) fn mark_all(&mut self) {
        self.changed.clear();
        self.changed.extend(0..self.nodes.len() as u32);
        for node in &mut self.nodes {
            node.changed = node.taken();
        }
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

    /// No box counts as changed any more.
    pub(in crate::scene) fn forget_changes(&mut self) {
        for node in self.changed.drain(..) {
            self.nodes[node as usize].changed = 0;
        }
    }
}
