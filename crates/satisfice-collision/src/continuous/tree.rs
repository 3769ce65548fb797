//! A tree of moving boxes: eight to a group, each box given at both ends of the step.
//!
//! A box that moves linearly from the one to the other contains its features all the time, so two features are apart all the
//! time if their boxes are, on one axis, apart in the same order at both ends. Two bodies that fall side by side are thus
//! apart, while the space that they sweep is shared.
//!
//! Boxes are in single precision, rounded outwards, in a frame centred on the scene and scaled to its size.

use crate::broad::{Box32, order_by_median};
use crate::distance::Point;
use crate::simd::{self, Floats};

/// Boxes of a group.
pub(super) const LANES: usize = 8;
type Lanes = [f32; LANES];

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
    min: [[Lanes; 3]; 2],
    max: [[Lanes; 3]; 2],
}

/// The boxes of a list of features.
#[derive(Debug)]
pub(super) struct MovingTree {
    /// The features in the order of the lowest level's lanes.
    pub(super) order: Vec<u32>,
    /// From the groups of features to the root. A group's number is the number of its box one level higher.
    pub(super) levels: Vec<Vec<MovingGroup>>,
    /// For every group the rigid body that all its features belong to, or [`MIXED`].
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

/// A lower end less a margin, rounded down.
#[inline(always)]
fn lowered(x: f32, margin: f32) -> f32 {
    if margin == 0.0 {
        x
    } else {
        (x - margin).next_down()
    }
}

/// An upper end and a margin, rounded up.
#[inline(always)]
fn raised(x: f32, margin: f32) -> f32 {
    if margin == 0.0 { x } else { (x + margin).next_up() }
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
        let less = |x: f32, y: f32| if x < y { x } else { y };
        let more = |x: f32, y: f32| if x > y { x } else { y };
        for end in 0..2 {
            for k in 0..3 {
                self.min[end][k] = less(other.min[end][k], self.min[end][k]);
                self.max[end][k] = more(other.max[end][k], self.max[end][k]);
            }
        }
    }

    /// The box grown by a margin on every side.
    pub(super) fn grown(&self, margin: f32) -> Self {
        Self {
            min: self.min.map(|p| p.map(|x| lowered(x, margin))),
            max: self.max.map(|p| p.map(|x| raised(x, margin))),
        }
    }

    /// The middle at half of the step.
    fn middle(&self) -> Box32 {
        let middle = std::array::from_fn(|k| {
            let sum = |end: usize| self.min[end][k] + self.max[end][k];
            0.25 * (sum(0) + sum(1))
        });
        Box32 {
            min: middle,
            max: middle,
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

/// When the boxes of two groups first meet.
#[derive(Debug, Clone)]
pub(super) struct Meetings {
    /// For each box of the first group those of the second that are not apart from it until the time asked for, a bit each.
    pub(super) masks: [u32; LANES],
    /// Lower bounds of the times at which they first meet, where the bit is set.
    pub(super) first: [Lanes; LANES],
}

/// The work of [`MovingGroup::meetings`].
struct Meet<'g> {
    a: &'g MovingGroup,
    b: &'g MovingGroup,
    lanes: usize,
    margin: f32,
    until: f32,
}

impl simd::Work for Meet<'_> {
    type Output = Meetings;

    /// A gap is a difference of two numbers, so its sign is right and its value off by one rounding; a quotient of gaps is off by
    /// less than four. A gap above 0 that shrinks is above 0 until a time if it is so, as computed with four roundings, until
    /// one that is later by a hundred roundings.
    #[inline(always)]
    fn run<L: simd::Lanes>(self, lanes: L) -> Meetings {
        let s = lanes.single();
        let zero = s.splat(0.0);
        let down = s.splat(1.0 - 8.0 * f32::EPSILON);
        let until = s.splat(self.until * (1.0 + 100.0 * f32::EPSILON));
        let mut meetings = Meetings {
            masks: [0; LANES],
            first: [[0.0; LANES]; LANES],
        };
        for lane in 0..self.lanes {
            let mut apart = s.splat(-1.0);
            let mut gaps = [[zero; 2]; 6];
            for k in 0..3 {
                let (mut after, mut before) = ([zero; 2], [zero; 2]);
                for (end, (after, before)) in after.iter_mut().zip(&mut before).enumerate() {
                    let max = s.splat(raised(self.a.max[end][k][lane], self.margin));
                    let min = s.splat(lowered(self.a.min[end][k][lane], self.margin));
                    *after = s.sub(s.load(&self.b.min[end][k]), max);
                    *before = s.sub(min, s.load(&self.b.max[end][k]));
                }
                for [from, to] in [after, before] {
                    let last = s.mul_add(until, s.sub(to, from), from);
                    // in this order an empty box, whose last gap is no number, is apart
                    apart = s.max(s.min(last, from), apart);
                }
                gaps[2 * k] = after;
                gaps[2 * k + 1] = before;
            }
            let mask = s.bits(s.at_most(apart, zero));
            meetings.masks[lane] = mask;
            if mask != 0 {
                let mut first = zero;
                for [from, to] in gaps {
                    let from = s.max(from, zero);
                    // NaN (of 0 / 0) is not greater.
                    first = s.max(s.div(from, s.sub(from, to)), first);
                }
                meetings.first[lane] = s.store(s.mul(first, down));
            }
        }
        meetings
    }
}

impl MovingGroup {
    /// When each of the first `lanes` boxes of this group, grown by a margin, meets the boxes of another group, if it does by the time
    /// `until`.
    #[inline]
    pub(super) fn meetings(&self, lanes: usize, margin: f32, other: &Self, until: f32) -> Meetings {
        simd::dispatch(Meet {
            a: self,
            b: other,
            lanes,
            margin,
            until,
        })
    }

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

