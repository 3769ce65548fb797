//! The couples of bodies that a search looks at one after another, and their problems, each made in its turn.

use std::sync::Arc;

use satisfice_collision::problem::{FeaturePairs, OrderedFeatures};
use satisfice_collision::{Aabb, FeatureKind};

use super::body::NamedBody;
use super::building;
use super::limit::Limit;
use super::scene::{Feature, Measure, Pair, World};

/// The pairs of two bodies, or of one with itself, as a problem for an engine.
#[derive(Debug)]
pub(super) struct PairProblem {
    pub(super) bodies: [usize; 2],
    pub(super) problem: FeaturePairs,
}

impl PairProblem {
    /// The problem of these bodies, alone.
    pub(super) fn new(world: &World, bodies: [usize; 2]) -> anyhow::Result<Self> {
        Self::of(world, bodies, [None, None]).map(|(problem, _)| problem)
    }

    /// The problem of these bodies, and their features in order, made where they are not given.
    fn of(
        world: &World,
        bodies: [usize; 2],
        [first, second]: [Option<OrderedFeatures>; 2],
    ) -> anyhow::Result<(Self, [OrderedFeatures; 2])> {
        let kind = world.request.kind;
        // The closest pairs at any distance have an infinite one.
        let threshold = world.request.threshold.min(f64::MAX);
        let (kind_a, kind_b) = kind.features();
        let order = |body: usize, kind| {
            let mesh = world.bodies[body].placed()?;
            OrderedFeatures::new(&mesh, kind)
        };
        let a = first.map_or_else(|| order(bodies[0], kind_a), Ok)?;
        let is_same = bodies[0] == bodies[1] && kind_a == kind_b;
        let b = second.or_else(|| is_same.then(|| a.clone()));
        let b = b.map_or_else(|| order(bodies[1], kind_b), Ok)?;
        let problem = if bodies[0] == bodies[1] {
            FeaturePairs::within_ordered(kind, &a, &b, threshold, world.ring_width())
        } else {
            FeaturePairs::between_ordered(kind, &a, &b, threshold)
        };
        let problem = Self {
            bodies,
            problem: problem?,
        };
        Ok((problem, [a, b]))
    }

    /// The pair of features that a solution of this problem is.
    pub(super) fn pair(&self, (a, b): (u32, u32)) -> Pair {
        let side = |body: usize, feature| Feature {
            body: body as u32,
            feature,
        };
        Pair {
            a: side(self.bodies[0], a),
            b: side(self.bodies[1], b),
        }
    }
}

/// The couples that can have a hit.
pub(super) struct Couples {
    /// The bodies of the first and of the second feature, in order.
    pub(super) near: Vec<[usize; 2]>,
    /// How many were left out because they are farther apart than the threshold.
    pub(super) apart: u64,
}

impl Couples {
    /// Couples whose boxes are apart have no hit. Of one or two bodies all are searched: the report says how close they come.
    pub(super) fn of(world: &World, measure: &mut Measure) -> anyhow::Result<Self> {
        let has_pairs = |&[a, b]: &[usize; 2]| {
            let within = || {
                let mesh = world.bodies[a].unplaced();
                FeaturePairs::has_pairs_within(world.request.kind, mesh, world.ring_width())
            };
            a != b || within()
        };
        if world.bodies.len() <= 2 {
            let all = || world.couples();
            let mut near: Vec<_> = all().filter(has_pairs).collect();
            if near.is_empty() {
                near = all().collect();
            }
            return Ok(Self { near, apart: 0 });
        }
        let mut near = Vec::new();
        let (kind_a, kind_b) = world.kinds();
        // The scene has boxes that are easy to move; these are as small as can be.
        let boxes: Vec<Aabb> = world.bodies.iter().map(NamedBody::bounds).collect();
        let distance = world.threshold.get();
        let may_touch = |&[a, b]: &[usize; 2]| {
            let gap = |k: usize| (boxes[b].min[k] - boxes[a].max[k]).max(boxes[a].min[k] - boxes[b].max[k]);
            (0..3).all(|k| gap(k).next_down() <= distance)
        };
        for a in world.with(kind_a) {
            let others = measure.near(a, world.threshold)?.into_iter();
            let couples = others.map(|b| [a, b]).filter(|&couple| world.is_couple(couple));
            let couples = couples.filter(may_touch);
            near.extend(couples.filter(|&[_, b]| world.bodies[b].count(kind_b) > 0));
        }
        let apart = world.couple_count() - near.len() as u64;
        near.retain(has_pairs);
        Ok(Self { near, apart })
    }
}

/// Makes the problems of couples in their turn. The features of a body are put in order once, and forgotten after its last couple.
pub(super) struct Problems<'w> {
    world: &'w Arc<World>,
    kinds: [FeatureKind; 2],
    /// For each body, in how many couples that are left it has the first or the second feature.
    uses: [Vec<u32>; 2],
    features: [Vec<Option<OrderedFeatures>>; 2],
}

