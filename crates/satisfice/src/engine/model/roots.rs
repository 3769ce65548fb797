//! Newton steps to the roots of the modelled components.

use super::lanes::{LANES, Lanes};
use super::limits::ComponentLimits;
use super::process::{Block, Process};
use super::units::{Shape, Units};

/// Steps from a point, each with another damping: squares of how many length scales a step costs what a deviation does.
const DAMPINGS: [f64; LANES] = [
    1e-8, 1e-6, 1e-5, 1e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0,
];
/// Step of a difference quotient, in length scales.
const DIFFERENCE: f64 = 1e-3;

/// The block of points that damped Gauss-Newton steps from `x` lead to (Levenberg 1944, doi 10.1090/qam/10666), for residuals that count
/// by their deviations, limits included.
pub(super) fn steps(process: &Process, units: &Units, limits: &ComponentLimits, x: &[f64]) -> Vec<Lanes> {
    let moving: Vec<usize> = (0..x.len())
        .filter(|&j| matches!(units.axes[j].shape, Shape::Line | Shape::Circle))
        .collect();
    let length = |j: usize| process.scales.length(j).min(0.5);
    let outputs = process.outputs();
    // Residuals at x, and their differences along each axis, all by their deviations at x.
    let mut residuals = vec![0.0; outputs];
    let mut slopes = vec![vec![0.0; outputs]; moving.len()];
    for (from, some) in moving.chunks(LANES - 1).enumerate() {
        let mut lanes: Vec<Lanes> = x.iter().map(|&x| [x; LANES]).collect();
        for (lane, &j) in some.iter().enumerate() {
            lanes[j][lane + 1] += DIFFERENCE * length(j);
        }
        let mut block = Block::new(lanes);
        process.update(&mut block);
        for k in 0..outputs {
            let (means, variances) = process.predictions(&block, k);
            let deviation = (variances[0] + limits.square(k)).sqrt();
            residuals[k] = means[0] / deviation;
            for lane in 0..some.len() {
                slopes[from * (LANES - 1) + lane][k] = (means[lane + 1] - means[0]) / DIFFERENCE / deviation;
            }
        }
    }
    let system = System::new(slopes, &residuals);
    let mut lanes: Vec<Lanes> = x.iter().map(|&x| [x; LANES]).collect();
    let mut target = x.to_vec();
    for (lane, damping) in DAMPINGS.iter().enumerate() {
        let step = system.step(*damping);
        target.copy_from_slice(x);
        for (&j, step) in moving.iter().zip(step) {
            let moved = x[j] + step * length(j);
            target[j] = if units.axes[j].shape == Shape::Circle {
                moved - moved.floor()
            } else {
                moved.clamp(0.0, 1.0)
            };
            if !target[j].is_finite() {
                target[j] = x[j];
            }
        }
        units.round(&mut target);
        for (lanes, &x) in lanes.iter_mut().zip(&target) {
            lanes[lane] = x;
        }
    }
    lanes
}

/// The linear system of the steps, in as many unknowns as there are axes or residuals, whichever are fewer:
/// `(J'J + damping)^-1 J' = J' (JJ' + damping)^-1`.
struct System {
    /// Of each axis, how the residuals change along it.
    slopes: Vec<Vec<f64>>,
    by_axes: bool,
    matrix: Vec<Vec<f64>>,
    right: Vec<f64>,
}

impl System {
    fn new(slopes: Vec<Vec<f64>>, residuals: &[f64]) -> Self {
        let products = |rows: &[Vec<f64>]| -> Vec<Vec<f64>> {
            let row = |a: &Vec<f64>| rows.iter().map(|b| dot(a, b)).collect();
            rows.iter().map(row).collect()
        };
        let by_axes = slopes.len() <= residuals.len();
        let (matrix, right) = if by_axes {
            let right = slopes.iter().map(|a| -dot(a, residuals)).collect();
            (products(&slopes), right)
        } else {
            let of_residual = |k: usize| slopes.iter().map(|a| a[k]).collect();
            let rows: Vec<Vec<f64>> = (0..residuals.len()).map(of_residual).collect();
            (products(&rows), residuals.iter().map(|r| -r).collect())
        };
        Self {
            slopes,
            by_axes,
            matrix,
            right,
        }
    }

