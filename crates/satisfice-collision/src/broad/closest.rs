//! The closest pairs of features of two posed trees, best first: the pairs of boxes with the least gap are opened first, until
//! no gap is left below the distances found (Hjaltason and Samet 1998, doi:10.1145/276304.276326, for pairs).
//!
//! Equal distances are ordered by number. Boxes cannot tell them apart, so that a search that goes on for long also asks for the
//! numbers in a subtree: see [`Subtrees`].

mod subtrees;

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::boxes::{Dirty, Group};
use super::features::FeatureTree;
use super::gaps::Gaps;
use super::pair::Pair;
use super::pair_query::{Keep, PairQuery};
use super::traverse::{Trees, Visit, next};
use super::watch::Watch;
use crate::distance::{self, ACCURACY, Proximity, Threshold};
use crate::simd::{Lanes, Work, dispatch};
use crate::{Error, Placement, Shape};
use subtrees::Subtrees;

/// Visits between two looks at the watch.
const LOOK: u64 = 256;

/// A result, ordered by distance, then by key.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ranked<T> {
    pub(crate) distance: f64,
    pub(crate) key: T,
}

impl<T: Ord> Eq for Ranked<T> {}

impl<T: Ord> Ord for Ranked<T> {
    fn cmp(&self, other: &Self) -> Ordering {
        self.distance
            .total_cmp(&other.distance)
            .then_with(|| self.key.cmp(&other.key))
    }
}

impl<T: Ord> PartialOrd for Ranked<T> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The closest results of any number of searches: at most a given number, all below a cutoff if there is one.
#[derive(Debug)]
pub(crate) struct Closest<T> {
    wanted: usize,
    cutoff: Option<Threshold>,
    /// Whether one at distance 0 is as good as any other.
    any_contact: bool,
    found: BinaryHeap<Ranked<T>>,
}

impl<T: Ord + Copy> Closest<T> {
    /// The `wanted` closest by distance, then by key.
    pub(crate) fn new(wanted: usize, cutoff: Option<Threshold>) -> Self {
        Self {
            wanted,
            cutoff,
            any_contact: false,
            found: BinaryHeap::new(),
        }
    }

    /// One at the least distance; if several are at distance 0, whichever is found first.
    pub(crate) fn any() -> Self {
        Self {
            any_contact: true,
            ..Self::new(1, None)
        }
    }

    /// Results further away than this no longer matter.
    pub(crate) fn bound(&self) -> f64 {
        let last = self.found.peek().filter(|_| self.found.len() >= self.wanted);
        let cutoff = self.cutoff.map_or(f64::INFINITY, Threshold::get);
        last.map_or(cutoff, |last| last.distance)
    }

    /// Whether no further result can change the answer.
    pub(crate) fn is_settled(&self) -> bool {
        self.wanted == 0 || (self.any_contact && self.found.len() == 1 && self.bound() == 0.0)
    }

    /// Whether results at this distance with this key, or beyond, no longer matter.
    pub(crate) fn excludes(&self, distance: f64, key: T) -> bool {
        let last = self.found.peek().filter(|_| self.found.len() >= self.wanted);
        last.is_some_and(|last| Ranked { distance, key } >= *last)
    }

    /// Adds a pair if it is close enough.
    fn offer(&mut self, a: &Shape, b: &Shape, key: T) {
        if self.excludes(0.0, key) || distance::measure(a, b) * (1.0 - 2.0 * ACCURACY) > self.bound() {
            return;
        }
        if let Some(distance) = self.distance(a, b) {
            self.insert(distance, key);
        }
    }

    /// The distance of a pair; `None` beyond the cutoff.
    fn distance(&self, a: &Shape, b: &Shape) -> Option<f64> {
        let is_beyond = self.cutoff.is_some_and(|cutoff| !distance::within(a, b, cutoff));
        (!is_beyond).then(|| distance::proximity(a, b).distance)
    }

    fn insert(&mut self, distance: f64, key: T) {
        self.found.push(Ranked { distance, key });
        if self.found.len() > self.wanted {
            self.found.pop();
        }
    }

