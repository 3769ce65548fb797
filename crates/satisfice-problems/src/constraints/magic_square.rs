//! Magic squares.

use satisfice::Bounds;
use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Error, Region, SatisficingProblem};

use super::{ENCODINGS, Encoding, Extendable, counted};
use crate::lattice::{Lattice, description, lattice_methods};

const LARGEST: usize = 16;

/// All magic squares of order n: the numbers 1..n^2, each once, such that all rows, columns and both diagonals have the sum
/// n (n^2 + 1) / 2.
///
/// F is the sum over these lines of |sum - wanted|, plus the number of pairs of equal numbers; a hit is F < 1. The solution
/// is, row by row, each number minus one. Squares that differ by a symmetry count as different: 8 for n = 3, 7,040 for
/// n = 4. A neighbour has one number changed, or two exchanged under random keys.
///
/// Source: Lo Shu; counts: Frénicle 1693, OEIS A006052 times 8, and by backtracking.
///
/// ```
/// use satisfice::catalogue::Catalogued;
/// use satisfice_problems::{Encoding, MagicSquare};
/// assert_eq!(MagicSquare::new(3, Encoding::Integer)?.reference_hits(), Some(8));
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct MagicSquare {
    lattice: Lattice,
    threshold: f64,
    description: Description,
    n: usize,
    /// The cells of each line.
    lines: Vec<Vec<usize>>,
    /// The sum of each line, with each number reduced by one.
    sum: u32,
}

impl MagicSquare {
    /// Squares of order `n`.
    ///
    /// # Errors
    /// [`Error::Parameter`] for n = 0 or above 16.
    pub fn new(n: usize, encoding: Encoding) -> Result<Self, Error> {
        if !(1..=LARGEST).contains(&n) {
            return Err(Error::parameter(
                "n",
                n,
                format!("a whole number from 1 to {LARGEST}"),
            ));
        }
        let rows = (0..n).map(|row| (0..n).map(|k| row * n + k).collect());
        let columns = (0..n).map(|column| (0..n).map(|k| k * n + column).collect());
        let falling = (0..n).map(|k| k * n + k).collect();
        let rising = (0..n).map(|k| k * n + n - 1 - k).collect();
        Ok(Self {
            lattice: encoding.lattice(n * n)?,
            threshold: 1.0,
            description: description(
                Self::NAME,
                [("n", n.to_string()), ("encoding", encoding.name().to_owned())],
            ),
            n,
            lines: rows.chain(columns).chain([falling, rising]).collect(),
            sum: (n * (n * n - 1) / 2) as u32,
        })
    }
}

impl Extendable for MagicSquare {
    fn values(&self, cell: usize) -> Option<u32> {
        (cell < self.n * self.n).then_some((self.n * self.n) as u32)
    }
    fn extends(&self, partial: &[u32]) -> bool {
        let Some((last, before)) = partial.split_last() else {
            return true;
        };
        let cell = before.len();
        // Cells are filled in order, so a line is full when its greatest cell is.
        let full = |line: &&Vec<usize>| line.iter().max() == Some(&cell);
        !before.contains(last)
            && (self.lines.iter().filter(full))
                .all(|line| line.iter().map(|&c| partial[c]).sum::<u32>() == self.sum)
    }
}

impl SatisficingProblem for MagicSquare {
    lattice_methods!();

    /// Cost: O(n^4) for the pairs.
    #[inline]
    fn fitness(&self, numbers: &Vec<u32>) -> f64 {
        if !self.lattice.holds(numbers) {
            return f64::NAN;
        }
        let line = |line: &Vec<usize>| {
            line.iter()
                .map(|&cell| numbers[cell])
                .sum::<u32>()
                .abs_diff(self.sum)
        };
        let mut violations = self.lines.iter().map(line).sum::<u32>();
        if !self.lattice.has_keys() {
            for (cell, number) in numbers.iter().enumerate() {
                violations += numbers[..cell].iter().filter(|other| *other == number).count() as u32;
            }
        }
        f64::from(violations)
    }
    fn neighbourhood(&self) -> Option<&dyn satisfice::Neighbourhood<Vec<u32>>> {
        Some(&self.lattice)
    }
    fn bounds(&self) -> Option<&dyn Bounds<f64>> {
        (!self.lattice.has_keys()).then_some(self as _)
    }
}

impl Bounds<f64> for MagicSquare {
    /// The distance of each line's range of sums from the required sum; sums of integers are exact.
    fn lower_bound(&self, region: &Region<f64>) -> Option<f64> {
        let cells = self.n * self.n;
        if region.lower.len() != cells || region.upper.len() != cells {
            return None;
        }
        let sum = |ends: &[f64], line: &[usize]| line.iter().map(|&cell| ends[cell]).sum::<f64>();
        let wanted = f64::from(self.sum);
        let line = |line: &Vec<usize>| {
            (sum(&region.lower, line) - wanted)
                .max(wanted - sum(&region.upper, line))
                .max(0.0)
        };
        Some(self.lines.iter().map(line).sum())
    }
}

impl Catalogued for MagicSquare {
    const NAME: &'static str = "magic-square";
    const SUMMARY: &'static str = "magic squares of order n, symmetric ones counted apart";
    const SOURCE: &'static str = "Lo Shu; counts: Frénicle 1693 and OEIS A006052, and by backtracking";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::integer("n", "order", 3, 1, LARGEST as i64),
        Parameter::choice(
            "encoding",
            "how axes become an arrangement",
            "random-key",
            ENCODINGS,
        ),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::new(params.count("n"), Encoding::of(params.text("encoding")))
    }

    fn reference_hits(&self) -> Option<u64> {
        match self.n {
            // 8 times 880 and 8 times 275,305,224 (Schroeppel 1973).
            4 => Some(7_040),
            5 => Some(8 * 275_305_224),
            _ => counted(self),
        }
    }
}
