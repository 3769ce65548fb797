//! `results.jsonl`: one line per finished run, appended as it ends.

use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::row::Row;
use crate::error::Error;

/// The file of a sweep.
#[derive(Debug)]
pub struct Results {
    path: PathBuf,
    file: File,
}

impl Results {
    /// Opens or creates the file of a folder, which is created as well; returns its rows. A last line that
    /// a crash has cut short is dropped.
    ///
    /// # Errors
    /// [`Error::File`] where it cannot be read or written, or a line is not a run.
    pub fn open(folder: &Path) -> Result<(Self, Vec<Row>), Error> {
        let path = folder.join("results.jsonl");
        let told = |what: String| Error::File {
            path: path.clone(),
            what,
        };
        std::fs::create_dir_all(folder)
            .map_err(|error| told(format!("cannot make its folder: {error}; choose another one")))?;
        let text = match std::fs::read_to_string(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => String::new(),
            read => read.map_err(|error| told(format!("cannot read it: {error}")))?,
        };
        let whole = text.rfind('\n').map_or(0, |end| end + 1);
        let rows = text[..whole]
            .lines()
            .enumerate()
            .map(|(number, line)| {
                serde_json::from_str(line).map_err(|error| {
                    told(format!(
                        "line {} is not a finished run ({error}): remove it, or choose another folder",
                        number + 1
                    ))
                })
            })
            .collect::<Result<Vec<Row>, _>>()?;
        let mut open = OpenOptions::new();
        let file = open
            .append(true)
            .create(true)
            .open(&path)
            .and_then(|file| file.set_len(whole as u64).map(|()| file))
            .map_err(|error| told(format!("cannot write to it: {error}; choose another folder")))?;
        Ok((Self { path, file }, rows))
    }

    /// Appends a run; it is on the disk when this returns.
    ///
    /// # Errors
    /// [`Error::File`] where the disk is full or gone.
    pub fn append(&mut self, row: &Row) -> Result<(), Error> {
        let mut line = serde_json::to_vec(row)?;
        line.push(b'\n');
        self.file.write_all(&line).and_then(|()| self.file.sync_data()).map_err(|error| Error::File {
            path: self.path.clone(),
            what: format!("cannot write to it: {error}; its rows are kept: free some space and run the same command again"),
        })
    }
}
