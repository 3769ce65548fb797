//! The command `satisfice` as a library: a program of your own gets `list`, `run`, `bench` and `verify` for its own problems.
//!
//! ```no_run
//! use satisfice::catalogue::{Catalogued, Parameter, Params};
//! use satisfice::{Error, Identity, SatisficingProblem, Space};
//!
//! /// Pairs of whole numbers with a given sum.
//! struct Sums {
//!     space: Space<f64>,
//!     sum: f64,
//! }
//!
//! impl SatisficingProblem for Sums {
//!     type Scalar = f64;
//!     type Solution = [u32; 2];
//!     fn space(&self) -> &Space<f64> {
//!         &self.space
//!     }
//!     fn decode(&self, values: &[f64]) -> [u32; 2] {
//!         [values[0] as u32, values[1] as u32]
//!     }
//!     fn fitness(&self, &[x, y]: &[u32; 2]) -> f64 {
//!         (f64::from(x + y) - self.sum).abs()
//!     }
//!     fn threshold(&self) -> f64 {
//!         0.5
//!     }
//! }
//!
//! impl Catalogued for Sums {
//!     const NAME: &'static str = "sums";
//!     const SUMMARY: &'static str = "pairs of whole numbers with a given sum";
//!     const SOURCE: &'static str = "this example";
//!     const PARAMETERS: &'static [Parameter] = &[Parameter::integer("sum", "the sum", 50, 0, 198)];
//!     fn from_params(params: &Params) -> Result<Self, Error> {
//!         Ok(Self { space: Space::lattice(2, 100)?, sum: params.integer("sum") as f64 })
//!     }
//! }
//!
//! fn main() -> std::process::ExitCode {
//!     satisfice_cli::Command::new().problem::<Sums>().main()
//! }
//! ```

mod allocator;
mod arguments;
mod bench;
mod checkpoint;
mod collide;
mod completions;
mod failure;
mod interrupt;
mod list;
mod message;
mod output;
mod page;
mod places;
mod plot;
mod program;
mod progress;
mod quantity;
mod reference;
mod run;
mod summary;
mod verify;

use std::ffi::OsString;
use std::process::ExitCode;

pub use allocator::Allocator;
use arguments::Subcommands;
use satisfice::catalogue::Catalogued;
use satisfice_catalogue::Catalogue;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// The command, with the problems that it knows by name.
///
/// An example is at the top of [this page](crate).
///
/// ```
/// use satisfice_cli::Command;
/// use satisfice_collision::problem::Teapots;
/// let command = Command::without_problems().problem::<Teapots>(); // `list`, `run`, `bench`, `verify` know `teapots`
/// # let _ = command;
/// ```
#[derive(Debug, Clone, Default)]
pub struct Command {
    catalogue: Catalogue,
}

impl Command {
    /// The command with the bundled problems.
    #[must_use]
    pub fn new() -> Self {
        Self {
            catalogue: Catalogue::bundled(),
        }
    }

    /// The command without any problem.
    #[must_use]
    pub fn without_problems() -> Self {
        Self {
            catalogue: Catalogue::empty(),
        }
    }

    /// Adds a problem under its [name](Catalogued::NAME). It replaces one of the same name.
    ///
    /// Reports list its solutions, so these must serialise with serde.
    #[must_use]
    pub fn problem<P>(mut self) -> Self
    where
        P: Catalogued + Send + 'static,
        P::Solution: Serialize + DeserializeOwned,
    {
        self.catalogue = self.catalogue.with::<P>();
        self
    }

    /// Runs the command with the arguments of this process. Results go to stdout, progress and errors to stderr.
    ///
    /// The exit code is 0 after at least one hit (or when `list`, `bench` or `verify` succeed), 1 without a hit (or when
    /// `verify` finds a mismatch), and 2 after an error.
    #[must_use]
    pub fn main(self) -> ExitCode {
        self.run(std::env::args_os())
    }

    /// Runs the command with these arguments, the first of which is the name of the program; for a command within another
    /// program. Otherwise as [`Command::main`]. Ctrl-C can be listened for once in a process, so this can be called once.
    #[must_use]
    pub fn run(self, arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
        let arguments: Vec<OsString> = arguments.into_iter().collect();
        let subcommand = match arguments::parse(&arguments) {
            Ok(subcommand) => subcommand,
            Err(error) => return failure::usage(&error, &arguments),
        };
        let catalogue = &self.catalogue;
        let outcome = match subcommand {
            Subcommands::List(arguments) => list::list(&arguments, catalogue),
            Subcommands::Run(arguments) => run::run(&arguments, catalogue),
            Subcommands::Collide(arguments) => collide::collide(&arguments),
            Subcommands::Bench(bench) => bench::bench(&bench, catalogue, &arguments),
            Subcommands::Verify(arguments) => verify::verify(&arguments, catalogue),
            Subcommands::Completions(arguments) => completions::completions(&arguments, catalogue),
        };
        outcome.unwrap_or_else(|error| failure::report(&error))
    }
}
