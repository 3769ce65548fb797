//! Falsification: inputs that drive a system out of its specification.

mod oscillator;

pub use oscillator::Falsification;
