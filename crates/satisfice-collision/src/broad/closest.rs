//! The closest pairs of features of two posed trees, best first: the pairs of boxes with the least gap are opened first, until
//! no gap is left below the distances found (Hjaltason and Samet 1998, doi:10.1145/276304.276326, for pairs).
//!
//! Boxes are compared in `f64`, so that bodies may be far apart: what is wrong by a rounding of `f32` is the box of a feature in
//! the frame of its own body, not the way between the bodies. With the names of `relative`, a side is wrong by at most
//! e = e_b + sqrt(3) r e_a and 2^-45 times all lengths involved, and the gap g of two boxes proves a distance of at least
//! (g - 2 sqrt(3) e) / s_b.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::boxes::{Dirty, Group};
use super::features::FeatureTree;
use super::frame::power_of_two;
use super::pair::Pair;
use super::pair_query::{Keep, PairQuery};
use super::relative::Composition;
use super::traverse::{Trees, Visit, next};
use super::watch::Watch;
use crate::distance::{self, ACCURACY, Proximity, Threshold};
use crate::simd::{Lanes, Work, dispatch};
use crate::{Error, Placement, Shape};

/// Visits between two looks at the watch.
const LOOK: u64 = 256;

/// What has been found by its distance, then by its key.
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

/// The closest that have been found so far, over any number of searches: at most so many, all below a cutoff if there is one.
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

    /// Nothing further away than this is of interest any more.
    pub(crate) fn bound(&self) -> f64 {
        let last = self.found.peek().filter(|_| self.found.len() >= self.wanted);
        let cutoff = self.cutoff.map_or(f64::INFINITY, Threshold::get);
        last.map_or(cutoff, |last| last.distance)
    }

    /// Whether nothing can change any more.
    pub(crate) fn is_settled(&self) -> bool {
        self.wanted == 0 || (self.any_contact && self.found.len() == 1 && self.bound() == 0.0)
    }

    /// Takes a pair, if it is close enough.
    fn offer(&mut self, a: &Shape, b: &Shape, key: T) {
        if distance::measure(a, b) * (1.0 - 2.0 * ACCURACY) > self.bound()
            || self.cutoff.is_some_and(|cutoff| !distance::within(a, b, cutoff))
        {
            return;
        }
        let distance = distance::proximity(a, b).distance;
        self.found.push(Ranked { distance, key });
        if self.found.len() > self.wanted {
            self.found.pop();
        }
    }

    /// What was found, the closest first.
    pub(crate) fn into_sorted(self) -> Vec<Ranked<T>> {
        self.found.into_sorted_vec()
    }
}

/// The `k` closest pairs of a feature of `a`, posed, and one of `b`, posed, that are kept, by distance, then by number; fewer if
/// there are fewer pairs. The distance is that of the posed coordinates as [`Placement::apply`] rounds them.
///
/// Cost: for small `k` usually logarithmic in the number of features; with thousands of equal distances, such as parallel faces
/// have, linear in these.
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
/// watch stopped it.
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
        let open = first.into_iter().map(|visit| Open { gap: 0, visit });
        dispatch(ClosestSearch {
            query,
            trees,
            flip,
            gaps,
            open: open.collect(),
            closest,
            key,
            watch,
        });
    });
}

/// Two groups of boxes, or of items, that have not been compared yet.
#[derive(PartialEq, Eq)]
struct Open {
    /// The bits of the square of a lower bound of their distance.
    gap: u64,
    visit: Visit,
}

