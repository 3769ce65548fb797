//! Eight boxes side by side, and what is in them.

use crate::broad::Box32;
use crate::simd::{Floats as _, Lanes};

/// Marks an empty lane, the place of a body that is not in the tree, and that of the root in its parent.
pub(super) const NONE: u32 = u32::MAX;

/// A lane of a node.
pub(super) fn at_lane(node: u32, lane: usize) -> u32 {
    8 * node + lane as u32
}

/// The node of a place.
pub(super) fn node_of(place: u32) -> u32 {
    place / 8
}

/// The lane of a place.
pub(super) fn lane_in(place: u32) -> usize {
    place as usize % 8
}

/// A node of the tree.
#[derive(Clone)]
pub(super) struct Node {
    lower: [[f32; 8]; 3],
    upper: [[f32; 8]; 3],
    /// Nodes, or bodies on level 0.
    pub(super) child: [u32; 8],
    /// Its place in its parent, or [`NONE`].
    pub(super) parent: u32,
    /// 0 for a node whose children are bodies.
    pub(super) level: u8,
    /// The lanes below which a box has changed, a bit each.
    pub(super) changed: u8,
}

impl Node {
    pub(super) fn empty(level: u8) -> Self {
        Self {
            lower: [[f32::INFINITY; 8]; 3],
            upper: [[f32::NEG_INFINITY; 8]; 3],
            child: [NONE; 8],
            parent: NONE,
            level,
            changed: 0,
        }
    }

    pub(super) fn set(&mut self, lane: usize, child: u32, to: &Box32) {
        self.child[lane] = child;
        self.set_box(lane, to);
    }

    pub(super) fn set_box(&mut self, lane: usize, to: &Box32) {
        for k in 0..3 {
            self.lower[k][lane] = to.min[k];
            self.upper[k][lane] = to.max[k];
        }
    }

    pub(super) fn lane_box(&self, lane: usize) -> Box32 {
        Box32 {
            min: std::array::from_fn(|k| self.lower[k][lane]),
            max: std::array::from_fn(|k| self.upper[k][lane]),
        }
    }

    /// The box around all lanes.
    pub(super) fn bounds(&self) -> Box32 {
        // by halves: empty lanes lie beyond every number
        let least = |x: &[f32; 8]| {
            let four: [f32; 4] = std::array::from_fn(|i| if x[i] < x[i + 4] { x[i] } else { x[i + 4] });
            let two: [f32; 2] = std::array::from_fn(|i| {
                if four[i] < four[i + 2] {
                    four[i]
                } else {
                    four[i + 2]
                }
            });
            if two[0] < two[1] { two[0] } else { two[1] }
        };
        let most = |x: &[f32; 8]| {
            let four: [f32; 4] = std::array::from_fn(|i| if x[i] > x[i + 4] { x[i] } else { x[i + 4] });
            let two: [f32; 2] = std::array::from_fn(|i| {
                if four[i] > four[i + 2] {
                    four[i]
                } else {
                    four[i + 2]
                }
            });
            if two[0] > two[1] { two[0] } else { two[1] }
        };
        Box32 {
            min: std::array::from_fn(|k| least(&self.lower[k])),
            max: std::array::from_fn(|k| most(&self.upper[k])),
        }
    }

    pub(super) fn free_lane(&self) -> Option<usize> {
        self.child.iter().position(|&child| child == NONE)
    }

    pub(super) fn children(&self) -> impl Iterator<Item = (usize, u32)> {
        self.child
            .iter()
            .copied()
            .enumerate()
            .filter(|&(_, child)| child != NONE)
    }

    /// The lanes that hold something, a bit each.
    pub(super) fn taken(&self) -> u8 {
        self.children().fold(0, |mask, (lane, _)| mask | 1 << lane)
    }

    /// Bit `lane` is set if the box of that lane overlaps `b`, which is finite.
    #[inline(always)]
    pub(super) fn overlaps<L: Lanes>(&self, lanes: L, b: &Box32) -> u32 {
        let s = lanes.single();
        let on = |k: usize| {
            s.both(
                s.at_most(s.load(&self.lower[k]), s.splat(b.max[k])),
                s.at_most(s.splat(b.min[k]), s.load(&self.upper[k])),
            )
        };
        s.bits(s.both(s.both(on(0), on(1)), on(2)))
    }
}

/// The lanes of a mask, ascending.
#[inline(always)]
pub(super) fn lanes(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = mask.trailing_zeros() as usize;
        mask &= mask.wrapping_sub(1);
        (lane < 8).then_some(lane)
    })
}
