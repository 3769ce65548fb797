//! Queens that do not attack each other.

use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Error, SatisficingProblem};

use super::{ENCODINGS, Encoding, Extendable, Violations, constraint_bounds, constraint_methods, counted};
use crate::lattice::{Lattice, description};

const LARGEST: usize = 1000;

/// All ways to put n queens on an n x n board, one per column, so that none attacks another.
///
/// The solution is the row of each column's queen. F is the number of pairs that share a row or a diagonal; a hit is
/// F < 1. Boards that differ by a symmetry count as different: 92 for n = 8. A neighbour has one queen moved along its
/// column, or two columns exchanged under random keys. [`backtrack`](crate::backtrack) finds all 92 in 2,057 nodes.
///
/// Source: Bezzel 1848; counts: Bell, Stevens 2009, doi 10.1016/j.disc.2007.12.043, and by backtracking.
///
/// ```
/// use satisfice::catalogue::Catalogued;
/// use satisfice_problems::Queens;
/// assert_eq!(Queens::new(8)?.reference_hits(), Some(92));
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Queens {
    lattice: Lattice,
    threshold: f64,
    description: Description,
    n: u32,
}

impl Queens {
    /// The board of edge `n`, with integer encoding.
    ///
    /// # Errors
    /// [`Error::Parameter`] for n = 0 or above 1000.
    pub fn new(n: usize) -> Result<Self, Error> {
        Self::with_encoding(n, Encoding::Integer)
    }

    /// The board of edge `n`.
    ///
    /// # Errors
    /// As [`Queens::new`].
    pub fn with_encoding(n: usize, encoding: Encoding) -> Result<Self, Error> {
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
            n: n as u32,
        })
    }
}

impl Violations for Queens {
    /// Cost: O(n^2); on small boards, faster than counting along lines.
    #[inline]
    fn violations(&self, value: impl Fn(usize) -> Option<u32>) -> u32 {
        let mut attacks = 0;
        for column in 0..self.n as usize {
            let Some(row) = value(column) else { continue };
            for other in 0..column {
                let apart = value(other).map(|other| row.abs_diff(other) as usize);
                attacks += u32::from(apart == Some(0) || apart == Some(column - other));
            }
        }
        attacks
    }
}

impl Extendable for Queens {
    fn values(&self, column: usize) -> Option<u32> {
        (column < self.n as usize).then_some(self.n)
    }
    fn extends(&self, rows: &[u32]) -> bool {
        let Some((row, before)) = rows.split_last() else {
            return true;
        };
        let free = |(distance, other): (u32, &u32)| other != row && other.abs_diff(*row) != distance;
        (1..).zip(before.iter().rev()).all(free)
    }
}

impl SatisficingProblem for Queens {
    constraint_methods!();
}

constraint_bounds!(Queens);

impl Catalogued for Queens {
    const NAME: &'static str = "queens";
    const SUMMARY: &'static str = "n queens on a board, none attacking another";
    const SOURCE: &'static str =
        "Bezzel 1848; counts: Bell, Stevens 2009, doi 10.1016/j.disc.2007.12.043, and by backtracking";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::integer(
            "n",
            "edge of the board and number of queens",
            8,
            1,
            LARGEST as i64,
        ),
        Parameter::choice("encoding", "how axes become rows", "integer", ENCODINGS),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::with_encoding(params.count("n"), Encoding::of(params.text("encoding")))
    }

    fn reference_hits(&self) -> Option<u64> {
        counted(self)
    }
}
