//! Roots of nonlinear systems: continuous spaces, hits polished by Newton's method, distinct roots counted.

mod equations;
mod himmelblau;
mod newton;
mod waves;

pub use himmelblau::Himmelblau;
pub use waves::Roots;
