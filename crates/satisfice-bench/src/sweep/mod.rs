//! Sweeps: engines x problems x parameters x seeds, from a TOML file or a named suite, to a table.
//!
//! ```
//! use satisfice::Cancel;
//! use satisfice_catalogue::Catalogue;
//! use satisfice_bench::sweep::{Plan, Suite, execute, groups, table};
//! let suite = Suite::parse("mine", r#"
//!     seeds = "0..4"
//!     [[part]]
//!     engines = ["random", "descent-flood"]
//!     problems = [{ name = "rastrigin", dimension = 2 }]
//!     evaluations = 5000
//! "#)?;
//! let plan = Plan::new(suite, &Catalogue::bundled())?; // here names and values are checked, all of them
//! # let folder = tempfile::tempdir()?;
//! # let folder = folder.path();
//! let done = execute(&plan, folder, 2, None, &Cancel::new(), &mut |_| {})?; // a line in results.jsonl as each run ends
//! println!("{}", table(&groups(&plan, &done.rows)));
//! # assert_eq!(done.rows.len(), 8);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! **Timings are not disturbed**: runs limited by a clock come last and one at a time, while this program does nothing else;
//! runs limited by evaluations share the cores, and their times are not reported. Reference counts are made before any run.

mod execute;
pub mod figures;
mod files;
mod grid;
pub mod ioh;

pub mod metrics;
mod plan;
mod publish;
pub mod regret;
mod report;
mod results;
mod row;
mod selection;
mod shard;
mod suite;
mod summary;

pub use execute::{Event, Finished, execute};
pub use plan::{Cell, Plan, Planned};
pub use publish::{publish, replaced};
pub use results::{Results, write_all};
pub use row::Row;
pub use selection::Selection;
pub use shard::{Shard, ShardOf, merge};
pub use suite::{Choice, Part, Regret, Suite, names, seeds};
pub use summary::{Group, Line, Reached, cells, groups, heading, rows_of, table};
