//! `results.jsonl`: a line for every finished run, appended as it ends.
//!
//! Each line is a JSON object whose first key is the checksum of the others. A process that writes the file locks it.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use satisfice_catalogue::sealed::{self, Broken};

use super::files;
use super::row::Row;
use crate::error::Error;

/// The file of a sweep, locked until it is dropped.
#[derive(Debug)]
pub struct Results {
    path: PathBuf,
    file: File,
}

impl Results {
    /// Opens or creates the file in a folder, which is created too, and locks it. Returns the rows in it. An unfinished last
    /// line, left by a crash, is dropped.
    ///
    /// # Errors
    /// [`Error::File`] if it cannot be read or written, if another process writes it, or if a line is damaged.
    pub fn open(folder: &Path) -> Result<(Self, Vec<Row>), Error> {
        let path = folder.join("results.jsonl");
        let failed = |what: String| Error::File {
            path: path.clone(),
            what,
        };
        files::make_folder(folder)?;
        let mut file = OpenOptions::new()
            .read(true)
            .append(true)
            .create(true)
            .open(&path)
            .map_err(|error| failed(format!("cannot write to it: {error}; choose another folder")))?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let what = "another process is writing to it: wait for its end, or choose another folder";
                return Err(failed(what.to_owned()));
            }
            Err(TryLockError::Error(error)) => return Err(failed(format!("cannot lock it: {error}"))),
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes)
            .map_err(|error| failed(format!("cannot read it: {error}")))?;
        let whole = bytes
            .iter()
            .rposition(|&byte| byte == b'\n')
            .map_or(0, |end| end + 1);
        let rows = bytes[..whole]
            .split(|&byte| byte == b'\n')
            .filter(|line| !line.is_empty())
            .enumerate()
            .map(|(number, line)| {
                read(line).map_err(|what| {
                    let number = number + 1;
                    failed(format!(
                        "line {number} {what}: remove it, or choose another folder"
                    ))
                })
            })
            .collect::<Result<Vec<Row>, _>>()?;
        file.set_len(whole as u64)
            .map_err(|error| failed(format!("cannot write to it: {error}; choose another folder")))?;
        Ok((Self { path, file }, rows))
    }

    /// Appends a run; it is on the disk when this returns.
    ///
    /// # Errors
    /// [`Error::File`] if the disk is full or gone.
    pub fn append(&mut self, row: &Row) -> Result<(), Error> {
        let line = write(&serde_json::to_string(row)?);
        let written = self
            .file
            .write_all(line.as_bytes())
            .and_then(|()| self.file.sync_data());
        written.map_err(|error| Error::File {
            path: self.path.clone(),
            what: format!("cannot write to it: {error}; its rows are kept: free some space and run the same command again"),
        })
    }
}

/// Writes these rows as the only ones of a folder.
///
/// # Errors
/// [`Error::File`] if it cannot be written, or has rows already.
pub fn write_all(folder: &Path, rows: &[Row]) -> Result<(), Error> {
    let (mut results, old) = Results::open(folder)?;
    if !old.is_empty() {
        return Err(Error::File {
            path: results.path,
            what: "it has runs already: choose a new folder".to_owned(),
        });
    }
    rows.iter().try_for_each(|row| results.append(row))
}

/// A line from the JSON of a row.
fn write(row: &str) -> String {
    format!("{}\n", sealed::seal(row))
}

/// The row of a line, or what is wrong with the line.
fn read(line: &[u8]) -> Result<Row, String> {
    let row = sealed::open(line).map_err(|broken| match broken {
        Broken::Unsealed => "is not a finished run".to_owned(),
        Broken::Damaged => "is damaged".to_owned(),
    })?;
    serde_json::from_str(&row).map_err(|error| format!("is not a finished run ({error})"))
}
