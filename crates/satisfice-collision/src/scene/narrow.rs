//! The pairs of features of two bodies, or of one with itself, by a plan.

use super::extent::largest;
use super::filter::PairFilter;
use super::pairs::{Record, Status};
use super::plan::{Plan, Situation};
use super::state::{Present, State};
use super::{Skips, World};
use crate::broad::{Dirty, Pair, PairQuery, PointGrid, TreeJoin, Watch, inflate, intersection};
use crate::distance::{self, PairKind, Point, Threshold};
use crate::{Error, Placement};

/// The memory that a thread needs to find pairs.
#[derive(Default)]
pub(super) struct Workspace {
    grid: PointGrid,
    pub(super) join: TreeJoin,
    posed: [PosedShapes; 2],
}

impl Workspace {
    pub(super) fn new(parallel: bool) -> Self {
        let (grid, join) = match parallel {
            true => (PointGrid::parallel(), TreeJoin::parallel()),
            false => (PointGrid::new(), TreeJoin::new()),
        };
        Self {
            grid,
            join,
            posed: Default::default(),
        }
    }

    /// Forgets the posed vertices: their body has another mesh now.
    pub(super) fn forget(&mut self) {
        self.posed.iter_mut().for_each(|posed| posed.of = None);
    }
}

/// The vertices of a body in the world.
#[derive(Default)]
struct PosedShapes {
    /// The body, and the frame in which it moved there.
    of: Option<(u32, u32, u64)>,
    points: Vec<Point>,
}

impl PosedShapes {
    fn points<'p>(&'p mut self, slot: u32, state: Present<'p>) -> &'p [Point] {
        if state.is_unplaced() {
            return state.state().vertices();
        }
        let of = Some((slot, state.generation(), state.moved_at()));
        if self.of != of {
            self.points.clear();
            let placement = state.placement();
            let posed = state.vertices().iter().map(|&p| placement.apply(p));
            self.points.extend(posed);
            self.of = of;
        }
        &self.points
    }
}

/// The result for a record.
pub(super) struct Found {
    pub(super) pairs: Vec<Pair>,
    pub(super) skips: Skips,
    /// Whether a new grid found fewer pairs than there are vertices.
    pub(super) sparse: Option<bool>,
}

impl World {
    /// The situation of a record, from which its plan follows.
    pub(super) fn situation(&self, record: &Record) -> Situation {
        let [a, b] = record.bodies;
        let (one, two) = (self.state(a), self.state(b));
        let (kind_a, kind_b) = self.kind.features();
        Situation {
            method: self.method,
            status: record.status,
            is_one_body: a == b,
            is_apart: self.boxes_apart(record.bodies),
            is_points: self.kind == PairKind::VertexVertex,
            trees_pay: [(one, kind_a), (two, kind_b)]
                .iter()
                .all(|(state, kind)| state.deforming.is_none() && state.mesh.pays_for_tree(*kind)),
            moved_share: one.moved_share(self.frame).max(two.moved_share(self.frame)),
            sparse: record.sparse,
        }
    }

    /// Whether the inflated boxes of two bodies do not meet.
    pub(super) fn boxes_apart(&self, [a, b]: [u32; 2]) -> bool {
        let bounds = |slot| self.state(slot).bounds();
        a != b && intersection(&bounds(a), &inflate(&bounds(b), self.threshold.get())).is_none()
    }

    /// Whether the hulls of two bodies that are not turned show that their inflated boxes do not meet.
    pub(super) fn hulls_apart(&self, bodies: [u32; 2]) -> bool {
        let [a, b] = bodies.map(|slot| {
            let (whereabouts, hull) = (&self.whereabouts[slot as usize], &self.hulls[slot as usize]);
            let place = whereabouts.present(self.frame);
            let is_known = whereabouts.is_upright(place) && !hull.is_empty();
            is_known.then(|| (whereabouts.translation(place), hull))
        });
        let (Some((at, one)), Some((to, two))) = (a, b) else {
            return false;
        };
        let [low, high] = [two.min, two.max].map(|corner| corner.map(f64::from));
        let [least, most] = [one.min, one.max].map(|corner| corner.map(f64::from));
        // more than rounding moves the sides of posed boxes
        let far = [&at, &to, &low, &high, &least, &most].map(largest);
        let apart = self.threshold.get() * (1.0 + 1e-12) + 1e-13 * far.iter().sum::<f64>();
        (0..3).any(|k| {
            let way = to[k] - at[k];
            (way + low[k] - most[k]).max(least[k] - high[k] - way) > apart
        })
    }

    /// Finds the pairs of a record, or those found before the watch stops it. The trees of the plan exist.
    pub(super) fn find(
        &self,
        record: &Record,
        plan: Plan,
        space: &mut Workspace,
        watch: &Watch<'_>,
    ) -> Result<Found, Error> {
        let mut skips = Skips::default();
        let found = |pairs| Found {
            pairs,
            skips: Skips::default(),
            sparse: None,
        };
        Ok(match plan {
            Plan::Unchanged => found(record.pairs.clone()),
            Plan::Apart => found(Vec::new()),
            Plan::Grid => self.by_grid(record, space, watch)?,
            Plan::All => {
                let pairs = self.by_tree(record, true, space, &mut skips, watch)?;
                Found {
                    skips,
                    ..found(pairs)
                }
            }
            Plan::Tree => {
                let [a, b] = record.bodies;
                let pairs = self.by_tree(record, false, space, &mut skips, watch)?;
                let vertices = self.state(a).vertices().len();
                Found {
                    skips,
                    sparse: (a == b && pairs.len() > vertices).then_some(false),
                    ..found(pairs)
                }
            }
        })
    }

