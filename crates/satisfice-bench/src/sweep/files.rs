//! Names and contents of the files of a sweep.

use std::path::Path;

use satisfice_catalogue::sealed;

use crate::error::Error;

/// The most that a text takes of a file's name, which file systems limit to 255 bytes.
const LONGEST: usize = 100;

/// A text as part of a file's name. The end of a long one is replaced by its checksum.
pub(super) fn plain(text: &str) -> String {
    let keep = |c: char| {
        if c.is_ascii_alphanumeric() || ".-".contains(c) {
            c
        } else {
            '_'
        }
    };
    let name: String = text.chars().map(keep).collect();
    if name.len() <= LONGEST {
        return name;
    }
    let checksum = format!("-{:016x}", sealed::checksum(text.as_bytes()));
    format!("{}{checksum}", &name[..LONGEST - checksum.len()])
}

/// Makes a folder, and those it is in.
pub(super) fn make_folder(folder: &Path) -> Result<(), Error> {
    let failed = |path: &Path, what: String| Error::File {
        path: path.to_owned(),
        what,
    };
    let is_file = |path: &&Path| path.exists() && !path.is_dir();
    if let Some(file) = folder.ancestors().find(is_file) {
        let what = "it is a file, but results need a folder; choose another one";
        return Err(failed(file, what.to_owned()));
    }
    std::fs::create_dir_all(folder).map_err(|error| {
        failed(
            folder,
            format!("cannot make this folder: {error}; choose another one"),
        )
    })
}

/// Writes a file and the folders it is in.
pub(super) fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    make_folder(path.parent().unwrap_or_else(|| Path::new(".")))?;
    std::fs::write(path, bytes).map_err(|error| Error::File {
        path: path.to_owned(),
        what: format!("cannot write it: {error}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_are_short_and_unlike() {
        assert_eq!(plain("sat file=a/b.cnf"), "sat_file_a_b.cnf");
        let [a, b] = ["1", "2"].map(|end| plain(&("x".repeat(300) + end)));
        assert!(a.len() == LONGEST && b.len() == LONGEST && a != b);
    }
}
