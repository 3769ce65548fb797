//! How near two features have to come.

use std::fmt;

use crate::Error;
use crate::distance::Threshold;

/// The distance delta of a hit during a motion: finite and at least 0, in the unit of the coordinates.
///
/// A pair hits if its distance is below delta at some time. For a delta of 0 it hits if it touches: if its distance is 0 at some
/// time.
///
/// ```
/// use satisfice_collision::continuous::Separation;
/// assert_eq!(Separation::new(0.0)?, Separation::TOUCHING);
/// assert!(Separation::new(-1.0).is_err());
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct Separation(f64);

impl Separation {
    /// A distance of 0 at some time.
    pub const TOUCHING: Self = Self(0.0);

    /// `delta`, in the unit of the coordinates; 0 asks for touching.
    ///
    /// # Errors
    /// [`Error::Parameter`] if it is not finite or below 0.
    pub fn new(delta: f64) -> Result<Self, Error> {
        if delta.is_finite() && delta >= 0.0 {
            // Also makes 0 of -0.
            Ok(Self(delta.abs()))
        } else {
            Err(Error::parameter(
                "threshold",
                delta,
                "a finite number, at least 0, in the unit of the coordinates",
            ))
        }
    }

    /// Delta itself.
    #[inline]
    #[must_use]
    pub fn get(self) -> f64 {
        self.0
    }
}

impl From<Threshold> for Separation {
    fn from(threshold: Threshold) -> Self {
        Self(threshold.get())
    }
}

impl fmt::Display for Separation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}
