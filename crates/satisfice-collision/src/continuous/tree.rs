//! A tree of moving boxes: eight to a group, each box given at both ends of the step.
//!
//! A box that moves linearly from the one to the other contains its features all the time, so two features are apart all the
//! time if their boxes are, on one axis, apart in the same order at both ends. Two bodies that fall side by side are thus
//! apart, while the space that they sweep is shared.
//!
//! Boxes are in single precision, rounded outwards, in a frame centred on the scene and scaled to its size.

use super::body_order::{filled, order_of};
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

/// The boxes of a list of features.
#[derive(Debug)]
pub(super) struct MovingTree {
    /// The features in the order of the lowest level's lanes, and [`HOLE`](super::body_order::HOLE) in lanes without one.
    pub(super) order: Vec<u32>,
    /// The vertices of the features of each group, a lane each: as many arrays a group as a feature has vertices.
    corners: Vec<[u32; LANES]>,
    corners_per_feature: usize,
    /// From the groups of features to the root. A group's number is the number of its box one level higher.
    pub(super) levels: Vec<Vec<MovingGroup>>,
    /// For every group the rigid body that all its features belong to, or [`MIXED`]; empty if there is none.
    rigid: Vec<Vec<u32>>,
    /// How large the boxes around groups were in this order when it was new.
    extent_when_new: f64,
}

/// A kept order is given up once the boxes around its groups have grown by this factor.
const LOOSE: f64 = 1.5;

/// By this margin a box reaches all others of its frame, whose coordinates are at most 1/2. An empty box stays apart only if it grows by a
/// finite number.
const EVERYWHERE: f32 = 4.0;

