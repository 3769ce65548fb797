//! Names and contents of the files of a sweep.

use std::path::Path;

use crate::error::Error;

/// A text as part of a file's name.
pub(super) fn plain(text: &str) -> String {
    let keep = |c: char| {
        if c.is_ascii_alphanumeric() || ".-".contains(c) {
            c
        } else {
            '_'
        }
    };
    text.chars().map(keep).collect()
}

/// Writes a file and the folders it is in.
pub(super) fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let folder = path.parent().unwrap_or_else(|| Path::new("."));
    std::fs::create_dir_all(folder)
        .and_then(|()| std::fs::write(path, bytes))
        .map_err(|error| Error::File {
            path: path.to_owned(),
            what: format!("cannot write it: {error}"),
        })
}