    /// The results, closest first.
    pub(crate) fn into_sorted(self) -> Vec<Ranked<T>> {
        self.found.into_sorted_vec()
    }
}

/// The `k` closest pairs of a feature of `a`, posed, and one of `b`, posed, that are kept, by distance, then by number; fewer if
/// there are fewer pairs. The distance is that of the posed coordinates as [`Placement::apply`] rounds them.
///
/// Cost: for small `k` usually logarithmic in the number of features; with thousands of equal distances, such as parallel faces
/// have, linear in these. Pairs at distance 0, and pairs of features that are several times at the same place, cost as much as
/// if there were `k` of them.
///
/// # Errors
/// [`Error::NonFiniteVertex`] if a pose takes a vertex out of range.
///
/// ```
/// use satisfice_collision::broad::{FeatureTree, closest_pairs};
/// use satisfice_collision::{FeatureKind, Placement, generate};
/// let ball = FeatureTree::new(&generate::icosphere(1.0, 3)?, FeatureKind::Triangle);
/// let there = Placement::from_translation([5.0, 0.0, 0.0])?;
/// let found = closest_pairs((&ball, &Placement::IDENTITY), (&ball, &there), 3, None)?;
/// assert_eq!(found.len(), 3);
/// assert!((found[0].1.distance - 3.0).abs() < 0.02);
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
pub fn closest_pairs(
    a: (&FeatureTree, &Placement),
    b: (&FeatureTree, &Placement),
    k: usize,
    keep: Keep<'_>,
) -> Result<Vec<(Pair, Proximity)>, Error> {
    let query = PairQuery {
        a,
        b,
        one_body: false,
        threshold: Threshold::LARGEST,
        keep,
        moved: [Dirty::All; 2],
        shares_mesh: false,
    };
    query.check()?;
    let mut closest = Closest::new(k, None);
    find_closest(&query, &mut closest, |pair| pair, &Watch::none());
    let found = closest.into_sorted().into_iter();
    let measured = found.map(|Ranked { key, .. }| {
        let [one, two] = query.shapes(key);
        (key, distance::proximity(&one, &two))
    });
    Ok(measured.collect())
}

/// Adds the closest pairs of a query, whose threshold does not matter, to what has been found elsewhere; those of before the
/// watch stopped it. Of two pairs, the lesser has the lesser key.
pub(crate) fn find_closest<T: Ord + Copy>(
    query: &PairQuery<'_>,
    closest: &mut Closest<T>,
    key: impl Fn(Pair) -> T,
    watch: &Watch<'_>,
) {
    query.in_common_frame(|trees, flip| {
        let way = (!query.one_body).then(|| query.composition(flip));
        let gaps = match &way {
            Some(way) => Gaps::new(way),
            None => Gaps::within(query),
        };
        let mut first = Vec::new();
        trees.start(&mut first);
        let open = first.into_iter().map(Open::first);
        dispatch(ClosestSearch {
            query,
            trees,
            flip,
            gaps,
            open: open.collect(),
            subtrees: None,
            closest,
            key,
            watch,
        });
    });
}

/// Two groups of boxes, or of items, that have not been compared yet.
struct Open {
    /// The bits of the square of a lower bound of their distance.
    gap: u64,
    /// Of equal gaps, the least comes first: the one nearest to the items, or the one with the least numbers.
    rank: u64,
    visit: Visit,
    /// The distance of all pairs of their items, where it is the same for all and known.
    distance: Option<f64>,
}

impl Open {
    fn first(visit: Visit) -> Self {
        Self {
            gap: 0,
            rank: 0,
            visit,
            distance: None,
        }
    }
}

impl Ord for Open {
    /// The greatest is opened first.
    fn cmp(&self, other: &Self) -> Ordering {
        (other.gap, other.rank, other.visit).cmp(&(self.gap, self.rank, self.visit))
    }
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Open {}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

struct ClosestSearch<'a, T, K> {
    query: &'a PairQuery<'a>,
    trees: Trees<'a>,
    flip: bool,
    gaps: Gaps,
    open: BinaryHeap<Open>,
    /// Looked through as soon as that costs no more than the visits made.
    subtrees: Option<[Subtrees; 2]>,
    closest: &'a mut Closest<T>,
    key: K,
    watch: &'a Watch<'a>,
}

