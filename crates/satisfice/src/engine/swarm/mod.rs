//! Particle swarms: the published ones, and what they share.

mod bounded_swarms;
mod dbscan;
mod informants;
mod latest_hit_qpso;
mod niching_pso_dbscan;
mod particles;
pub(super) mod potential_well;
mod pso;
mod pso_1995;
mod pso_inertia;
mod pso_latest_hit;
mod qpso;
mod qpso_deletion;
mod quantum;
mod schedule;
mod spso_2011;
mod velocity;

pub use bounded_swarms::BoundedSwarms;
pub use latest_hit_qpso::LatestHitQpso;
pub use niching_pso_dbscan::NichingPsoDbscan;
pub use potential_well::ALPHA_BOUNDED;
pub use pso::Pso;
pub use pso_1995::Pso1995;
pub use pso_inertia::PsoInertia;
pub use pso_latest_hit::PsoLatestHit;
pub use qpso::Qpso;
pub use qpso_deletion::QpsoDeletion;
pub use spso_2011::Spso2011;
