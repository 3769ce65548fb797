//! The options of `satisfice run` for a fitness that other processes compute.

use std::path::PathBuf;
use std::time::Duration;

use anyhow::bail;
use clap::{Args, ValueHint};
use satisfice::catalogue::Parameter;

use crate::quantity;

/// A fitness that other processes compute.
#[derive(Debug, Args)]
pub(crate) struct ProgramArguments {
    /// Start this program for each point: {x} stands for all coordinates, {NAME} for one. It writes the value as its last line. No
    /// shell is involved.
    #[arg(long, value_name = "COMMAND", group = "evaluator")]
    pub(crate) program: Option<String>,

    /// Start this program once for each worker: it reads and writes lines of JSON.
    #[arg(long, value_name = "COMMAND", group = "evaluator")]
    pub(crate) worker: Option<String>,

    /// The space of a program, as a TOML file.
    #[arg(long, value_name = "FILE.toml", value_hint = ValueHint::FilePath)]
    pub(crate) space: Option<PathBuf>,

    /// delta of a program: a hit is a point whose value is below it.
    #[arg(long, value_name = "DELTA", allow_hyphen_values = true)]
    pub(crate) threshold: Option<f64>,

    /// Processes at a time [default: 1].
    #[arg(long, value_name = "N", value_parser = quantity::workers, allow_hyphen_values = true)]
    pub(crate) workers: Option<u16>,

    /// Give up an evaluation after this time, and end its process.
    #[arg(long, value_name = "TIME", value_parser = satisfice_catalogue::quantity::time)]
    pub(crate) timeout: Option<Duration>,

    /// Retry a failed evaluation up to this many times [default: 1]. If it still fails, its value counts as NaN, and the report proves
    /// nothing.
    #[arg(long, value_name = "N", value_parser = quantity::retries, allow_hyphen_values = true)]
    pub(crate) retries: Option<u32>,

    /// Let /bin/sh run the program. What stands for coordinates is quoted where the shell would not read it literally.
    #[arg(long)]
    pub(crate) shell: bool,

    /// Enter values in the order of the points: the same report for any number of workers. Workers may have to wait; --parallel gives them more.
    #[arg(long)]
    pub(crate) ordered: bool,
}

impl ProgramArguments {
    /// Whether the fitness is that of a program.
    pub(crate) fn is_given(&self) -> bool {
        self.program.is_some() || self.worker.is_some()
    }

    /// How many processes work at a time.
    pub(super) fn workers(&self) -> u16 {
        self.workers.unwrap_or(1)
    }

    /// How often a failed evaluation is tried again.
    pub(super) fn retries(&self) -> u32 {
        self.retries.unwrap_or(1)
    }

    /// Refuses options that only programs have, for a problem of the catalogue with these parameters: some set a parameter there.
    pub(crate) fn check_unused(&self, parameters: &[Parameter]) -> anyhow::Result<()> {
        let given = [
            ("--space", self.space.is_some()),
            ("--threshold", self.threshold.is_some()),
            ("--workers", self.workers.is_some()),
            ("--timeout", self.timeout.is_some()),
            ("--retries", self.retries.is_some()),
            ("--shell", self.shell),
            ("--ordered", self.ordered),
        ];
        let Some((option, _)) = given.into_iter().find(|(_, is_given)| *is_given) else {
            return Ok(());
        };
        let meant = self.threshold.filter(|_| option == "--threshold");
        let own = parameters
            .iter()
            .find(|row| ["threshold", "delta"].contains(&row.name));
        let instead = meant.zip(own).map_or_else(String::new, |(delta, own)| {
            format!(", or set that of the problem: --set {}={delta}", own.name)
        });
        bail!("{option} is for --program and --worker: leave it out{instead}")
    }
}
