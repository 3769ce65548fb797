//! What command lines and reports need: problems and engines by name, with tables of parameters.
//!
//! A library user who writes a problem and runs a search needs none of it.

use crate::error::Error;
use crate::problem::SatisficingProblem;

mod parameter;
mod params;
mod value;

pub use crate::description::Description;
pub use parameter::{ParamKind, Parameter};
pub use params::Params;
pub use value::ParamValue;
pub(crate) use value::as_map;

/// A problem that a command line can name and build from parameters.
pub trait Catalogued: SatisficingProblem + Sized {
    /// Its name, in lower case with hyphens.
    const NAME: &'static str;
    /// One line.
    const SUMMARY: &'static str;
    /// Its source.
    const SOURCE: &'static str;
    /// Its parameters with defaults and ranges.
    const PARAMETERS: &'static [Parameter];

    /// The problem with these parameters, which are within their ranges.
    ///
    /// # Errors
    /// [`Error::Parameter`] for parameters that contradict each other.
    fn from_params(params: &Params) -> Result<Self, Error>;

    /// The number of distinct hits, where it is known or can be enumerated within seconds.
    fn reference_hits(&self) -> Option<u64> {
        None
    }
}
