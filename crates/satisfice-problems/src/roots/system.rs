//! Nonlinear systems from the literature, by name.

use satisfice::catalogue::{Catalogued, Description, Parameter, Params};
use satisfice::{Error, SatisficingProblem};

use super::certify;
use super::equations::{Equations, root_methods};
use super::systems::{Entry, NAMES, SYSTEMS};
use crate::lattice::description;

const LARGEST_THRESHOLD: f64 = 1e-5;
const LARGEST_SEPARATION: f64 = 0.01;

/// All roots of a nonlinear system in a box.
///
/// F is the sum of the squares of the equations. A hit, F < delta = 1e-5, is polished by Newton's method, and hits within
/// 0.01 of each other are one root: the usual rules of the field. Every count is proved by [`System::certify`] in a test,
/// except for the singular root of cosine-circle.
///
/// | name | unknowns | roots |
/// |---|---|---|
/// | merlet | 2 | 13 |
/// | sine-line | 2 | 11 |
/// | cosine-circle | 2 | 15 |
/// | floudas | 2 | 2 |
/// | tsai-morgan | 8 | 16 |
/// | effati-grosan | 2 | 13 |
/// | boggs | 2 | 3 |
/// | himmelblau-stationary | 2 | 9 |
/// | camel-stationary | 2 | 15 |
/// | crossed-sines | 2 | 27 |
/// | waves | 2 | 144 |
/// | rastrigin-stationary | 2 | 81 |
/// | sphere-waves | 3 | 18 |
/// | noonburg | 3 | 7 |
/// | kuramoto | 3 | 8 |
/// | katsura | 4 | 6 |
/// | wright | 5 | 32 |
///
/// The sources are given with the equations in `roots/systems.rs`; a survey of such problems: Gong et al. 2021, doi
/// 10.1016/j.swevo.2021.100906.
///
/// ```
/// use satisfice_problems::System;
/// let system = System::new("boggs", 1e-5, 0.01)?;
/// assert_eq!(system.certify(100_000).unwrap().len(), 3); // proved
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct System {
    equations: Equations,
    description: Description,
    index: usize,
}

impl System {
    /// The system called `name`, with roots where F < `threshold`, farther apart than `separation`.
    ///
    /// # Errors
    /// [`Error::Unknown`] for an unknown name, [`Error::Parameter`] if a number is not positive and finite.
    pub fn new(name: &str, threshold: f64, separation: f64) -> Result<Self, Error> {
        let index = SYSTEMS.iter().position(|entry| entry.name == name);
        let index = index.ok_or_else(|| Error::unknown("system", name, NAMES.iter().copied()))?;
        let entry = &SYSTEMS[index];
        Ok(Self {
            equations: Equations::new(
                entry.functions,
                entry.bounds.iter().copied(),
                threshold,
                separation,
            )?,
            description: description(
                Self::NAME,
                [
                    ("equations", name.to_owned()),
                    ("threshold", threshold.to_string()),
                    ("separation", separation.to_string()),
                ],
            ),
            index,
        })
    }

    /// The names of all systems.
    #[must_use]
    pub fn names() -> &'static [&'static str] {
        NAMES
    }

    /// The roots, with the proof that there are no others: interval branch and bound with Krawczyk's operator. Roots on the
    /// border count. `None` if that takes more than `limit` boxes, as it does where a root is singular.
    #[must_use]
    pub fn certify(&self, limit: usize) -> Option<Vec<Vec<f64>>> {
        certify::certify(&self.equations, limit)
    }

    fn entry(&self) -> &'static Entry {
        const TABLE: &[Entry] = &SYSTEMS;
        &TABLE[self.index]
    }
}

impl SatisficingProblem for System {
    root_methods!();
}

impl Catalogued for System {
    const NAME: &'static str = "system";
    const SUMMARY: &'static str =
        "all roots of a nonlinear system from the literature, polished and counted distinct";
    const SOURCE: &'static str = "Song et al. 2015, doi 10.1109/TEVC.2014.2336865, and others; counts proved by interval branch and bound";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::choice("equations", "which system", "merlet", NAMES),
        Parameter::real(
            "threshold",
            "level of the sum of squares, delta",
            LARGEST_THRESHOLD,
            1e-20,
            10.0,
        ),
        Parameter::real(
            "separation",
            "distance within which two hits are one root",
            LARGEST_SEPARATION,
            1e-6,
            1.0,
        ),
    ];

    fn from_params(params: &Params) -> Result<Self, Error> {
        Self::new(
            params.text("equations"),
            params.real("threshold"),
            params.real("separation"),
        )
    }

    fn reference_hits(&self) -> Option<u64> {
        let sound = self.equations.threshold.total_cmp(&LARGEST_THRESHOLD).is_le()
            && self.equations.separation.total_cmp(&LARGEST_SEPARATION).is_le();
        sound.then(|| self.entry().roots)
    }
}