    pub(super) fn lane(&self, lane: usize) -> MovingBox {
        MovingBox {
            min: std::array::from_fn(|end| std::array::from_fn(|k| self.min[end][k][lane])),
            max: std::array::from_fn(|end| std::array::from_fn(|k| self.max[end][k][lane])),
        }
    }

    fn union(&self) -> MovingBox {
        let least = |lanes: &Lanes| lanes.iter().copied().fold(f32::INFINITY, f32::min);
        let most = |lanes: &Lanes| lanes.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        MovingBox {
            min: std::array::from_fn(|end| std::array::from_fn(|k| least(&self.min[end][k]))),
            max: std::array::from_fn(|end| std::array::from_fn(|k| most(&self.max[end][k]))),
        }
    }

    /// The lanes that are not apart from a box in the same order at both ends, a bit each.
    #[inline]
    pub(super) fn candidates(&self, of: &MovingBox) -> u32 {
        let mut apart = [0_u32; LANES];
        for k in 0..3 {
            let (min, max) = ([of.min[0][k], of.min[1][k]], [of.max[0][k], of.max[1][k]]);
            let (lower, upper) = (
                [&self.min[0][k], &self.min[1][k]],
                [&self.max[0][k], &self.max[1][k]],
            );
            // Without branches, so that lanes become those of vector instructions.
            for lane in 0..LANES {
                let after = u32::from(lower[0][lane] > max[0]) & u32::from(lower[1][lane] > max[1]);
                let before = u32::from(min[0] > upper[0][lane]) & u32::from(min[1] > upper[1][lane]);
                apart[lane] |= after | before;
            }
        }
        let mut mask = 0;
        for (lane, apart) in apart.into_iter().enumerate() {
            mask |= (apart ^ 1) << lane;
        }
        mask
    }
}

impl MovingTree {
    /// The tree over features with these boxes: `body` gives the body of each, and again if it is rigid or [`MIXED`]. Features
    /// of a body stay together.
    pub(super) fn new(boxes: &[MovingBox], body: impl Fn(u32) -> (u32, u32)) -> Self {
        let middles: Vec<Box32> = boxes.iter().map(MovingBox::middle).collect();
        let mut order = Vec::with_capacity(boxes.len());
        while order.len() < boxes.len() {
            // The features of a body follow each other.
            let first = order.len();
            let number = body(first as u32).0;
            let rest = (first..boxes.len()).take_while(|&feature| body(feature as u32).0 == number);
            let end = first + rest.count();
            let within = order_by_median(&middles[first..end], false);
            order.extend(within.into_iter().map(|feature| feature + first as u32));
        }
        let mut rigid = vec![common(order.iter().map(|&feature| body(feature).1))];
        let sorted = order.iter().map(|&feature| boxes[feature as usize]);
        let mut levels = vec![groups(sorted)];
        while levels[levels.len() - 1].len() > 1 {
            let next = groups(levels[levels.len() - 1].iter().map(MovingGroup::union));
            levels.push(next);
            rigid.push(common(rigid[rigid.len() - 1].iter().copied()));
        }
        Self { order, levels, rigid }
    }

    /// The rigid body that all features of a group belong to, or [`MIXED`].
    pub(super) fn rigid_body(&self, level: usize, group: u32) -> u32 {
        self.rigid[level].get(group as usize).copied().unwrap_or(MIXED)
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

    /// Visits the groups of features, from number `least` on, whose box is not apart from `of`, leaving out those of the
    /// rigid body `without`.
    pub(super) fn visit(
        &self,
        of: &MovingBox,
        least: u32,
        without: u32,
        stack: &mut Vec<(u8, u32)>,
        visit: &mut impl FnMut(u32),
    ) {
        stack.clear();
        stack.push((self.levels.len() as u8 - 1, 0));
        while let Some((level, group)) = stack.pop() {
            if level == 0 {
                visit(group);
                continue;
            }
            let mut mask = self.levels[level as usize][group as usize].candidates(of);
            while mask != 0 {
                let child = group * LANES as u32 + mask.trailing_zeros();
                mask &= mask - 1;
                // The last group of features below the child.
                let last = ((u64::from(child) + 1) << (3 * (u32::from(level) - 1))) - 1;
                let is_own = without != MIXED && self.rigid_body(usize::from(level) - 1, child) == without;
                if last >= u64::from(least) && !is_own {
                    stack.push((level - 1, child));
                }
            }
        }
    }
}

/// What all of eight have in common, or [`MIXED`].
fn common(bodies: impl Iterator<Item = u32>) -> Vec<u32> {
    let bodies: Vec<u32> = bodies.collect();
    let of_eight = |eight: &[u32]| {
        let all_the_same = eight.iter().all(|&body| body == eight[0]);
        if all_the_same { eight[0] } else { MIXED }
    };
    bodies.chunks(LANES).map(of_eight).collect()
}

fn groups(boxes: impl Iterator<Item = MovingBox>) -> Vec<MovingGroup> {
    let mut groups = Vec::new();
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
