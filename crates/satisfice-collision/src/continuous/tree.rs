//! A tree of moving boxes: eight to a group.

use std::ops::Range;

use super::body_order::{Layout, filled};
use super::boxes::{BoxFrame, LANES, MovingBox, MovingGroup};

/// The boxes of a list of features.
#[derive(Debug)]
pub(super) struct MovingTree {
    /// The features in the order of the lowest level's lanes, and [`HOLE`](super::body_order::HOLE) in lanes without one.
    pub(super) order: Vec<u32>,
    /// The bodies that the features belong to, in ascending order, and the lanes of each.
    bodies: Vec<(u32, Range<usize>)>,
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

/// No rigid body: features of several bodies, or of one that collides with itself.
pub(super) const MIXED: u32 = u32::MAX;

impl MovingTree {
    /// The tree over the features of a layout with these `corners`.
    pub(super) fn new<const N: usize>(
        frame: &BoxFrame,
        corners: impl Fn(u32) -> [u32; N],
        layout: Layout,
    ) -> Self {
        let Layout {
            order,
            owners,
            bodies,
        } = layout;
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
        if !owners.is_empty() {
            rigid.push(common(&owners));
            for level in 1..levels.len() {
                rigid.push(common(&rigid[level - 1]));
            }
        }
        let mut tree = Self {
            order,
            bodies,
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

    /// The tree over the same features in another motion, in the order that it has.
    pub(super) fn refitted<const N: usize>(mut self, frame: &BoxFrame) -> Self {
        self.fit::<N>(frame);
        self
    }

    /// Whether the boxes around groups are larger by this factor than they were in this order when it was new.
    pub(super) fn is_loose(&self, frame: &BoxFrame, factor: f64) -> bool {
        self.extent(frame) > factor * self.extent_when_new
    }

    /// Whether the features in the tree are those of these bodies, in ascending order.
    pub(super) fn is_of(&self, bodies: &[u32]) -> bool {
        self.bodies.iter().map(|(body, _)| body).eq(bodies)
    }

    fn lanes_of(&self, body: u32) -> Option<&Range<usize>> {
        let place = self.bodies.binary_search_by_key(&body, |(body, _)| *body).ok()?;
        Some(&self.bodies[place].1)
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
        frame.length(groups.map(MovingGroup::extent).sum())
    }

    /// The same of the groups that have features of this body only.
    pub(super) fn extent_of(&self, frame: &BoxFrame, body: u32) -> f64 {
        let Some(lanes) = self.lanes_of(body) else {
            return 0.0;
        };
        let (mut first, mut end) = (lanes.start, lanes.end);
        let mut extent = 0.0;
        for level in &self.levels[1..] {
            (first, end) = (first.div_ceil(LANES), end / LANES);
            for group in first..end {
                extent += level[group / LANES].lane(group % LANES).extent();
            }
        }
        frame.length(extent)
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

    /// Visits the features whose boxes are not apart from `of`.
    pub(super) fn visit_features(
        &self,
        of: &MovingBox,
        stack: &mut Vec<(u8, u32)>,
        visit: &mut impl FnMut(u32),
    ) {
        self.visit(0, of, 0, MIXED, stack, &mut |group| {
            let mut mask = self.levels[0][group as usize].candidates(of);
            while mask != 0 {
                visit(self.order[group as usize * LANES + mask.trailing_zeros() as usize]);
                mask &= mask - 1;
            }
        });
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
    use crate::distance::Point;
    use crate::generate;

    #[test]
    fn an_order_is_kept_while_it_fits() {
        let cloth = generate::cloth(1.0, 1.0, 20, 20).expect("a cloth");
        let resting = cloth.vertices();
        let mut step = Step::new();
        step.add_deforming(&cloth, resting).expect("one topology");
        let lists = [FeatureList::Vertices, FeatureList::Edges, FeatureList::Triangles];
        let orders = |step: &Step| lists.map(|list| step.tree(list, 0.0).order.clone());
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
