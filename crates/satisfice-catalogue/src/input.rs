//! Reading what a user names: whole files, and streams up to a limit.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Devices and pipes may have no end; more than this is refused rather than filling the memory.
const STREAM_LIMIT: u64 = 1 << 30;

/// The contents of a file. Of what is not a regular file, such as a pipe, at most 1 GiB.
///
/// # Errors
/// What the system says, and [`io::ErrorKind::FileTooLarge`].
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut file = File::open(path)?;
    if !file.metadata()?.is_file() {
        return read_stream(file);
    }
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// As [`read`], a text in UTF-8.
///
/// # Errors
/// As [`read`], and [`io::ErrorKind::InvalidData`].
pub fn read_to_string(path: &Path) -> io::Result<String> {
    String::from_utf8(read(path)?)
        .map_err(|_| io::Error::new(io::ErrorKind::InvalidData, "it is not UTF-8 text"))
}

/// The contents of a stream, at most 1 GiB.
///
/// # Errors
/// As [`read`].
pub fn read_stream(stream: impl Read) -> io::Result<Vec<u8>> {
    limited(stream, STREAM_LIMIT)
}

fn limited(stream: impl Read, limit: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    if stream.take(limit + 1).read_to_end(&mut bytes)? as u64 > limit {
        let reason = format!("more than {limit} bytes from a stream or a device: name a file instead");
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, reason));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_end_at_the_limit() {
        assert_eq!(limited(&[7; 10][..], 10).unwrap(), [7; 10]);
        let error = limited(io::repeat(7), 10).unwrap_err();
        assert!(error.to_string().starts_with("more than 10 bytes"), "{error}");
    }
}
