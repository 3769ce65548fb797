//! The exact engine: regions of the space, best first, excluded by the problem's lower bounds.

use std::collections::BinaryHeap;

use super::region_tree::{Node, Split, Splitter};
use crate::batch::{Batch, Outcome};
use crate::context::{Context, points_at_once};
use crate::engine::compiled::both_scalars;
use crate::engine::{Answers, Ask, Engine, EngineConfig, Origin};
use crate::error::Error;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::{Region, Space};
use crate::state::{Reader, Saved, State};
use crate::{engine_choice, engine_settings};

engine_choice! {
    /// The axis on which [`BranchAndBound`] splits a region.
    pub enum SplitRule {
        /// The longest, relative to the length of the whole axis.
        Longest = "longest",
        /// The first that is not fixed.
        First = "first",
    }
}

engine_settings! {
    /// Branch and bound for all points with F < delta.
    ///
    /// A region is closed if its bound is at least delta, if one hit [covers](Context::covers) it, or, once it holds at most `leaf`
    /// points, by proposing all of them. Other regions are split in two, least bound first, then least F at a point inside (on
    /// continuous axes only, where these points find the hits), then latest first. Until the first leaf, which is far on a large
    /// permutation, a point inside the next region is evaluated now and then. When no region is left, every hit is in C or the
    /// same answer as one in C: [`Ask::Covered`].
    ///
    /// * On integer axes and permutations this always happens. Without bounds it is an enumeration, in the order of halving: completeness `Proved`,
    ///   `bound_calls` 0.
    /// * On continuous axes a region has to be excluded, or to lie within the separation of one hit. Where F equals delta
    ///   without falling below it, or where the problem does not say what a hit covers, regions shrink to `resolution`. Those that no
    ///   later hit covers are given up, and the engine ends with [`Ask::Exhausted`], completeness `Unknown`.
    ///
    /// Draws no random numbers. Memory: per region 2 D numbers and about 60 bytes, up to `regions` regions or 2^25 numbers; deeper
    /// regions are then processed depth first, in as much memory again. With thousands of axes even that does not suffice: regions that
    /// do not fit are given up after one point inside, and completeness is `Unknown`. Source: Land, Doig 1960, doi 10.2307/1910129.
    ///
    /// ```
    /// use satisfice::{Budget, Completeness, Search, Space, engine::BranchAndBound, from_fn};
    /// let disc = from_fn(Space::lattice(2, 100)?, 10.0, |x: &[f64]| (x[0] - 50.0).hypot(x[1] - 20.0));
    /// let engine = BranchAndBound { leaf: 16, ..Default::default() };
    /// let report = Search::with(engine).run(&disc, &Budget::evaluations(20000))?;
    /// assert_eq!((report.hit_count(), report.completeness), (305, Completeness::Proved));
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    pub struct BranchAndBound {
        /// An integer region of at most this many points is enumerated.
        pub leaf: usize = 32, 1..=1 << 20;
        /// Points per batch, approximately.
        pub batch: usize = 64, 1..=1 << 20;
        /// Regions kept in best-first order; beyond that, depth first in bounded memory.
        pub regions: usize = 1 << 20, 1..=1 << 30;
        /// The axis to split: the longest relative to the whole axis, or the first that is not fixed.
        pub split: SplitRule = SplitRule::Longest;
        /// A region shorter than this share of every continuous axis, by logarithms on a logarithmic one, is given up unproved.
        pub resolution: f64 = 1e-12, 0.0..=1.0;
    }
}

impl EngineConfig for BranchAndBound {
    const NAME: &'static str = "branch-and-bound";
    const SUMMARY: &'static str =
        "exact: best-first over regions by the problem's lower bounds; enumeration where there are none";
    const CITATION: &'static str = "Land, Doig 1960, doi 10.2307/1910129";

    both_scalars!();
}

