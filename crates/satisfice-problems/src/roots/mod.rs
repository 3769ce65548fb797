//! Roots of nonlinear systems: continuous spaces, hits polished by Newton's method, distinct roots counted.

mod certify;
pub(crate) mod equations;
mod himmelblau;
mod newton;
mod periodic_points;
mod system;
mod systems;
mod waves;

pub use himmelblau::Himmelblau;
pub use periodic_points::PeriodicPoints;
pub use system::System;
pub use waves::Roots;
