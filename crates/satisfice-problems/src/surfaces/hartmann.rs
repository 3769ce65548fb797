//! Hartmann's function of six variables.

use satisfice::catalogue::{Catalogued, Parameter, Params};
use satisfice::{Error, SatisficingProblem};

use super::surface::{Surface, surface_methods};

/// The wells of Hartmann's function of six variables in the unit cube:
///
/// F(x) = -sum_k c_k exp(-sum_j a_kj (x_j - p_kj)^2) < delta, k = 1..4.
///
/// The least F is -3.32237, at (0.20169, 0.150011, 0.476874, 0.275332, 0.311652, 0.6573). F is below -1.885, the default of
/// delta, in a hundredth of the cube. Hits within the separation are one.
///
/// Source: Hartman 1973, J. Optim. Theory Appl. 12; the constants of Dixon, Szegő 1978, Towards Global Optimisation 2.
///
/// ```
/// use satisfice::{Budget, Search};
/// let report = Search::new().run(&satisfice_problems::Hartmann6::new(-3.0, 0.05)?, &Budget::evaluations(5_000))?;
/// assert!(report.hit_count() > 0);
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Hartmann6 {
    surface: Surface,
}

/// c_k.
const DEPTHS: [f64; 4] = [1.0, 1.2, 3.0, 3.2];
/// a_kj.
const WIDTHS: [[f64; 6]; 4] = [
    [10.0, 3.0, 17.0, 3.5, 1.7, 8.0],
    [0.05, 10.0, 17.0, 0.1, 8.0, 14.0],
    [3.0, 3.5, 1.7, 10.0, 17.0, 8.0],
    [17.0, 8.0, 0.05, 10.0, 0.1, 14.0],
];
/// p_kj.
const CENTRES: [[f64; 6]; 4] = [
    [0.1312, 0.1696, 0.5569, 0.0124, 0.8283, 0.5886],
    [0.2329, 0.4135, 0.8307, 0.3736, 0.1004, 0.9991],
    [0.2348, 0.1451, 0.3522, 0.2883, 0.3047, 0.6650],
    [0.4047, 0.8828, 0.8732, 0.5743, 0.1091, 0.0381],
];

impl Hartmann6 {
    /// The points with F below `threshold`; points within `separation` of each other are one hit.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a threshold that is not finite, or a separation that is negative or not finite.
    pub fn new(threshold: f64, separation: f64) -> Result<Self, Error> {
        let surface = Surface::new(Self::NAME, 6, threshold, separation)?;
        Ok(Self { surface })
    }

    /// F at a point of the unit cube; a missing coordinate is taken at each centre.
    #[must_use]
    pub fn value(point: &[f64]) -> f64 {
        let well = |k: usize| {
            let squares = point.iter().zip(&WIDTHS[k]).zip(&CENTRES[k]);
            let sum: f64 = squares
                .map(|((x, width), centre)| width * (x - centre).powi(2))
                .sum();
            DEPTHS[k] * (-sum).exp()
        };
        -(0..4).map(well).sum::<f64>()
    }
}

impl SatisficingProblem for Hartmann6 {
    surface_methods!(Self::value);
}

impl Catalogued for Hartmann6 {
    const NAME: &'static str = "hartmann-6";
    const SUMMARY: &'static str = "the wells of Hartmann's function of six variables";
    const SOURCE: &'static str = "Hartman 1973, J. Optim. Theory Appl. 12; Dixon, Szegő 1978";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::real(
            "threshold",
            "level, delta; the least F is -3.32237",
            -1.885,
            -4.0,
            0.0,
        ),
        Parameter::real(
            "separation",
            "distance within which two hits are one, in units of the cube",
            0.05,
            0.0,
            2.5,
        ),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::new(params.real("threshold"), params.real("separation"))
    }
}
