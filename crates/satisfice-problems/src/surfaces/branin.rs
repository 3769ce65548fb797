//! Branin's function.

use std::f64::consts::PI;

use satisfice::catalogue::{Catalogued, Parameter, Params};
use satisfice::{Error, SatisficingProblem};

use super::surface::{Surface, surface_methods};

/// The low ground of Branin's function, which has three basins of equal depth:
///
/// F(x, y) = (y - 5.1 x^2 / (4 pi^2) + 5 x / pi - 6)^2 + 10 (1 - 1 / (8 pi)) cos x + 10 < delta
///
/// for x in [-5, 10] and y in [0, 15], scaled to the unit square. The least F is 0.397887, at (-pi, 12.275), (pi, 2.275) and
/// (9.42478, 2.475). F is below 0.904, the default of delta, in a hundredth of the square. Hits within the separation, in units
/// of the square, are one.
///
/// Source: Branin 1972, IBM J. Res. Dev. 16, 504-522; the form of Dixon, Szegő 1978, Towards Global Optimisation 2.
///
/// ```
/// use satisfice::{Budget, Search};
/// let report = Search::new().run(&satisfice_problems::Branin::new(0.904, 0.05)?, &Budget::evaluations(3_000))?;
/// let basins = |x: f64| report.hits().filter(|hit| (15.0 * hit.solution.coordinates[0] - 5.0 - x).abs() < 1.5).count();
/// assert!(basins(-3.14) > 0 && basins(3.14) > 0 && basins(9.42) > 0);
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Branin {
    surface: Surface,
}

impl Branin {
    /// The points with F below `threshold`; points within `separation` of each other are one hit.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a threshold that is not finite, or a separation that is negative or not finite.
    pub fn new(threshold: f64, separation: f64) -> Result<Self, Error> {
        let surface = Surface::new(Self::NAME, 2, threshold, separation)?;
        Ok(Self { surface })
    }

    /// F at a point of the unit square.
    ///
    /// # Panics
    /// If `point` has fewer than two coordinates.
    #[must_use]
    pub fn value(point: &[f64]) -> f64 {
        let (x, y) = (15.0 * point[0] - 5.0, 15.0 * point[1]);
        let valley = y - 5.1 / (4.0 * PI * PI) * x * x + 5.0 / PI * x - 6.0;
        valley * valley + 10.0 * (1.0 - 1.0 / (8.0 * PI)) * x.cos() + 10.0
    }
}

impl SatisficingProblem for Branin {
    surface_methods!(Self::value);
}

impl Catalogued for Branin {
    const NAME: &'static str = "branin";
    const SUMMARY: &'static str = "the low ground of Branin's function, in three basins";
    const SOURCE: &'static str = "Branin 1972, IBM J. Res. Dev. 16, 504-522";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::real(
            "threshold",
            "level, delta; the least F is 0.397887",
            0.904,
            0.0,
            400.0,
        ),
        Parameter::real(
            "separation",
            "distance within which two hits are one, in units of the square",
            0.01,
            0.0,
            1.0,
        ),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::new(params.real("threshold"), params.real("separation"))
    }
}
