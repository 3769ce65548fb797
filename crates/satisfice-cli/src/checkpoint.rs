//! `--checkpoint` and `--resume`.

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, bail};
use satisfice::Cancel;
use satisfice_catalogue::{Request, Saved};

use crate::arguments::RunArguments;
use crate::output::Output;

/// How often a checkpoint is written.
pub(crate) const EVERY: Duration = Duration::from_secs(5);

/// Reads a checkpoint, and what was asked for when it was written.
pub(crate) fn read(path: &Path) -> anyhow::Result<(Vec<u8>, Saved)> {
    let shown = path.display();
    let bytes = std::fs::read(path)
        .with_context(|| format!("cannot read {shown}: name a file that `run --checkpoint` has written"))?;
    let saved = Saved::read(&bytes)
        .with_context(|| format!("{shown} is no checkpoint that `run --checkpoint` has written"))?;
    Ok((bytes, saved))
}

/// Refuses the checkpoint of another problem.
pub(crate) fn is_of(saved: &Saved, problem: &str) -> anyhow::Result<()> {
    if saved.problem != problem {
        bail!(
            "the checkpoint is of {}, not of {problem}: name that problem",
            saved.problem
        );
    }
    Ok(())
}

/// The saved request under what the command line says. Where the two differ, the run refuses the checkpoint.
pub(crate) fn request(saved: &Saved, arguments: &RunArguments, cancel: &Cancel) -> Request {
    let mut asked = saved.clone();
    arguments.search.over(&mut asked);
    if let Some(engine) = &arguments.engine {
        asked.engine.clone_from(engine);
    }
    asked.slices = arguments.slices.unwrap_or(asked.slices);
    asked.request(arguments.search.threads(), cancel)
}

/// Keeps the latest checkpoint in a file, which is whole at any time.
pub(crate) struct Keeper {
    path: PathBuf,
    /// The next file, tried before it is needed.
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

    /// Replaces the file. What goes wrong is told at the end: it is no reason to lose the run.
    pub(crate) fn save(&mut self, bytes: &[u8]) {
        // One output is gone before the next one is opened: both are written beside the same place.
        let written = self.next.take().map(|mut output| output.write(bytes));
        match written.unwrap_or(Ok(())).and_then(|()| Output::open(&self.path)) {
            Ok(next) => self.next = Some(next),
            Err(error) => self.failed = Some(error),
        }
    }

    /// Tells what went wrong.
    pub(crate) fn finish(self) -> anyhow::Result<()> {
        match self.failed {
            Some(error) if self.next.is_none() => Err(error).context("the last checkpoint was not written"),
            _ => Ok(()),
        }
    }
}
