//! Feasible sets of the CEC2006 problems of constrained optimisation.

use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Error, SatisficingProblem};

use crate::lattice::{ENUMERABLE, Lattice, count_hits, description, lattice_methods};

/// Most inequalities and dimensions of a problem here.
const INEQUALITIES: usize = 9;
const DIMENSION: usize = 13;

struct Set {
    name: &'static str,
    bounds: &'static [(f64, f64)],
    /// Writes g_i(x), feasible where all are <= 0; returns how many.
    inequalities: fn(&[f64], &mut [f64; INEQUALITIES]) -> usize,
    /// Cells an axis by default: as many as can be enumerated, or 10.
    cells: usize,
}

const NAMES: &[&str] = &["g01", "g04", "g06", "g08", "g09", "g12", "g24"];
const SETS: [Set; 7] = [
    Set {
        name: "g01",
        bounds: &[
            (0.0, 1.0),
            (0.0, 1.0),
            (0.0, 1.0),
            (0.0, 1.0),
            (0.0, 1.0),
            (0.0, 1.0),
            (0.0, 1.0),
            (0.0, 1.0),
            (0.0, 1.0),
            (0.0, 100.0),
            (0.0, 100.0),
            (0.0, 100.0),
            (0.0, 1.0),
        ],
        inequalities: g01,
        cells: 10,
    },
    Set {
        name: "g04",
        bounds: &[
            (78.0, 102.0),
            (33.0, 45.0),
            (27.0, 45.0),
            (27.0, 45.0),
            (27.0, 45.0),
        ],
        inequalities: g04,
        cells: 20,
    },
    Set {
        name: "g06",
        bounds: &[(13.0, 100.0), (0.0, 100.0)],
        inequalities: g06,
        cells: 2000,
    },
    Set {
        name: "g08",
        bounds: &[(0.0, 10.0), (0.0, 10.0)],
        inequalities: g08,
        cells: 1000,
    },
    Set {
        name: "g09",
        bounds: &[(-10.0, 10.0); 7],
        inequalities: g09,
        cells: 10,
    },
    Set {
        name: "g12",
        bounds: &[(0.0, 10.0); 3],
        inequalities: g12,
        cells: 200,
    },
    Set {
        name: "g24",
        bounds: &[(0.0, 3.0), (0.0, 4.0)],
        inequalities: g24,
        cells: 1000,
    },
];

/// All cells of a lattice on the box of a CEC2006 problem whose centre x is feasible:
///
/// F(x) = max_i g_i(x) < delta, 0 by default.
///
/// Those of the 24 problems that have no equalities and whose feasible sets differ in kind: g01 (13 unknowns, linear), g04 (27 % of
/// the box), g06 (a thin crescent, 0.0066 % of the box), g08 (0.86 %), g09 (7 unknowns, 0.51 %), g12 (729 balls, 4.8 %), g24
/// (two parts, 44 %). The shares are those of Table 3 of the report, except for g04 and g24, for which it gives 52.1230 % and 79.6556 %,
/// against its own inequalities. A hit is a cell; counts are by enumeration where the lattice has at most 2e7 cells.
///
/// Source: Liang et al. 2006, Problem definitions and evaluation criteria for the CEC 2006 special session on constrained
/// real-parameter optimization.
///
/// ```
/// use satisfice::SatisficingProblem;
/// use satisfice_problems::Cec2006;
/// let crescent = Cec2006::new("g06", 100, 0.0)?;
/// assert_eq!(crescent.centre(&[0, 0]).len(), 2);
/// assert!(crescent.fitness(&vec![0, 0]) > 0.0);
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Cec2006 {
    lattice: Lattice,
    threshold: f64,
    description: Description,
    index: usize,
    cells: usize,
}

impl Cec2006 {
    /// The feasible set of `problem` with `cells` cells per axis, 0 for the default of that problem.
    ///
    /// # Errors
    /// [`Error::Unknown`] for an unknown name, [`Error::Threshold`] for NaN.
    pub fn new(problem: &str, cells: usize, threshold: f64) -> Result<Self, Error> {
        let index = SETS.iter().position(|set| set.name == problem);
        let index = index.ok_or_else(|| Error::unknown("problem", problem, NAMES.iter().copied()))?;
        if threshold.is_nan() {
            return Err(Error::Threshold);
        }
        let cells = if cells == 0 { SETS[index].cells } else { cells };
        Ok(Self {
            lattice: Lattice::new(vec![cells; SETS[index].bounds.len()])?,
            threshold,
            description: description(
                Self::NAME,
                [
                    ("problem", problem.to_owned()),
                    ("cells", cells.to_string()),
                    ("threshold", threshold.to_string()),
                ],
            ),
            index,
            cells,
        })
    }

    /// The centre of a cell; empty if it is not a cell of this problem.
    #[must_use]
    pub fn centre(&self, cells: &[u32]) -> Vec<f64> {
        if !self.lattice.holds(cells) {
            return Vec::new();
        }
        let bounds = SETS[self.index].bounds.iter();
        bounds
            .zip(cells)
            .map(|(bounds, cell)| self.coordinate(*bounds, *cell))
            .collect()
    }

    #[inline]
    fn coordinate(&self, (lower, upper): (f64, f64), cell: u32) -> f64 {
        lower + (upper - lower) * (f64::from(cell) + 0.5) / self.cells as f64
    }
}

