//! Where results go: stdout, or files that are complete or absent.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

/// Writes to stdout. A reader that stops early (`| head`) is not an error.
pub(crate) fn print(bytes: &[u8]) -> anyhow::Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(error).context("cannot write to stdout")
        }
        _ => Ok(()),
    }
}

/// A destination for results, opened before the work begins, so that a typo does not cost the work.
pub(crate) struct Output {
    path: PathBuf,
    to: To,
}

enum To {
    /// `-`
    Stdout,
    /// A device or a pipe: written in place.
    InPlace(File),
    /// A file: written beside its destination, and moved there when it is complete.
    Beside(PathBuf, File),
}

impl Output {
    /// Opens `path`, or stdout for `-`.
    pub(crate) fn open(path: &Path) -> anyhow::Result<Self> {
        let hint = || format!("cannot write {}: choose another place", path.display());
        let to = if path == Path::new("-") {
            To::Stdout
        } else {
            match fs::metadata(path) {
                Ok(found) if found.is_dir() => bail!("{} is a folder: name a file in it", path.display()),
                Ok(found) if found.permissions().readonly() => {
                    bail!("{} may not be written to: choose another place", path.display())
                }
                Ok(found) if !found.is_file() => {
                    To::InPlace(OpenOptions::new().write(true).open(path).with_context(hint)?)
                }
                _ => {
                    let Some(name) = path.file_name() else {
                        bail!("{} is not a file name: name a file", path.display())
                    };
                    let mut partial = std::ffi::OsString::from(".");
                    partial.push(name);
                    partial.push(format!(".{}.partial", std::process::id()));
                    let partial = path.with_file_name(partial);
                    let file = File::create(&partial).with_context(hint)?;
                    To::Beside(partial, file)
                }
            }
        };
        Ok(Self {
            path: path.to_owned(),
            to,
        })
    }

    /// Writes all of `bytes`; before that, the file is as it was.
    pub(crate) fn write(&mut self, bytes: &[u8]) -> anyhow::Result<()> {
        let written = match &mut self.to {
            To::Stdout => return print(bytes),
            To::InPlace(file) => match file.write_all(bytes) {
                Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
                written => written,
            },
            To::Beside(partial, file) => file
                .write_all(bytes)
                .and_then(|()| file.sync_data())
                .and_then(|()| fs::rename(partial, &self.path)),
        };
        written.with_context(|| {
            format!(
                "cannot write {}: free some space or choose another place",
                self.path.display()
            )
        })
    }
}

impl Drop for Output {
    fn drop(&mut self) {
        if let To::Beside(partial, _) = &self.to {
            // It no longer exists where all went well.
            drop(fs::remove_file(partial));
        }
    }
}

/// Opens the destination, where one is given.
pub(crate) fn open(path: Option<&PathBuf>) -> anyhow::Result<Option<Output>> {
    path.map(|path| Output::open(path)).transpose()
}
