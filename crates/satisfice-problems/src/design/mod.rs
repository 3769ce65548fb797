//! Engineering design windows.

mod sallen_key;

pub use sallen_key::{Parts, SallenKey, Window};
