//! Satisficing problems with known answers, each a type that implements [`SatisficingProblem`] and [`Catalogued`].
//!
//! | family | problems |
//! |---|---|
//! | level sets | [`Rastrigin`], [`Shell`], [`Islands`], [`DiscPacking`], [`Cec2006`], and the negative control [`Needles`] |
//! | design windows | [`SallenKey`] |
//! | inverse kinematics | [`Arm`], [`SevenJoints`], [`Puma`] |
//! | falsification | [`Falsification`], [`Transmission`], specifications in signal temporal logic: [`Specification`] |
//! | constraint satisfaction | [`Queens`], [`GraphColouring`], [`Costas`], [`MagicSquare`], [`LatinSquare`], [`Langford`], [`Sat`] |
//! | roots of nonlinear systems | [`Roots`], [`Himmelblau`], [`System`] (17 by name) |
//! | smooth functions of few variables | [`Branin`], [`Hartmann6`] |
//! | niching | [`Cec2013`] (20 functions) |
//!
//! On a lattice, different cells are distinct hits. Where roots are sought, hits are polished by Newton's method and different
//! roots are distinct. Counts that take long to enumerate are constants; `cargo run --release -p satisfice-problems --example
//! enumerate` recomputes them.
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
