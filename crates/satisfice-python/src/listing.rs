//! What there is by name, and the command.

use std::ffi::OsString;
use std::process::ExitCode;

use pyo3::prelude::*;
use satisfice_catalogue::{Catalogue, json};

use crate::refused;

/// Every engine and problem with its parameters, as the JSON of `satisfice list --json`.
#[pyfunction]
pub(crate) fn listing() -> PyResult<String> {
    let listing = satisfice_catalogue::listing::listing(&Catalogue::bundled());
    let text = json::to_vec(&listing).map_err(refused)?;
    String::from_utf8(text).map_err(refused)
}

/// Runs the command; the first argument is the name of the program. Returns the exit code.
#[pyfunction]
pub(crate) fn command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    let code = py.detach(|| satisfice_cli::Command::new().run(arguments));
    (0..u8::MAX)
        .find(|&byte| ExitCode::from(byte) == code)
        .unwrap_or(u8::MAX)
}

/// The version of the framework.
#[pyfunction]
pub(crate) fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}