    fn by_grid(&self, record: &Record, space: &mut Workspace, watch: &Watch<'_>) -> Result<Found, Error> {
        let [a, b] = record.bodies;
        let (one, two) = (self.state(a), self.state(b));
        let Workspace { grid, posed, .. } = space;
        let [posed_a, posed_b] = posed;
        let points = posed_a.points(a, one);
        let pairs = if a == b {
            grid.within_until(points, one.blocks(), self.threshold, watch)?
        } else {
            grid.between_until(points, posed_b.points(b, two), self.threshold, watch)?
        };
        let filter = PairFilter::new(self.kind, one.state(), two.state(), a == b);
        let mut kept = Vec::new();
        let sparse = pairs.len() < one.vertices().len();
        if filter.is_needed() {
            kept.reserve(pairs.len());
            kept.extend(pairs.iter().copied().filter(|&pair| filter.keeps(pair)));
        } else {
            kept.extend_from_slice(pairs);
        }
        let work = grid.work();
        let mut skips = Skips {
            outside_overlap: work.clipped,
            without_partner: work.isolated,
            ..Skips::default()
        };
        filter.count(&mut skips);
        Ok(Found {
            pairs: kept,
            skips,
            sparse: Some(sparse),
        })
    }

    /// By trees, or by deciding every pair. Known pairs of the last frame of which neither feature moved are kept.
    fn by_tree(
        &self,
        record: &Record,
        all: bool,
        space: &mut Workspace,
        skips: &mut Skips,
        watch: &Watch<'_>,
    ) -> Result<Vec<Pair>, Error> {
        let [a, b] = record.bodies;
        let (one, two) = (self.state(a), self.state(b));
        let (kind_a, kind_b) = self.kind.features();
        let filter = PairFilter::new(self.kind, one.state(), two.state(), a == b);
        let keep: &(dyn Fn(u32, u32) -> bool + Sync) = &|i, j| filter.keeps(Pair { a: i, b: j });
        let places = self.places(record.bodies);
        let Some(mut query) = self.pair_query(record.bodies, &places, self.threshold, &filter, keep) else {
            return Ok(Vec::new());
        };
        if all {
            // the filter counts what it leaves out, as the descent of trees does
            (query.keep, query.shares_mesh) = (filter.is_needed().then_some(keep), false);
            space.join.brute_force(&query, watch);
            let pairs = space.join.take_pairs();
            filter.count(skips);
            return Ok(pairs);
        }
        let moved = [one.moved(self.frame, kind_a), two.moved(self.frame, kind_b)];
        let is_partial = record.status == Status::Behind && moved != [Dirty::All; 2];
        if is_partial {
            query.moved = moved;
        }
        space.join.all(&query, watch);
        let mut pairs = space.join.take_pairs();
        skips.mesh_neighbours += space.join.work().neighbours;
        if is_partial {
            let rests = |state: &State, kind, moved, feature| match moved {
                Dirty::None => true,
                Dirty::All => false,
                Dirty::Marked => state.tree(kind).is_some_and(|tree| !tree.has_moved(feature)),
            };
            let found = pairs.len();
            let known = record.pairs.iter().copied();
            pairs.extend(known.filter(|pair| {
                rests(&one, kind_a, moved[0], pair.a) && rests(&two, kind_b, moved[1], pair.b)
            }));
            skips.unmoved_pairs += (pairs.len() - found) as u64;
            pairs.sort_unstable();
        }
        filter.count(skips);
        Ok(pairs)
    }

    /// Where two bodies are.
    pub(super) fn places(&self, bodies: [u32; 2]) -> [Placement; 2] {
        bodies.map(|slot| self.state(slot).placement())
    }

    /// The query for two bodies in their places, whose trees exist.
    pub(super) fn pair_query<'a>(
        &'a self,
        [a, b]: [u32; 2],
        [place_a, place_b]: &'a [Placement; 2],
        threshold: Threshold,
        filter: &PairFilter<'_>,
        keep: &'a (dyn Fn(u32, u32) -> bool + Sync),
    ) -> Option<PairQuery<'a>> {
        let (one, two) = (self.state(a), self.state(b));
        let (kind_a, kind_b) = self.kind.features();
        let shares_mesh = filter.is_by_mesh();
        Some(PairQuery {
            a: (one.state().tree(kind_a)?, place_a),
            b: (two.state().tree(kind_b)?, place_b),
            one_body: a == b && kind_a == kind_b,
            threshold,
            keep: (filter.is_needed() && !shares_mesh).then_some(keep),
            moved: [Dirty::All; 2],
            shares_mesh,
        })
    }

    /// Whether a pair of features of two bodies is within the threshold now: the exact decision.
    pub(super) fn decide(&self, [a, b]: [u32; 2], pair: Pair) -> bool {
        let (kind_a, kind_b) = self.kind.features();
        let (a, b) = (self.state(a), self.state(b));
        distance::within(&a.shape(kind_a, pair.a), &b.shape(kind_b, pair.b), self.threshold)
    }

    /// Builds the trees of two bodies, which are up to date, that would be built when they are used.
    pub(super) fn build_shared_trees(&self, [a, b]: [u32; 2]) {
        let (kind_a, kind_b) = self.kind.features();
        self.state(a).tree(kind_a);
        self.state(b).tree(kind_b);
    }

    /// Brings the trees of two bodies up to date.
    pub(super) fn ensure_trees(&mut self, [a, b]: [u32; 2]) -> Result<(), Error> {
        let (kind_a, kind_b) = self.kind.features();
        let parallel = self.parallel;
        self.state_mut(a).ensure_tree(kind_a, parallel)?;
        self.state_mut(b).ensure_tree(kind_b, parallel)
    }
}
