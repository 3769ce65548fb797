//! Runs any engine on any problem by name: the [catalogue] of problems, records of runs as JSON, their verification.
//!
//! A problem is generic and inlines on the hot path; here it is behind one [`Instance`], whose inside stays monomorphic:
//! only the call of a whole run is virtual.
//!
//! ```
//! use satisfice::Budget;
//! use satisfice_catalogue::{Request, catalogue};
//! # if catalogue::all().is_empty() { return Ok(()); }
//! let problem = catalogue::all()[0].build([])?;
//! let request = Request::new("random", Budget::evaluations(1000)).seed(7);
//! let record = problem.run(&request, &mut |_| {})?;
//! assert_eq!(record.counts.evaluations, 1000);
//! println!("{}", serde_json::to_string_pretty(&record)?);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod catalogue;
mod error;
pub mod exact;
mod instance;
pub mod json;
pub mod listing;
mod machine;
pub mod quantity;
pub mod record;
pub mod resume;
pub mod run;
pub mod settings;
pub mod verify;

pub use error::Error;
pub use instance::Instance;
pub use machine::machine;
pub use record::Record;
pub use resume::{Keeping, Saved};
pub use run::{Progress, Request, search};
pub use settings::Settings;
pub use verify::Mismatch;
