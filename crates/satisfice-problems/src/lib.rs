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
//! What counts as distinct: a cell on a lattice, a root where the space is continuous (hits are polished by Newton's
//! method). Long enumerations are kept as constants; `cargo run --release -p satisfice-problems --example enumerate`
//! makes them again.
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

pub use cec2013::{Cec2013, Score, SuiteData, peak_ratio};
pub use constraints::{
    Backtracking, Costas, Encoding, Extendable, Formula, Graph, GraphColouring, Langford, LatinSquare,
    MagicSquare, Queens, Sat, backtrack,
};
pub use design::{Parts, SallenKey, Window};
pub use falsification::{Falsification, Specification, Trace, Transmission};
pub use kinematics::{Arm, Puma, SevenJoints};
pub use lattice::{ENUMERABLE, count_hits};
pub use level_sets::{Cec2006, DiscPacking, Islands, Needles, Rastrigin, Shell};
pub use roots::{Himmelblau, Roots, System};
pub use surfaces::{Branin, Hartmann6};
