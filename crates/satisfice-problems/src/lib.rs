//! Satisficing problems with known answers, each a type that implements [`SatisficingProblem`] and [`Catalogued`].
//!
//! | family | problems |
//! |---|---|
//! | level sets | [`Rastrigin`], [`Shell`], [`Islands`], [`DiscPacking`], [`Cec2006`], [`MixedAxes`], and the negative control [`Needles`] |
//! | small regions | [`SmallRegions`]: boxes, balls, thin turned ellipsoids, plateaus |
//! | design windows | [`SallenKey`] |
//! | inverse kinematics | [`Arm`], [`SevenJoints`], [`Puma`] |
//! | falsification | [`Falsification`], [`Transmission`], specifications in signal temporal logic: [`Specification`] |
//! | constraint satisfaction | [`Queens`], [`GraphColouring`], [`Costas`], [`MagicSquare`], [`LatinSquare`], [`Langford`], [`Sat`] |
//! | roots of nonlinear systems | [`Roots`], [`Himmelblau`], [`System`] (17 by name), [`PeriodicPoints`] |
//! | smooth functions of few variables | [`Branin`], [`Hartmann6`] |
//! | niching | [`Cec2013`] (20 functions) |
//!
//! What counts as distinct: a cell on a lattice, a root or a region where the space is continuous (a hit becomes the root, by
//! Newton's method, or the centre). Counts that take long to enumerate are constants; `cargo run --release -p satisfice-problems
//! --example enumerate` recomputes them.
//!
//! [`SatisficingProblem`]: satisfice::SatisficingProblem
//! [`Catalogued`]: satisfice::catalogue::Catalogued

mod cec2013;
mod constraints;
mod design;
mod falsification;
mod kinematics;
mod lattice;
mod level_sets;
pub mod number;
mod roots;
mod surfaces;

pub use cec2013::*;
pub use constraints::*;
pub use design::*;
pub use falsification::*;
pub use kinematics::*;
pub use lattice::{ENUMERABLE, count_hits};
pub use level_sets::*;
pub use roots::*;
pub use surfaces::*;
