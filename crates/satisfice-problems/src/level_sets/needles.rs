//! Needles in a haystack: the negative control.

use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Error, SatisficingProblem};

use crate::lattice::{ENUMERABLE, Lattice, count_hits, description, lattice_methods};

/// All cells (i, j) of an m x m lattice with F(i, j) = hash(i, j) < delta, where the hash is uniform in [0, 1).
///
/// F at one cell says nothing about F at another: no engine can beat uniform sampling. The hash is
/// the output function of `SplitMix64` (Steele, Lea, Flood 2014, doi 10.1145/2714064.2660195) on the cell's number
/// plus the seed times an odd constant.
///
/// ```
/// use satisfice::SatisficingProblem;
/// use satisfice_problems::Needles;
/// let problem = Needles::new(100, 0.01, 7)?;
/// assert!((0.0..1.0).contains(&problem.fitness(&vec![3, 4])));
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Needles {
    lattice: Lattice,
    threshold: f64,
    description: Description,
    cells: u64,
    offset: u64,
}

impl Needles {
    /// Needles of density `threshold` among `cells` x `cells`; `hash_seed` chooses the hash.
    ///
    /// # Errors
    /// [`Error::Bounds`] for 0 cells; [`Error::Threshold`] for NaN.
    pub fn new(cells: usize, threshold: f64, hash_seed: u64) -> Result<Self, Error> {
        if threshold.is_nan() {
            return Err(Error::Threshold);
        }
        Ok(Self {
            lattice: Lattice::new([cells; 2])?,
            threshold,
            description: description(
                Self::NAME,
                [
                    ("cells", cells.to_string()),
                    ("threshold", threshold.to_string()),
                    ("hash-seed", hash_seed.to_string()),
                ],
            ),
            cells: cells as u64,
            offset: hash_seed.wrapping_mul(0xd134_2543_de82_ef95),
        })
    }
}

/// The output function of `SplitMix64`, state advanced once.
#[inline]
fn splitmix64(state: u64) -> u64 {
    let mut z = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

impl SatisficingProblem for Needles {
    lattice_methods!();

    #[inline]
    fn fitness(&self, cells: &Vec<u32>) -> f64 {
        if !self.lattice.holds(cells) {
            return f64::NAN;
        }
        let number = u64::from(cells[0]) * self.cells + u64::from(cells[1]);
        (splitmix64(number.wrapping_add(self.offset)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

impl Catalogued for Needles {
    const NAME: &'static str = "needles";
    const SUMMARY: &'static str = "cells whose hash is small: no structure, the negative control";
    const SOURCE: &'static str =
        "SplitMix64: Steele, Lea, Flood 2014, doi 10.1145/2714064.2660195; counts by enumeration";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::integer("cells", "cells per axis, m", 1000, 1, 1_000_000),
        Parameter::real(
            "threshold",
            "share of the cells that are hits, delta",
            0.002,
            0.0,
            1.0,
        ),
        Parameter::integer("hash-seed", "which hash", 0, 0, i64::MAX),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::new(
            params.count("cells"),
            params.real("threshold"),
            params.count("hash-seed") as u64,
        )
    }

    fn reference_hits(&self) -> Option<u64> {
        count_hits(self, ENUMERABLE)
    }
}

#[cfg(test)]
mod tests {
    /// The first outputs for state 0 of the authors' code: the hash defines the problem, so it must never change.
    #[test]
    fn the_hash_is_splitmix64() {
        assert_eq!(super::splitmix64(0), 0xe220_a839_7b1d_cdaf);
        assert_eq!(super::splitmix64(0x9e37_79b9_7f4a_7c15), 0x6e78_9e6a_a1b9_65f4);
    }
}
