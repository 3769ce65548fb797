//! Where results go: stdout, or files that are whole or not there.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use anyhow::{Context, bail};
use tempfile::NamedTempFile;

/// Writes into the place that it is given.
pub(crate) type Writer<'w> = &'w mut dyn FnMut(&mut dyn Write) -> io::Result<()>;

fn buffered(to: &mut dyn Write, write: Writer<'_>) -> io::Result<()> {
    let mut out = BufWriter::with_capacity(1 << 16, to);
    write(&mut out).and_then(|()| out.flush())
}

/// A reader that closes the pipe early (`| head`) is no error.
fn unless_closed(written: io::Result<()>) -> io::Result<()> {
    match written {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        written => written,
    }
}

/// Writes to stdout. A reader that closes the pipe early (`| head`) is no error.
pub(crate) fn print(bytes: &[u8]) -> anyhow::Result<()> {
    let mut out = io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(error).context("cannot write to stdout")
        }
        _ => Ok(()),
    }
}

/// A place for results. It is opened before the work begins, so that an hour's work is not lost to a typo.
pub(crate) struct Output {
    path: PathBuf,
    to: To,
}

enum To {
    /// `-`
    Stdout,
    /// A device or a pipe: written in place.
    InPlace(File),
    /// A file: written under a temporary name beside its place and moved there when it is whole.
    Beside(Option<NamedTempFile>),
}

/// Temporary files that exist now: a program that gives up removes them.
static PARTIAL: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn partial_files() -> MutexGuard<'static, Vec<PathBuf>> {
    PARTIAL.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes every temporary file. Only for a program that is about to exit.
pub(crate) fn remove_partial_files() {
    for path in partial_files().drain(..) {
        drop(fs::remove_file(path));
    }
}

/// As [`remove_partial_files`], where the list may be in use and memory may have ended.
pub(crate) fn try_remove_partial_files() {
    if let Ok(files) = PARTIAL.try_lock() {
        for path in files.iter() {
            drop(fs::remove_file(path));
        }
    }
}

impl Output {
    /// Opens `path`, or stdout for `-`. A link is written through.
    pub(crate) fn open(path: &Path) -> anyhow::Result<Self> {
        let hint = || format!("cannot write {}: choose another place", path.display());
        if path == Path::new("-") {
            let (path, to) = (path.to_owned(), To::Stdout);
            return Ok(Self { path, to });
        }
        let path = target(path)?;
        let to = match fs::metadata(&path) {
            Ok(found) if found.is_dir() => bail!("{} is a folder: name a file in it", path.display()),
            Ok(found) if found.permissions().readonly() => {
                bail!("{} may not be written to: choose another place", path.display())
            }
            Ok(found) if !found.is_file() => {
                To::InPlace(OpenOptions::new().write(true).open(&path).with_context(hint)?)
            }
            _ => To::Beside(Some(beside(&path).with_context(hint)?)),
        };
        Ok(Self { path, to })
    }

    /// Writes all of `bytes`; before that, the file is as it was.
    pub(crate) fn write(&mut self, bytes: &[u8]) -> anyhow::Result<()> {
        self.write_by(&mut |out| out.write_all(bytes))
    }

    /// Writes what `write` writes, piece by piece; before all of it is there, the file is as it was.
    pub(crate) fn write_by(&mut self, write: Writer<'_>) -> anyhow::Result<()> {
        let written = match &mut self.to {
            To::Stdout => {
                return unless_closed(buffered(&mut io::stdout().lock(), write))
                    .context("cannot write to stdout");
            }
            To::InPlace(file) => unless_closed(buffered(file, write)),
            To::Beside(partial) => match partial.take() {
                Some(file) => replace(file, &self.path, write),
                None => beside(&self.path).and_then(|file| replace(file, &self.path, write)),
            },
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
        if let To::Beside(Some(partial)) = &self.to {
            forget(partial.path());
        }
    }
}

/// The folder of a path; the current one for a plain name.
pub(crate) fn folder_of(path: &Path) -> &Path {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    folder.unwrap_or(Path::new("."))
}

/// A new file of an unpredictable name in the folder of `path`.
fn beside(path: &Path) -> io::Result<NamedTempFile> {
    let mut prefix = OsString::from(".");
    prefix.push(path.file_name().unwrap_or_default());
    prefix.push(".");
    let mut builder = tempfile::Builder::new();
    builder.prefix(&prefix).suffix(".partial");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666)); // less the user's mask
    // The library's error names the temporary file, which means nothing to the user.
    let plain = |error: io::Error| io::Error::from(error.kind());
    let file = builder.tempfile_in(folder_of(path)).map_err(plain)?;
    partial_files().push(file.path().to_owned());
    Ok(file)
}

/// Moves a file with these contents to its place.
fn replace(mut file: NamedTempFile, path: &Path, write: Writer<'_>) -> io::Result<()> {
    let partial = file.path().to_owned();
    // Not by the library's own writer, whose errors name the temporary file.
    let moved = buffered(file.as_file_mut(), write)
        .and_then(|()| file.as_file().sync_data())
        .and_then(|()| file.persist(path).map(drop).map_err(|error| error.error));
    forget(&partial);
    moved
}

fn forget(path: &Path) {
    partial_files().retain(|known| known != path);
}

/// Steps that are all taken, whatever becomes of the others: a full disk for one file loses no other. The first failure is the outcome.
#[derive(Debug, Default)]
pub(crate) struct Steps(Option<anyhow::Error>);

impl Steps {
    pub(crate) fn step(&mut self, taken: anyhow::Result<()>) {
        if let (None, Err(error)) = (&self.0, taken) {
            self.0 = Some(error);
        }
    }

    pub(crate) fn outcome(self) -> anyhow::Result<()> {
        self.0.map_or(Ok(()), Err)
    }
}

/// Where the bytes for `path` go: the end of a link, else the path itself.
fn target(path: &Path) -> anyhow::Result<PathBuf> {
    if path.file_name().is_none() {
        bail!("{} is no name of a file: name one", path.display());
    }
    if !folder_of(path).is_dir() {
        bail!(
            "cannot write {}: its folder does not exist: make it, or choose another place",
            path.display()
        );
    }
    if fs::symlink_metadata(path).is_ok_and(|found| found.is_symlink()) {
        return fs::canonicalize(path).with_context(|| {
            format!(
                "{} is a link that leads nowhere: name another file",
                path.display()
            )
        });
    }
    Ok(path.to_owned())
}

/// Opens the place, if one is named.
pub(crate) fn open(path: Option<&PathBuf>) -> anyhow::Result<Option<Output>> {
    path.map(|path| Output::open(path)).transpose()
}
