//! Costas arrays.

use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Error, SatisficingProblem};

use super::{ENCODINGS, Encoding, Extendable, Violations, constraint_bounds, constraint_methods, counted};
use crate::lattice::{Lattice, description};

const LARGEST: usize = 64;
/// Numbers of arrays of order 1, 2, ..., beyond those that backtracking counts in seconds.
const PUBLISHED: [u64; 20] = [
    1, 2, 4, 12, 40, 116, 200, 444, 760, 2_160, 4_368, 7_852, 12_828, 17_252, 19_612, 21_104, 18_276, 15_096,
    10_240, 6_464,
];

/// All Costas arrays of order n: permutations f of 0..n such that for each distance d the differences f(i + d) - f(i) are
/// all different.
///
/// F counts pairs of equal differences at one distance, and pairs of equal values; a hit is F < 1. Every array counts,
/// symmetric ones too. A neighbour has one value changed, or, under random keys, two exchanged.
///
/// Source: Costas 1984, doi 10.1109/PROC.1984.12967; counts: OEIS A008404, checked by backtracking to order 9.
///
/// ```
/// use satisfice::catalogue::Catalogued;
/// use satisfice_problems::{Costas, Encoding};
/// assert_eq!(Costas::new(6, Encoding::Integer)?.reference_hits(), Some(116));
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Costas {
    lattice: Lattice,
    threshold: f64,
    description: Description,
    n: usize,
}

impl Costas {
    /// Arrays of order `n`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for n = 0 or above 64.
    pub fn new(n: usize, encoding: Encoding) -> Result<Self, Error> {
        if !(1..=LARGEST).contains(&n) {
            return Err(Error::parameter(
                "n",
                n,
                format!("a whole number from 1 to {LARGEST}"),
            ));
        }
        Ok(Self {
            lattice: encoding.lattice(n)?,
            threshold: 1.0,
            description: description(
                Self::NAME,
                [("n", n.to_string()), ("encoding", encoding.name().to_owned())],
            ),
            n,
        })
    }
}

impl Violations for Costas {
    /// Cost: O(n^3).
    #[inline]
    fn violations(&self, value: impl Fn(usize) -> Option<u32>) -> u32 {
        let mut violations = 0;
        let difference = |i: usize, d: usize| Some(i64::from(value(i + d)?) - i64::from(value(i)?));
        for d in 1..self.n {
            for i in 0..self.n - d {
                let Some(here) = difference(i, d) else { continue };
                violations += u32::from(here == 0);
                violations += (0..i).filter(|&j| difference(j, d) == Some(here)).count() as u32;
            }
        }
        violations
    }
}

impl Extendable for Costas {
    fn values(&self, place: usize) -> Option<u32> {
        (place < self.n).then_some(self.n as u32)
    }
    fn extends(&self, partial: &[u32]) -> bool {
        let Some((last, before)) = partial.split_last() else {
            return true;
        };
        // Only the new row of differences can repeat an older one.
        (1..partial.len()).all(|d| {
            let here = i64::from(*last) - i64::from(before[before.len() - d]);
            let earlier = partial.windows(d + 1).take(before.len() - d);
            here != 0
                && earlier
                    .map(|w| i64::from(w[d]) - i64::from(w[0]))
                    .all(|there| there != here)
        })
    }
}

impl SatisficingProblem for Costas {
    constraint_methods!();
}

constraint_bounds!(Costas);

impl Catalogued for Costas {
    const NAME: &'static str = "costas";
    const SUMMARY: &'static str = "Costas arrays: permutations whose differences at each distance differ";
    const SOURCE: &'static str =
        "Costas 1984, doi 10.1109/PROC.1984.12967; counts: OEIS A008404, and by backtracking";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::integer("n", "order", 8, 1, LARGEST as i64),
        Parameter::choice("encoding", "how axes become a permutation", "integer", ENCODINGS),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::new(params.count("n"), Encoding::of(params.text("encoding")))
    }

    fn reference_hits(&self) -> Option<u64> {
        PUBLISHED.get(self.n - 1).copied().or_else(|| counted(self))
    }
}