impl SatisficingProblem for Cec2006 {
    lattice_methods!();

    #[inline]
    fn fitness(&self, cells: &Vec<u32>) -> f64 {
        if !self.lattice.holds(cells) {
            return f64::NAN;
        }
        let set = &SETS[self.index];
        let mut x = [0.0; DIMENSION];
        for ((x, bounds), &cell) in x.iter_mut().zip(set.bounds).zip(cells) {
            *x = self.coordinate(*bounds, cell);
        }
        let mut violations = [0.0; INEQUALITIES];
        let count = (set.inequalities)(&x[..cells.len()], &mut violations);
        violations[..count]
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max)
    }
}

impl Catalogued for Cec2006 {
    const NAME: &'static str = "cec2006";
    const SUMMARY: &'static str = "cells inside the feasible set of a CEC2006 problem";
    const SOURCE: &'static str =
        "Liang et al. 2006, CEC special session on constrained optimization; counts by enumeration";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::choice("problem", "which problem", "g06", NAMES),
        Parameter::integer(
            "cells",
            "cells per axis, m; 0 = 2000, 1000, 200, 20 or 10 by dimension",
            0,
            0,
            1_000_000,
        ),
        Parameter::real("threshold", "violation allowed, delta", 0.0, -1e6, 1e6),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::new(
            params.text("problem"),
            params.count("cells"),
            params.real("threshold"),
        )
    }

    fn reference_hits(&self) -> Option<u64> {
        count_hits(self, ENUMERABLE)
    }
}

fn g01(x: &[f64], g: &mut [f64; INEQUALITIES]) -> usize {
    *g = [
        2.0 * x[0] + 2.0 * x[1] + x[9] + x[10] - 10.0,
        2.0 * x[0] + 2.0 * x[2] + x[9] + x[11] - 10.0,
        2.0 * x[1] + 2.0 * x[2] + x[10] + x[11] - 10.0,
        -8.0 * x[0] + x[9],
        -8.0 * x[1] + x[10],
        -8.0 * x[2] + x[11],
        -2.0 * x[3] - x[4] + x[9],
        -2.0 * x[5] - x[6] + x[10],
        -2.0 * x[7] - x[8] + x[11],
    ];
    9
}

fn g04(x: &[f64], g: &mut [f64; INEQUALITIES]) -> usize {
    let u = 85.334407 + 0.0056858 * x[1] * x[4] + 0.0006262 * x[0] * x[3] - 0.0022053 * x[2] * x[4];
    let v = 80.51249 + 0.0071317 * x[1] * x[4] + 0.0029955 * x[0] * x[1] + 0.0021813 * x[2] * x[2];
    let w = 9.300961 + 0.0047026 * x[2] * x[4] + 0.0012547 * x[0] * x[2] + 0.0019085 * x[2] * x[3];
    g[..6].copy_from_slice(&[u - 92.0, -u, v - 110.0, 90.0 - v, w - 25.0, 20.0 - w]);
    6
}

fn g06(x: &[f64], g: &mut [f64; INEQUALITIES]) -> usize {
    g[0] = 100.0 - (x[0] - 5.0).powi(2) - (x[1] - 5.0).powi(2);
    g[1] = (x[0] - 6.0).powi(2) + (x[1] - 5.0).powi(2) - 82.81;
    2
}

fn g08(x: &[f64], g: &mut [f64; INEQUALITIES]) -> usize {
    g[0] = x[0] * x[0] - x[1] + 1.0;
    g[1] = 1.0 - x[0] + (x[1] - 4.0).powi(2);
    2
}

fn g09(x: &[f64], g: &mut [f64; INEQUALITIES]) -> usize {
    g[0] = -127.0 + 2.0 * x[0].powi(2) + 3.0 * x[1].powi(4) + x[2] + 4.0 * x[3].powi(2) + 5.0 * x[4];
    g[1] = -282.0 + 7.0 * x[0] + 3.0 * x[1] + 10.0 * x[2].powi(2) + x[3] - x[4];
    g[2] = -196.0 + 23.0 * x[0] + x[1].powi(2) + 6.0 * x[5].powi(2) - 8.0 * x[6];
    g[3] =
        4.0 * x[0].powi(2) + x[1].powi(2) - 3.0 * x[0] * x[1] + 2.0 * x[2].powi(2) + 5.0 * x[5] - 11.0 * x[6];
    4
}

/// Inside one of the balls of radius 1/4 around the points of {1, ..., 9}^3.
fn g12(x: &[f64], g: &mut [f64; INEQUALITIES]) -> usize {
    let part = |x: f64| (x - x.round().clamp(1.0, 9.0)).powi(2);
    g[0] = x.iter().map(|x| part(*x)).sum::<f64>() - 0.0625;
    1
}

fn g24(x: &[f64], g: &mut [f64; INEQUALITIES]) -> usize {
    let a = x[0];
    g[0] = -2.0 * a.powi(4) + 8.0 * a.powi(3) - 8.0 * a * a + x[1] - 2.0;
    g[1] = -4.0 * a.powi(4) + 32.0 * a.powi(3) - 88.0 * a * a + 96.0 * a + x[1] - 36.0;
    2
}
