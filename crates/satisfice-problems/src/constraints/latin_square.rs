//! Latin squares.

use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Error, SatisficingProblem};

use super::{Extendable, Violations, constraint_bounds, constraint_methods, counted};
use crate::lattice::{Lattice, description};

const LARGEST: usize = 32;
/// Numbers of squares of order 1, 2, ...
const PUBLISHED: [u64; 7] = [1, 2, 12, 576, 161_280, 812_851_200, 61_479_419_904_000];

/// All Latin squares of order n: n symbols in n x n cells, each once in every row and every column.
///
/// F is the number of pairs of equal symbols in a row or column; a hit is F < 1. The solution is the symbol of each cell, row
/// by row; every square counts, reduced or not. A neighbour has one symbol changed.
///
/// Source: Euler 1782; counts: McKay, Wanless 2005, doi 10.1007/s00026-005-0261-7, and by backtracking to order 5.
///
/// ```
/// use satisfice::catalogue::Catalogued;
/// use satisfice_problems::LatinSquare;
/// assert_eq!(LatinSquare::new(4)?.reference_hits(), Some(576));
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct LatinSquare {
    lattice: Lattice,
    threshold: f64,
    description: Description,
    n: usize,
}

impl LatinSquare {
    /// Squares of order `n`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for n = 0 or above 32.
    pub fn new(n: usize) -> Result<Self, Error> {
        if !(1..=LARGEST).contains(&n) {
            return Err(Error::parameter(
                "n",
                n,
                format!("a whole number from 1 to {LARGEST}"),
            ));
        }
        Ok(Self {
            lattice: Lattice::new(vec![n; n * n])?,
            threshold: 1.0,
            description: description(Self::NAME, [("n", n.to_string())]),
            n,
        })
    }
}

impl Violations for LatinSquare {
    /// Cost: O(n^3).
    #[inline]
    fn violations(&self, value: impl Fn(usize) -> Option<u32>) -> u32 {
        let mut violations = 0;
        for cell in 0..self.n * self.n {
            let Some(symbol) = value(cell) else { continue };
            let (row, column) = (cell / self.n, cell % self.n);
            let left = (row * self.n..cell).filter(|&other| value(other) == Some(symbol));
            let above = (0..row).filter(|above| value(above * self.n + column) == Some(symbol));
            violations += (left.count() + above.count()) as u32;
        }
        violations
    }
}

impl Extendable for LatinSquare {
    fn values(&self, cell: usize) -> Option<u32> {
        (cell < self.n * self.n).then_some(self.n as u32)
    }
    fn extends(&self, partial: &[u32]) -> bool {
        let Some((symbol, before)) = partial.split_last() else {
            return true;
        };
        let cell = before.len();
        let row = cell - cell % self.n;
        !before[row..].contains(symbol)
            && before
                .iter()
                .skip(cell % self.n)
                .step_by(self.n)
                .all(|other| other != symbol)
    }
}

impl SatisficingProblem for LatinSquare {
    constraint_methods!();
}

constraint_bounds!(LatinSquare);

impl Catalogued for LatinSquare {
    const NAME: &'static str = "latin-square";
    const SUMMARY: &'static str = "Latin squares of order n";
    const SOURCE: &'static str =
        "Euler 1782; counts: McKay, Wanless 2005, doi 10.1007/s00026-005-0261-7, and by backtracking";
    const PARAMETERS: &'static [Parameter] = &[Parameter::integer("n", "order", 4, 1, LARGEST as i64)];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::new(params.count("n"))
    }

    fn reference_hits(&self) -> Option<u64> {
        PUBLISHED.get(self.n - 1).copied().or_else(|| counted(self))
    }
}
