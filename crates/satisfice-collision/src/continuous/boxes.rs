//! Moving boxes, each given at both ends of the step, and groups of eight for the vector unit.
//!
//! A box that moves linearly from the one to the other contains its features all the time, so two features are apart all the
//! time if their boxes are, on one axis, apart in the same order at both ends. Two bodies that fall side by side are thus
//! apart, while the space that they sweep is shared.
//!
//! Boxes are in single precision, rounded outwards, in a frame centred on the scene and scaled to its size.

use std::ops::Range;

use crate::broad::{fold, greater, lesser};
use crate::distance::Point;
use crate::simd::Eight;

/// Boxes of a group.
pub(super) const LANES: usize = 8;

/// Where the frame of the boxes lies, and where the vertices are in it.
#[derive(Debug)]
pub(super) struct BoxFrame {
    centre: Point,
    scale: f64,
    /// Of every vertex at both ends of the step; the fourth coordinate is 0.
    paths: Vec<[[f32; 4]; 2]>,
}

/// A box at both ends of the step.
#[derive(Debug, Clone, Copy)]
pub(super) struct MovingBox {
    /// At time 0 and at time 1.
    pub(super) min: [[f32; 3]; 2],
    pub(super) max: [[f32; 3]; 2],
}

/// Eight boxes, a lane each. Unused lanes are empty boxes, apart from all others.
#[derive(Debug, Clone)]
pub(super) struct MovingGroup {
    pub(super) min: [[Eight; 3]; 2],
    pub(super) max: [[Eight; 3]; 2],
}

/// By this margin a box reaches all others of its frame, whose coordinates are at most 1/2. An empty box stays apart only if it grows by a
/// finite number.
pub(super) const EVERYWHERE: f32 = 4.0;

impl BoxFrame {
    pub(super) fn around(from: &[Point], to: &[Point]) -> Self {
        let (mut min, mut max) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for p in from.iter().chain(to) {
            for k in 0..3 {
                min[k] = if p[k] < min[k] { p[k] } else { min[k] };
                max[k] = if p[k] > max[k] { p[k] } else { max[k] };
            }
        }
        // Halves first, so that nothing overflows.
        let size = (0..3).fold(0.0_f64, |size, k| size.max(0.5 * max[k] - 0.5 * min[k]));
        let mut frame = Self {
            centre: std::array::from_fn(|k| 0.5 * min[k] + 0.5 * max[k]),
            scale: if size > 1e-300 { 1.0 / size } else { 1.0 },
            paths: Vec::new(),
        };
        let ends = from.iter().zip(to);
        frame.paths = ends.map(|(p, q)| [frame.local(p), frame.local(q)]).collect();
        frame
    }

    /// A point in the frame: the exact value of each coordinate lies within one step of single precision of it, or two.
    #[inline(always)]
    fn local(&self, p: &Point) -> [f32; 4] {
        let [x, y, z] = [0, 1, 2].map(|k| ((0.5 * p[k] - 0.5 * self.centre[k]) * self.scale) as f32);
        [x, y, z, 0.0]
    }

    /// Around these vertices at both ends of the step: the least and the greatest coordinates, as rounded.
    #[inline(always)]
    pub(super) fn extent<const N: usize>(&self, corners: [u32; N]) -> [[[f32; 4]; 2]; 2] {
        let mut min = self.paths[corners[0] as usize];
        let mut max = min;
        for corner in &corners[1..] {
            let path = &self.paths[*corner as usize];
            for end in 0..2 {
                for k in 0..4 {
                    min[end][k] = lesser(path[end][k], min[end][k]);
                    max[end][k] = greater(path[end][k], max[end][k]);
                }
            }
        }
        [min, max]
    }

    /// A number for each axis that orders features as the middles of their boxes at half of the step are ordered, up to rounding.
    #[inline(always)]
    pub(super) fn middle<const N: usize>(&self, corners: [u32; N]) -> [f32; 3] {
        let [min, max] = self.extent(corners);
        let mut middle = [0.0; 3];
        for k in 0..3 {
            middle[k] = (min[0][k] + max[0][k]) + (min[1][k] + max[1][k]);
        }
        middle
    }

    /// The number of vertices.
    pub(super) fn vertices(&self) -> usize {
        self.paths.len()
    }

    /// The box around consecutive vertices.
    pub(super) fn box_around(&self, vertices: Range<usize>) -> MovingBox {
        let mut around = MovingBox::EMPTY;
        for path in &self.paths[vertices] {
            let ends = path.map(|[x, y, z, _]| [x, y, z]);
            around.include(&MovingBox { min: ends, max: ends });
        }
        MovingBox {
            min: around.min.map(|p| p.map(below)),
            max: around.max.map(|p| p.map(above)),
        }
    }

    /// The same frame, but its vertices are the least and the greatest corner of each box in turn.
    pub(super) fn of_corners(&self, boxes: &[MovingBox]) -> Self {
        let path = |corner: &[[f32; 3]; 2]| corner.map(|[x, y, z]| [x, y, z, 0.0]);
        Self {
            centre: self.centre,
            scale: self.scale,
            paths: boxes
                .iter()
                .flat_map(|of| [path(&of.min), path(&of.max)])
                .collect(),
        }
    }

    /// A length in the frame in the unit of the scene.
    pub(super) fn length(&self, in_frame: f64) -> f64 {
        in_frame / self.scale
    }

    /// A distance in the frame, rounded up, or [`EVERYWHERE`] if it is longer.
    pub(super) fn margin(&self, delta: f64) -> f32 {
        if delta == 0.0 {
            return 0.0;
        }
        let margin = ((0.5 * delta * self.scale * (1.0 + 1e-12)) as f32).next_up();
        margin.min(EVERYWHERE)
    }
}

