//! Visits of a tree over bodies: what overlaps a box or a ray, and pairs by their gaps.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::{BodyTree, lanes};
use crate::Aabb;
use crate::broad::{Box32, Slabs};
use crate::simd::{Lanes, Work, dispatch};

impl BodyTree {
    /// Visits every body whose box overlaps `bounds`, among them the body itself.
    pub(in crate::scene) fn overlapping(&self, bounds: &Aabb, stack: &mut Vec<u32>, visit: impl FnMut(u32)) {
        dispatch(Overlapping {
            tree: self,
            bounds: self.place(bounds),
            stack,
            visit,
        });
    }

    /// Visits pairs of bodies, those with the least gap between their boxes first, as long as the gap is at most what the last visit
    /// returned.
    pub(in crate::scene) fn closest_pairs<E>(
        &self,
        mut reach: f64,
        mut visit: impl FnMut(u32, u32) -> Result<f64, E>,
    ) -> Result<(), E> {
        // of equal gaps, the pair nearest to the bodies first: few wait
        let mut open: BinaryHeap<Reverse<(u32, u32, u32, u32)>> = BinaryHeap::new();
        if let Some(root) = self.root {
            open.push(Reverse((
                0,
                u32::from(self.nodes[root as usize].level) + 1,
                root,
                root,
            )));
        }
        while let Some(Reverse((gap, height, a, b))) = open.pop() {
            if self.way(gap) > reach {
                return Ok(());
            }
            if height == 0 {
                reach = visit(a, b)?;
                continue;
            }
            let (one, two) = (&self.nodes[a as usize], &self.nodes[b as usize]);
            for (lane, child) in one.children() {
                let first = if a == b {
                    lane + usize::from(height == 1)
                } else {
                    0
                };
                let bounds = one.lane_box(lane);
                for (other, partner) in two.children().filter(|&(other, _)| other >= first) {
                    let gap = bounds.gap(&two.lane_box(other));
                    if self.way(gap) <= reach {
                        open.push(Reverse((gap, height - 1, child, partner)));
                    }
                }
            }
        }
        Ok(())
    }

    /// Visits bodies, those with the least gap between their boxes and `bounds` first, as long as the gap is at most what the last
    /// visit returned. The visitor is told a lower bound of their distance.
    pub(in crate::scene) fn nearest_to<E>(
        &self,
        bounds: &Aabb,
        mut visit: impl FnMut(u32, f64) -> Result<f64, E>,
    ) -> Result<(), E> {
        let b = self.place(bounds);
        let mut reach = f64::INFINITY;
        let mut open: BinaryHeap<Reverse<(u32, u32, u32)>> = BinaryHeap::new();
        if let Some(root) = self.root {
            open.push(Reverse((0, u32::from(self.nodes[root as usize].level) + 1, root)));
        }
        while let Some(Reverse((gap, height, at))) = open.pop() {
            if self.way(gap) > reach {
                return Ok(());
            }
            if height == 0 {
                reach = visit(at, self.way(gap))?;
                continue;
            }
            let node = &self.nodes[at as usize];
            for (lane, child) in node.children() {
                let gap = node.lane_box(lane).gap(&b);
                if self.way(gap) <= reach {
                    open.push(Reverse((gap, height - 1, child)));
                }
            }
        }
        Ok(())
    }

    /// Visits the bodies whose boxes a segment meets, in the order in which it enters them, as long as the part of the way until
    /// then is at most what the last visit returned.
    pub(in crate::scene) fn along<E>(
        &self,
        segment: [[f64; 3]; 2],
        mut visit: impl FnMut(u32) -> Result<f64, E>,
    ) -> Result<(), E> {
        let local = |p: [f64; 3]| std::array::from_fn(|k| (p[k] - self.frame.origin[k]) * self.frame.scale);
        let slabs = Slabs::new(segment.map(local), 0.0);
        let mut bound = 1.0;
        let mut open: BinaryHeap<Reverse<(u64, u32, u32)>> = BinaryHeap::new();
        if let Some(root) = self.root {
            open.push(Reverse((0, u32::from(self.nodes[root as usize].level) + 1, root)));
        }
        while let Some(Reverse((entry, height, at))) = open.pop() {
            if f64::from_bits(entry) > bound {
                return Ok(());
            }
            if height == 0 {
                bound = visit(at)?;
                continue;
            }
            let node = &self.nodes[at as usize];
            for (lane, child) in node.children() {
                let Box32 { min, max } = node.lane_box(lane);
                if let Some(entry) = slabs.entry(min, max) {
                    open.push(Reverse((entry.to_bits(), height - 1, child)));
                }
            }
        }
        Ok(())
    }

    /// A lower bound of the distance that belongs to a gap.
    fn way(&self, gap: u32) -> f64 {
        // the subtraction, the squares, the sums and the root round; what underflows proves nothing
        let gap = f64::from(f32::from_bits(gap)).sqrt() - 1e-22;
        (gap * (1.0 - 1e-6)).max(0.0) / self.frame.scale
    }

    /// Whether the box of a body in the tree holds `bounds`.
    pub(in crate::scene) fn holds(&self, body: u32, bounds: &Aabb) -> bool {
        let (known, b) = (self.box_of(body), self.place(bounds));
        (0..3).all(|k| known.min[k] <= b.min[k] && b.max[k] <= known.max[k])
    }

    /// Whether the boxes of two bodies in the tree overlap.
    pub(in crate::scene) fn overlap(&self, a: u32, b: u32) -> bool {
        self.box_of(a).overlaps(&self.box_of(b))
    }
}

struct Overlapping<'a, V> {
    tree: &'a BodyTree,
    bounds: Box32,
    stack: &'a mut Vec<u32>,
    visit: V,
}

impl<V: FnMut(u32)> Work for Overlapping<'_, V> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self, unit: L) {
        self.stack.clear();
        let mut next = self.tree.root;
        // nothing is allocated where nothing is found
        while let Some(node) = next {
            let at = &self.tree.nodes[node as usize];
            for lane in lanes(at.overlaps(unit, &self.bounds)) {
                match at.level {
                    0 => (self.visit)(at.child[lane]),
                    _ => self.stack.push(at.child[lane]),
                }
            }
            next = self.stack.pop();
        }
    }
}