/// No rigid body: features of several bodies, or of one that collides with itself.
pub(super) const MIXED: u32 = u32::MAX;

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
    fn extent<const N: usize>(&self, corners: [u32; N]) -> [[[f32; 4]; 2]; 2] {
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
    fn middle<const N: usize>(&self, corners: [u32; N]) -> [f32; 3] {
        let [min, max] = self.extent(corners);
        let mut middle = [0.0; 3];
        for k in 0..3 {
            middle[k] = (min[0][k] + max[0][k]) + (min[1][k] + max[1][k]);
        }
        middle
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
    const EMPTY: Self = Self {
        min: [[f32::INFINITY; 3]; 2],
        max: [[f32::NEG_INFINITY; 3]; 2],
    };

    fn include(&mut self, other: &Self) {
        for end in 0..2 {
            for k in 0..3 {
                self.min[end][k] = lesser(other.min[end][k], self.min[end][k]);
                self.max[end][k] = greater(other.max[end][k], self.max[end][k]);
            }
        }
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
    const EMPTY: Self = Self {
        min: [[[f32::INFINITY; LANES]; 3]; 2],
        max: [[[f32::NEG_INFINITY; LANES]; 3]; 2],
    };

    fn set(&mut self, lane: usize, of: &MovingBox) {
        for end in 0..2 {
            for k in 0..3 {
                self.min[end][k][lane] = of.min[end][k];
                self.max[end][k][lane] = of.max[end][k];
            }
        }
    }

    /// Makes a lane the box around what has this extent before rounding.
    #[inline(always)]
    fn set_around(&mut self, lane: usize, [min, max]: &[[[f32; 4]; 2]; 2]) {
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
    fn extent(&self) -> f64 {
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

    fn union(&self) -> MovingBox {
        let least = |lanes: &Eight| fold(lanes, lesser);
        let most = |lanes: &Eight| fold(lanes, greater);
        MovingBox {
            min: std::array::from_fn(|end| std::array::from_fn(|k| least(&self.min[end][k]))),
            max: std::array::from_fn(|end| std::array::from_fn(|k| most(&self.max[end][k]))),
        }
    }
}

impl MovingTree {
    /// The tree over so many features with these `corners`. `bodies` are where those of each body begin, and the body if it is rigid or
    /// [`MIXED`].
    pub(super) fn new<const N: usize>(
        frame: &BoxFrame,
        count: usize,
        corners: impl Fn(u32) -> [u32; N],
        bodies: &[(usize, u32)],
    ) -> Self {
        let middles: Vec<_> = (0..count)
            .map(|feature| frame.middle(corners(feature as u32)))
            .collect();
        let has_rigid = bodies.iter().any(|&(_, rigid)| rigid != MIXED);
        let (order, owners) = order_of(&middles, bodies);
        let number = order.len().div_ceil(LANES).max(1);
        let mut in_lanes = vec![[u32::MAX; LANES]; number * N];
        for (in_lanes, features) in in_lanes.chunks_exact_mut(N).zip(order.chunks(LANES)) {
            for (lane, feature) in filled(features) {
                for (lanes, corner) in in_lanes.iter_mut().zip(corners(feature)) {
                    lanes[lane] = corner;
                }
            }
        }
        let mut levels = vec![vec![MovingGroup::EMPTY; number]];
        while levels[levels.len() - 1].len() > 1 {
            let groups = levels[levels.len() - 1].len().div_ceil(LANES);
            levels.push(vec![MovingGroup::EMPTY; groups]);
        }
        let mut rigid: Vec<Vec<u32>> = Vec::new();
        if has_rigid {
            rigid.push(common(&owners));
            for level in 1..levels.len() {
                rigid.push(common(&rigid[level - 1]));
            }
        }
        let mut tree = Self {
            order,
            corners: in_lanes,
            corners_per_feature: N,
            levels,
            rigid,
            extent_when_new: 0.0,
        };
        tree.fit::<N>(frame);
        tree.extent_when_new = tree.extent(frame);
        tree
    }

    /// The tree over the same features in another motion, in the order that it has; `None` if that order has become loose.
    pub(super) fn refitted<const N: usize>(mut self, frame: &BoxFrame) -> Option<Self> {
        self.fit::<N>(frame);
        let is_loose = self.extent(frame) > LOOSE * self.extent_when_new;
        (!is_loose).then_some(self)
    }

    /// Sets all boxes.
    fn fit<const N: usize>(&mut self, frame: &BoxFrame) {
        let lanes = self.levels[0].iter_mut().zip(self.corners.chunks_exact(N));
        for ((group, in_lanes), features) in lanes.zip(self.order.chunks(LANES)) {
            for (lane, _) in filled(features) {
                let corners = std::array::from_fn::<_, N, _>(|k| in_lanes[k][lane]);
                group.set_around(lane, &frame.extent(corners));
            }
        }
        for level in 1..self.levels.len() {
            let (below, above) = self.levels.split_at_mut(level);
            for (group, children) in above[0].iter_mut().zip(below[level - 1].chunks(LANES)) {
                for (lane, child) in children.iter().enumerate() {
                    group.set(lane, &child.union());
                }
            }
        }
    }

    /// The edges of all boxes around groups, which is how often a search meets one, up to a factor.
    fn extent(&self, frame: &BoxFrame) -> f64 {
        let groups = self.levels[1..].iter().flatten();
        groups.map(MovingGroup::extent).sum::<f64>() / frame.scale
    }

    /// How many features the lanes from this one on have.
    pub(super) fn features_from(&self, lane: usize) -> usize {
        filled(self.order.get(lane..).unwrap_or_default()).count()
    }

    /// The vertices of the features of a group, a lane each.
    #[inline(always)]
    pub(super) fn corners(&self, group: u32) -> &[[u32; LANES]] {
        let first = group as usize * self.corners_per_feature;
        &self.corners[first..first + self.corners_per_feature]
    }

    /// The rigid body that all features of a group belong to, or [`MIXED`].
    pub(super) fn rigid_body(&self, level: usize, group: u32) -> u32 {
        let level = self.rigid.get(level);
        level
            .and_then(|level| level.get(group as usize))
            .copied()
            .unwrap_or(MIXED)
    }

    /// A box of a level.
    pub(super) fn box_of(&self, level: usize, number: u32) -> MovingBox {
        self.levels[level][number as usize / LANES].lane(number as usize % LANES)
    }

    /// The box around the features at these places of the order, both included.
    pub(super) fn box_of_range(&self, from: u32, to: u32) -> MovingBox {
        let mut around = MovingBox::EMPTY;
        let (mut from, mut end) = (from, to + 1);
        // What fills no group of this level, then the groups as the boxes of the next one.
        for level in 0..self.levels.len() {
            while from < end && from % LANES as u32 != 0 {
                around.include(&self.box_of(level, from));
                from += 1;
            }
            while from < end && (end % LANES as u32 != 0 || level + 1 == self.levels.len()) {
                end -= 1;
                around.include(&self.box_of(level, end));
            }
            from /= LANES as u32;
            end /= LANES as u32;
        }
        around
    }

    /// The box around a group of a level.
    pub(super) fn box_around(&self, level: usize, group: u32) -> MovingBox {
        if level + 1 < self.levels.len() {
            self.box_of(level + 1, group)
        } else {
            self.levels[level][group as usize].union()
        }
    }

    /// Where the box around a group of a level is: a group of the next level and a lane of it; `None` at the root.
    #[inline(always)]
    pub(super) fn place_of(&self, level: usize, group: u32) -> Option<(&MovingGroup, usize)> {
        let above = self.levels.get(level + 1)?;
        Some((&above[group as usize / LANES], group as usize % LANES))
    }

    /// Visits the groups of a level, from number `least` on, whose box is not apart from `of`, leaving out those of the
    /// rigid body `without`.
    pub(super) fn visit(
        &self,
        floor: u8,
        of: &MovingBox,
        least: u32,
        without: u32,
        stack: &mut Vec<(u8, u32)>,
        visit: &mut impl FnMut(u32),
    ) {
        stack.clear();
        stack.push((self.levels.len() as u8 - 1, 0));
        while let Some((level, group)) = stack.pop() {
            if level == floor {
                visit(group);
                continue;
            }
            let mut mask = self.levels[level as usize][group as usize].candidates(of);
            while mask != 0 {
                let child = group * LANES as u32 + mask.trailing_zeros();
                mask &= mask - 1;
                // The last group of the floor below the child.
                let last = ((u64::from(child) + 1) << (3 * u32::from(level - 1 - floor))) - 1;
                let is_own = without != MIXED && self.rigid_body(usize::from(level) - 1, child) == without;
                if last >= u64::from(least) && !is_own {
                    stack.push((level - 1, child));
                }
            }
        }
    }
}

/// What all of eight have in common, or [`MIXED`].
fn common(bodies: &[u32]) -> Vec<u32> {
    let of_eight = |eight: &[u32]| {
        let all_the_same = eight.iter().all(|&body| body == eight[0]);
        if all_the_same { eight[0] } else { MIXED }
    };
    bodies.chunks(LANES).map(of_eight).collect()
}

#[cfg(test)]
mod tests {
    use super::super::step::{FeatureList, Step};
    use super::*;
    use crate::generate;

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

    #[test]
    fn an_order_is_kept_while_it_fits() {
        let cloth = generate::cloth(1.0, 1.0, 20, 20).expect("a cloth");
        let resting = cloth.vertices();
        let mut step = Step::new();
        step.add_deforming(&cloth, resting).expect("one topology");
        let lists = [FeatureList::Vertices, FeatureList::Edges, FeatureList::Triangles];
        let orders = |step: &Step| lists.map(|list| step.tree(list).order.clone());
        let first = orders(&step);
        // rolled up, far away and larger than before, but each neighbourhood as it was
        let rolled: Vec<Point> = resting
            .iter()
            .map(|&[x, y, _]| [100.0 + 1.2 * y, 0.2 * (6.0 * x).sin(), 0.2 * (6.0 * x).cos()])
            .collect();
        step.set_motion(0, resting, &rolled).expect("one topology");
        assert_eq!(orders(&step), first);
        // a motion that nothing asks about loses nothing
        step.set_motion(0, &rolled, &rolled).expect("one topology");
        step.set_motion(0, &rolled, resting).expect("one topology");
        assert_eq!(orders(&step), first);
        // neighbours are torn apart
        let torn: Vec<Point> = (0..resting.len())
            .map(|v| resting[v * 67 % resting.len()])
            .collect();
        step.set_motion(0, &torn, &torn).expect("one topology");
        let mut anew = Step::new();
        let cloth = cloth.with_vertices(torn.clone()).expect("finite");
        anew.add_deforming(&cloth, &torn).expect("one topology");
        assert_eq!(orders(&step), orders(&anew));
        assert_ne!(orders(&step), first);
    }
}
