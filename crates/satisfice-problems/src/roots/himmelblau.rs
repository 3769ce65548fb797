//! Himmelblau's function.

use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Error, SatisficingProblem};

use super::equations::{Equations, functions, root_methods};
use crate::lattice::description;
use crate::number::Number;

/// The four basins stay apart below the saddle at 13.3.
const SEPARATE: f64 = 10.0;
/// Roots are at least 3.89 apart.
const LEAST_DISTANCE: f64 = 3.5;

/// The four roots of Himmelblau's function on [-6, 6]^2:
///
/// F(x, y) = (x^2 + y - 11)^2 + (x + y^2 - 7)^2 < delta.
///
/// A hit is polished by Newton's method; different roots are distinct, and hits within the separation of a root are that
/// root. `lower_bound` is an interval evaluation.
///
/// Source: Himmelblau 1972, Applied Nonlinear Programming; the roots are those of the quartic that elimination leaves.
///
/// ```
/// use satisfice::catalogue::Catalogued;
/// use satisfice_problems::Himmelblau;
/// assert_eq!(Himmelblau::new(1.0, 0.1)?.reference_hits(), Some(4));
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Himmelblau {
    equations: Equations,
    description: Description,
}

fn himmelblau<N: Number>(x: &[N], e: &mut [N]) {
    e[0] = x[0].square() + x[1].plus(-11.0);
    e[1] = x[0] + x[1].square().plus(-7.0);
}

impl Himmelblau {
    /// The roots with F below `threshold`, farther apart than `separation`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a number is not positive and finite.
    pub fn new(threshold: f64, separation: f64) -> Result<Self, Error> {
        Ok(Self {
            equations: Equations::new(functions!(himmelblau), [(-6.0, 6.0); 2], threshold, separation)?,
            description: description(
                Self::NAME,
                [
                    ("threshold", threshold.to_string()),
                    ("separation", separation.to_string()),
                ],
            ),
        })
    }
}

impl SatisficingProblem for Himmelblau {
    root_methods!();
}

impl Catalogued for Himmelblau {
    const NAME: &'static str = "himmelblau";
    const SUMMARY: &'static str = "the four roots of Himmelblau's function on [-6, 6]^2";
    const SOURCE: &'static str = "Himmelblau 1972, Applied Nonlinear Programming; 4 roots by elimination";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::real("threshold", "level of the sum of squares, delta", 1.0, 1e-20, 1e4),
        Parameter::real(
            "separation",
            "distance within which two hits are one root",
            0.5,
            1e-6,
            10.0,
        ),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::new(params.real("threshold"), params.real("separation"))
    }

    fn reference_hits(&self) -> Option<u64> {
        (self.equations.threshold <= SEPARATE && self.equations.separation <= LEAST_DISTANCE).then_some(4)
    }
}
