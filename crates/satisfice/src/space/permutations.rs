//! The permutations among the axes: keys and ranks, and what regions hold of them.

use core::cmp::Reverse;
use std::collections::BinaryHeap;

use super::{Axis, AxisKind, Region, Space};
use crate::error::Error;
use crate::scalar::{Real, ordered};

/// First axis and length of each permutation.
pub(super) fn permutations<S: Real>(axes: &[Axis<S>]) -> Result<Vec<(usize, usize)>, Error> {
    let mut found = Vec::new();
    let mut next = 0;
    while next < axes.len() {
        let first = next;
        next += 1;
        if axes[first].kind != AxisKind::Place {
            continue;
        }
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a u32, whole"
        )]
        let length = axes[first].upper.f64() as usize + 1;
        let all = axes[first..].iter().take(length).zip(0_u32..);
        let together = all
            .filter(|(axis, place)| {
                axis.kind == AxisKind::Place && axis.place == *place && axis.upper == axes[first].upper
            })
            .count();
        if together != length {
            let (lower, upper) = (axes[first].lower.f64(), axes[first].upper.f64());
            let reason = "the places of a permutation stand together, in their order";
            return Err(Error::Bounds {
                axis: first,
                lower,
                upper,
                reason,
            });
        }
        found.push((first, length));
        next = first + length;
    }
    Ok(found)
}

impl<S: Real> Space<S> {
    /// Turns the keys of each permutation into their ranks.
    #[cold]
    pub(super) fn rank(&self, values: &mut [S]) {
        let mut order = Vec::new();
        for &(first, length) in &self.permutations {
            let keys = &mut values[first..first + length];
            order.clear();
            order.extend(0..length);
            // Stable: of equal keys, the earlier place has the lower rank.
            order.sort_by(|&a, &b| {
                keys[a]
                    .partial_cmp(&keys[b])
                    .unwrap_or(core::cmp::Ordering::Equal)
            });
            for (rank, &place) in order.iter().enumerate() {
                keys[place] =
                    self.axes[first].lower + S::of(f64::from(u32::try_from(rank).unwrap_or(u32::MAX)));
            }
        }
    }

    pub(crate) fn has_permutations(&self) -> bool {
        !self.permutations.is_empty()
    }

    /// First axis and length of the first permutation in which a value is there twice. Cost: O(n log n).
    pub(crate) fn first_repeated(&self, values: &[S]) -> Option<(usize, usize)> {
        let mut sorted = Vec::new();
        let mut repeats = |&(first, length): &(usize, usize)| {
            sorted.clear();
            sorted.extend(values[first..first + length].iter().map(|value| value.f64()));
            sorted.sort_unstable_by(f64::total_cmp);
            sorted.windows(2).any(|pair| pair[0] == pair[1])
        };
        self.permutations
            .iter()
            .copied()
            .find(|permutation| repeats(permutation))
    }

    /// Replaces the values of each permutation by an order that lies inside a region; `false` if there is none. Cost: O(n log n).
    ///
    /// Of the places that a value fits into, the one whose region ends first takes it: Glover 1967, doi 10.1002/nav.3800140304.
    pub(crate) fn order_inside(&self, region: &Region<S>, values: &mut [S]) -> bool {
        let (mut places, mut begun) = (Vec::new(), BinaryHeap::new());
        self.permutations.iter().all(|&(first, length)| {
            let (lower, upper) = (&region.lower[first..], &region.upper[first..]);
            places.clear();
            places.extend(0..length);
            places.sort_unstable_by(|&a: &usize, &b| lower[a].f64().total_cmp(&lower[b].f64()));
            let mut later = places.iter().copied().peekable();
            begun.clear();
            let mut rank = self.axes[first].lower;
            for _ in 0..length {
                while let Some(place) = later.next_if(|&place| lower[place] <= rank) {
                    begun.push(Reverse((ordered(upper[place].f64()), place)));
                }
                match begun.pop() {
                    // A place that has ended gets no value.
                    Some(Reverse((_, place))) if rank <= upper[place] => values[first + place] = rank,
                    _ => return false,
                }
                rank = rank + S::one();
            }
            true
        })
    }

    /// Exchanges places of each permutation at random, as far as its order stays inside a region. `pick` draws a number from a range.
    pub(crate) fn shuffle_inside(
        &self,
        region: &Region<S>,
        values: &mut [S],
        pick: &mut dyn FnMut(core::ops::Range<usize>) -> usize,
    ) {
        for &(first, length) in &self.permutations {
            let fits = |place: usize, rank: S| region.lower[place] <= rank && rank <= region.upper[place];
            for last in (first + 1..first + length).rev() {
                let other = pick(first..last + 1);
                if fits(last, values[other]) && fits(other, values[last]) {
                    values.swap(last, other);
                }
            }
        }
    }
}

impl<S: Real> Axis<S> {
    /// The number of values that are left for it once the axes before it have theirs, as a real; for a continuous axis its width.
    pub(crate) fn choices(&self) -> f64 {
        match self.kind {
            AxisKind::Place => self.upper.f64() + 1.0 - f64::from(self.place),
            AxisKind::Integer | AxisKind::Categorical | AxisKind::Continuous => self.width().f64(),
        }
    }

    /// At a place of a permutation: how many of the later places have a smaller key, where `keys` are those from this place on.
    pub(crate) fn inversions(&self, keys: &[S]) -> usize {
        let later = keys.iter().take(self.later_places() + 1).skip(1);
        later.filter(|&&key| key < keys[0]).count()
    }

    /// The inverse: turns an inversion count into a rank, where `ranks` are those from this place on, of which all but the first are among
    /// each other already.
    pub(crate) fn insert_rank(&self, ranks: &mut [S]) {
        let own = ranks[0];
        for rank in ranks.iter_mut().take(self.later_places() + 1).skip(1) {
            if *rank >= own {
                *rank = *rank + S::one();
            }
        }
    }

    /// The key in the middle of those that have this rank, if all are evenly apart.
    pub(crate) fn key_of_rank(&self, rank: S) -> S {
        (rank + S::of(0.5)) / (self.upper + S::one())
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a u32, whole"
    )]
    fn later_places(&self) -> usize {
        self.upper.f64() as usize - self.place as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All regions of a permutation of four, by all assignments.
    #[test]
    fn an_order_is_found_wherever_there_is_one() {
        let space = Space::<f64>::new(Axis::permutation(4)).unwrap();
        let bounds: Vec<(f64, f64)> = (0..4)
            .flat_map(|a| (a..4).map(move |b| (f64::from(a), f64::from(b))))
            .collect();
        let count = bounds.len();
        let (mut feasible, mut infeasible) = (0, 0);
        for choice in 0..count.pow(4) {
            let at = |j: u32| bounds[choice / count.pow(j) % count];
            let region = Region {
                lower: (0..4).map(|j| at(j).0).collect(),
                upper: (0..4).map(|j| at(j).1).collect(),
            };
            let mut expected = false;
            for code in 0..256 {
                let order = [code % 4, code / 4 % 4, code / 16 % 4, code / 64].map(f64::from);
                let distinct = (1..4).all(|j| !order[..j].contains(&order[j]));
                expected |= distinct && region.contains(&order);
            }
            let mut order = [0.0; 4];
            assert_eq!(space.order_inside(&region, &mut order), expected, "{region:?}");
            if expected {
                assert!(region.contains(&order) && space.first_repeated(&order).is_none());
            }
            feasible += u32::from(expected);
            infeasible += u32::from(!expected);
        }
        assert!(feasible > 1000 && infeasible > 1000, "{feasible} {infeasible}");
    }
}
