//! Eight balls in four dimensions.

use satisfice::Bounds;
use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Error, Region, SatisficingProblem};

use crate::lattice::{Lattice, Published, RangeMinimum, centres, description, lattice_methods, reference};

const DIMENSION: usize = 4;
/// Coordinates of the centres, which are the corners of a cube with an even number of high ones.
const LOW: f64 = 0.25;
const HIGH: f64 = 0.75;
const CENTRES: [[bool; DIMENSION]; 8] = [
    [false, false, false, false],
    [false, false, true, true],
    [false, true, false, true],
    [false, true, true, false],
    [true, false, false, true],
    [true, false, true, false],
    [true, true, false, false],
    [true, true, true, true],
];
/// Dimension, cells per axis, threshold, hits: 8 times 1,312. The hits are those of `--example enumerate`.
const PUBLISHED: &[Published] = &[(DIMENSION, 40, 0.1, 10_496)];

/// All cells of a lattice on [0, 1]^4 whose centre lies near one of eight points:
///
/// F(x) = min_k |x - c_k| < delta, c_k in {0.25, 0.75}^4 with an even number of coordinates 0.75.
///
/// Centres are 0.71 apart, and balls of radius 0.1 are islands far from each other. A hit is a cell.
///
/// ```
/// use satisfice::SatisficingProblem;
/// use satisfice_problems::Islands;
/// let problem = Islands::new(40, 0.1)?;
/// assert!(problem.fitness(&vec![10, 10, 10, 10]) < 0.1); // next to the centre (0.25, 0.25, 0.25, 0.25)
/// assert!(problem.fitness(&vec![20, 20, 20, 20]) > 0.1);
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Islands {
    lattice: Lattice,
    threshold: f64,
    description: Description,
    cells: usize,
    /// Squared distances to `LOW` and to `HIGH` along an axis.
    squares: [RangeMinimum; 2],
}

impl Islands {
    /// Islands of radius `threshold` with `cells` cells per axis.
    ///
    /// # Errors
    /// [`Error::Bounds`] for 0 cells; [`Error::Threshold`] for NaN.
    pub fn new(cells: usize, threshold: f64) -> Result<Self, Error> {
        if threshold.is_nan() {
            return Err(Error::Threshold);
        }
        let squares = |centre: f64| {
            let square = |x: f64| (x - centre) * (x - centre);
            RangeMinimum::new(centres(cells, 0.0, 1.0).into_iter().map(square).collect())
        };
        Ok(Self {
            lattice: Lattice::new([cells; DIMENSION])?,
            threshold,
            description: description(
                Self::NAME,
                [("cells", cells.to_string()), ("threshold", threshold.to_string())],
            ),
            cells,
            squares: [squares(LOW), squares(HIGH)],
        })
    }

    /// The least over the centres of the distance whose squared part along axis j to the low or high coordinate is given.
    #[inline]
    fn least(&self, square: impl Fn(usize, &RangeMinimum) -> f64) -> f64 {
        let mut parts = [[0.0; 2]; DIMENSION];
        for (axis, part) in parts.iter_mut().enumerate() {
            *part = [square(axis, &self.squares[0]), square(axis, &self.squares[1])];
        }
        let sum = |centre: &[bool; DIMENSION]| {
            (parts.iter().zip(centre)).fold(0.0, |sum, (part, &high)| sum + part[usize::from(high)])
        };
        CENTRES.iter().map(sum).fold(f64::INFINITY, f64::min).sqrt()
    }
}

impl SatisficingProblem for Islands {
    lattice_methods!();

    #[inline]
    fn fitness(&self, cells: &Vec<u32>) -> f64 {
        if !self.lattice.holds(cells) {
            return f64::NAN;
        }
        self.least(|axis, squares| squares.table()[cells[axis] as usize])
    }
    fn bounds(&self) -> Option<&dyn Bounds<f64>> {
        Some(self)
    }
}

impl Bounds<f64> for Islands {
    /// From the least parts along each axis; rounding is monotone and in the order of the fitness.
    fn lower_bound(&self, region: &Region<f64>) -> Option<f64> {
        (region.lower.len() == DIMENSION && region.upper.len() == DIMENSION)
            .then(|| self.least(|axis, squares| squares.minimum(region.lower[axis], region.upper[axis])))
    }
}

impl Catalogued for Islands {
    const NAME: &'static str = "islands";
    const SUMMARY: &'static str = "cells of [0, 1]^4 inside one of eight balls far from each other";
    const SOURCE: &'static str = "a standard test set; counts by enumeration";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::integer("cells", "cells per axis, m", 40, 1, 10_000),
        Parameter::real("threshold", "radius of the balls, delta", 0.1, 0.0, 2.0),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::new(params.count("cells"), params.real("threshold"))
    }

    fn reference_hits(&self) -> Option<u64> {
        reference(PUBLISHED, self, DIMENSION, self.cells)
    }
}
