//! `--checkpoint` and `--resume`.

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, bail};
use satisfice_catalogue::{RunSpec, checkpoint};

use crate::output::Output;

/// How often a checkpoint is written.
pub(crate) const EVERY: Duration = Duration::from_secs(5);

/// Reads a checkpoint and the specification of its run, which must be of `problem`.
pub(crate) fn read(path: &Path, problem: &str) -> anyhow::Result<(Vec<u8>, RunSpec)> {
    let shown = path.display();
    let bytes = std::fs::read(path)
        .with_context(|| format!("cannot read {shown}: name a file that `run --checkpoint` wrote"))?;
    let spec = checkpoint::spec(&bytes)
        .with_context(|| format!("{shown} is not a checkpoint that `run --checkpoint` wrote"))?;
    if spec.problem != problem {
        bail!(
            "the checkpoint is of {}, not of {problem}: name that problem",
            spec.problem
        );
    }
    Ok((bytes, spec))
}

/// Keeps the latest checkpoint in a file, which is complete at any time.
pub(crate) struct Keeper {
    path: PathBuf,
    /// The next file, opened before it is needed.
    next: Option<Output>,
    failed: Option<anyhow::Error>,
}

impl Keeper {
    pub(crate) fn new(path: &Path) -> anyhow::Result<Self> {
        if path == Path::new("-") {
            bail!("a checkpoint is written again and again: name a file for it, not stdout");
        }
        Ok(Self {
            path: path.to_owned(),
            next: Some(Output::open(path)?),
            failed: None,
        })
    }

    /// Replaces the file. An error is reported at the end, so that the run is not lost.
    pub(crate) fn save(&mut self, bytes: &[u8]) {
        // One output is gone before the next one is opened: both are written beside the same place.
        let written = self.next.take().map(|mut output| output.write(bytes));
        match written.unwrap_or(Ok(())).and_then(|()| Output::open(&self.path)) {
            Ok(next) => self.next = Some(next),
            Err(error) => self.failed = Some(error),
        }
    }

    /// Reports what went wrong.
    pub(crate) fn finish(self) -> anyhow::Result<()> {
        match self.failed {
            Some(error) if self.next.is_none() => Err(error).context("the last checkpoint was not written"),
            _ => Ok(()),
        }
    }
}
