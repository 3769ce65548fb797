//! Newton's method from a point near a root, damped.

use satisfice::{Boundary, Located};

use super::equations::{Equations, UNKNOWNS};
use crate::number::Dual;

/// Below a sensible threshold ten steps suffice; more are needed only at near-singular roots.
const STEPS: usize = 60;
/// Damped steps are shorter than full ones.
const DAMPED_STEPS: usize = 1000;
/// A step is halved at most this many times.
const HALVINGS: usize = 20;
/// The first and the largest damping of Levenberg 1944, for points near a singularity, where the Gauss-Newton step fails.
const DAMPING: (f64, f64) = (1e-4, 1.0);

impl Equations {
    /// The root that Newton's method finds from a hit; `None` if it finds none inside the box.
    pub(crate) fn canonical(&self, hit: &Located<f64>) -> Option<Located<f64>> {
        Some(Located {
            coordinates: polish(self, &hit.coordinates)?,
            separation: hit.separation.clone(),
        })
    }
}

/// The root near `start`: as close as f64 allows, with a residual not above that of `start`, inside the box. `None` if
/// the Jacobian is singular or the iteration leaves the box.
fn polish(equations: &Equations, start: &[f64]) -> Option<Vec<f64>> {
    let before = equations.fitness(start);
    let (mut best, mut least) = (start.to_vec(), before);
    let can_damp = equations.residuals > start.len();
    let mut damping = 0.0;
    for _ in 0..if can_damp { DAMPED_STEPS } else { STEPS } {
        if least == 0.0 {
            break;
        }
        let step = newton_step(equations, &best, damping);
        if step.is_none() && !can_damp {
            return None;
        }
        let mut share = 1.0;
        let better = step.and_then(|step| {
            (0..HALVINGS).find_map(|_| {
                let next: Vec<f64> = best.iter().zip(step).map(|(x, step)| x - share * step).collect();
                let here = equations.fitness(&next);
                share *= 0.5;
                (here < least).then_some((next, here))
            })
        });
        match better {
            Some((next, here)) => {
                (best, least) = (next, here);
                damping = if damping > DAMPING.0 { damping / 4.0 } else { 0.0 };
            }
            None if can_damp && damping < DAMPING.1 => damping = (4.0 * damping).max(DAMPING.0),
            // No step improves it: only rounding is left.
            None => break,
        }
    }
    if equations.space.boundary() == Boundary::Wrap {
        equations.space.keep_inside(&mut best);
    }
    // A root on the border may come out a rounding error outside.
    for (x, axis) in best.iter_mut().zip(equations.space.axes()) {
        let tolerance = 1e-9 * axis.width();
        if *x < axis.lower() - tolerance || *x > axis.upper() + tolerance {
            return None;
        }
        *x = x.clamp(axis.lower(), axis.upper());
    }
    (equations.fitness(&best) <= before).then_some(best)
}

/// J(x)^-1 e(x), by Gaussian elimination with partial pivoting on the exact derivatives. With more equations than unknowns
/// the Gauss-Newton step, from J^T J, to whose diagonal `damping` is added.
fn newton_step(equations: &Equations, x: &[f64], damping: f64) -> Option<[f64; UNKNOWNS]> {
    let (n, m) = (x.len(), equations.residuals);
    let mut matrix = [[0.0; UNKNOWNS + 1]; UNKNOWNS];
    let mut input = [Dual {
        value: 0.0,
        slope: 0.0,
    }; UNKNOWNS];
    let mut output = input;
    for (input, &value) in input.iter_mut().zip(x) {
        input.value = value;
    }
    for column in 0..n {
        input[column].slope = 1.0;
        (equations.functions.dual)(&input[..n], &mut output[..m]);
        input[column].slope = 0.0;
        for (row, output) in matrix.iter_mut().zip(&output[..m]) {
            row[column] = output.slope;
            row[n] = output.value;
        }
    }
    if m > n {
        let tall = matrix;
        for (i, row) in matrix.iter_mut().enumerate().take(n) {
            for (j, entry) in row.iter_mut().enumerate().take(n + 1) {
                *entry = tall[..m].iter().map(|row| row[i] * row[j]).sum();
            }
            row[i] += damping;
        }
    }
    for column in 0..n {
        let pivot =
            (column..n).max_by(|&a, &b| matrix[a][column].abs().total_cmp(&matrix[b][column].abs()))?;
        matrix.swap(column, pivot);
        let divisor = matrix[column][column];
        if divisor == 0.0 || !divisor.is_finite() {
            return None;
        }
        let above = matrix[column];
        for row in &mut matrix[column + 1..n] {
            let factor = row[column] / divisor;
            for (entry, above) in row[column..=n].iter_mut().zip(&above[column..=n]) {
                *entry -= factor * above;
            }
        }
    }
    let mut step = [0.0; UNKNOWNS];
    for row in (0..n).rev() {
        let known: f64 = (row + 1..n).map(|k| matrix[row][k] * step[k]).sum();
        step[row] = (matrix[row][n] - known) / matrix[row][row];
    }
    Some(step)
}
