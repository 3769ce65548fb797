//! Interval arithmetic for [`lower_bound`](crate::Bounds): F of a region in one evaluation.
//!
//! A fitness in closed form, written once more with [`Interval`]s instead of numbers, encloses all its values in a region:
//! the lower end is a bound. The arithmetic is that of [`maryada`], which rounds outward (IEEE Std 1788.1-2017).
//!
//! Why that library: it builds on stable Rust for any processor. `inari` 2.0 refuses to build without `RUSTFLAGS`
//! (`-Ctarget-cpu=haswell`), which a dependency cannot set; others need MPFR, or do not round outward.
//!
//! **What is enclosed.** The exact values, and those that the same operations (`+ - * /`, `sqrt`, `abs`, `min`, `max`) give
//! in `f64`, because rounding to nearest is monotone. Elementary functions of the standard library (`sin`, `exp`, `powi`, …)
//! are not rounded correctly: put [`widened`] around each of their enclosures. A sum has to be taken in the same order.
//! A fitness computed in `f32` rounds more than any of this: widen by 2^29 units for each operation, or compute in `f64`.
//! Beware of `f64::max` and `min`, which drop NaN, on arguments outside a function's domain.
//!
//! ```
//! use satisfice::interval::{lower_bound, sides, EnclosureOps, IntervalOps};
//! use satisfice::{Bounds, Located, Region, SatisficingProblem, Space};
//!
//! /// All points where (x^2 + y - 11)^2 + (x + y^2 - 7)^2 < 0.01.
//! struct Himmelblau(Space<f64>);
//!
//! impl SatisficingProblem for Himmelblau {
//!     type Scalar = f64;
//!     type Solution = Located<f64>;
//!     fn space(&self) -> &Space<f64> { &self.0 }
//!     fn decode(&self, values: &[f64]) -> Located<f64> { Located::new(values, 0.5) }
//!     fn fitness(&self, at: &Located<f64>) -> f64 {
//!         let (x, y) = (at.coordinates[0], at.coordinates[1]);
//!         let (a, b) = (x * x + y - 11.0, x + y * y - 7.0);
//!         a * a + b * b
//!     }
//!     fn threshold(&self) -> f64 { 0.01 }
//!     fn bounds(&self) -> Option<&dyn Bounds<f64>> { Some(self) }
//! }
//!
//! impl Bounds<f64> for Himmelblau {
//!     fn lower_bound(&self, region: &Region<f64>) -> Option<f64> {
//!         let [x, y] = sides(region)?;
//!         let (a, b) = (x.sqr() + y - 11.0, x + y.sqr() - 7.0);
//!         lower_bound(a.sqr() + b.sqr())
//!     }
//! }
//!
//! let problem = Himmelblau(Space::cube(2, -6.0, 6.0)?);
//! let corner = Region { lower: vec![4.0, 4.0], upper: vec![6.0, 6.0] };
//! assert_eq!(problem.lower_bound(&corner), Some(250.0)); // 9^2 + 13^2, at (4, 4)
//! # Ok::<(), satisfice::Error>(())
//! ```

pub use maryada::{EnclosureOps, Interval, IntervalOps};

use crate::scalar::Real;
use crate::space::Region;

/// The values of axis `axis` in `region`, empty if there is no such axis. Exact in both scalars.
#[must_use]
pub fn side<S: Real>(region: &Region<S>, axis: usize) -> Interval {
    match (region.lower.get(axis), region.upper.get(axis)) {
        (Some(lower), Some(upper)) => Interval::new(lower.f64(), upper.f64()),
        _ => Interval::EMPTY,
    }
}

/// The values of all axes in `region`; `None` if it has not N of them.
#[must_use]
pub fn sides<const N: usize, S: Real>(region: &Region<S>) -> Option<[Interval; N]> {
    (region.lower.len() == N && region.upper.len() == N)
        .then(|| core::array::from_fn(|axis| side(region, axis)))
}

/// The lower end of an enclosure of F, rounded down; `None` for the empty interval, of which nothing follows.
#[must_use]
pub fn lower_bound<S: Real>(fitness: Interval) -> Option<S> {
    let bound = fitness.inf();
    if bound > fitness.sup() || bound.is_nan() {
        return None;
    }
    let near = S::of(bound);
    Some(if near.f64() > bound { near.below() } else { near })
}

/// `x` with both ends moved outward by `ulps` units in the last place.
///
/// For what the standard library computes without rounding correctly: 2 units cover `sin`, `cos`, `tan`, `exp`, `ln`, `powf`
/// and `hypot` of the common C libraries, which are documented at 1 or less; `powi(n)` takes n.
#[must_use]
pub fn widened(x: Interval, ulps: u32) -> Interval {
    let (mut inf, mut sup) = x.bounds();
    if inf > sup {
        return x;
    }
    for _ in 0..ulps {
        (inf, sup) = (inf.next_down(), sup.next_up());
    }
    Interval::new(inf, sup)
}

#[cfg(test)]
#[path = "interval_tests.rs"]
mod tests;
