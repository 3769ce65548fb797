//! `--checkpoint` and `--resume`.

use std::path::Path;

use anyhow::{Context, bail};
use satisfice_catalogue::{RunSpec, checkpoint, input};

use crate::message;
use crate::output::Output;

/// Reads a checkpoint and the specification of its run, which must be of `problem`, if that is given.
pub(crate) fn read(path: &Path, problem: Option<&str>) -> anyhow::Result<(Vec<u8>, RunSpec)> {
    let shown = path.display();
    let bytes = input::read(path)
        .with_context(|| format!("cannot read {shown}: name a file that `run --checkpoint` wrote"))?;
    let spec = checkpoint::spec(&bytes)
        .with_context(|| format!("{shown} is not a checkpoint that `run --checkpoint` wrote"))?;
    if let Some(problem) = problem
        && spec.problem != problem
    {
        bail!(
            "the checkpoint is of {}, not of {problem}: name that problem",
            spec.problem
        );
    }
    Ok((bytes, spec))
}

/// Keeps the latest checkpoint in a file, which is whole at any time.
pub(crate) struct Keeper {
    output: Output,
    /// Why the latest checkpoint was not written.
    failed: Option<anyhow::Error>,
}

impl Keeper {
    pub(crate) fn new(path: &Path) -> anyhow::Result<Self> {
        if path == Path::new("-") {
            bail!("a checkpoint is written again and again: name a file for it, not stdout");
        }
        Ok(Self {
            output: Output::open(path)?,
            failed: None,
        })
    }

    /// Replaces the file. A failure is reported at once, and the next checkpoint is tried again: the run continues.
    pub(crate) fn save(&mut self, bytes: &[u8]) {
        self.failed = self.output.write(bytes).err();
        if let Some(error) = &self.failed {
            message::say(format_args!(
                "warning: no checkpoint was written: {error:#}; the run goes on"
            ));
        }
    }

    /// Fails if the last checkpoint was not written.
    pub(crate) fn finish(self) -> anyhow::Result<()> {
        self.failed.map_or(Ok(()), |error| {
            Err(error).context("the last checkpoint was not written")
        })
    }
}
