//! A thin spherical shell.

use satisfice::Bounds;
use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Error, Region, SatisficingProblem};

use crate::lattice::{
    Lattice, Published, RangeMinimum, as_published, centres, description, lattice_methods, reference,
};

/// Dimension, cells per axis, threshold, hits. The hits are those of `--example enumerate`.
const PUBLISHED: &[Published] = &[
    (2, 1000, 0.003, 6_636),
    (4, 40, 0.02, 47_360),
    (6, 14, 0.03, 36_224),
];

const RADIUS: f64 = 0.7;

/// All cells of a lattice on [-1, 1]^D whose centre x lies near a sphere:
///
/// F(x) = | |x| - 0.7 | < delta,
///
/// one connected set without an interior. A hit is a cell.
///
/// ```
/// use satisfice::SatisficingProblem;
/// use satisfice_problems::Shell;
/// let problem = Shell::new(2, 1000, 0.01)?;
/// assert!(problem.fitness(&vec![850, 500]) < 0.01); // x = (0.7, 0)
/// assert!(problem.fitness(&vec![500, 500]) > 0.69); // the centre
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Shell {
    lattice: Lattice,
    threshold: f64,
    description: Description,
    cells: usize,
    squares: RangeMinimum,
    negative_squares: RangeMinimum,
}

impl Shell {
    /// The shell of half-width `threshold` in `dimension` dimensions with `cells` cells per axis.
    ///
    /// # Errors
    /// [`Error::NoAxis`] or [`Error::Bounds`] for a number that is 0; [`Error::Threshold`] for NaN.
    pub fn new(dimension: usize, cells: usize, threshold: f64) -> Result<Self, Error> {
        if threshold.is_nan() {
            return Err(Error::Threshold);
        }
        let lattice = Lattice::new(vec![cells; dimension])?;
        let squares: Vec<f64> = centres(cells, -1.0, 1.0).into_iter().map(|x| x * x).collect();
        Ok(Self {
            lattice,
            threshold,
            description: description(
                Self::NAME,
                [
                    ("dimension", dimension.to_string()),
                    ("cells", cells.to_string()),
                    ("threshold", threshold.to_string()),
                ],
            ),
            cells,
            negative_squares: RangeMinimum::new(squares.iter().map(|s| -s).collect()),
            squares: RangeMinimum::new(squares),
        })
    }
}

impl SatisficingProblem for Shell {
    lattice_methods!();

    #[inline]
    fn fitness(&self, cells: &Vec<u32>) -> f64 {
        if !self.lattice.holds(cells) {
            return f64::NAN;
        }
        let squares = self.squares.table();
        let square = cells.iter().fold(0.0, |sum, &cell| sum + squares[cell as usize]);
        (square.sqrt() - RADIUS).abs()
    }
    fn bounds(&self) -> Option<&dyn Bounds<f64>> {
        Some(self)
    }
}

impl Bounds<f64> for Shell {
    /// From the least and the greatest distance of the region. Sums, root and difference are rounded monotonely and in the
    /// order of the fitness: no fitness is below it.
    fn lower_bound(&self, region: &Region<f64>) -> Option<f64> {
        let (mut least, mut greatest) = (0.0, 0.0);
        for (&from, &to) in region.lower.iter().zip(&region.upper) {
            least += self.squares.minimum(from, to);
            greatest -= self.negative_squares.minimum(from, to);
        }
        Some((least.sqrt() - RADIUS).max(RADIUS - greatest.sqrt()).max(0.0))
    }
}

impl Catalogued for Shell {
    const NAME: &'static str = "shell";
    const SUMMARY: &'static str = "cells of [-1, 1]^D near the sphere of radius 0.7: one thin connected set";
    const SOURCE: &'static str = "a standard test set; counts by enumeration";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::integer("dimension", "number of axes, D", 4, 1, 64),
        Parameter::integer(
            "cells",
            "cells per axis, m; 0 = as published for this dimension",
            0,
            0,
            1_000_000,
        ),
        Parameter::real(
            "threshold",
            "half the width of the shell, delta; below 0 = as published for this dimension",
            -1.0,
            -1.0,
            1e6,
        ),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        let dimension = params.count("dimension");
        let (cells, threshold) = as_published(
            PUBLISHED,
            ("dimension", dimension),
            params.count("cells"),
            params.real("threshold"),
        )?;
        Self::new(dimension, cells, threshold)
    }

    fn reference_hits(&self) -> Option<u64> {
        reference(PUBLISHED, self, self.lattice.space().dimension(), self.cells)
    }
}