impl<T: Ord + Copy, K: Fn(Pair) -> T> Work for ClosestSearch<'_, T, K> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self, _: L) {
        let items = (self.trees.a.len() + self.trees.b.len()) as u64;
        let mut visits = 0;
        let mut limit = self.gaps.limit(self.closest.bound());
        while let Some(open) = self.open.pop() {
            if f64::from_bits(open.gap) > limit || self.closest.is_settled() {
                return;
            }
            visits += 1;
            if visits % LOOK == 0 && self.watch.ask(0) {
                return;
            }
            if self.subtrees.is_none() && visits * 64 > items {
                self.look_through();
                self.push(open);
                continue;
            }
            if self.excludes(&open) {
                continue;
            }
            let visit = open.visit;
            let mut rooms = [Group::EMPTY; 2];
            let [room_a, room_b] = &mut rooms;
            let a = self.trees.a.group(visit.level_a, visit.a, room_a);
            let b = self.trees.b.group(visit.level_b, visit.b, room_b);
            let squares = self.gaps.squares(a, b);
            match visit.level_a.cmp(&visit.level_b) {
                Ordering::Equal if visit.level_a == 0 => limit = self.measure(&open, &squares, limit),
                Ordering::Equal => self.open_both(&open, &squares, limit),
                taller => self.open_one(&open, &squares, limit, taller == Ordering::Greater),
            }
        }
    }
}

