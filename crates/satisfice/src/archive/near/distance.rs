//! Distances in units of the radius of each axis.

/// So many coordinates are looked at together: each point has a multiple of them.
pub(super) const LANES: usize = 4;

/// The sum of the squares of the distances along all coordinates, unless it is more than `limit`.
#[inline(always)]
pub(super) fn square<T>(
    chunks: impl Iterator<Item = T>,
    limit: f64,
    distance: impl Fn(&T, usize) -> f64,
) -> Option<f64> {
    let mut squares = [0.0; LANES];
    for chunk in chunks {
        for (lane, square) in squares.iter_mut().enumerate() {
            let distance = distance(&chunk, lane);
            *square += distance * distance;
        }
        let [a, b, c, d] = squares;
        if (a + b) + (c + d) > limit {
            return None;
        }
    }
    let [a, b, c, d] = squares;
    Some((a + b) + (c + d))
}

/// The squared distance of two points, in radii, unless it is more than `limit`.
#[inline(always)]
pub(super) fn distance(a: &[f64], b: &[f64], scales: &[f64], limit: f64) -> Option<f64> {
    let lanes = a.chunks_exact(LANES).zip(b.chunks_exact(LANES));
    square(
        lanes.zip(scales.chunks_exact(LANES)),
        limit,
        |((a, b), scales), lane| (a[lane] - b[lane]) * scales[lane],
    )
}
