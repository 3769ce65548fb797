//! Queens that do not attack each other.

use satisfice::{Catalogued, Description, Error, Parameter, SatisficingProblem, Values};

use crate::lattice::{Lattice, description, lattice_methods};

/// Larger boards are not counted: backtracking takes seconds at 14 and grows by 6 to 8 from board to board.
const COUNTED: usize = 14;

/// All ways to put n queens on an n x n board, one a column, such that none attacks another.
///
/// The row of each column's queen is a lattice axis. F is the number of pairs that share a row or a diagonal, a hit is
/// F < 1. Boards that differ by a symmetry count as different: 92 for n = 8. A neighbour has one queen moved along its
/// column. The exact rival is [`Queens::backtrack`], which visits all 92 in 2,057 nodes.
///
/// Source: Bezzel 1848; counts: Bell, Stevens 2009, doi 10.1016/j.disc.2007.12.043, and by backtracking.
#[derive(Debug, Clone)]
pub struct Queens {
    lattice: Lattice,
    threshold: f64,
    description: Description,
    n: usize,
}

impl Queens {
    /// The board of edge `n`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for n = 0 or above 1000.
    pub fn new(n: usize) -> Result<Self, Error> {
        if !(1..=1000).contains(&n) {
            return Err(Error::parameter("n", n, "a whole number from 1 to 1000"));
        }
        Ok(Self {
            lattice: Lattice::new(vec![n; n])?,
            threshold: 1.0,
            description: description(Self::NAME, [("n", n.to_string())]),
            n,
        })
    }

    /// Visits every solution, column by column, in lexicographic order, and returns the number of nodes of the search
    /// tree: partial boards without an attack, the empty one included. The exact rival of every engine.
    pub fn backtrack(&self, visit: &mut dyn FnMut(&[u32])) -> u64 {
        let mut rows = Vec::with_capacity(self.n);
        self.extend(&mut rows, visit)
    }

    fn extend(&self, rows: &mut Vec<u32>, visit: &mut dyn FnMut(&[u32])) -> u64 {
        let column = rows.len();
        if column == self.n {
            visit(rows);
            return 1;
        }
        let mut nodes = 1;
        for row in 0..self.n as u32 {
            let free = |(other, &taken): (usize, &u32)| {
                taken != row && taken.abs_diff(row) as usize != column - other
            };
            if rows.iter().enumerate().all(free) {
                rows.push(row);
                nodes += self.extend(rows, visit);
                rows.pop();
            }
        }
        nodes
    }
}

impl SatisficingProblem for Queens {
    lattice_methods!();

    /// Cost: O(n^2) for small boards, where that is faster than counting along lines.
    #[inline]
    fn fitness(&self, rows: &Vec<u32>) -> f64 {
        if !self.lattice.holds(rows) {
            return f64::NAN;
        }
        let mut attacks = 0_u32;
        for (column, &row) in rows.iter().enumerate() {
            for (&other, distance) in rows[column + 1..].iter().zip(1..) {
                let apart = row.abs_diff(other);
                attacks += u32::from(apart == 0 || apart == distance);
            }
        }
        f64::from(attacks)
    }

    fn neighbours(&self, of: &Vec<u32>, visit: &mut dyn FnMut(Vec<u32>)) -> bool {
        for column in 0..of.len() {
            for row in (0..self.n as u32).filter(|row| *row != of[column]) {
                let mut moved = of.clone();
                moved[column] = row;
                visit(moved);
            }
        }
        true
    }
}

impl Catalogued for Queens {
    const NAME: &'static str = "queens";
    const SUMMARY: &'static str = "n queens on a board, none attacking another";
    const SOURCE: &'static str =
        "Bezzel 1848; counts: Bell, Stevens 2009, doi 10.1016/j.disc.2007.12.043, and by backtracking";
    const PARAMETERS: &'static [Parameter] = &[Parameter::integer(
        "n",
        "edge of the board and number of queens",
        8,
        1,
        1000,
    )];

    fn from_values(values: &Values) -> Result<Self, Error> {
        Self::new(values.count("n"))
    }

    fn reference_hits(&self) -> Option<u64> {
        (self.n <= COUNTED).then(|| {
            let mut count = 0;
            self.backtrack(&mut |_| count += 1);
            count
        })
    }
}