impl BranchAndBound {
    #[expect(clippy::cast_precision_loss, reason = "at most 2^20")]
    pub(in crate::engine) fn search<S: Real>(&self) -> RegionSearch<S> {
        RegionSearch {
            leaf: self.leaf as f64,
            batch: self.batch,
            regions: self.regions,
            splitter: Splitter {
                first: self.split == SplitRule::First,
                resolution: S::of(self.resolution),
            },
            started: false,
            best_first: BinaryHeap::new(),
            depth_first: Vec::new(),
            proposed: Vec::new(),
            too_small: Vec::new(),
            next_index: 0,
            enumerated: false,
            given_up: false,
        }
    }

    fn engine<S: Real>(&self) -> Box<dyn Engine<S>> {
        Box::new(self.search())
    }
}

/// Regions that are kept until points of the next ones are evaluated, if none has been enumerated by then.
const LONG_WAY: u64 = 256;
/// Points tried in a region to find one that is not in C.
const ATTEMPTS: u64 = 4;
/// Coordinates of regions in best-first order, at most, and of those that are processed depth first: 256 MB each.
const MOST_COORDINATES: usize = 1 << 25;

/// The engine of [`BranchAndBound`].
#[derive(Debug)]
pub(in crate::engine) struct RegionSearch<S> {
    leaf: f64,
    batch: usize,
    regions: usize,
    splitter: Splitter<S>,
    started: bool,
    best_first: BinaryHeap<Node<S>>,
    /// Regions that did not fit there; processed first.
    depth_first: Vec<Node<S>>,
    /// Regions with a proposed point, and its index in the batch.
    proposed: Vec<(usize, Node<S>)>,
    /// Regions at the limit of the resolution, examined again at the end.
    too_small: Vec<Node<S>>,
    next_index: u64,
    /// Whether a region has been closed by proposing all its points.
    enumerated: bool,
    given_up: bool,
}

impl<S: Real> RegionSearch<S> {
    /// Changes the number of points of the next batch.
    pub(in crate::engine) fn set_batch(&mut self, points: usize) {
        self.batch = points;
    }

    /// The bound of a region, at least its parent's; `None` if it excludes the region.
    fn bound(context: &dyn Context<S>, region: &Region<S>, parent: S) -> Option<S> {
        // `max` ignores NaN.
        let bound = context
            .lower_bound(region)
            .map_or(parent, |bound| parent.max(bound));
        (bound < context.threshold()).then_some(bound)
    }

    /// Keeps a region unless it is excluded; on continuous axes a point inside is proposed.
    fn enter(&mut self, context: &dyn Context<S>, region: Region<S>, parent: S, out: &mut Batch<S>) {
        let space = context.space();
        if space.has_permutations() && !space.order_inside(&region, &mut region.lower.clone()) {
            return;
        }
        let Some(bound) = Self::bound(context, &region, parent) else {
            return;
        };
        let index = self.next_index;
        self.next_index += 1;
        let node = Node {
            bound,
            guide: S::infinity(),
            index,
            region,
        };
        let room = MOST_COORDINATES / (2 * space.dimension());
        if self.best_first.len() >= self.regions.min(room)
            && self.depth_first.len() + self.proposed.len() >= room
        {
            self.given_up = true;
            let mut point = node.inner_point(space, 0);
            space.positions(&mut point);
            out.push(&point);
            return;
        }
        if node.cardinality(space).is_some() {
            self.keep(space, node);
            return;
        }
        for attempt in 0..ATTEMPTS {
            let mut point = node.inner_point(space, attempt);
            space.positions(&mut point);
            if !context.is_deleted(&point) {
                self.proposed.push((out.len(), node));
                out.push(&point);
                return;
            }
        }
        self.keep(space, node);
    }

    fn keep(&mut self, space: &Space<S>, node: Node<S>) {
        if self.best_first.len() < self.regions.min(MOST_COORDINATES / (2 * space.dimension())) {
            self.best_first.push(node);
        } else {
            self.depth_first.push(node);
        }
    }