impl<T: Ord + Copy, K: Fn(Pair) -> T> ClosestSearch<'_, T, K> {
    /// Looks through the subtrees, and orders by them what is open.
    fn look_through(&mut self) {
        let (a, b) = (self.query.a.0, self.query.b.0);
        let (first, second) = if self.flip { (b, a) } else { (a, b) };
        self.subtrees = Some([first, second].map(|tree| Subtrees::new(&tree.tree, |i| tree.shape(i))));
        for open in std::mem::take(&mut self.open) {
            self.push(open);
        }
    }

    /// Queues an entry unless nothing in it matters.
    fn push(&mut self, mut open: Open) {
        let visit = open.visit;
        open.rank = u64::from(visit.level_a) + u64::from(visit.level_b);
        if let Some([a, b]) = &self.subtrees {
            if open.distance.is_none()
                && a.is_uniform(visit.level_a, visit.a)
                && b.is_uniform(visit.level_b, visit.b)
            {
                let (i, j) = (a.least(visit.level_a, visit.a), b.least(visit.level_b, visit.b));
                match self.common_distance(i, j) {
                    Common::Beyond => return,
                    Common::At(distance) => open.distance = Some(distance),
                    Common::Unknown => {}
                }
            }
            if self.excludes(&open) {
                return;
            }
            if !self.closest.any_contact {
                let Pair { a, b } = self.least(visit).unwrap_or_default();
                open.rank = u64::from(a) << 32 | u64::from(b);
            }
        }
        self.open.push(open);
    }

    /// The distance of two items, each of which stands for all in its subtree.
    fn common_distance(&self, first: u32, second: u32) -> Common {
        let [one, two] = self.query.shapes(self.pair(first, second));
        match self.closest.distance(&one, &two) {
            None => Common::Beyond,
            // The first of a pair of one body may be in either subtree; rounding may tell them apart.
            Some(distance) if self.query.one_body && self.closest.distance(&two, &one) != Some(distance) => {
                Common::Unknown
            }
            Some(distance) => Common::At(distance),
        }
    }

    /// Whether distances and numbers prove that nothing below matters any more.
    fn excludes(&self, open: &Open) -> bool {
        self.least(open.visit).is_some_and(|least| {
            self.closest
                .excludes(open.distance.unwrap_or(0.0), (self.key)(least))
        })
    }

    /// No pair below a visit is less than this.
    fn least(&self, visit: Visit) -> Option<Pair> {
        let [a, b] = self.subtrees.as_ref()?;
        Some(self.pair(a.least(visit.level_a, visit.a), b.least(visit.level_b, visit.b)))
    }

    /// Items of the first and of the second tree as a pair.
    fn pair(&self, first: u32, second: u32) -> Pair {
        let swap = if self.query.one_body {
            first > second
        } else {
            self.flip
        };
        let (a, b) = if swap { (second, first) } else { (first, second) };
        Pair { a, b }
    }

    /// Measures the items of two groups, the closest boxes first. Returns the new limit.
    fn measure(&mut self, open: &Open, squares: &[[f64; 8]; 8], mut limit: f64) -> f64 {
        let at = open.visit;
        let mut wanted = self.trees.wanted(at);
        let mut near = [(0_u64, 0_usize, 0_usize); 64];
        let mut count = 0;
        while wanted != 0 {
            let (i, j) = next(&mut wanted);
            if squares[i][j] <= limit {
                near[count] = (squares[i][j].to_bits(), i, j);
                count += 1;
            }
        }
        near[..count].sort_unstable();
        let (ids_a, ids_b) = (
            &self.trees.a.order[at.a as usize * 8..],
            &self.trees.b.order[at.b as usize * 8..],
        );
        for &(gap, i, j) in &near[..count] {
            if f64::from_bits(gap) > limit || self.closest.is_settled() {
                break;
            }
            let pair = self.pair(ids_a[i], ids_b[j]);
            let key = (self.key)(pair);
            if self.closest.excludes(open.distance.unwrap_or(0.0), key) || !self.query.keeps(pair.a, pair.b) {
                continue;
            }
            if let Some(distance) = open.distance {
                self.closest.insert(distance, key);
            } else {
                let [one, two] = self.query.shapes(pair);
                self.closest.offer(&one, &two, key);
            }
            limit = self.gaps.limit(self.closest.bound());
        }
        limit
    }

    /// Opens both groups of two on the same level.
    fn open_both(&mut self, open: &Open, squares: &[[f64; 8]; 8], limit: f64) {
        let at = open.visit;
        let mut wanted = self.trees.wanted(at);
        while wanted != 0 {
            let (i, j) = next(&mut wanted);
            if squares[i][j] <= limit {
                let visit = Visit {
                    level_a: at.level_a - 1,
                    level_b: at.level_b - 1,
                    a: at.a * 8 + i as u32,
                    b: at.b * 8 + j as u32,
                };
                self.push_below(open, squares[i][j], visit);
            }
        }
    }

    /// Opens the group of the taller tree.
    fn open_one(&mut self, open: &Open, squares: &[[f64; 8]; 8], limit: f64, first: bool) {
        let at = open.visit;
        let mut wanted = self.trees.wanted(at);
        let mut least = [f64::INFINITY; 8];
        let mut any = 0_u32;
        while wanted != 0 {
            let (i, j) = next(&mut wanted);
            let lane = if first { i } else { j };
            any |= 1 << lane;
            least[lane] = squares[i][j].min(least[lane]);
        }
        for lane in (0..8_u32).filter(|lane| any >> lane & 1 == 1) {
            let gap = least[lane as usize];
            if gap > limit {
                continue;
            }
            let visit = if first {
                Visit {
                    level_a: at.level_a - 1,
                    a: at.a * 8 + lane,
                    ..at
                }
            } else {
                Visit {
                    level_b: at.level_b - 1,
                    b: at.b * 8 + lane,
                    ..at
                }
            };
            self.push_below(open, gap, visit);
        }
    }

    /// Queues a part of an opened entry.
    fn push_below(&mut self, open: &Open, gap: f64, visit: Visit) {
        self.push(Open {
            gap: gap.to_bits(),
            rank: 0,
            visit,
            distance: open.distance,
        });
    }
}

/// The distance of all pairs of two subtrees.
enum Common {
    At(f64),
    /// Beyond the cutoff.
    Beyond,
    /// Perhaps not one.
    Unknown,
}

#[cfg(test)]
mod tests;
