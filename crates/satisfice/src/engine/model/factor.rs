//! Cholesky factor of a covariance matrix, extended by one row for each point.

use super::lanes::{LANES, Lanes};

/// Pivots below this are raised to it: rounding may make the covariance of two close points singular.
const LEAST_PIVOT: f64 = 1e-10;

/// Lower triangular `L` with `L Lᵀ = K`, row after row.
///
/// Sums run over columns in ascending order everywhere, so that a factor extended row by row has the bits of one computed at
/// once.
#[derive(Debug, Clone, Default)]
pub(super) struct Factor {
    /// Row `i` holds `i + 1` numbers.
    rows: Vec<f64>,
    /// `1 / L_ii`.
    inverse_pivots: Vec<f64>,
}

impl Factor {
    /// Number of rows.
    pub(super) fn len(&self) -> usize {
        self.inverse_pivots.len()
    }

    /// Row `i` up to its pivot.
    #[inline]
    pub(super) fn row(&self, i: usize) -> &[f64] {
        let start = i * (i + 1) / 2;
        &self.rows[start..=start + i]
    }

    /// `1 / L_ii`.
    #[inline]
    pub(super) fn inverse_pivot(&self, i: usize) -> f64 {
        self.inverse_pivots[i]
    }

    pub(super) fn clear(&mut self) {
        self.truncate(0);
    }

    /// Keeps the first `len` rows.
    pub(super) fn truncate(&mut self, len: usize) {
        self.rows.truncate(len * (len + 1) / 2);
        self.inverse_pivots.truncate(len);
    }

    /// The logarithm of the determinant of `L`.
    pub(super) fn log_determinant(&self) -> f64 {
        -self
            .inverse_pivots
            .iter()
            .map(|inverse| inverse.ln())
            .sum::<f64>()
    }

    /// Adds a row for a point with these covariances with the points before, and this variance. Cost: n² / 2.
    pub(super) fn push(&mut self, covariances: impl Iterator<Item = f64>, variance: f64) {
        let start = self.rows.len();
        self.rows.extend(covariances);
        let (above, row) = self.rows.split_at_mut(start);
        assert_eq!(row.len(), self.inverse_pivots.len(), "one for each point before");
        for (j, inverse) in self.inverse_pivots.iter().enumerate() {
            let other = &above[j * (j + 1) / 2..][..j];
            let dot = other
                .iter()
                .zip(&row[..j])
                .fold(row[j], |sum, (a, b)| sum - a * b);
            row[j] = dot * inverse;
        }
        let rest = row.iter().fold(variance, |rest, x| rest - x * x);
        self.push_pivot(rest);
    }

    fn push_pivot(&mut self, square: f64) {
        let pivot = square.max(LEAST_PIVOT).sqrt();
        self.rows.push(pivot);
        self.inverse_pivots.push(1.0 / pivot);
    }

    /// Adds `count` rows: `covariances[j]` holds those of all of them with point `j`, for all points before, and then for the
    /// new points themselves, variances included. `covariances` is memory afterwards.
    #[inline(always)]
    pub(super) fn push_block(&mut self, covariances: &mut [Lanes], count: usize) {
        let before = self.len();
        self.solve(&mut covariances[..before], 0);
        let mut squares = [0.0; LANES];
        let mut inverses = [0.0; LANES];
        for lane in 0..count {
            let (above, rest) = covariances.split_at_mut(before + lane);
            let mut sum = rest[0];
            for v in above.iter() {
                let l = v[lane];
                for (sum, v) in sum.iter_mut().zip(v) {
                    *sum -= l * v;
                }
            }
            squares[lane] = sum[lane];
            inverses[lane] = 1.0 / sum[lane].max(LEAST_PIVOT).sqrt();
            for (out, sum) in rest[0].iter_mut().zip(sum) {
                *out = sum * inverses[lane];
            }
        }
        for lane in 0..count {
            let row = covariances[..before + lane].iter().map(|values| values[lane]);
            self.rows.extend(row);
            self.push_pivot(squares[lane]);
        }
    }

    /// Solves `L V = B` by forward substitution for a block of right-hand sides in place, rows before `from` being solved
    /// already. Cost: n² / 2 for each lane.
    #[inline(always)]
    pub(super) fn solve(&self, block: &mut [Lanes], from: usize) {
        // Two rows at a time, so that the rows above are read half as often.
        for i in (from..block.len()).step_by(2) {
            let (above, rest) = block.split_at_mut(i);
            match rest {
                [one] => *one = self.solved(i, *one, above),
                [one, two, ..] => [*one, *two] = self.two_solved(i, [*one, *two], above),
                [] => {}
            }
        }
    }

    /// Row `i` of the solution below the rows `above`.
    #[inline(always)]
    fn solved(&self, i: usize, mut sum: Lanes, above: &[Lanes]) -> Lanes {
        for (&l, v) in self.row(i).iter().zip(above) {
            for (sum, v) in sum.iter_mut().zip(v) {
                *sum -= l * v;
            }
        }
        for sum in &mut sum {
            *sum *= self.inverse_pivots[i];
        }
        sum
    }

