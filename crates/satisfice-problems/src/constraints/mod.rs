//! Constraint satisfaction: F counts violated constraints, a hit violates none.

mod queens;

pub use queens::Queens;
