//! Roots of nonlinear systems: continuous spaces, hits polished by Newton's method, distinct roots counted.

mod certify;
pub(crate) mod equations;
mod himmelblau;
mod newton;
mod system;
mod systems;
mod waves;

pub use himmelblau::Himmelblau;
pub use system::System;
pub use waves::Roots;
