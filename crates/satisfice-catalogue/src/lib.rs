//! Runs any engine on any problem by name: the [catalogue] of problems, [specifications](RunSpec) and [reports](RunReport)
//! of runs as JSON, and their [verification](verify).
//!
//! A problem is generic and inlines on the hot path; here it is behind an [`Instance`], whose inside stays monomorphic:
//! only the call of a whole run is virtual.
//!
//! ```
//! use satisfice_catalogue::{RunControl, RunSpec, catalogue};
//! let problem = catalogue::find("queens")?.build([("n", "6")])?;
//! let report = problem.run(&RunSpec::new("random").evaluations(1000).seed(7), RunControl::default())?;
//! assert_eq!(report.counts.evaluations, 1000);
//! println!("{}", serde_json::to_string_pretty(&report)?);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod axes;
pub mod catalogue;
pub mod checkpoint;
mod control;
mod error;
pub mod exact;
pub mod input;
mod instance;
pub mod json;
pub mod listing;
mod machine;
mod method;
pub mod options;
pub mod quantity;
mod remarks;
pub mod report;
mod run;
pub mod sealed;
mod settings;
mod spec;
pub mod verify;

pub use catalogue::{Catalogue, ProblemSpec};
pub use control::{Progress, RunControl, Save};
pub use error::Error;
pub use instance::Instance;
pub use machine::machine;
pub use options::RunOption;
pub use remarks::small_batches;
pub use report::RunReport;
pub use run::run;
pub use settings::Settings;
pub use spec::{Limits, RunSpec};
pub use verify::Mismatch;
