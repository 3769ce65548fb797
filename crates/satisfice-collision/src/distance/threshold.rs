//! The threshold delta, checked once, with the bounds of its square that every decision needs.

use crate::Error;

/// A distance threshold delta: finite and positive. A pair is within it if its distance is strictly less.
///
/// ```
/// use satisfice_collision::distance::Threshold;
/// assert_eq!(Threshold::new(0.25)?.get(), 0.25);
/// assert!(Threshold::new(0.0).is_err());
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Threshold {
    delta: f64,
    squared_below: f64,
    squared_above: f64,
}

impl Threshold {
    /// The largest there is.
    pub(crate) const LARGEST: Self = Self {
        delta: f64::MAX,
        squared_below: f64::MAX,
        squared_above: f64::INFINITY,
    };

    /// `delta`, in the unit of the coordinates.
    ///
    /// # Errors
    /// [`Error::Parameter`] if it is not finite or not above 0.
    pub fn new(delta: f64) -> Result<Self, Error> {
        if delta.is_finite() && delta > 0.0 {
            // The rounded square is off by at most half a step (also where it underflows), so its neighbours enclose.
            let squared = delta * delta;
            Ok(Self {
                delta,
                squared_below: squared.next_down(),
                squared_above: squared.next_up(),
            })
        } else {
            Err(Error::parameter(
                "threshold",
                delta,
                "a finite number above 0, in the unit of the coordinates",
            ))
        }
    }

    /// Delta itself.
    #[inline]
    pub fn get(self) -> f64 {
        self.delta
    }

    /// A lower bound of delta squared; negative if the square underflows.
    #[inline]
    pub fn squared_below(self) -> f64 {
        self.squared_below
    }

    /// An upper bound of delta squared; infinite if the square overflows.
    #[inline]
    pub fn squared_above(self) -> f64 {
        self.squared_above
    }
}

impl TryFrom<f64> for Threshold {
    type Error = Error;

    fn try_from(delta: f64) -> Result<Self, Error> {
        Self::new(delta)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn only_finite_positive_thresholds_are_made() {
        for bad in [0.0, -0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let message = Threshold::new(bad).unwrap_err().to_string();
            assert!(message.contains("threshold"), "{message}");
        }
        for good in [f64::from_bits(1), 1e-162, 0.1, 1e154, 1e155, f64::MAX] {
            let threshold = Threshold::new(good).unwrap();
            assert_eq!(threshold.get(), good);
            assert!(threshold.squared_below() < threshold.squared_above());
        }
    }
}
