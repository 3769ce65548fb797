//! Eigenvalues and eigenvectors of small symmetric matrices.

/// Sweeps, at most; three to eight are enough.
const SWEEPS: usize = 30;
/// Squares off the diagonal that are left, as a share of those on it.
const ROUNDING: f64 = 1e-26;

/// Writes the eigenvectors of a symmetric matrix of n rows, one a row; its eigenvalues stay on the diagonal of `matrix`. Jacobi's rotations
/// (Golub, Van Loan 2013, 8.5). Cost: some 10 n³.
pub(super) fn symmetric(matrix: &mut [f64], n: usize, vectors: &mut Vec<f64>) {
    vectors.clear();
    vectors.resize(n * n, 0.0);
    for diagonal in vectors.iter_mut().step_by(n + 1) {
        *diagonal = 1.0;
    }
    for _ in 0..SWEEPS {
        let square = |i: usize, j: usize| matrix[i * n + j] * matrix[i * n + j];
        let on: f64 = (0..n).map(|i| square(i, i)).sum();
        let off: f64 = (0..n).flat_map(|i| (0..i).map(move |j| square(i, j))).sum();
        if off <= ROUNDING * on || off.is_nan() {
            break;
        }
        for p in 0..n {
            for q in p + 1..n {
                rotate(matrix, vectors, n, (p, q));
            }
        }
    }
}

/// Makes the entry at (p, q) zero.
fn rotate(matrix: &mut [f64], vectors: &mut [f64], n: usize, (p, q): (usize, usize)) {
    let entry = matrix[p * n + q];
    if entry == 0.0 {
        return;
    }
    let ratio = (matrix[q * n + q] - matrix[p * n + p]) / (2.0 * entry);
    let tangent = 1.0_f64.copysign(ratio) / (ratio.abs() + ratio.hypot(1.0));
    let cosine = 1.0 / tangent.hypot(1.0);
    let sine = tangent * cosine;
    let turn = |values: &mut [f64], a: usize, b: usize| {
        let (x, y) = (values[a], values[b]);
        values[a] = cosine * x - sine * y;
        values[b] = sine * x + cosine * y;
    };
    for k in 0..n {
        turn(matrix, k * n + p, k * n + q);
    }
    for k in 0..n {
        turn(matrix, p * n + k, q * n + k);
        turn(vectors, p * n + k, q * n + k);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SearchRng;

    /// V^T D V is the matrix, and V V^T the identity.
    #[test]
    fn vectors_and_values_give_the_matrix() {
        let mut rng = SearchRng::new(1);
        for n in 1..9 {
            let mut matrix = vec![0.0; n * n];
            for i in 0..n {
                for j in 0..=i {
                    let entry = rng.normal() * 10.0_f64.powi(i as i32);
                    (matrix[i * n + j], matrix[j * n + i]) = (entry, entry);
                }
            }
            let (mut rest, mut vectors) = (matrix.clone(), Vec::new());
            symmetric(&mut rest, n, &mut vectors);
            let values: Vec<f64> = rest.iter().step_by(n + 1).copied().collect();
            let scale = values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            for i in 0..n {
                for j in 0..n {
                    let entry: f64 = (0..n)
                        .map(|k| vectors[k * n + i] * values[k] * vectors[k * n + j])
                        .sum();
                    let product: f64 = (0..n).map(|k| vectors[i * n + k] * vectors[j * n + k]).sum();
                    approx::assert_abs_diff_eq!(entry / scale, matrix[i * n + j] / scale, epsilon = 1e-12);
                    approx::assert_abs_diff_eq!(product, f64::from(u8::from(i == j)), epsilon = 1e-12);
                }
            }
        }
    }
}