    /// Rows `i` and `i + 1` of the solution below the rows `above`.
    #[inline(always)]
    fn two_solved(&self, i: usize, [mut one, mut two]: [Lanes; 2], above: &[Lanes]) -> [Lanes; 2] {
        for ((&l, &m), v) in self.row(i).iter().zip(self.row(i + 1)).zip(above) {
            for ((one, two), v) in one.iter_mut().zip(&mut two).zip(v) {
                *one -= l * v;
                *two -= m * v;
            }
        }
        for one in &mut one {
            *one *= self.inverse_pivots[i];
        }
        let l = self.row(i + 1)[i];
        for (two, one) in two.iter_mut().zip(&one) {
            *two = (*two - l * one) * self.inverse_pivots[i + 1];
        }
        [one, two]
    }

    /// Block `b` of the columns of `L⁻¹`, from row `b * LANES` on; the rows above are zero. Cost: n² / 2 for each lane.
    #[inline(always)]
    pub(super) fn inverse_columns(&self, b: usize) -> Vec<Lanes> {
        let start = b * LANES;
        let mut columns: Vec<Lanes> = Vec::with_capacity(self.len() - start);
        for i in start..self.len() {
            let mut sum = [0.0; LANES];
            if let Some(one) = sum.get_mut(i - start) {
                *one = 1.0;
            }
            for (&l, v) in self.row(i)[start..].iter().zip(&columns) {
                for (sum, v) in sum.iter_mut().zip(v) {
                    *sum -= l * v;
                }
            }
            columns.push(sum.map(|sum| sum * self.inverse_pivots[i]));
        }
        columns
    }

    /// Solves `L z = b` for one right-hand side in place.
    pub(super) fn solve_one(&self, values: &mut [f64]) {
        for i in 0..values.len() {
            let row = &self.row(i)[..i];
            let sum = row
                .iter()
                .zip(&values[..i])
                .fold(values[i], |sum, (l, v)| sum - l * v);
            values[i] = sum * self.inverse_pivots[i];
        }
    }

    /// Solves `Lᵀ a = z` for one right-hand side in place.
    pub(super) fn solve_transposed(&self, values: &mut [f64]) {
        for i in (0..values.len()).rev() {
            let value = values[i] * self.inverse_pivots[i];
            values[i] = value;
            for (out, l) in values[..i].iter_mut().zip(self.row(i)) {
                *out -= l * value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::model::kernel::matern;

    const NUGGET: f64 = 1e-6;

    fn covariance(a: usize, b: usize) -> f64 {
        let x = |i: usize| (i as f64 * 0.754_877).fract();
        let y = |i: usize| (i as f64 * 0.569_840).fract();
        let (dx, dy) = (x(a) - x(b), y(a) - y(b));
        matern(&[(dx * dx + dy * dy) / 0.09; LANES])[0] + if a == b { NUGGET } else { 0.0 }
    }

    fn by_rows(n: usize) -> Factor {
        let mut factor = Factor::default();
        for i in 0..n {
            factor.push((0..i).map(|j| covariance(i, j)), covariance(i, i));
        }
        factor
    }

    fn by_blocks(n: usize) -> Factor {
        let mut factor = Factor::default();
        for start in (0..n).step_by(LANES) {
            let count = LANES.min(n - start);
            let mut block: Vec<Lanes> = (0..start + count)
                .map(|j| core::array::from_fn(|lane| covariance((start + lane).min(n - 1), j)))
                .collect();
            factor.push_block(&mut block, count);
        }
        factor
    }

    #[test]
    fn the_factor_times_its_transpose_is_the_matrix() {
        let factor = by_rows(50);
        for i in 0..50 {
            for j in 0..=i {
                let product: f64 = factor.row(i).iter().zip(factor.row(j)).map(|(a, b)| a * b).sum();
                assert!((product - covariance(i, j)).abs() < 1e-12, "{i} {j}");
            }
        }
    }

    #[test]
    fn rows_and_blocks_give_the_same_bits() {
        for n in [1, 15, 16, 17, 50] {
            assert_eq!(by_rows(n).rows, by_blocks(n).rows);
        }
    }

    #[test]
    fn solutions_solve() {
        let factor = by_rows(40);
        let right: Vec<f64> = (0..40).map(|i| f64::from(i).sin()).collect();
        let mut solved = right.clone();
        factor.solve_one(&mut solved);
        let mut block: Vec<Lanes> = right.iter().map(|&x| [x; LANES]).collect();
        factor.solve(&mut block, 0);
        assert!(block.iter().zip(&solved).all(|(lanes, x)| lanes == &[*x; LANES]));
        factor.solve_transposed(&mut solved);
        for (i, b) in right.iter().enumerate() {
            let product: f64 = (0..40).map(|j| covariance(i, j) * solved[j]).sum();
            assert!((product - b).abs() < 1e-6, "{product} {b}");
        }
    }

    #[test]
    fn equal_points_do_no_harm() {
        let mut factor = Factor::default();
        for i in 0..5 {
            factor.push((0..i).map(|_| 1.0), 1.0);
        }
        let mut right = vec![1.0; 5];
        factor.solve_one(&mut right);
        assert!(right.iter().all(|x| x.is_finite()));
    }
}
