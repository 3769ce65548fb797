//! The files that a command reads and writes: what it writes takes the place of nothing that it reads.

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::bail;

use crate::output::folder_of;

/// Standard input or output.
const STREAM: &str = "-";

/// The inputs and outputs of one call.
#[derive(Debug, Default)]
pub(crate) struct Places {
    inputs: Vec<PathBuf>,
    /// With the option that names it.
    outputs: Vec<(&'static str, PathBuf)>,
}

impl Places {
    /// Adds files that are read, those included that other files name.
    pub(crate) fn reads(mut self, paths: impl IntoIterator<Item = PathBuf>) -> Self {
        let is_file = |path: &PathBuf| path != Path::new(STREAM);
        self.inputs.extend(paths.into_iter().filter(is_file));
        self
    }

    /// Adds words of which any may be the name of a file, such as those of a program's command.
    pub(crate) fn may_read(self, words: impl IntoIterator<Item = String>) -> Self {
        let paths = words.into_iter().map(PathBuf::from);
        self.reads(paths.filter(|path| path.is_file()))
    }

    /// Adds a place that an option names, if it is given.
    pub(crate) fn writes(mut self, option: &'static str, path: Option<&PathBuf>) -> Self {
        self.outputs.extend(path.map(|path| (option, path.clone())));
        self
    }

    /// Whether something goes to stdout.
    pub(crate) fn takes_stdout(&self) -> bool {
        self.outputs.iter().any(|(_, path)| path == Path::new(STREAM))
    }

    /// Refuses outputs that are the same file, or one of the inputs. To be called before any output is opened.
    ///
    /// # Errors
    /// The option, the file, and what to do.
    pub(crate) fn check(&self) -> anyhow::Result<()> {
        let inputs: Vec<PathBuf> = self.inputs.iter().map(|input| identity(input)).collect();
        let mut known: Vec<(&str, PathBuf)> = Vec::new();
        for (option, path) in &self.outputs {
            let file = identity(path);
            let other = known.iter().find(|(_, known)| *known == file);
            let shown = path.display();
            if path == Path::new(STREAM) {
                if let Some((other, _)) = other {
                    bail!("{other} and {option} both go to stdout: name a file for one of them");
                }
            } else if inputs.contains(&file) && !is_stream(&file) {
                bail!("{option} {shown} would overwrite an input: choose another file");
            } else if let Some((other, _)) = other {
                bail!("{other} and {option} both write {shown}: choose two files");
            }
            known.push((option, file));
        }
        Ok(())
    }
}

/// Whether two paths lead to one file.
pub(crate) fn is_same(a: &Path, b: &Path) -> bool {
    identity(a) == identity(b)
}

/// What tells a file from others: its path without links, in the letters that the file system keeps; for a new file its folder
/// without links, and its name.
fn identity(path: &Path) -> PathBuf {
    if path == Path::new(STREAM) {
        return path.to_owned();
    }
    if let Ok(whole) = fs::canonicalize(path) {
        return whole;
    }
    let folder = fs::canonicalize(folder_of(path)).unwrap_or_default();
    folder.join(path.file_name().unwrap_or(path.as_os_str()))
}

/// Whether it is a device or a pipe, which loses nothing when it is written to.
fn is_stream(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_told_apart_by_where_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("sub")).unwrap();
        fs::write(at("input"), "").unwrap();
        let check = |outputs: &[&str]| {
            let places = Places::default().reads([at("input"), at("missing"), STREAM.into()]);
            let write = |places: Places, name: &&str| places.writes("--to", Some(&at(name)));
            outputs
                .iter()
                .fold(places, write)
                .check()
                .map_err(|error| error.to_string())
        };
        assert_eq!(check(&["a", "b", "sub/a", "sub/input"]), Ok(()));
        for outputs in [&["input"][..], &["a", "sub/../input"], &["./input"]] {
            assert!(
                check(outputs).unwrap_err().contains("would overwrite an input"),
                "{outputs:?}"
            );
        }
        for outputs in [["a", "a"], ["a", "sub/../a"], ["sub/./a", "sub/a"]] {
            assert!(
                check(&outputs).unwrap_err().contains("--to and --to both write"),
                "{outputs:?}"
            );
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("input", at("link")).unwrap();
            std::os::unix::fs::symlink("sub", at("folder")).unwrap();
            assert!(check(&["link"]).is_err() && check(&["folder/a", "sub/a"]).is_err());
            let null = PathBuf::from("/dev/null");
            let places = Places::default()
                .reads([null.clone()])
                .writes("--to", Some(&null));
            assert!(places.check().is_ok(), "nothing is lost there");
        }
    }

    #[test]
    fn one_output_goes_to_stdout() {
        let stdout = PathBuf::from(STREAM);
        let places = Places::default()
            .reads([stdout.clone()])
            .writes("--json", Some(&stdout));
        assert!(places.takes_stdout() && places.check().is_ok());
        let error = places.writes("--page", Some(&stdout)).check().unwrap_err();
        assert_eq!(
            error.to_string(),
            "--json and --page both go to stdout: name a file for one of them"
        );
    }
}