/// At most a coordinate whose rounded value in the frame is `x`, which is at most 1/2.
fn below(x: f32) -> f32 {
    x - (x.abs() * 4.0 * f32::EPSILON + 1e-12)
}

fn above(x: f32) -> f32 {
    x + (x.abs() * 4.0 * f32::EPSILON + 1e-12)
}

impl MovingBox {
    pub(super) const EMPTY: Self = Self {
        min: [[f32::INFINITY; 3]; 2],
        max: [[f32::NEG_INFINITY; 3]; 2],
    };

    /// The sum of the edges at both ends.
    pub(super) fn extent(&self) -> f64 {
        let edges = |end: usize| (0..3).map(move |k| self.max[end][k] - self.min[end][k]);
        edges(0)
            .chain(edges(1))
            .map(|edge| f64::from(edge.max(0.0)))
            .sum()
    }

    pub(super) fn include(&mut self, other: &Self) {
        for end in 0..2 {
            for k in 0..3 {
                self.min[end][k] = lesser(other.min[end][k], self.min[end][k]);
                self.max[end][k] = greater(other.max[end][k], self.max[end][k]);
            }
        }
    }

    /// The middle at half of the step, times four.
    pub(super) fn centre(&self) -> [f32; 3] {
        let ([min, min_to], [max, max_to]) = (self.min, self.max);
        std::array::from_fn(|k| (min[k] + max[k]) + (min_to[k] + max_to[k]))
    }

    /// The box grown by a margin on every side.
    #[inline(always)]
    pub(super) fn grown(&self, margin: f32) -> Self {
        if margin == 0.0 {
            return *self;
        }
        Self {
            min: self.min.map(|p| p.map(|x| (x - margin).next_down())),
            max: self.max.map(|p| p.map(|x| (x + margin).next_up())),
        }
    }

    /// Bounds of the times at which two boxes meet, or `None` if they are apart all the time.
    pub(super) fn meeting(&self, other: &Self) -> Option<[f64; 2]> {
        let (mut first, mut last) = (0.0_f64, 1.0_f64);
        for (p, q) in [(self, other), (other, self)] {
            for k in 0..3 {
                // The gap between them, linear in the time. The differences have at most one rounding.
                let [from, to] = [0, 1].map(|end| f64::from(p.min[end][k]) - f64::from(q.max[end][k]));
                if from > 0.0 {
                    if to > 0.0 {
                        return None;
                    }
                    first = first.max(from / (from - to) * (1.0 - 1e-15));
                } else if to > 0.0 {
                    last = last.min(from / (from - to) * (1.0 + 1e-15));
                }
            }
        }
        (first <= last).then_some([first, last])
    }
}

impl MovingGroup {
    pub(super) const EMPTY: Self = Self {
        min: [[[f32::INFINITY; LANES]; 3]; 2],
        max: [[[f32::NEG_INFINITY; LANES]; 3]; 2],
    };

    pub(super) fn set(&mut self, lane: usize, of: &MovingBox) {
        for end in 0..2 {
            for k in 0..3 {
                self.min[end][k][lane] = of.min[end][k];
                self.max[end][k][lane] = of.max[end][k];
            }
        }
    }

    /// Makes a lane the box around what has this extent before rounding.
    #[inline(always)]
    pub(super) fn set_around(&mut self, lane: usize, [min, max]: &[[[f32; 4]; 2]; 2]) {
        for end in 0..2 {
            for k in 0..3 {
                self.min[end][k][lane] = below(min[end][k]);
                self.max[end][k][lane] = above(max[end][k]);
            }
        }
    }

    #[inline(always)]
    pub(super) fn lane(&self, lane: usize) -> MovingBox {
        MovingBox {
            min: std::array::from_fn(|end| std::array::from_fn(|k| self.min[end][k][lane])),
            max: std::array::from_fn(|end| std::array::from_fn(|k| self.max[end][k][lane])),
        }
    }

    /// The edges of all boxes.
    pub(super) fn extent(&self) -> f64 {
        let mut sum = [0.0; LANES];
        for end in 0..2 {
            for k in 0..3 {
                for (lane, sum) in sum.iter_mut().enumerate() {
                    // an empty box has less than none
                    *sum += greater(self.max[end][k][lane] - self.min[end][k][lane], 0.0);
                }
            }
        }
        sum.iter().map(|&sum: &f32| f64::from(sum)).sum()
    }

    pub(super) fn union(&self) -> MovingBox {
        let least = |lanes: &Eight| fold(lanes, lesser);
        let most = |lanes: &Eight| fold(lanes, greater);
        MovingBox {
            min: std::array::from_fn(|end| std::array::from_fn(|k| least(&self.min[end][k]))),
            max: std::array::from_fn(|end| std::array::from_fn(|k| most(&self.max[end][k]))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_margin_is_finite_however_long_delta_is() {
        let points: [Point; 2] = [[0.0; 3], [1e-200, 0.0, 0.0]];
        let frame = BoxFrame::around(&points, &points);
        assert!(frame.margin(0.0) == 0.0 && frame.margin(1e-200) < 1.01);
        for delta in [1e-160, 1.0, f64::MAX] {
            let margin = frame.margin(delta);
            assert_eq!(margin, EVERYWHERE);
            let far = MovingBox {
                min: [[0.5; 3]; 2],
                max: [[0.5; 3]; 2],
            };
            let near = MovingBox {
                min: [[-0.5; 3]; 2],
                max: [[-0.5; 3]; 2],
            };
            assert!(near.meeting(&far).is_none());
            assert!(near.meeting(&far.grown(margin)).is_some());
            assert!(near.meeting(&MovingBox::EMPTY.grown(margin)).is_none());
        }
    }
}
