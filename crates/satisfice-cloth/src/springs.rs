//! The springs of a cloth: structural, shear and bending, each a distance with a compliance.

use satisfice_collision::distance::Point;

/// A distance that two particles keep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Spring {
    pub(crate) a: u32,
    pub(crate) b: u32,
    /// Rest length.
    pub(crate) rest: f64,
    /// Inverse stiffness over the mass of a particle, in s^2; 0 is rigid.
    pub(crate) compliance: f64,
}

/// Along the edges of the cells.
const STRUCTURAL: f64 = 0.0;
/// Along their diagonals.
const SHEAR: f64 = 2e-7;
/// Over two cells.
const BENDING: f64 = 3e-6;

/// The springs of `columns` x `columns` particles in rows, `spacing` apart.
pub(crate) fn springs(columns: u32, spacing: f64) -> Vec<Spring> {
    let kinds = [
        ((1, 0), STRUCTURAL),
        ((0, 1), STRUCTURAL),
        ((1, 1), SHEAR),
        ((1, -1), SHEAR),
        ((2, 0), BENDING),
        ((0, 2), BENDING),
    ];
    let mut springs = Vec::new();
    for ((right, down), compliance) in kinds {
        for row in 0..columns {
            for column in 0..columns {
                let to = (row.checked_add_signed(down), column + right);
                let (Some(other_row), other_column) = to else {
                    continue;
                };
                if other_row >= columns || other_column >= columns {
                    continue;
                }
                let length = f64::hypot(f64::from(right), f64::from(down));
                springs.push(Spring {
                    a: row * columns + column,
                    b: other_row * columns + other_column,
                    rest: length * spacing,
                    compliance,
                });
            }
        }
    }
    springs
}

/// One XPBD correction of every spring in turn (Gauss-Seidel) for a step of `dt` seconds, one iteration per step:
///
/// ```text
/// dx_a = -w C n / (2 w + compliance / dt^2),   C = |x_a - x_b| - rest,   w = 1
/// ```
pub(crate) fn relax(springs: &[Spring], points: &mut [Point], dt: f64) {
    let inverse = 1.0 / (dt * dt);
    for spring in springs {
        let (a, b) = (spring.a as usize, spring.b as usize);
        let (p, q) = (points[a], points[b]);
        let d = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
        let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        if length <= 0.0 {
            // The points coincide: there is no direction to push in until the next step.
            continue;
        }
        let share = (length - spring.rest) / (length * (2.0 + spring.compliance * inverse));
        for k in 0..3 {
            points[a][k] -= share * d[k];
            points[b][k] += share * d[k];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_particle_has_its_springs() {
        let springs = springs(5, 0.1);
        // Structural 2 n (n-1), shear 2 (n-1)^2, bending 2 n (n-2).
        assert_eq!(springs.len(), 2 * 5 * 4 + 2 * 16 + 2 * 5 * 3);
        let at = |i: u32| [f64::from(i % 5) * 0.1, f64::from(i / 5) * 0.1];
        for spring in &springs {
            let (p, q) = (at(spring.a), at(spring.b));
            assert!((f64::hypot(p[0] - q[0], p[1] - q[1]) - spring.rest).abs() < 1e-12);
        }
    }

    #[test]
    fn a_stretched_spring_comes_to_rest() {
        let rigid = [Spring {
            a: 0,
            b: 1,
            rest: 1.0,
            compliance: 0.0,
        }];
        let mut points = [[0.0; 3], [3.0, 0.0, 0.0]];
        relax(&rigid, &mut points, 0.01);
        assert_eq!(points, [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
        let soft = [Spring {
            compliance: 2e-4,
            ..rigid[0]
        }];
        let mut points = [[0.0; 3], [3.0, 0.0, 0.0]];
        relax(&soft, &mut points, 0.01);
        // 2 / (2 + 2e-4 / 1e-4): half as far.
        assert_eq!(points, [[0.5, 0.0, 0.0], [2.5, 0.0, 0.0]]);
    }
}
