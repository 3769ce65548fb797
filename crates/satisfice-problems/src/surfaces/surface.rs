//! A function of the unit cube: a threshold, and the radius within which two hits are one.

use satisfice::catalogue::Description;
use satisfice::{Encoding, Error, Located, Space};

use crate::lattice::description;

/// The part that the problems of this family share.
#[derive(Debug, Clone)]
pub(super) struct Surface {
    pub(super) space: Space<f64>,
    pub(super) threshold: f64,
    pub(super) separation: f64,
    pub(super) description: Description,
}

impl Surface {
    /// # Errors
    /// [`Error::Parameter`] for a threshold that is not finite, or a separation that is negative or not finite.
    pub(super) fn new(name: &str, axes: usize, threshold: f64, separation: f64) -> Result<Self, Error> {
        if !threshold.is_finite() {
            return Err(Error::parameter("threshold", threshold, "a finite number"));
        }
        if !(separation >= 0.0 && separation.is_finite()) {
            return Err(Error::parameter(
                "separation",
                separation,
                "a finite number from 0 on",
            ));
        }
        let parameters = [
            ("threshold", threshold.to_string()),
            ("separation", separation.to_string()),
        ];
        Ok(Self {
            space: Space::cube(axes, 0.0, 1.0)?,
            threshold,
            separation,
            description: description(name, parameters),
        })
    }
}

impl Encoding<f64, Located<f64>> for Surface {
    fn encode(&self, solution: &Located<f64>, values: &mut [f64]) -> bool {
        let fits = solution.coordinates.len() == values.len() && self.space.contains(&solution.coordinates);
        if fits {
            values.copy_from_slice(&solution.coordinates);
        }
        fits
    }
}

/// The methods of a problem whose field `surface` is a [`Surface`], with this F of the coordinates.
macro_rules! surface_methods {
    ($f:path) => {
        type Scalar = f64;
        type Solution = satisfice::Located<f64>;
        fn space(&self) -> &satisfice::Space<f64> {
            &self.surface.space
        }
        fn decode(&self, values: &[f64]) -> Self::Solution {
            satisfice::Located::new(values, self.surface.separation)
        }
        fn decode_into(&self, values: &[f64], solution: &mut Self::Solution) {
            solution.coordinates.clear();
            solution.coordinates.extend_from_slice(values);
            solution.separation = self.surface.separation.into();
        }
        fn fitness(&self, solution: &Self::Solution) -> f64 {
            $f(&solution.coordinates)
        }
        fn threshold(&self) -> f64 {
            self.surface.threshold
        }
        fn description(&self) -> satisfice::catalogue::Description {
            self.surface.description.clone()
        }
        fn encoding(&self) -> Option<&dyn satisfice::Encoding<f64, Self::Solution>> {
            Some(&self.surface)
        }
    };
}
pub(super) use surface_methods;
