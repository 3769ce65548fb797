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
pub(super) fn pair(count: usize, rng: &mut SearchRng) -> (usize, usize) {
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
/// fair draw, else a single one is exchanged. `false` where the result is one of the two.
pub(super) fn recombine<S: Real>(hits: &[S], rng: &mut SearchRng, position: &mut [S]) -> bool {
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
}
