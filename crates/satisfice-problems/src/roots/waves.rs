//! Two crossing waves with 144 roots.

use core::f64::consts::PI;

use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Error, SatisficingProblem};

use super::equations::{Equations, functions, root_methods};
use crate::lattice::description;
use crate::number::Number;

const LARGEST_THRESHOLD: f64 = 0.01;
const LARGEST_SEPARATION: f64 = 0.05;

/// All roots on [0, 2]^2 of
///
/// sin 6 pi x = 0.5 cos 2 pi y, sin 6 pi y = -0.5 cos 2 pi x.
///
/// F is the sum of the squared differences. A hit is polished by Newton's method; different roots are distinct.
/// There are 144: both equations have period 2 in x and y. The first implies |sin 6 pi x| <= 0.5, away from the extrema of
/// the wave: its solutions are 12 curves x = g(y) with |g'| < 0.2 on the torus; those of the second, 12 curves y = h(x) with
/// |h'| < 0.2; two curves, one of each kind, cross exactly once (h after g is a contraction), and no crossing is on the border.
///
/// ```
/// use satisfice::catalogue::Catalogued;
/// use satisfice_problems::Roots;
/// assert_eq!(Roots::new(6e-4, 0.01)?.reference_hits(), Some(144));
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Roots {
    equations: Equations,
    description: Description,
}

pub(super) fn waves<N: Number>(x: &[N], e: &mut [N]) {
    let (x, y) = (x[0], x[1]);
    e[0] = x.times(6.0 * PI).sin() - y.times(2.0 * PI).cos().times(0.5);
    e[1] = y.times(6.0 * PI).sin() + x.times(2.0 * PI).cos().times(0.5);
}

impl Roots {
    /// The roots with F below `threshold`, farther apart than `separation`.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a number is not positive and finite.
    pub fn new(threshold: f64, separation: f64) -> Result<Self, Error> {
        Ok(Self {
            equations: Equations::new(functions!(waves), [(0.0, 2.0); 2], threshold, separation)?,
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

impl SatisficingProblem for Roots {
    root_methods!();
}

impl Catalogued for Roots {
    const NAME: &'static str = "roots";
    const SUMMARY: &'static str = "the 144 roots of two crossing waves on [0, 2]^2";
    const SOURCE: &'static str =
        "a standard test set; count by a graph argument and by interval branch and bound";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::real(
            "threshold",
            "level of the sum of squares, delta",
            6e-4,
            1e-20,
            10.0,
        ),
        Parameter::real(
            "separation",
            "distance within which two hits are one root",
            0.01,
            1e-6,
            1.0,
        ),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::new(params.real("threshold"), params.real("separation"))
    }

    fn reference_hits(&self) -> Option<u64> {
        let sound =
            self.equations.threshold <= LARGEST_THRESHOLD && self.equations.separation <= LARGEST_SEPARATION;
        sound.then_some(144)
    }
}