impl<'w> Problems<'w> {
    pub(super) fn new(world: &'w Arc<World>, couples: &[[usize; 2]]) -> Self {
        let bodies = world.bodies.len();
        let mut problems = Self {
            world,
            kinds: world.kinds().into(),
            uses: [vec![0; bodies], vec![0; bodies]],
            features: [vec![None; bodies], vec![None; bodies]],
        };
        for couple in couples {
            for (side, &body) in couple.iter().enumerate() {
                let list = problems.list(side);
                problems.uses[list][body] += 1;
            }
        }
        problems
    }

    /// One list serves both features if they are of one kind.
    fn list(&self, side: usize) -> usize {
        match self.kinds[0] == self.kinds[1] {
            true => 0,
            false => side,
        }
    }

    /// The problem of the next couple; `None` if the limit is reached before.
    pub(super) fn next(
        &mut self,
        bodies: [usize; 2],
        limit: &Limit<'_>,
    ) -> anyhow::Result<Option<PairProblem>> {
        let known = [0, 1].map(|side| self.features[self.list(side)][bodies[side]].clone());
        let is_known = bodies[0] != bodies[1] && known.iter().all(Option::is_some);
        let count = |side: usize| self.world.bodies[bodies[side]].count(self.kinds[side]);
        let features = if is_known { 0 } else { count(0) + count(1) };
        let world = Arc::clone(self.world);
        let build = move || PairProblem::of(&world, bodies, known);
        let built = building::within_limit(features, || limit.is_reached(), build)?;
        let Some((problem, made)) = built.transpose()? else {
            return Ok(None);
        };
        for (side, made) in made.into_iter().enumerate() {
            let list = self.list(side);
            let uses = &mut self.uses[list][bodies[side]];
            *uses -= 1;
            self.features[list][bodies[side]] = (*uses > 0).then_some(made);
        }
        Ok(Some(problem))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use satisfice::Cancel;
    use satisfice_collision::distance::PairKind;
    use satisfice_collision::{generate, io};

    use super::*;
    use crate::collide::arguments::Find;
    use crate::collide::inputs::Inputs;
    use crate::collide::scene::Request;

    /// Three balls beside each other, whose vertices are put in order in far more time than there is to the first look at the limit.
    fn balls(kind: PairKind, depth: u32) -> Arc<World> {
        let folder = tempfile::tempdir().unwrap();
        io::save_obj(
            &generate::icosphere(1.0, depth).unwrap(),
            folder.path().join("ball.obj"),
        )
        .unwrap();
        let body = |x: f64| format!("[[bodies]]\nmesh = \"ball.obj\"\nat = [{x:?}, 0.0, 0.0]\n");
        let path = folder.path().join("balls.toml");
        std::fs::write(&path, body(0.0) + &body(1.9) + &body(3.8)).unwrap();
        let request = Request {
            inputs: Inputs {
                paths: vec![path],
                ..Inputs::default()
            },
            kind,
            threshold: 0.3,
            within: false,
            ring_width: None,
            find: Find::All,
            solid: false,
        };
        Arc::new(World::read(request).unwrap())
    }

    #[test]
    fn ctrl_c_ends_the_making_of_a_problem() {
        let world = balls(PairKind::VertexVertex, 6);
        let cancel = Cancel::new();
        let limit = Limit::new(None, &cancel);
        cancel.cancel();
        let mut problems = Problems::new(&world, &[[0, 1], [1, 2]]);
        assert!(problems.next([0, 1], &limit).unwrap().is_none());
    }

    #[test]
    fn features_are_kept_until_the_last_couple_of_their_body() {
        let cancel = Cancel::new();
        let limit = Limit::new(None, &cancel);
        for kind in PairKind::ALL {
            let world = balls(kind, 1);
            let couples = Couples::of(&world, &mut world.measure().unwrap()).unwrap();
            let orders = if world.kinds().0 == world.kinds().1 { 1 } else { 2 };
            assert_eq!((couples.near.len(), couples.apart), (2 * orders, orders as u64));
            let mut problems = Problems::new(&world, &couples.near);
            let kept = |problems: &Problems<'_>| problems.features.iter().flatten().flatten().count();
            for &bodies in &couples.near {
                let made = problems.next(bodies, &limit).unwrap().unwrap();
                let alone = PairProblem::new(&world, bodies).unwrap();
                assert_eq!(made.problem.exact_pairs(), alone.problem.exact_pairs(), "{kind}");
                assert!(kept(&problems) <= 3, "{kind}");
            }
            assert_eq!(kept(&problems), 0, "{kind}");
        }
    }
}