    /// The step along each axis.
    fn step(&self, damping: f64) -> Vec<f64> {
        let solved = solve(self.matrix.clone(), self.right.clone(), damping);
        if self.by_axes {
            return solved;
        }
        self.slopes.iter().map(|a| dot(a, &solved)).collect()
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Solves `(A + damping) s = b` for a symmetric `A` that is nowhere negative, by a Cholesky factor.
fn solve(mut a: Vec<Vec<f64>>, mut b: Vec<f64>, damping: f64) -> Vec<f64> {
    let n = b.len();
    for i in 0..n {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| a[i][k] * a[j][k]).sum();
            let rest = a[i][j] - known;
            a[i][j] = if i == j {
                (rest + damping).max(damping).sqrt()
            } else {
                rest / a[j][j]
            };
        }
        let known: f64 = (0..i).map(|k| a[i][k] * b[k]).sum();
        b[i] = (b[i] - known) / a[i][i];
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|k| a[k][i] * b[k]).sum();
        b[i] = (b[i] - known) / a[i][i];
    }
    b
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::model::limits::Norm;
    use crate::engine::model::scales::Scales;
    use crate::space::{Axis, Space};

    /// Two modelled planes that meet 0 at one point of a square, and a category that stays.
    #[test]
    fn one_of_the_steps_leads_to_the_root_of_planes() {
        let axes = [
            Axis::continuous(0.0, 1.0),
            Axis::categorical(3),
            Axis::continuous(0.0, 1.0),
        ];
        let units = Units::of(&Space::<f64>::new(axes).unwrap());
        let mut scales = Scales::new(units.shapes());
        scales.logs[..3].fill(1.0);
        let points: Vec<[f64; 3]> = (0..40)
            .map(|i| {
                [
                    (f64::from(i) * 0.754_877).fract(),
                    0.5,
                    (f64::from(i) * 0.569_840).fract(),
                ]
            })
            .collect();
        let values = [
            points.iter().map(|x| x[0] - x[2] + 0.2).collect(),
            points.iter().map(|x| x[0] + x[2] - 1.0).collect(),
        ];
        let inputs: Vec<&[f64]> = points.iter().map(|x| &x[..]).collect();
        let process = Process::new(scales, &inputs, &values);
        let limits = ComponentLimits::new(Norm::Greatest, vec![1.0; 2]);
        let steps = steps(&process, &units, &limits, &[0.9, 0.5, 0.2]);
        let distance = |lane: usize| (steps[0][lane] - 0.4).hypot(steps[2][lane] - 0.6);
        assert!(distance(0) < 5e-3 && distance(LANES - 1) > 0.1, "{steps:?}");
        assert!(steps[1].iter().all(|&x| x == 0.5));
    }

    /// One residual along three axes, and one axis with three residuals, against the solution written down.
    #[test]
    fn steps_are_the_same_in_axes_and_in_residuals() {
        let (slopes, residual, damping) = ([1.0, -2.0, 0.5], 3.0, 0.1);
        let rows = slopes.iter().map(|&slope| vec![slope]).collect();
        let steps = System::new(rows, &[residual]).step(damping);
        let scale = -residual / (dot(&slopes, &slopes) + damping);
        for (step, slope) in steps.iter().zip(slopes) {
            approx::assert_relative_eq!(*step, scale * slope, epsilon = 1e-14);
        }
        let residuals = [0.3, -1.0, 2.0];
        let steps = System::new(vec![slopes.to_vec()], &residuals).step(damping);
        let expected = -dot(&slopes, &residuals) / (dot(&slopes, &slopes) + damping);
        approx::assert_relative_eq!(steps[0], expected, epsilon = 1e-14);
    }

    #[test]
    fn a_singular_system_is_solved_by_its_damping() {
        let step = solve(vec![vec![1.0, 1.0], vec![1.0, 1.0]], vec![2.0, 2.0], 1e-8);
        assert!(step.iter().all(|x| (x - 1.0).abs() < 1e-6), "{step:?}");
        approx::assert_relative_eq!(solve(vec![vec![0.0]], vec![3.0], 0.5)[0], 6.0);
    }
}
