//! The level set of Rastrigin's function.

use core::f64::consts::TAU;
use satisfice::Bounds;

use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Error, Region, SatisficingProblem};

use crate::lattice::{
    Lattice, Published, RangeMinimum, as_published, centres, description, lattice_methods, reference,
};

/// Dimension, cells per axis, threshold, hits. The hits are those of `--example enumerate`.
const PUBLISHED: &[Published] = &[
    (2, 1000, 4.0, 15_136),
    (3, 100, 6.0, 3_184),
    (4, 40, 8.0, 1_664),
    (5, 24, 14.0, 6_624),
    (6, 14, 20.0, 4_992),
];

/// All cells of a lattice on [-2.56, 2.56]^D whose centre x has
///
/// F(x) = sum_i (x_i^2 + 10 - 10 cos 2 pi x_i) < delta:
///
/// many islands of several sizes on a grid of period 1. A hit is a cell; F is separable, which gives exact bounds of regions.
///
/// Source: Rastrigin 1974; in D dimensions Mühlenbein, Schomisch, Born 1991, doi 10.1016/S0167-8191(05)80052-3.
///
/// ```
/// use satisfice::catalogue::Catalogued;
/// use satisfice::SatisficingProblem;
/// let problem = satisfice_problems::Rastrigin::new(2, 1000, 4.0)?;
/// assert!(problem.fitness(&vec![500, 500]) < 0.01); // next to the optimum
/// assert_eq!(problem.reference_hits(), Some(15_136));
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Rastrigin {
    lattice: Lattice,
    threshold: f64,
    description: Description,
    cells: usize,
    terms: RangeMinimum,
}

impl Rastrigin {
    /// The level set below `threshold` in `dimension` dimensions with `cells` cells per axis.
    ///
    /// # Errors
    /// [`Error::NoAxis`] or [`Error::Bounds`] for a number that is 0; [`Error::Threshold`] for NaN.
    pub fn new(dimension: usize, cells: usize, threshold: f64) -> Result<Self, Error> {
        if threshold.is_nan() {
            return Err(Error::Threshold);
        }
        let lattice = Lattice::new(vec![cells; dimension])?;
        let term = |x: f64| x * x + 10.0 - 10.0 * (TAU * x).cos();
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
            terms: RangeMinimum::new(centres(cells, -2.56, 2.56).into_iter().map(term).collect()),
        })
    }
}

impl SatisficingProblem for Rastrigin {
    lattice_methods!();

    #[inline]
    fn fitness(&self, cells: &Vec<u32>) -> f64 {
        if !self.lattice.holds(cells) {
            return f64::NAN;
        }
        let terms = self.terms.table();
        cells.iter().fold(0.0, |sum, &cell| sum + terms[cell as usize])
    }
    fn bounds(&self) -> Option<&dyn Bounds<f64>> {
        Some(self)
    }
}

impl Bounds<f64> for Rastrigin {
    /// The sum of the least terms. Rounding is monotone and both sums run in the same order: no fitness is below it.
    fn lower_bound(&self, region: &Region<f64>) -> Option<f64> {
        let axes = region.lower.iter().zip(&region.upper);
        Some(axes.fold(0.0, |sum, (&from, &to)| sum + self.terms.minimum(from, to)))
    }
}

impl Catalogued for Rastrigin {
    const NAME: &'static str = "rastrigin";
    const SUMMARY: &'static str =
        "cells of [-2.56, 2.56]^D where Rastrigin's function is below a level: islands on a grid";
    const SOURCE: &'static str =
        "Mühlenbein, Schomisch, Born 1991, doi 10.1016/S0167-8191(05)80052-3; counts by enumeration";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::integer("dimension", "number of axes, D", 5, 1, 64),
        Parameter::integer(
            "cells",
            "cells per axis, m; 0 = as published for this dimension",
            0,
            0,
            1_000_000,
        ),
        Parameter::real(
            "threshold",
            "the level, delta; below 0 = as published for this dimension",
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
