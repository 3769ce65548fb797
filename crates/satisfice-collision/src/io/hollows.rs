//! The corners of a polygon that turn the other way, or not at all, found by their place: only they can be in the way of an ear.

use crate::distance::Point;

/// Corners of a leaf of the tree.
const LEAF: usize = 8;
/// What a rounded turn is off by at most, as a part of its two products.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// A balanced tree over all corners, of which some are marked. The children of node k are 2 k and 2 k + 1.
pub(super) struct Hollows {
    /// The corners, those of a leaf side by side.
    order: Vec<usize>,
    /// The leaf of each corner.
    leaf: Vec<usize>,
    nodes: Vec<CornerBox>,
    is_marked: Vec<bool>,
    /// How many nodes and corners were looked at so far.
    pub(super) looks: u64,
}

#[derive(Clone)]
struct CornerBox {
    least: [f64; 2],
    most: [f64; 2],
    /// How many of its corners are marked.
    marked: usize,
}

/// A triangle that turns left.
#[derive(Clone, Copy)]
pub(super) struct Left(pub(super) [Point; 3]);

impl Hollows {
    pub(super) fn new(points: &[Point]) -> Self {
        let leaves = points.len().div_ceil(LEAF).next_power_of_two();
        let nothing = CornerBox {
            least: [f64::INFINITY; 2],
            most: [f64::NEG_INFINITY; 2],
            marked: 0,
        };
        let mut hollows = Self {
            order: (0..points.len()).collect(),
            leaf: vec![0; points.len()],
            nodes: vec![nothing; 2 * leaves],
            is_marked: vec![false; points.len()],
            looks: 0,
        };
        hollows.build(points, 1);
        hollows
    }

    /// How many leaves there are.
    fn leaves(&self) -> usize {
        self.nodes.len() / 2
    }

    /// The corners of a node, as a part of the order.
    fn corners(&self, node: usize) -> std::ops::Range<usize> {
        let level = node.ilog2();
        let width = self.leaves() >> level;
        let first = (node - (1 << level)) * width;
        let at = |leaf: usize| leaf * self.order.len() / self.leaves();
        at(first)..at(first + width)
    }

    fn build(&mut self, points: &[Point], node: usize) {
        let range = self.corners(node);
        let (mut least, mut most) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for &corner in &self.order[range.clone()] {
            for k in 0..2 {
                least[k] = least[k].min(points[corner][k]);
                most[k] = most[k].max(points[corner][k]);
            }
        }
        (self.nodes[node].least, self.nodes[node].most) = (least, most);
        if node >= self.leaves() {
            for &corner in &self.order[range] {
                self.leaf[corner] = node;
            }
            return;
        }
        let axis = usize::from(most[1] - least[1] > most[0] - least[0]);
        let split = self.corners(2 * node).len();
        let part = &mut self.order[range];
        if split < part.len() {
            part.select_nth_unstable_by(split, |&a, &b| points[a][axis].total_cmp(&points[b][axis]));
        }
        self.build(points, 2 * node);
        self.build(points, 2 * node + 1);
    }

    pub(super) fn mark(&mut self, corner: usize, marked: bool) {
        if std::mem::replace(&mut self.is_marked[corner], marked) == marked {
            return;
        }
        let mut node = self.leaf[corner];
        while node > 0 {
            let count = &mut self.nodes[node].marked;
            *count = if marked { *count + 1 } else { *count - 1 };
            node /= 2;
        }
    }

    /// Whether one of the marked corners that may be in a triangle passes the test.
    pub(super) fn any_in(&mut self, triangle: Left, is_inside: impl Fn(usize) -> bool) -> bool {
        let mut left = vec![1];
        while let Some(node) = left.pop() {
            self.looks += 1;
            if self.nodes[node].marked == 0 || triangle.misses(&self.nodes[node]) {
                continue;
            }
            if node < self.leaves() {
                left.extend([2 * node, 2 * node + 1]);
                continue;
            }
            for &corner in &self.order[self.corners(node)] {
                self.looks += 1;
                if self.is_marked[corner] && is_inside(corner) {
                    return true;
                }
            }
        }
        false
    }
}

impl Left {
    /// Whether it certainly has no point of the box of a node: all of it is beyond one side of the triangle or of its box.
    fn misses(self, CornerBox { least, most, .. }: &CornerBox) -> bool {
        let [a, b, c] = self.0;
        let is_beside = (0..2).any(|k| {
            let (low, high) = (a[k].min(b[k]).min(c[k]), a[k].max(b[k]).max(c[k]));
            high < least[k] || most[k] < low
        });
        is_beside
            || [[a, b], [b, c], [c, a]].iter().any(|[from, to]| {
                let along = [to[0] - from[0], to[1] - from[1]];
                // the corner of the box that lies farthest to the left
                let x = if along[1] > 0.0 { least[0] } else { most[0] };
                let y = if along[0] > 0.0 { most[1] } else { least[1] };
                let products = [along[0] * (y - from[1]), along[1] * (x - from[0])];
                let error = ROUNDING * (products[0].abs() + products[1].abs()) + f64::MIN_POSITIVE;
                products[0] - products[1] < -error
            })
    }
}
