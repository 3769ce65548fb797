//! The native part of the Python package `satisfice`: searches, reports and the command. Its Python part is in `python/`.

// Arguments and tuples as Python passes them.
#![allow(clippy::needless_pass_by_value, clippy::type_complexity)]

mod arguments;
mod caller;
mod collision;
mod find;
mod listing;
mod problem;
mod question;
mod report;
mod rounds;
mod saved;
mod search;
mod told;
mod watch;

use pyo3::prelude::*;

/// Native part of the package `satisfice`.
#[pymodule]
mod _satisfice {
    #[pymodule_export]
    use crate::collision::{Body, Mesh, Step, World, close_pairs};
    #[pymodule_export]
    use crate::find::find;
    #[pymodule_export]
    use crate::listing::{command, listing, version};
    #[pymodule_export]
    use crate::problem::Problem;
    #[pymodule_export]
    use crate::report::{Best, Report};
    #[pymodule_export]
    use crate::rounds::{Rounds, run_island};
    #[pymodule_export]
    use crate::saved::saved_seed;
    #[pymodule_export]
    use crate::search::Search;
}

/// A refusal of the framework, as Python sees it.
pub(crate) fn refused(error: impl std::fmt::Display) -> PyErr {
    pyo3::exceptions::PyValueError::new_err(error.to_string())
}
