//! Where the results go: each place is tried before the work begins, and no input is overwritten.

use std::path::{Path, PathBuf};

use anyhow::bail;

use super::arguments::CollideArguments;
use crate::output::{self, Output};

pub(super) struct Files {
    pub(super) json: Option<Output>,
    pub(super) csv: Option<Output>,
    pub(super) picture: Option<Output>,
    pub(super) page: Option<Output>,
    /// Whether stdout is free for a summary.
    pub(super) summary: bool,
}

impl Files {
    pub(super) fn open(arguments: &CollideArguments) -> anyhow::Result<Self> {
        let CollideArguments {
            json,
            out,
            picture,
            page,
            meshes,
            from,
            to,
            ..
        } = arguments;
        let stdout = Path::new("-");
        let to_stdout = [json, out, picture, page]
            .into_iter()
            .flatten()
            .filter(|path| *path == stdout)
            .count();
        if to_stdout > 1 {
            bail!(
                "only one of --json, --out, --picture and --page can go to stdout: name files for the others"
            );
        }
        let is_file = |path: &&PathBuf| **path != stdout;
        let inputs = meshes.iter().chain(from).chain(to);
        let inputs: Vec<&Path> = inputs.filter(is_file).map(PathBuf::as_path).collect();
        let outputs = [
            ("--json", json),
            ("--out", out),
            ("--picture", picture),
            ("--page", page),
        ]
        .map(|(option, path)| (option, path.as_ref().filter(is_file)));
        output::check_distinct(&inputs, &outputs)?;
        Ok(Self {
            json: output::open(json.as_ref())?,
            csv: output::open(out.as_ref())?,
            picture: output::open(picture.as_ref())?,
            page: output::open(page.as_ref())?,
            summary: to_stdout == 0,
        })
    }
}
