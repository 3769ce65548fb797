//! A planar arm with more joints than the plane needs.

use core::f64::consts::PI;

use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Error, SatisficingProblem};

use crate::lattice::{Lattice, Published, as_published, description, lattice_methods, reference};

/// Links, cells per angle, threshold, hits. The hits are those of `--example enumerate`.
const PUBLISHED: &[Published] = &[(3, 100, 0.01, 128), (4, 50, 0.015, 2_724), (5, 24, 0.03, 11_667)];

const GOAL: [f64; 2] = [0.45, 0.2];

/// All postures of a planar arm of n equal links and total length 1 whose tip is near a goal:
///
/// F(q) = |(1/n) sum_k (cos a_k, sin a_k) - (0.45, 0.2)| < delta, a_k = q_1 + ... + q_k.
///
/// Each relative angle q_k is the centre of one of m equal cells of [-pi, pi]; a hit is a cell. Three links leave one
/// degree of freedom, five leave three.
///
/// ```
/// use satisfice_problems::Arm;
/// let arm = Arm::new(3, 60, 0.05)?;
/// let joints = arm.joints(&[30, 30, 30]); // nearly straight
/// assert_eq!(joints.len(), 4);
/// assert!(joints[3][0] > 0.98);
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Arm {
    lattice: Lattice,
    threshold: f64,
    description: Description,
    cells: usize,
    /// (cos, sin) of the multiples of pi / m over one turn: every sum of cell centres is one of them.
    directions: Vec<[f64; 2]>,
}

impl Arm {
    /// An arm of `links` links with `cells` cells per angle; `threshold` in units of the arm's length.
    ///
    /// # Errors
    /// [`Error::NoAxis`] or [`Error::Bounds`] for a number that is 0; [`Error::Threshold`] for NaN.
    pub fn new(links: usize, cells: usize, threshold: f64) -> Result<Self, Error> {
        if threshold.is_nan() {
            return Err(Error::Threshold);
        }
        let direction = |k: usize| {
            let angle = PI * k as f64 / cells as f64;
            [angle.cos(), angle.sin()]
        };
        Ok(Self {
            lattice: Lattice::new(vec![cells; links])?,
            threshold,
            description: description(
                Self::NAME,
                [
                    ("links", links.to_string()),
                    ("cells", cells.to_string()),
                    ("threshold", threshold.to_string()),
                ],
            ),
            cells,
            directions: (0..2 * cells).map(direction).collect(),
        })
    }

    /// The joints of a posture from the base (0, 0) to the tip; empty if they are not cells of this arm.
    #[must_use]
    pub fn joints(&self, cells: &[u32]) -> Vec<[f64; 2]> {
        if !self.lattice.holds(cells) {
            return Vec::new();
        }
        let mut joints = vec![[0.0; 2]];
        self.walk(cells, |joint| joints.push(joint));
        joints
    }

    /// The goal of the tip.
    #[must_use]
    pub fn goal(&self) -> [f64; 2] {
        GOAL
    }

    #[inline]
    fn walk(&self, cells: &[u32], mut visit: impl FnMut([f64; 2])) {
        let length = 1.0 / cells.len() as f64;
        let turn = self.directions.len();
        let [mut x, mut y] = [0.0; 2];
        let mut angle = 0; // in units of pi / m
        for &cell in cells {
            // The centre of cell k of m is -pi + (2 k + 1) pi / m.
            angle = (angle + 2 * cell as usize + 1 + self.cells) % turn;
            let [cos, sin] = self.directions[angle];
            (x, y) = (x + cos * length, y + sin * length);
            visit([x, y]);
        }
    }
}

/// How far the tip is from the goal along each axis, by the threshold.
impl satisfice::Components<f64, Vec<u32>> for Arm {
    fn count(&self) -> usize {
        2
    }

    fn write(&self, cells: &Vec<u32>, components: &mut [f64]) {
        if !self.lattice.holds(cells) {
            return components.fill(f64::NAN);
        }
        let mut tip = [0.0; 2];
        self.walk(cells, |joint| tip = joint);
        for ((component, tip), goal) in components.iter_mut().zip(tip).zip(GOAL) {
            *component = (tip - goal) / self.threshold;
        }
    }
}

impl SatisficingProblem for Arm {
    lattice_methods!();

    fn components(&self) -> Option<&dyn satisfice::Components<f64, Vec<u32>>> {
        Some(self)
    }

    #[inline]
    fn fitness(&self, cells: &Vec<u32>) -> f64 {
        if !self.lattice.holds(cells) {
            return f64::NAN;
        }
        let mut tip = [0.0; 2];
        self.walk(cells, |joint| tip = joint);
        let (x, y) = (tip[0] - GOAL[0], tip[1] - GOAL[1]);
        (x * x + y * y).sqrt()
    }
}

impl Catalogued for Arm {
    const NAME: &'static str = "arm";
    const SUMMARY: &'static str = "postures of a redundant planar arm whose tip is at (0.45, 0.2)";
    const SOURCE: &'static str = "a standard redundant manipulator; counts by enumeration";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::integer("links", "number of links, n", 3, 1, 64),
        Parameter::integer(
            "cells",
            "cells per angle, m; 0 = as published for this number of links",
            0,
            0,
            1_000_000,
        ),
        Parameter::real(
            "threshold",
            "distance of the tip, delta, in arm lengths; below 0 = as published for this number of links",
            -1.0,
            -1.0,
            2.0,
        ),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        let links = params.count("links");
        let (cells, threshold) = as_published(
            PUBLISHED,
            ("links", links),
            params.count("cells"),
            params.real("threshold"),
        )?;
        Self::new(links, cells, threshold)
    }

    fn reference_hits(&self) -> Option<u64> {
        reference(PUBLISHED, self, self.lattice.space().dimension(), self.cells)
    }
}
