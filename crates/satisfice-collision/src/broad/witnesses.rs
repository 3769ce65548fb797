//! Pairs of points of two bodies that move as wholes: which of them are still near, wherever the bodies have gone. Eight at a
//! time, by the filter that trees use, and without a look at the features the points belong to.

use std::ops::Range;

use super::clip::{four, wide};
use super::frame::Frame;
use super::lanes::{Eight, Lanes, Work, dispatch};
use super::relative::Relative;
use crate::distance::Point;
use crate::{Aabb, Placement};

/// Pairs of points, each in its body's own frame.
#[derive(Debug, Default)]
pub(crate) struct Witnesses {
    frames: Option<[Frame; 2]>,
    /// Whether the first of a pair is of the second body: the frame of the second has the coarser scale.
    flip: bool,
    /// Eight pairs each; what is missing in the last is its last pair again.
    groups: Vec<[[Eight; 3]; 2]>,
    len: usize,
}

impl Witnesses {
    /// Forgets all pairs.
    pub(crate) fn clear(&mut self) {
        self.groups.clear();
        self.len = 0;
    }

    /// Takes over pairs of points, a point of each body, in the bodies' own coordinates.
    pub(crate) fn set(&mut self, pairs: &[[Point; 2]]) {
        self.clear();
        let Some(&[one, two]) = pairs.first() else { return };
        let mut bounds = [Aabb::point(one), Aabb::point(two)];
        for pair in pairs {
            for (bounds, point) in bounds.iter_mut().zip(pair) {
                bounds.include(*point);
            }
        }
        let [one, two] = bounds.map(|bounds| Frame::unit(&bounds));
        self.flip = two.scale > one.scale;
        let frames = if self.flip { [two, one] } else { [one, two] };
        self.frames = Some(frames);
        self.len = pairs.len();
        dispatch(Placing {
            pairs,
            frames: &frames,
            flip: self.flip,
            groups: &mut self.groups,
        });
    }

    /// How many groups of eight pairs there are.
    pub(crate) fn groups(&self) -> usize {
        self.groups.len()
    }

    /// Appends a mask for each of some groups: bit `i` is set if pair `i` of it is nearer than `delta` for certain, with the
    /// bodies placed so.
    pub(crate) fn near(&self, groups: Range<usize>, poses: [&Placement; 2], delta: f64, masks: &mut Vec<u8>) {
        let [first, second] = if self.flip { [poses[1], poses[0]] } else { poses };
        if let Some([one, two]) = &self.frames {
            let (relative, filter) = Relative::new(one, first, two, second, delta);
            let last = groups.end == self.groups.len();
            dispatch(Nearing {
                groups: &self.groups[groups],
                relative: &relative,
                limit: filter.sure,
                masks,
            });
            if last && let Some(mask) = masks.last_mut() {
                *mask &= 0xff >> (self.groups.len() * 8 - self.len);
            }
        }
    }
}

struct Placing<'a> {
    pairs: &'a [[Point; 2]],
    frames: &'a [Frame; 2],
    flip: bool,
    groups: &'a mut Vec<[[Eight; 3]; 2]>,
}

impl Work for Placing<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let flat = self.pairs.as_flattened();
        for group in 0..self.pairs.len().div_ceil(8) {
            let mut to = [[[0.0; 8]; 3]; 2];
            for (body, to) in to.iter_mut().enumerate() {
                let frame = &self.frames[body];
                let (origin, axes) = (wide(frame.origin), frame.axes());
                let mut rows = [[0.0; 4]; 8];
                for (lane, row) in rows.iter_mut().enumerate() {
                    let pair = (group * 8 + lane).min(self.pairs.len() - 1);
                    let point = four(flat, 2 * pair + (body ^ usize::from(self.flip)));
                    *row = lanes.place(&point, &origin, frame.scale, axes);
                }
                *to = lanes.columns(&rows);
            }
            self.groups.push(to);
        }
    }
}

struct Nearing<'a> {
    groups: &'a [[[Eight; 3]; 2]],
    relative: &'a Relative,
    limit: f32,
    masks: &'a mut Vec<u8>,
}

impl Work for Nearing<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let mut room = [[0.0; 8]; 3];
        for [one, two] in self.groups {
            let one = self.relative.points(one, &mut room);
            self.masks.push(lanes.each_closer(one, two, self.limit) as u8);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Witnesses;
    use crate::Placement;
    use crate::distance::{Threshold, vertex_vertex};

    #[test]
    fn what_is_near_for_certain_is_near_and_few_are_left_to_the_exact_decision() {
        let mut state = 3_u64;
        let mut number = || {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(1);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        for (size, far) in [([1.0, 1.0], 0.0), ([1e-3, 4.0], 3.0), ([5.0, 0.2], 1e6)] {
            let mut point =
                |size: f64, far: f64| -> [f64; 3] { std::array::from_fn(|_| far + size * number()) };
            let pairs: Vec<_> = (0..1003)
                .map(|_| [point(size[0], far), point(size[1], -far)])
                .collect();
            let poses = [
                Placement::from_axis_angle([1.0, 2.0, 3.0], 0.7)
                    .and_then(|turn| turn.moved([0.1, -0.2, 0.3]))
                    .unwrap(),
                Placement::from_translation([2.0 * far, 2.0 * far + 0.1, 2.0 * far]).unwrap(),
            ];
            let mut witnesses = Witnesses::default();
            witnesses.set(&pairs);
            assert_eq!(witnesses.groups(), 126);
            for poses in [
                [&poses[0], &poses[1]],
                [&poses[1], &poses[1]],
                [&Placement::IDENTITY, &poses[1]],
            ] {
                let at = |pair: &[[f64; 3]; 2]| [poses[0].apply(pair[0]), poses[1].apply(pair[1])];
                let distance = |pair| {
                    let [p, q] = at(pair);
                    vertex_vertex::proximity(&p, &q).distance
                };
                let mut distances: Vec<f64> = pairs.iter().map(distance).collect();
                distances.sort_by(f64::total_cmp);
                let delta = distances[500] * (1.0 + 1e-12);
                let threshold = Threshold::new(delta).unwrap();
                let mut masks = Vec::new();
                witnesses.near(0..100, poses, delta, &mut masks);
                witnesses.near(100..126, poses, delta, &mut masks);
                let mut near = 0;
                for (at_pair, pair) in pairs.iter().enumerate() {
                    let [p, q] = at(pair);
                    let sure = masks[at_pair / 8] >> (at_pair % 8) & 1 == 1;
                    assert!(!sure || vertex_vertex::within(&p, &q, threshold));
                    near += u32::from(sure);
                }
                assert_eq!(masks[125] >> 3, 0, "nothing but the pairs");
                assert!(far > 0.0 || near > 490, "{near}");
            }
        }
    }
}
