//! Sampling and local search.

pub(super) mod bandit;
pub(super) mod descent;
mod descent_flood;
mod ends;
pub(super) mod flood;
pub(super) mod luby;
mod misses;
mod niching;
pub(super) mod one_plus_one;
mod pairs_of_hits;
mod random;
pub(super) mod recombination;
mod repelled;
mod restarted_cma_es;
mod strategy;
mod walk;

pub use descent::Descent;
pub use descent_flood::DescentFlood;
pub use niching::Niching;
pub use random::Random;
pub use restarted_cma_es::RestartedCmaEs;
pub use walk::Walk;
