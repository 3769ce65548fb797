//! Where the results go: each place is tried before the work begins, and no input is overwritten.

use std::path::PathBuf;

use super::arguments::CollideArguments;
use crate::output::{self, Output};
use crate::places::Places;

pub(super) struct Files {
    pub(super) json: Option<Output>,
    pub(super) csv: Option<Output>,
    pub(super) picture: Option<Output>,
    pub(super) page: Option<Output>,
    /// Whether stdout is free for a summary.
    pub(super) summary: bool,
}

impl Files {
    /// Opens them. `read` is every file that was read for the bodies.
    pub(super) fn open(arguments: &CollideArguments, read: &[PathBuf]) -> anyhow::Result<Self> {
        let CollideArguments {
            json,
            out,
            picture,
            page,
            ..
        } = arguments;
        let places = Places::default()
            .reads(read.iter().cloned())
            .writes("--json", json.as_ref())
            .writes("--out", out.as_ref())
            .writes("--picture", picture.as_ref())
            .writes("--page", page.as_ref());
        places.check()?;
        Ok(Self {
            json: output::open(json.as_ref())?,
            csv: output::open(out.as_ref())?,
            picture: output::open(picture.as_ref())?,
            page: output::open(page.as_ref())?,
            summary: !places.takes_stdout(),
        })
    }

    /// Whether some output lists the pairs.
    pub(super) fn lists_pairs(&self) -> bool {
        self.json.is_some() || self.csv.is_some()
    }
}
