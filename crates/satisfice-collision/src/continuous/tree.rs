//! A tree of moving boxes: eight to a group, each box given at both ends of the step.
//!
//! A box that moves linearly from the one to the other contains its features all the time, so two features are apart all the
//! time if their boxes are, on one axis, apart in the same order at both ends. Two bodies that fall side by side are thus
//! apart, while the space that they sweep is shared.
//!
//! Boxes are in single precision, rounded outwards, in a frame centred on the scene and scaled to its size.

use crate::broad::{fold, greater, lesser, order_by_median};
use crate::distance::Point;
use crate::simd::Eight;

/// Boxes of a group.
pub(super) const LANES: usize = 8;

/// Where the frame of the boxes lies.
#[derive(Debug, Clone, Copy)]
pub(super) struct BoxFrame {
    centre: Point,
    scale: f64,
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
    /// The features in the order of the lowest level's lanes.
    pub(super) order: Vec<u32>,
    /// From the groups of features to the root. A group's number is the number of its box one level higher.
    pub(super) levels: Vec<Vec<MovingGroup>>,
    /// For every group the rigid body that all its features belong to, or [`MIXED`]; empty if there is none.
    rigid: Vec<Vec<u32>>,
}

/// No rigid body: features of several bodies, or of one that collides with itself.
pub(super) const MIXED: u32 = u32::MAX;

impl BoxFrame {
    pub(super) fn around(from: &[Point], to: &[Point]) -> Self {
        let (mut min, mut max) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for p in from.iter().chain(to) {
            for k in 0..3 {
                min[k] = min[k].min(p[k]);
                max[k] = max[k].max(p[k]);
            }
        }
        // Halves first, so that nothing overflows.
        let size = (0..3).fold(0.0_f64, |size, k| size.max(0.5 * max[k] - 0.5 * min[k]));
        Self {
            centre: std::array::from_fn(|k| 0.5 * min[k] + 0.5 * max[k]),
            scale: if size > 1e-300 { 1.0 / size } else { 1.0 },
        }
    }

    /// A point in the frame: the exact value of each coordinate lies within one step of single precision of it, or two.
    fn local(&self, p: Point) -> [f32; 3] {
        std::array::from_fn(|k| ((0.5 * p[k] - 0.5 * self.centre[k]) * self.scale) as f32)
    }

    /// The boxes around vertices at both ends of the step.
    pub(super) fn boxes(&self, from: &[Point], to: &[Point]) -> Vec<MovingBox> {
        let ends = from.iter().zip(to).map(|(&p, &q)| [self.local(p), self.local(q)]);
        ends.map(|ends| MovingBox {
            min: ends.map(|p| p.map(below)),
            max: ends.map(|p| p.map(above)),
        })
        .collect()
    }

    /// A distance in the frame, rounded up.
    pub(super) fn margin(&self, delta: f64) -> f32 {
        if delta == 0.0 {
            return 0.0;
        }
        ((0.5 * delta * self.scale * (1.0 + 1e-12)) as f32).next_up()
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

    /// The box around several.
    pub(super) fn around<'a>(boxes: impl IntoIterator<Item = &'a Self>) -> Self {
        let mut all = Self::EMPTY;
        for of in boxes {
            all.include(of);
        }
        all
    }

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

    /// Four times the middle at half of the step.
    fn middle(&self) -> [f32; 3] {
        let sum = |end: usize, k: usize| self.min[end][k] + self.max[end][k];
        std::array::from_fn(|k| sum(0, k) + sum(1, k))
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

    #[inline(always)]
    pub(super) fn lane(&self, lane: usize) -> MovingBox {
        MovingBox {
            min: std::array::from_fn(|end| std::array::from_fn(|k| self.min[end][k][lane])),
            max: std::array::from_fn(|end| std::array::from_fn(|k| self.max[end][k][lane])),
        }
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
    /// The tree over so many features with the boxes `of` them. `bodies` are where those of each body begin, and the body if it is rigid or [`MIXED`].
    /// Features of a body stay together.
    pub(super) fn new(count: usize, of: impl Fn(u32) -> MovingBox, bodies: &[(usize, u32)]) -> Self {
        let mut order = Vec::with_capacity(count);
        let mut owners = Vec::new();
        let has_rigid = bodies.iter().any(|&(_, rigid)| rigid != MIXED);
        for (number, &(first, rigid)) in bodies.iter().enumerate() {
            let end = bodies.get(number + 1).map_or(count, |&(next, _)| next);
            let middles = (first..end).map(|feature| of(feature as u32).middle());
            let within = order_by_median(middles, false);
            order.extend(within.into_iter().map(|feature| feature + first as u32));
            if has_rigid {
                owners.resize(end, rigid);
            }
        }
        let mut levels = vec![groups(order.iter().map(|&feature| of(feature)))];
        while levels[levels.len() - 1].len() > 1 {
            let next = groups(levels[levels.len() - 1].iter().map(MovingGroup::union));
            levels.push(next);
        }
        let mut rigid: Vec<Vec<u32>> = Vec::new();
        if has_rigid {
            rigid.push(common(&owners));
            for level in 1..levels.len() {
                rigid.push(common(&rigid[level - 1]));
            }
        }
        Self { order, levels, rigid }
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

    /// The number of boxes in a group.
    pub(super) fn lanes(&self, level: usize, group: u32) -> usize {
        let below = match level {
            0 => self.order.len(),
            _ => self.levels[level - 1].len(),
        };
        below.saturating_sub(group as usize * LANES).min(LANES)
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

fn groups(boxes: impl ExactSizeIterator<Item = MovingBox>) -> Vec<MovingGroup> {
    let mut groups = Vec::with_capacity(boxes.len().div_ceil(LANES));
    for (number, of) in boxes.enumerate() {
        if number % LANES == 0 {
            groups.push(MovingGroup::EMPTY);
        }
        if let Some(group) = groups.last_mut() {
            group.set(number % LANES, &of);
        }
    }
    if groups.is_empty() {
        groups.push(MovingGroup::EMPTY);
    }
    groups
}
