//! What came out of a run: plain data, the JSON of `--json`, of sweeps and of `verify`.

use serde_json::Value;

use crate::spec::RunSpec;

pub use satisfice::report::{SliceReport, recall};

/// The report of a run: all that is needed to repeat and to verify it. Everything but times is the same for the
/// same specification under a budget of evaluations.
///
/// Its JSON is that of a library's [`Report`](satisfice::Report), and in addition lists several slices.
pub type RunReport = satisfice::RunReport<RunSpec, Value>;

/// The candidate with the least fitness.
pub type Best = satisfice::Best<Value>;

/// One hit.
pub type FoundSolution = satisfice::report::FoundSolution<Value>;
