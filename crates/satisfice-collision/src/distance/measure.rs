//! A distance to ten digits, for a search that asks for millions of them.

use super::frame::PairFrame;
use super::vector::ldexp;
use super::{Point, gjk, resolve};

/// The greatest relative error of [`measure`](super::measure()).
pub const ACCURACY: f64 = 1e-10;

/// The distance of the convex hulls of two sets of corners within [`ACCURACY`]; see [`measure`](super::measure()).
pub(super) fn hulls<const M: usize, const N: usize>(a: &[Point; M], b: &[Point; N]) -> f64 {
    fast(a, b).unwrap_or_else(|| resolve::proximity(a, b).distance)
}

fn fast<const M: usize, const N: usize>(a: &[Point; M], b: &[Point; N]) -> Option<f64> {
    let frame: PairFrame<M, N> = resolve::frame(a, b)?;
    let distance = gjk::distance(&frame, ACCURACY / 4.0)?;
    Some(if frame.exponent == 0 {
        distance
    } else {
        ldexp(distance, frame.exponent)
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::distance::{Triangle, measure, proximity};
    use crate::mesh::{FeatureKind, Shape};
    use rand::{RngExt as _, SeedableRng};

    /// Against the proximity, whose own referee is rational arithmetic: random features at every ratio of size to distance.
    #[test]
    fn ten_digits_of_every_kind() {
        let mut rng = rand_xoshiro::Xoshiro256PlusPlus::seed_from_u64(5);
        for case in 0..4000 {
            let apart = 10.0_f64.powi(case % 9 - 5);
            let unit = [1.0, 1e-160, 1e150, 1e-5][case as usize % 4];
            let mut point = |shift: f64| -> Point {
                std::array::from_fn(|k| unit * (rng.random::<f64>() + if k == 0 { shift } else { 0.0 }))
            };
            let t: Triangle = std::array::from_fn(|_| point(0.0));
            let s: Triangle = std::array::from_fn(|_| point(1.0 + apart));
            for kind in FeatureKind::ALL {
                for other in FeatureKind::ALL {
                    let (a, b) = (Shape::new(kind, |k| t[k]), Shape::new(other, |k| s[k]));
                    let (found, exact) = (measure(&a, &b), proximity(&a, &b).distance);
                    assert!(
                        (found - exact).abs() <= ACCURACY * exact,
                        "{found} {exact} {a:?} {b:?}"
                    );
                }
            }
        }
        // What meets is at 0, what is no number has no distance.
        let t = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let s = [[0.2, 0.2, -1.0], [0.2, 0.2, 1.0], [5.0, 5.0, 0.0]];
        assert_eq!(measure(&Shape::Triangle(t), &Shape::Triangle(s)), 0.0);
        assert_eq!(measure(&Shape::Vertex(t[1]), &Shape::Triangle(t)), 0.0);
        assert!(measure(&Shape::Vertex([f64::NAN, 0.0, 0.0]), &Shape::Triangle(t)).is_nan());
    }
}
