//! The referee: which pairs a scene has, by another method than those that find them. Boxes of bodies, then of their features, are
//! swept along an axis, and the pairs of near features are decided one by one; there are no trees, cells or bounds.

use std::cell::OnceCell;

use satisfice_collision::distance::{self, PairKind, Threshold};
use satisfice_collision::{Aabb, Adjacency, FeatureKind, Shape};

use super::super::body::NamedBody;
use super::super::scene::{Feature, Pair, World};
use super::sweep::{Effort, SweepEnd, are_near, sweep};

/// Looking for all pairs may take about so many nanoseconds.
const PATIENCE: u64 = 5_000_000_000;

pub(super) struct Referee<'a> {
    world: &'a World,
    bounds: Vec<Aabb>,
    /// The boxes of the features of each body, of the first and of the second kind of a pair, where they were asked for.
    boxes: [Vec<OnceCell<Vec<Aabb>>>; 2],
    /// The vertices of each body that belong to no pair since few edges join them, where they were asked for.
    rings: Vec<OnceCell<Adjacency>>,
}

impl<'a> Referee<'a> {
    pub(super) fn new(world: &'a World) -> Self {
        let bodies = world.bodies.len();
        let boxes = || (0..bodies).map(|_| OnceCell::new()).collect();
        Self {
            world,
            bounds: world.bodies.iter().map(NamedBody::bounds).collect(),
            boxes: [boxes(), boxes()],
            rings: (0..bodies).map(|_| OnceCell::new()).collect(),
        }
    }

    fn kinds(&self) -> [FeatureKind; 2] {
        self.world.kinds().into()
    }

    /// Whether this is a pair of features of the scene, the lesser first.
    pub(super) fn is_pair(&self, pair: &Pair) -> bool {
        self.has(pair) && (pair.a.body != pair.b.body || self.is_pair_within(pair))
    }

    /// The same of pairs that count as none as well, since their features are joined.
    pub(super) fn has(&self, pair: &Pair) -> bool {
        let [kind_a, kind_b] = self.kinds();
        let exists = |Feature { body, feature }: Feature, kind: FeatureKind| {
            let body = self.world.bodies.get(body as usize);
            body.is_some_and(|body| (feature as usize) < body.count(kind))
        };
        exists(pair.a, kind_a)
            && exists(pair.b, kind_b)
            && self.world.is_couple(pair.bodies())
            && (pair.a.body != pair.b.body || kind_a != kind_b || pair.a.feature < pair.b.feature)
    }

    /// Whether two features that one body has are a pair: the lesser first, and not joined.
    fn is_pair_within(&self, pair: &Pair) -> bool {
        let body = pair.a.body as usize;
        let mesh = self.world.bodies[body].unplaced();
        let [kind_a, kind_b] = self.kinds();
        let rings = self.rings[body].get_or_init(|| mesh.adjacency().rings(self.world.ring_width()));
        let corners = |kind, feature| mesh.features(kind).corners(feature);
        let others = corners(kind_b, pair.b.feature);
        let are_joined = |v: u32| others.iter().any(|&w| v == w || rings.contains(v, w));
        (kind_a != kind_b || pair.a.feature < pair.b.feature)
            && !corners(kind_a, pair.a.feature).into_iter().any(are_joined)
    }

    /// The features of a pair that there is.
    pub(super) fn shapes(&self, pair: &Pair) -> [Shape; 2] {
        let [kind_a, kind_b] = self.kinds();
        [self.shape(pair.a, kind_a), self.shape(pair.b, kind_b)]
    }

    fn shape(&self, Feature { body, feature }: Feature, kind: FeatureKind) -> Shape {
        self.world.bodies[body as usize].shape(kind, feature)
    }

    /// Calls `visit` with each pair closer than `below`. If it returns `false`, the other pairs of these two bodies are left out.
    /// Returns whether all were visited, which is not so where that would take too long.
    pub(super) fn each_pair(&self, below: Threshold, visit: &mut dyn FnMut(Pair) -> bool) -> bool {
        self.each_pair_until(&mut Effort::new(PATIENCE), below, visit)
    }

    fn each_pair_until(
        &self,
        effort: &mut Effort,
        below: Threshold,
        visit: &mut dyn FnMut(Pair) -> bool,
    ) -> bool {
        let mut of_bodies = |a: usize, b: usize, effort: &mut Effort| {
            if !self.world.is_couple([a, b]) {
                return Ok(());
            }
            match self.pairs_of(a, b, below, effort, visit) {
                Err(SweepEnd::Enough) => Ok(()),
                ended => ended,
            }
        };
        sweep(&self.bounds, &self.bounds, below.get(), effort, &mut of_bodies).is_ok()
    }

