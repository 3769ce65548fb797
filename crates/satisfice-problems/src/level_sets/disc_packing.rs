//! Discs that do not overlap.

use satisfice::Encoding;
use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Axis, Error, SatisficingProblem, Space};

use crate::constraints::{Extendable, counted};
use crate::lattice::description;

/// All ways to put n points on an m x m grid of the unit square with mutual distances above d: n equal discs of diameter d
/// packed into a square of edge 1 + d.
///
/// F = d - min_(i < j) |p_i - p_j|, a hit is F < 0. Discs are interchangeable: the solution is the ascending list of grid cells,
/// row by row, and an arrangement counts once. Axes are x and y of each point. For n = 3 no distance above sqrt 6 - sqrt 2 = 1.035
/// is possible; at the default 0.95 a few narrow families of arrangements are left. The reference count is by
/// backtracking over ascending cells.
///
/// Source: Schaer 1965, doi 10.4153/CMB-1965-018-9 (the packing of points in a square).
///
/// ```
/// use satisfice::SatisficingProblem;
/// use satisfice_problems::DiscPacking;
/// let problem = DiscPacking::new(2, 3, 1.2)?;
/// assert!(problem.fitness(&vec![0, 8]) < 0.0); // opposite corners
/// assert!(problem.fitness(&vec![0, 2]) > 0.0); // an edge of the square
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct DiscPacking {
    space: Space<f64>,
    description: Description,
    discs: usize,
    grid: u32,
    diameter: f64,
}

impl DiscPacking {
    /// `discs` points on a grid of `grid` x `grid` points, farther apart than `diameter` in edges of the square.
    ///
    /// # Errors
    /// [`Error::Parameter`] for fewer than 2 discs or grid points, or more than 1000; or a diameter that is not positive and
    /// finite.
    pub fn new(discs: usize, grid: usize, diameter: f64) -> Result<Self, Error> {
        for (name, number) in [("discs", discs), ("grid", grid)] {
            if !(2..=1000).contains(&number) {
                return Err(Error::parameter(name, number, "a whole number from 2 to 1000"));
            }
        }
        if !(diameter > 0.0 && diameter.is_finite()) {
            return Err(Error::parameter("diameter", diameter, "a number above 0"));
        }
        Ok(Self {
            space: Space::new(vec![Axis::integer(0, grid as i64 - 1); 2 * discs])?,
            description: description(
                Self::NAME,
                [
                    ("discs", discs.to_string()),
                    ("grid", grid.to_string()),
                    ("diameter", diameter.to_string()),
                ],
            ),
            discs,
            grid: grid as u32,
            diameter,
        })
    }

    /// The centres of a solution, in [0, 1]^2.
    #[must_use]
    pub fn centres(&self, cells: &[u32]) -> Vec<[f64; 2]> {
        cells.iter().map(|&cell| self.centre(cell)).collect()
    }

    fn centre(&self, cell: u32) -> [f64; 2] {
        let last = f64::from(self.grid - 1);
        [
            f64::from(cell % self.grid) / last,
            f64::from(cell / self.grid) / last,
        ]
    }

    #[inline]
    fn distance(&self, a: u32, b: u32) -> f64 {
        let ([ax, ay], [bx, by]) = (self.centre(a), self.centre(b));
        ((ax - bx) * (ax - bx) + (ay - by) * (ay - by)).sqrt()
    }

    fn holds(&self, cells: &[u32]) -> bool {
        cells.len() == self.discs && cells.iter().all(|&cell| cell < self.grid * self.grid)
    }
}

impl Extendable for DiscPacking {
    fn values(&self, disc: usize) -> Option<u32> {
        (disc < self.discs).then_some(self.grid * self.grid)
    }
    fn extends(&self, cells: &[u32]) -> bool {
        let Some((&last, before)) = cells.split_last() else {
            return true;
        };
        before
            .iter()
            .all(|&cell| cell < last && self.distance(cell, last) > self.diameter)
    }
}

impl SatisficingProblem for DiscPacking {
    type Scalar = f64;
    type Solution = Vec<u32>;

    fn space(&self) -> &Space<f64> {
        &self.space
    }
    fn decode(&self, values: &[f64]) -> Vec<u32> {
        let mut cells = Vec::with_capacity(self.discs);
        self.decode_into(values, &mut cells);
        cells
    }
    fn decode_into(&self, values: &[f64], cells: &mut Vec<u32>) {
        cells.clear();
        cells.extend(
            values
                .chunks_exact(2)
                .map(|point| point[1] as u32 * self.grid + point[0] as u32),
        );
        cells.sort_unstable();
    }
    #[inline]
    fn fitness(&self, cells: &Vec<u32>) -> f64 {
        if !self.holds(cells) {
            return f64::NAN;
        }
        let mut least = f64::INFINITY;
        for (k, &cell) in cells.iter().enumerate() {
            for &other in &cells[..k] {
                least = least.min(self.distance(cell, other));
            }
        }
        self.diameter - least
    }
    fn threshold(&self) -> f64 {
        0.0
    }
    fn description(&self) -> Description {
        self.description.clone()
    }
    fn encoding(&self) -> Option<&dyn Encoding<f64, Vec<u32>>> {
        Some(self)
    }
}

impl Encoding<f64, Vec<u32>> for DiscPacking {
    fn encode(&self, cells: &Vec<u32>, values: &mut [f64]) -> bool {
        if !self.holds(cells) || !cells.is_sorted() || values.len() != 2 * self.discs {
            return false;
        }
        for (point, &cell) in values.chunks_exact_mut(2).zip(cells) {
            point[0] = f64::from(cell % self.grid);
            point[1] = f64::from(cell / self.grid);
        }
        true
    }
}

impl Catalogued for DiscPacking {
    const NAME: &'static str = "disc-packing";
    const SUMMARY: &'static str = "arrangements of equal discs in a square without overlap";
    const SOURCE: &'static str = "Schaer 1965, doi 10.4153/CMB-1965-018-9; counts by backtracking";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::integer("discs", "number of discs, n", 3, 2, 1000),
        Parameter::integer("grid", "grid points along an edge, m", 15, 2, 1000),
        Parameter::real(
            "diameter",
            "least distance of centres, d, in edges of their square",
            0.95,
            1e-9,
            2.0,
        ),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::new(
            params.count("discs"),
            params.count("grid"),
            params.real("diameter"),
        )
    }

    fn reference_hits(&self) -> Option<u64> {
        counted(self)
    }
}