impl Ord for Open {
    /// The greatest is the closest one; of equals, the one nearest to the items.
    fn cmp(&self, other: &Self) -> Ordering {
        let height = |open: &Self| open.visit.level_a + open.visit.level_b;
        (other.gap, height(other), other.visit).cmp(&(self.gap, height(self), self.visit))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Eight boxes in `f64`.
struct Wide {
    lower: [[f64; 8]; 3],
    upper: [[f64; 8]; 3],
}

/// How the first tree lies in the frame of the second, and what gaps of boxes prove there.
struct Gaps {
    matrix: [[f64; 3]; 3],
    shift: [f64; 3],
    /// A gap exceeds the distance by at most this.
    error: f64,
    scale: f64,
}

impl Gaps {
    fn new(way: &Composition) -> Self {
        let side = way.b_error
            + 1.7321 * way.ratio * way.a_error
            + power_of_two(-45) * way.lengths
            + power_of_two(-140);
        // squares of larger numbers could overflow, and then nothing is proved
        let sane = way.lengths < power_of_two(500);
        Self {
            matrix: way.matrix.map(|row| row.map(|m| m * way.ratio)),
            shift: way.shift,
            error: if sane { 3.4642 * side } else { f64::INFINITY },
            scale: way.scale,
        }
    }

    /// Of a body with itself.
    fn within(query: &PairQuery<'_>) -> Self {
        let frame = &query.a.0.frame;
        Self {
            matrix: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            shift: [0.0; 3],
            error: 3.4642 * (frame.error + power_of_two(-45) * frame.half) + power_of_two(-140),
            scale: frame.scale,
        }
    }

    /// Boxes with a gap whose square is greater are further apart than `distance`.
    fn limit(&self, distance: f64) -> f64 {
        let limit = (distance * self.scale + self.error) * (1.0 + power_of_two(-48));
        limit * limit
    }

    /// Boxes of the first tree in the frame of the second.
    #[inline(always)]
    fn bring(&self, of: &Group) -> Wide {
        let mut wide = Wide {
            lower: [[0.0; 8]; 3],
            upper: [[0.0; 8]; 3],
        };
        for i in 0..3 {
            for l in 0..8 {
                let (mut centre, mut half) = (self.shift[i], 0.0);
                for k in 0..3 {
                    let (low, high) = (f64::from(of.lower[k][l]), f64::from(of.upper[k][l]));
                    centre += self.matrix[i][k] * (0.5 * (low + high));
                    half += self.matrix[i][k].abs() * (0.5 * (high - low));
                }
                wide.lower[i][l] = centre - half;
                wide.upper[i][l] = centre + half;
            }
        }
        wide
    }

    /// The squared gaps between eight boxes and eight others.
    #[inline(always)]
    fn squares(&self, a: &Group, b: &Group) -> [[f64; 8]; 8] {
        let a = self.bring(a);
        let mut squares = [[0.0; 8]; 8];
        for k in 0..3 {
            for (i, row) in squares.iter_mut().enumerate() {
                let (low, high) = (a.lower[k][i], a.upper[k][i]);
                for (l, square) in row.iter_mut().enumerate() {
                    let below = f64::from(b.lower[k][l]) - high;
                    let above = low - f64::from(b.upper[k][l]);
                    let gap = if below > above { below } else { above };
                    // not NaN, which proves nothing
                    let gap = if gap > 0.0 { gap } else { 0.0 };
                    *square += gap * gap;
                }
            }
        }
        squares
    }
}

struct ClosestSearch<'a, T, K> {
    query: &'a PairQuery<'a>,
    trees: Trees<'a>,
    flip: bool,
    gaps: Gaps,
    open: BinaryHeap<Open>,
    closest: &'a mut Closest<T>,
    key: K,
    watch: &'a Watch<'a>,
}

impl<T: Ord + Copy, K: Fn(Pair) -> T> Work for ClosestSearch<'_, T, K> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self, _: L) {
        let mut visits = 0;
        let mut limit = self.gaps.limit(self.closest.bound());
        while let Some(Open { gap, visit }) = self.open.pop() {
            if f64::from_bits(gap) > limit || self.closest.is_settled() {
                return;
            }
            visits += 1;
            if visits % LOOK == 0 && self.watch.ask(0) {
                return;
            }
            let mut rooms = [Group::EMPTY; 2];
            let [room_a, room_b] = &mut rooms;
            let a = self.trees.a.group(visit.level_a, visit.a, room_a);
            let b = self.trees.b.group(visit.level_b, visit.b, room_b);
            let squares = self.gaps.squares(a, b);
            match visit.level_a.cmp(&visit.level_b) {
                Ordering::Equal if visit.level_a == 0 => limit = self.measure(visit, &squares, limit),
                Ordering::Equal => self.open_both(visit, &squares, limit),
                taller => self.open_one(visit, &squares, limit, taller == Ordering::Greater),
            }
        }
    }
}

impl<T: Ord + Copy, K: Fn(Pair) -> T> ClosestSearch<'_, T, K> {
    /// Measures the items of two groups, the closest boxes first. Returns the new limit.
    fn measure(&mut self, at: Visit, squares: &[[f64; 8]; 8], mut limit: f64) -> f64 {
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
            let (first, second) = (ids_a[i], ids_b[j]);
            let swap = if self.query.one_body {
                first > second
            } else {
                self.flip
            };
            let (a, b) = if swap { (second, first) } else { (first, second) };
            if self.query.keeps(a, b) {
                let pair = Pair { a, b };
                let [one, two] = self.query.shapes(pair);
                self.closest.offer(&one, &two, (self.key)(pair));
                limit = self.gaps.limit(self.closest.bound());
            }
        }
        limit
    }

    /// Opens both groups of two on the same level.
    fn open_both(&mut self, at: Visit, squares: &[[f64; 8]; 8], limit: f64) {
        let mut wanted = self.trees.wanted(at);
        while wanted != 0 {
            let (i, j) = next(&mut wanted);
            if squares[i][j] <= limit {
                self.open.push(Open {
                    gap: squares[i][j].to_bits(),
                    visit: Visit {
                        level_a: at.level_a - 1,
                        level_b: at.level_b - 1,
                        a: at.a * 8 + i as u32,
                        b: at.b * 8 + j as u32,
                    },
                });
            }
        }
    }

    /// Opens the group of the taller tree.
    fn open_one(&mut self, at: Visit, squares: &[[f64; 8]; 8], limit: f64, first: bool) {
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
            self.open.push(Open {
                gap: gap.to_bits(),
                visit,
            });
        }
    }
}

#[cfg(test)]
mod tests;
