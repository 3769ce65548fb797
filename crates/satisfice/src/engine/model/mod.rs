//! Engines that model F.

mod candidates;
mod duplicates;
mod factor;
mod failures;
mod gaussian_process;
mod kernel;
mod lanes;
mod likelihood;
mod limits;
mod local;
mod one_answer;
mod points;
mod pool;
mod process;
mod promise;
mod quadratic;
mod reach;
mod record;
mod region;
mod roots;
mod saved;
mod scales;
mod skill;
mod surrogate;
mod target;
mod units;

pub use gaussian_process::GaussianProcess;
pub use quadratic::QuadraticDescent;
pub(super) use skill::Yardstick;
pub(super) use surrogate::ModelledSearch;
pub use surrogate::Surrogate;
