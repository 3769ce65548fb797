//! An arm with seven joints and their limits.

use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Error, SatisficingProblem};

use crate::lattice::{ENUMERABLE, Lattice, count_hits, description, lattice_methods};

const JOINTS: usize = 7;
/// Limits of the joints in degrees, to both sides.
const LIMITS: [f64; JOINTS] = [170.0, 120.0, 170.0, 120.0, 170.0, 120.0, 175.0];
/// Lengths in metres: base to shoulder, upper arm, forearm, wrist to flange; the tool stands out sideways.
const SHOULDER: f64 = 0.34;
const UPPER: f64 = 0.4;
const FOREARM: f64 = 0.4;
const FLANGE: f64 = 0.126;
const TOOL: f64 = 0.1;
const GOAL: [f64; 3] = [0.45, 0.2, 0.5];
/// Cells an angle, threshold, hits, by `--example enumerate`.
const PUBLISHED: (usize, f64, u64) = (10, 0.03, 514);

type Vector = [f64; 3];
/// The columns of a rotation.
type Frame = [Vector; 3];

/// All postures of an arm with seven joints that bring its tool to a goal:
///
/// F(q) = |p(q) - (0.45, 0.2, 0.5)| < delta = 0.03 m.
///
/// The arm has the proportions of the KUKA LBR iiwa 7: joints turn about z, y, z, -y, z, y, z of the links, within 170, 120,
/// 170, 120, 170, 120, 175 degrees to both sides; lengths 0.34, 0.4, 0.4, 0.126 m; the tool stands 0.1 m sideways. Three
/// equations leave a self-motion of four dimensions. Each angle is the centre of one of m equal cells between its limits;
/// a hit is a cell.
///
/// Source: Kuhlemann et al. 2016 (the proportions); count by enumeration.
///
/// ```
/// use satisfice_problems::SevenJoints;
/// let arm = SevenJoints::new(10, 0.03)?;
/// assert_eq!(arm.angles(&[5; 7]).len(), 7);
/// assert_eq!(arm.joints(&[5; 7]).len(), 5); // shoulder, elbow, wrist, flange, tool
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct SevenJoints {
    lattice: Lattice,
    threshold: f64,
    description: Description,
    cells: usize,
    /// (cos, sin) of the angles of each joint.
    turns: Vec<Vec<[f64; 2]>>,
}

impl SevenJoints {
    /// Postures with `cells` cells per angle; `threshold` in metres.
    ///
    /// # Errors
    /// [`Error::Bounds`] for 0 cells, [`Error::Threshold`] for NaN.
    pub fn new(cells: usize, threshold: f64) -> Result<Self, Error> {
        if threshold.is_nan() {
            return Err(Error::Threshold);
        }
        let turns = |limit: f64| {
            let angle = |k: usize| limit.to_radians() * ((2 * k + 1) as f64 / cells as f64 - 1.0);
            (0..cells).map(|k| [angle(k).cos(), angle(k).sin()]).collect()
        };
        Ok(Self {
            lattice: Lattice::new([cells; JOINTS])?,
            threshold,
            description: description(
                Self::NAME,
                [("cells", cells.to_string()), ("threshold", threshold.to_string())],
            ),
            cells,
            turns: LIMITS.map(turns).to_vec(),
        })
    }

    /// The angles of a solution in radians; empty if they are not cells of this arm.
    #[must_use]
    pub fn angles(&self, cells: &[u32]) -> Vec<f64> {
        if !self.lattice.holds(cells) {
            return Vec::new();
        }
        let turns = self.turns.iter().zip(cells);
        turns
            .map(|(turns, &cell)| turns[cell as usize])
            .map(|[cos, sin]| sin.atan2(cos))
            .collect()
    }

    /// Shoulder, elbow, wrist, flange and tool of a solution; empty if they are not cells of this arm.
    #[must_use]
    pub fn joints(&self, cells: &[u32]) -> Vec<Vector> {
        if !self.lattice.holds(cells) {
            return Vec::new();
        }
        let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mut frame = [x, y, z];
        let mut place = [0.0; 3];
        let mut joints = Vec::with_capacity(5);
        for (joint, (turns, &cell)) in self.turns.iter().zip(cells).enumerate() {
            let [cos, sin] = turns[cell as usize];
            frame = match joint {
                1 | 5 => about_y(frame, cos, sin),
                3 => about_y(frame, cos, -sin),
                _ => about_z(frame, cos, sin),
            };
            let length = match joint {
                0 => SHOULDER,
                2 => UPPER,
                4 => FOREARM,
                6 => FLANGE,
                _ => continue,
            };
            place = along(place, frame[2], length);
            joints.push(place);
        }
        joints.push(along(place, frame[0], TOOL));
        joints
    }
}

/// The frame turned about its own z.
#[inline]
fn about_z([x, y, z]: Frame, cos: f64, sin: f64) -> Frame {
    [blend(x, cos, y, sin), blend(y, cos, x, -sin), z]
}

/// The frame turned about its own y.
#[inline]
fn about_y([x, y, z]: Frame, cos: f64, sin: f64) -> Frame {
    [blend(x, cos, z, -sin), y, blend(z, cos, x, sin)]
}

#[inline]
fn blend(a: Vector, cos: f64, b: Vector, sin: f64) -> Vector {
    core::array::from_fn(|k| cos * a[k] + sin * b[k])
}

#[inline]
fn along(from: Vector, direction: Vector, length: f64) -> Vector {
    core::array::from_fn(|k| from[k] + length * direction[k])
}

/// How far the tool is from the goal along each axis, by the threshold.
impl satisfice::Components<f64, Vec<u32>> for SevenJoints {
    fn count(&self) -> usize {
        3
    }

    fn write(&self, cells: &Vec<u32>, components: &mut [f64]) {
        let joints = self.joints(cells);
        let Some(tool) = joints.last() else {
            return components.fill(f64::NAN);
        };
        for ((component, tool), goal) in components.iter_mut().zip(tool).zip(GOAL) {
            *component = (tool - goal) / self.threshold;
        }
    }
}

impl SatisficingProblem for SevenJoints {
    lattice_methods!();

    fn components(&self) -> Option<&dyn satisfice::Components<f64, Vec<u32>>> {
        Some(self)
    }

    fn fitness(&self, cells: &Vec<u32>) -> f64 {
        let joints = self.joints(cells);
        let Some(tool) = joints.last() else {
            return f64::NAN;
        };
        let square: f64 = tool.iter().zip(GOAL).map(|(a, b)| (a - b) * (a - b)).sum();
        square.sqrt()
    }
}

impl Catalogued for SevenJoints {
    const NAME: &'static str = "seven-joints";
    const SUMMARY: &'static str =
        "postures of an arm with seven joints and their limits whose tool is at a goal";
    const SOURCE: &'static str = "proportions of the KUKA LBR iiwa 7; count by enumeration";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::integer("cells", "cells per angle, m", 10, 1, 100_000),
        Parameter::real(
            "threshold",
            "distance of the tool, delta, in metres",
            0.03,
            0.0,
            10.0,
        ),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::new(params.count("cells"), params.real("threshold"))
    }

    fn reference_hits(&self) -> Option<u64> {
        let (cells, threshold, hits) = PUBLISHED;
        if self.cells == cells && self.threshold.total_cmp(&threshold).is_eq() {
            return Some(hits);
        }
        count_hits(self, ENUMERABLE)
    }
}