    fn pairs_of(
        &self,
        a: usize,
        b: usize,
        below: Threshold,
        effort: &mut Effort,
        visit: &mut dyn FnMut(Pair) -> bool,
    ) -> Result<(), SweepEnd> {
        let [near_a, near_b] = [(0, a, b), (1, b, a)].map(|(side, body, other)| {
            let boxes = self.boxes_of(side, body);
            let near = (0..)
                .zip(boxes)
                .filter(|(_, of)| are_near(of, &self.bounds[other], below.get()));
            near.map(|(feature, of): (u32, _)| (feature, *of))
                .unzip::<_, _, Vec<_>, Vec<_>>()
        });
        effort.spend((self.boxes_of(0, a).len() + self.boxes_of(1, b).len()) as u64)?;
        let cost = match self.world.request.kind {
            PairKind::VertexVertex => 10,
            PairKind::VertexEdge | PairKind::VertexTriangle | PairKind::EdgeEdge => 40,
            PairKind::EdgeTriangle | PairKind::TriangleTriangle => 200,
        };
        let mut decide = |i: usize, j: usize, effort: &mut Effort| {
            let side = |body: usize, feature| Feature {
                body: body as u32,
                feature,
            };
            let pair = Pair {
                a: side(a, near_a.0[i]),
                b: side(b, near_b.0[j]),
            };
            effort.spend(cost)?;
            if a == b && !self.is_pair_within(&pair) {
                return Ok(());
            }
            let [one, two] = self.shapes(&pair);
            if distance::within(&one, &two, below) && !visit(pair) {
                return Err(SweepEnd::Enough);
            }
            Ok(())
        };
        sweep(&near_a.1, &near_b.1, below.get(), effort, &mut decide)
    }

    fn boxes_of(&self, side: usize, body: usize) -> &[Aabb] {
        let kinds = self.kinds();
        // One list serves both features if they are of one kind.
        let side = if kinds[0] == kinds[1] { 0 } else { side };
        self.boxes[side][body].get_or_init(|| {
            let shape = |feature| {
                let body = body as u32;
                self.shape(Feature { body, feature }, kinds[side]).bounds()
            };
            (0..self.world.bodies[body].count(kinds[side]) as u32)
                .map(shape)
                .collect()
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use std::collections::BTreeSet;
    use std::path::PathBuf;

    use satisfice_collision::broad::Method;
    use satisfice_collision::{Placement, generate, io};

    use super::*;
    use crate::collide::arguments::Find;
    use crate::collide::inputs::Inputs;
    use crate::collide::scene::Request;

    fn world(paths: Vec<PathBuf>, kind: PairKind, threshold: f64, within: bool) -> World {
        let request = Request {
            inputs: Inputs {
                paths,
                ..Inputs::default()
            },
            kind,
            threshold,
            within,
            ring_width: None,
            find: Find::All,
            solid: false,
        };
        World::read(request).unwrap()
    }

    #[test]
    fn the_referee_finds_what_brute_force_does() {
        let folder = tempfile::tempdir().unwrap();
        let save = |name: &str, x: f64| {
            let path = folder.path().join(name);
            let ball = generate::icosphere(1.0, 1).unwrap();
            let there = Placement::from_translation([x, 0.1 * x, 0.0]).unwrap();
            io::save_obj(&there.place(&ball).unwrap(), &path).unwrap();
            path
        };
        let paths = vec![
            save("a.obj", 0.0),
            save("b.obj", 1.7),
            save("c.obj", -0.4),
            save("far.obj", 9.0),
        ];
        for kind in PairKind::ALL {
            for (threshold, within) in [(0.3, false), (0.4, true)] {
                let world = world(paths.clone(), kind, threshold, within);
                let mut scene = world.scene(Method::BruteForce).unwrap();
                let frame = scene.frame().unwrap();
                let expected: BTreeSet<Pair> = world.pairs(frame.contacts.iter().copied()).collect();
                let referee = Referee::new(&world);
                let mut found = BTreeSet::new();
                let all = referee.each_pair(world.threshold, &mut |pair| found.insert(pair));
                assert_eq!(found, expected, "{kind} {within}");
                assert!(all && !found.is_empty(), "{kind} {within}");
                assert!(found.iter().all(|pair| referee.is_pair(pair)));
            }
        }
    }

    #[test]
    fn the_work_does_not_grow_with_the_square_of_the_bodies() {
        let folder = tempfile::tempdir().unwrap();
        io::save_obj(
            &generate::icosphere(0.6, 0).unwrap(),
            folder.path().join("ball.obj"),
        )
        .unwrap();
        let work = |side: usize| {
            let numbers = || (0..side).map(|n| n as f64);
            let mut list = String::new();
            for (x, y) in numbers().flat_map(|x| numbers().map(move |y| (x, y))) {
                list += &format!("[[bodies]]\nmesh = \"ball.obj\"\nat = [{x:?}, {y:?}, 0.0]\n");
            }
            let path = folder.path().join("list.toml");
            std::fs::write(&path, list).unwrap();
            let world = world(vec![path], PairKind::TriangleTriangle, 0.1, false);
            let mut effort = Effort::new(u64::MAX);
            assert!(Referee::new(&world).each_pair_until(&mut effort, world.threshold, &mut |_| false));
            (u64::MAX - effort.left()) as f64
        };
        let (few, many) = (work(6), work(24));
        // Sixteen times as many bodies, of which each has the same neighbours; all pairs would be 256 times as many.
        assert!(many < 40.0 * few, "{few} {many}");
    }
}
