//! Hits recombined: some coordinates of one, the others of another.
//!
//! Where the hits are a product of sets, one for each axis or group of axes, or a union of few such products, the exchange of
//! coordinates between two hits is likely to be a hit: six maxima an axis make 216 in three dimensions, but six of them tell
//! where all are.

use crate::scalar::Real;
use crate::seed::SearchRng;

/// Half of the pairs are at most so far apart in the order found, which are near to each other in space.
const NEAR: f64 = 8.0;

/// Two different numbers below `count`, which is at least 2.
pub(in crate::engine) fn pair(count: usize, rng: &mut SearchRng) -> (usize, usize) {
    let a = rng.below(count);
    let (reach, far) = rng.uniform_and_sign();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 7")]
    let apart = 1 + if far {
        rng.below(count - 1)
    } else {
        (NEAR * reach) as usize % (count - 1)
    };
    (a, (a + count - apart) % count)
}

/// Writes a recombination of two hits of the list, which has at least two: half of the time each coordinate is either's by a
/// fair draw, else a single one is exchanged. `false` if the result is one of the two.
pub(in crate::engine) fn recombine<S: Real>(hits: &[S], rng: &mut SearchRng, position: &mut [S]) -> bool {
    let dimension = position.len();
    let (a, b) = pair(hits.len() / dimension, rng);
    let row = |hit: usize| &hits[hit * dimension..(hit + 1) * dimension];
    let (a, b) = (row(a), row(b));
    position.copy_from_slice(a);
    let (_, single) = rng.uniform_and_sign();
    if single {
        let j = rng.below(dimension);
        position[j] = b[j];
    } else {
        for (x, &other) in position.iter_mut().zip(b) {
            if rng.uniform() < 0.5 {
                *x = other;
            }
        }
    }
    position != a && position != b
}

/// Goes through all pairs of a growing list of hits, each once, the two exchanges of a pair one after the other.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(in crate::engine) struct Pairs {
    /// The later and the earlier hit of the pair that is next.
    later: usize,
    earlier: usize,
    /// The axes that the last exchange has swapped; the next one swaps the others. Empty where a new pair is next.
    swapped: Vec<bool>,
}

impl Pairs {
    /// Whether a list of so many hits has pairs that have not been visited.
    pub(in crate::engine) fn is_left(&self, count: usize) -> bool {
        self.later.max(1) < count || !self.swapped.is_empty()
    }

    /// Whether this is a place in the pairs of a list of so many hits with so many coordinates.
    pub(in crate::engine) fn fit(&self, count: usize, dimension: usize) -> bool {
        let within = self.earlier < self.later.max(1) && self.later <= count.max(1);
        within && (self.swapped.is_empty() || (self.swapped.len() == dimension && self.later < count))
    }

    /// Writes the next exchange of coordinates and says whether it differs from its two hits; `None` if there is none left.
    /// Which axes are exchanged is drawn: each by a fair draw, or, half of the time and always in the plane, a single one;
    /// then the others. Cost: O(D).
    pub(in crate::engine) fn next<S: Real>(
        &mut self,
        hits: &[S],
        rng: &mut SearchRng,
        position: &mut [S],
    ) -> Option<bool> {
        let dimension = position.len();
        if !self.is_left(hits.len() / dimension) {
            return None;
        }
        let row = |hit: usize| &hits[hit * dimension..(hit + 1) * dimension];
        self.later = self.later.max(1);
        let (a, b) = (row(self.later), row(self.earlier));
        let is_first = self.swapped.is_empty();
        if is_first {
            let (_, single) = rng.uniform_and_sign();
            self.swapped.resize(dimension, false);
            if single || dimension == 2 {
                self.swapped[rng.below(dimension)] = true;
            } else {
                self.swapped.fill_with(|| rng.uniform() < 0.5);
            }
        } else {
            for swapped in &mut self.swapped {
                *swapped = !*swapped;
            }
        }
        for (j, x) in position.iter_mut().enumerate() {
            *x = if self.swapped[j] { b[j] } else { a[j] };
        }
        if !is_first {
            self.swapped.clear();
            self.earlier += 1;
            if self.earlier == self.later {
                (self.later, self.earlier) = (self.later + 1, 0);
            }
        }
        Some(position != a && position != b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_are_two_and_all_of_them_are_drawn() {
        let mut rng = SearchRng::new(1);
        for count in 2..20 {
            let mut seen = vec![false; count * count];
            for _ in 0..4000 * count {
                let (a, b) = pair(count, &mut rng);
                assert_ne!(a, b);
                seen[a * count + b] = true;
            }
            assert_eq!(seen.iter().filter(|seen| **seen).count(), count * (count - 1));
        }
    }

    #[test]
    fn coordinates_come_from_two_hits_each_on_its_own_axis() {
        let hits: Vec<f64> = (0..30).map(f64::from).collect();
        let (mut rng, mut position) = (SearchRng::new(2), [0.0; 3]);
        let mut mixed = 0;
        for _ in 0..2000 {
            let new = recombine(&hits, &mut rng, &mut position);
            let mut sources: Vec<i64> = position.iter().map(|x| (x / 3.0) as i64).collect();
            assert!(position.iter().enumerate().all(|(j, x)| *x as usize % 3 == j));
            sources.dedup();
            sources.sort_unstable();
            sources.dedup();
            assert!(sources.len() <= 2 && new == (sources.len() == 2));
            mixed += usize::from(new);
        }
        assert!(mixed > 1000, "{mixed}");
    }

    #[test]
    fn every_pair_is_visited_once_also_of_a_list_that_grows() {
        let (mut rng, mut pairs) = (SearchRng::new(3), Pairs::default());
        let (mut hits, mut position) = (Vec::<f64>::new(), [0.0; 3]);
        let mut visits = std::collections::BTreeMap::new();
        for count in 0..12 {
            assert!(!pairs.is_left(count) && pairs.next(&hits, &mut rng, &mut position).is_none());
            // Hit n is (3n, 3n + 1, 3n + 2): a coordinate tells whose it is.
            hits.extend((3 * count..3 * count + 3).map(|x| x as f64));
            while let Some(is_new) = pairs.next(&hits, &mut rng, &mut position) {
                let mut owners: Vec<usize> = position.iter().map(|x| *x as usize / 3).collect();
                owners.sort_unstable();
                owners.dedup();
                assert_eq!(owners.len(), 1 + usize::from(is_new), "{position:?}");
                if !is_new {
                    continue;
                }
                *visits.entry(owners).or_insert(0) += 1;
            }
        }
        // All but those whose fair draws left every coordinate with one hit.
        assert!(
            visits.len() > 50 && visits.values().all(|&visits| visits == 2),
            "{visits:?}"
        );
    }

    #[test]
    fn in_the_plane_two_hits_are_the_corners_of_a_rectangle_whose_others_are_written() {
        let (mut rng, mut pairs) = (SearchRng::new(4), Pairs::default());
        let (hits, mut position) = ([1.0, 2.0, 3.0, 4.0], [0.0; 2]);
        let mut corners = Vec::new();
        while pairs.next(&hits, &mut rng, &mut position) == Some(true) {
            corners.push(position.map(|x| x as i32));
        }
        corners.sort_unstable();
        assert_eq!(corners, [[1, 4], [3, 2]]);
    }
}
