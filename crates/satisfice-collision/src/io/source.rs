//! The bytes of files and streams, decompressed where they are gzip.

use std::cell::RefCell;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use flate2::read::MultiGzDecoder;

use super::faces::UncutFaces;
use crate::error::Error;

/// Streams and compressed files do not say how long they are; more than this is refused rather than filling the memory.
const STREAM_LIMIT: u64 = 1 << 30;
const GZIP_MAGIC: [u8; 3] = [0x1f, 0x8b, 8];

/// Why a folder is not read.
pub(super) fn is_folder() -> io::Error {
    io::Error::other("it is a folder: name the mesh files in it")
}

/// The contents of a file.
pub(super) fn file(path: &Path) -> Result<Vec<u8>, Error> {
    let contents = || {
        if path.is_dir() {
            return Err(is_folder());
        }
        let mut file = File::open(path)?;
        let mut bytes = Vec::new();
        // Only regular files have a known end; devices and pipes may have none.
        if file.metadata()?.is_file() {
            file.read_to_end(&mut bytes)?;
        } else {
            bytes = limited(file, STREAM_LIMIT)?;
        }
        decompressed(bytes)
    };
    contents().map_err(|source| Error::Unreadable {
        path: path.to_owned(),
        source,
    })
}

/// The contents of a stream, e.g. of standard input.
pub(super) fn stream(stream: impl Read) -> Result<Vec<u8>, Error> {
    limited(stream, STREAM_LIMIT)
        .and_then(decompressed)
        .map_err(|source| Error::Unreadable {
            path: "-".into(),
            source,
        })
}

fn decompressed(bytes: Vec<u8>) -> io::Result<Vec<u8>> {
    if bytes.starts_with(&GZIP_MAGIC) {
        limited(MultiGzDecoder::new(&bytes[..]), STREAM_LIMIT)
    } else {
        Ok(bytes)
    }
}

fn limited(stream: impl Read, limit: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    if stream.take(limit + 1).read_to_end(&mut bytes)? as u64 > limit {
        let reason = format!(
            "more than {limit} bytes from a stream or a compressed file; name an uncompressed file instead"
        );
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, reason));
    }
    Ok(bytes)
}

/// The folder that the names inside a file are relative to, which files were read for these names, and what could not be cut.
pub(super) struct Folder {
    path: PathBuf,
    /// The file itself.
    own: PathBuf,
    read: RefCell<Vec<PathBuf>>,
    uncut: RefCell<Vec<UncutFaces>>,
}

impl Folder {
    /// The folder for a stream.
    pub(super) fn new(path: impl Into<PathBuf>) -> Self {
        Self {
            path: path.into(),
            own: "-".into(),
            read: RefCell::default(),
            uncut: RefCell::default(),
        }
    }

    /// The folder of a file.
    pub(super) fn of(path: &Path) -> Self {
        Self {
            own: path.to_owned(),
            ..Self::new(path.parent().map(Path::to_owned).unwrap_or_default())
        }
    }

    pub(super) fn join(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// The contents of the file of this name.
    pub(super) fn file(&self, name: &str) -> Result<Vec<u8>, Error> {
        let path = self.join(name);
        let bytes = file(&path)?;
        self.note([path]);
        Ok(bytes)
    }

    /// Notes files that were read.
    pub(super) fn note(&self, files: impl IntoIterator<Item = PathBuf>) {
        self.read.borrow_mut().extend(files);
    }

    /// Notes so many faces of the file itself that could not be cut.
    pub(super) fn note_own_uncut(&self, faces: usize) {
        if faces > 0 {
            let file = self.own.clone();
            self.note_uncut([UncutFaces { file, faces }]);
        }
    }

    /// Notes faces of further files that could not be cut.
    pub(super) fn note_uncut(&self, faces: impl IntoIterator<Item = UncutFaces>) {
        self.uncut.borrow_mut().extend(faces);
    }

    /// The files that were read, and the faces that could not be cut.
    pub(super) fn into_notes(self) -> (Vec<PathBuf>, Vec<UncutFaces>) {
        (self.read.into_inner(), self.uncut.into_inner())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn streams_end_at_the_limit() {
        assert_eq!(limited(&[7; 10][..], 10).unwrap(), [7; 10]);
        let error = limited(io::repeat(7), 10).unwrap_err();
        assert!(error.to_string().starts_with("more than 10 bytes"), "{error}");
    }
}