    /// Proposes a point inside the next region, if its points are countable: others have had one.
    fn look_ahead(&self, context: &dyn Context<S>, out: &mut Batch<S>) {
        let space = context.space();
        let next = self.depth_first.last().or_else(|| self.best_first.peek());
        let Some(node) = next.filter(|node| node.cardinality(space).is_some()) else {
            return;
        };
        let mut point = node.exchanged_point(space);
        space.positions(&mut point);
        if context.evaluations_left() > 0 && !context.is_deleted(&point) {
            out.push(&point);
        }
    }

    /// Closes a region or splits it.
    fn open(&mut self, context: &dyn Context<S>, node: Node<S>, out: &mut Batch<S>) {
        let space = context.space();
        if context.covers(&node.region) {
            return;
        }
        if node.cardinality(space).is_some_and(|points| points <= self.leaf) {
            node.each_point(space, |point| out.push(point));
            self.enumerated = true;
            return;
        }
        match self.splitter.split(space, &node.region) {
            Split::Halves(lower, upper) => {
                // Among equals, the later one comes first.
                self.enter(context, upper, node.bound, out);
                self.enter(context, lower, node.bound, out);
            }
            Split::TooSmall => {
                if self.too_small.len() >= self.regions && !self.given_up {
                    self.too_small.retain(|node| !context.covers(&node.region));
                }
                if self.too_small.len() < self.regions {
                    self.too_small.push(node);
                } else {
                    self.given_up = true;
                }
            }
        }
    }
}

impl<S: Real> Engine<S> for RegionSearch<S> {
    fn begin(&mut self, _context: &dyn Context<S>) {
        self.started = false;
        self.best_first.clear();
        self.depth_first.clear();
        self.proposed.clear();
        self.too_small.clear();
        self.next_index = 0;
        self.enumerated = false;
        self.given_up = false;
    }

    fn ask(&mut self, context: &dyn Context<S>, _: &mut SearchRng, out: &mut Batch<S>) -> Ask {
        if !self.started {
            self.started = true;
            self.enter(context, context.space().region(), S::neg_infinity(), out);
        }
        // Few enough that the clock is read in between, and no more than the points that are wanted at once.
        let work = points_at_once(context.space().dimension()) / 4;
        for _ in 0..work.min(self.batch).max(1) {
            if context.is_out_of_time() {
                return Ask::More;
            }
            let next = self.depth_first.pop().or_else(|| self.best_first.pop());
            let Some(node) = next else { break };
            self.open(context, node, out);
            if out.len() >= self.batch || out.len() as u64 >= context.evaluations_left() {
                break;
            }
        }
        if self.depth_first.len() + self.best_first.len() + self.proposed.len() > 0 {
            if out.is_empty() && !self.enumerated && self.next_index >= LONG_WAY {
                self.look_ahead(context, out);
            }
            return Ask::More;
        }
        // Hits found since may cover regions that were too small to split.
        self.too_small.retain(|node| !context.covers(&node.region));
        if self.given_up || !self.too_small.is_empty() {
            Ask::Exhausted
        } else {
            Ask::Covered
        }
    }

    fn tell(&mut self, context: &dyn Context<S>, _: &Batch<S>, outcomes: &[Outcome<S>], origin: Origin) {
        if origin != Origin::Engine {
            return;
        }
        for (place, mut node) in core::mem::take(&mut self.proposed) {
            node.guide = outcomes
                .get(place)
                .map_or(S::infinity(), |outcome| outcome.fitness());
            self.keep(context.space(), node);
        }
    }

    fn answers(&self) -> Answers {
        Answers::Alone
    }

    fn save(&self, state: &mut State) {
        self.started.save(state);
        // The order in the heap does not matter: nodes are totally ordered.
        self.best_first.save(state);
        self.depth_first.save(state);
        self.proposed.save(state);
        self.too_small.save(state);
        self.next_index.save(state);
        self.enumerated.save(state);
        self.given_up.save(state);
    }

    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        self.started = from.read()?;
        self.best_first = from.read()?;
        self.depth_first = from.read()?;
        self.proposed = from.read()?;
        self.too_small = from.read()?;
        self.next_index = from.read()?;
        self.enumerated = from.read()?;
        self.given_up = from.read()?;
        Ok(())
    }
}

#[cfg(test)]
mod tests;
