//! Settings of the simulation.

use satisfice_collision::Error;

/// The contacts that push back.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Response {
    /// Those with the sphere and those of the cloth with itself.
    #[default]
    All,
    /// Those with the sphere alone: the cloth passes through itself.
    Sphere,
}

/// Settings of the simulation. Lengths in metres.
///
/// ```
/// use satisfice_cloth::{Response, Settings};
/// let small = Settings { columns: 16, response: Response::Sphere, ..Settings::default() };
/// assert!(small.spacing() > Settings::default().spacing());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Particles on each side of the square cloth, 4 to 1024.
    pub columns: u32,
    /// Side of the cloth.
    pub width: f64,
    /// Radius of the sphere, whose centre is the origin.
    pub radius: f64,
    /// Initial offset of the cloth's middle from the centre of the sphere, along x.
    pub beside: f64,
    /// Initial height of the cloth above the sphere.
    pub drop: f64,
    /// Drag of the air, 1/s: speeds fall by exp(-drag t).
    pub drag: f64,
    /// Coulomb's coefficient of friction, of all contacts.
    pub friction: f64,
    /// Pairs of particles closer than this are detected, in spacings. A value a little below 1 leaves out most pairs joined
    /// by an edge; above 0.71 nothing passes undetected through the middle of a cell.
    pub reach: f64,
    /// The contacts that push back.
    pub response: Response,
}

impl Default for Settings {
    /// 128 x 128 particles, 2 m wide, on a sphere of 0.5 m.
    fn default() -> Self {
        Self {
            columns: 128,
            width: 2.0,
            radius: 0.5,
            beside: 0.05,
            drop: 0.03,
            drag: 1.0,
            friction: 0.3,
            reach: 0.95,
            response: Response::All,
        }
    }
}

impl Settings {
    /// Distance between neighbouring particles at rest.
    #[must_use]
    pub fn spacing(&self) -> f64 {
        self.width / (f64::from(self.columns) - 1.0)
    }

    /// Distance below which a pair is detected as a contact.
    #[must_use]
    pub fn delta(&self) -> f64 {
        self.reach * self.spacing()
    }

    /// Initial height of the cloth.
    #[must_use]
    pub fn start_height(&self) -> f64 {
        self.radius + self.drop + self.spacing()
    }

    /// Steps per frame, each with a detection: a particle at 3 m/s moves by less than half a spacing per step.
    pub(crate) fn steps(&self) -> u32 {
        self.columns.div_ceil(16).max(2)
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        if !(4..=1024).contains(&self.columns) {
            return Err(refused("columns", self.columns, "4 to 1024 particles on a side"));
        }
        for (name, value) in [
            ("width", self.width),
            ("radius", self.radius),
            ("reach", self.reach),
        ] {
            if !(value.is_finite() && value > 0.0) {
                return Err(refused(name, value, "a finite length above 0"));
            }
        }
        for (name, value) in [
            ("drop", self.drop),
            ("drag", self.drag),
            ("friction", self.friction),
        ] {
            if !(value.is_finite() && value >= 0.0) {
                return Err(refused(name, value, "a finite number of at least 0"));
            }
        }
        if self.beside.is_finite() {
            Ok(())
        } else {
            Err(refused("beside", self.beside, "a finite length"))
        }
    }
}
fn refused(parameter: &'static str, value: impl std::fmt::Display, allowed: &'static str) -> Error {
    Error::Parameter {
        parameter,
        value: value.to_string(),
        allowed,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Simulation;

    #[test]
    fn settings_out_of_range_are_refused() {
        let good = Settings::default();
        for bad in [
            Settings { columns: 3, ..good },
            Settings {
                columns: 1025,
                ..good
            },
            Settings { width: 0.0, ..good },
            Settings {
                radius: f64::NAN,
                ..good
            },
            Settings {
                friction: -1.0,
                ..good
            },
            Settings {
                beside: f64::INFINITY,
                ..good
            },
        ] {
            assert!(Simulation::new(&bad).is_err(), "{bad:?}");
        }
    }
}
