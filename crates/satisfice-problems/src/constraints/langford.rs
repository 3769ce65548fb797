//! Langford pairings.

use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Error, SatisficingProblem};

use super::{Extendable, Violations, constraint_bounds, constraint_methods, counted};
use crate::lattice::{Lattice, description};

const LARGEST: usize = 60;
/// Pairings up to reversal, by order.
const PUBLISHED: [(usize, u64); 4] = [(11, 17_792), (12, 108_144), (15, 39_809_640), (16, 326_721_800)];

/// All Langford pairings L(2, n): the numbers 1, 1, 2, 2, ..., n, n in a row such that between both k there are exactly k
/// others.
///
/// Variable k - 1 is the place of the first k. F counts pairs of numbers that claim the same place, once for each such place;
/// a hit is F < 1. A pairing and its reversal are two hits: 52 for n = 7, 300 for n = 8, none unless n mod 4 is 0 or 3.
/// A neighbour has one pair moved.
///
/// Source: Langford 1958, Mathematical Gazette 42:228; counts: OEIS A014552 times 2, and by backtracking.
///
/// ```
/// use satisfice::catalogue::Catalogued;
/// use satisfice_problems::Langford;
/// assert_eq!(Langford::new(7)?.reference_hits(), Some(52));
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Langford {
    lattice: Lattice,
    threshold: f64,
    description: Description,
    n: usize,
}

impl Langford {
    /// Pairings of order `n`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for n below 1 or above 60.
    pub fn new(n: usize) -> Result<Self, Error> {
        if !(1..=LARGEST).contains(&n) {
            return Err(Error::parameter(
                "n",
                n,
                format!("a whole number from 1 to {LARGEST}"),
            ));
        }
        // For n = 1 the pair does not fit in the row; a single place is left, and the two 1s claim places 0 and 2.
        Ok(Self {
            lattice: Lattice::new((1..=n).map(|k| (2 * n - k - 1).max(1)))?,
            threshold: 1.0,
            description: description(Self::NAME, [("n", n.to_string())]),
            n,
        })
    }

    /// The row of numbers of a solution; `None` if it is not a pairing.
    #[must_use]
    pub fn row(&self, solution: &[u32]) -> Option<Vec<usize>> {
        let hit = self.lattice.holds(solution) && self.fitness(&solution.to_vec()) < self.threshold;
        hit.then(|| {
            let mut row = vec![0; 2 * self.n];
            for (k, &place) in (1..).zip(solution) {
                row[place as usize] = k;
                row[place as usize + k + 1] = k;
            }
            row
        })
    }
}

/// How many places two pairs have in common.
#[inline]
fn shared(k: usize, place: u32, other: usize, at: u32) -> u32 {
    let (a, b) = (place as usize, place as usize + k + 1);
    let (c, d) = (at as usize, at as usize + other + 1);
    u32::from(a == c) + u32::from(a == d) + u32::from(b == c) + u32::from(b == d)
}

impl Violations for Langford {
    /// Cost: O(n^2).
    #[inline]
    fn violations(&self, value: impl Fn(usize) -> Option<u32>) -> u32 {
        // Only the pair of n = 1 does not fit.
        let mut violations = u32::from(self.n == 1);
        for k in 1..=self.n {
            let Some(place) = value(k - 1) else { continue };
            for other in 1..k {
                violations += value(other - 1).map_or(0, |at| shared(k, place, other, at));
            }
        }
        violations
    }
}

impl Extendable for Langford {
    fn values(&self, variable: usize) -> Option<u32> {
        let k = variable + 1;
        (k <= self.n).then(|| (2 * self.n - k - 1) as u32)
    }
    fn extends(&self, partial: &[u32]) -> bool {
        let Some((place, before)) = partial.split_last() else {
            return true;
        };
        (1..)
            .zip(before)
            .all(|(other, &at)| shared(partial.len(), *place, other, at) == 0)
    }
}

impl SatisficingProblem for Langford {
    constraint_methods!();
}

constraint_bounds!(Langford);

impl Catalogued for Langford {
    const NAME: &'static str = "langford";
    const SUMMARY: &'static str =
        "Langford pairings: between both k there are k others; reversals counted apart";
    const SOURCE: &'static str =
        "Langford 1958, Mathematical Gazette 42:228; counts: OEIS A014552 times 2, and by backtracking";
    const PARAMETERS: &'static [Parameter] = &[Parameter::integer("n", "order", 8, 1, LARGEST as i64)];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::new(params.count("n"))
    }

    fn reference_hits(&self) -> Option<u64> {
        if !matches!(self.n % 4, 0 | 3) {
            return Some(0);
        }
        let published = PUBLISHED.iter().find(|row| row.0 == self.n).map(|row| 2 * row.1);
        published.or_else(|| counted(self))
    }
}
