//! Falsification: inputs that drive a system out of its specification.

mod oscillator;
mod temporal_logic;
mod transmission;

pub use oscillator::Falsification;
pub use temporal_logic::{Specification, Trace};
pub use transmission::Transmission;
