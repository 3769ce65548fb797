//! The registry of formats: one line for each.

use std::path::Path;

use super::format::Format;
use super::source::is_folder;
use super::{gltf, list, obj, off, ply, stl};
use crate::error::Error;

impl Format {
    /// All formats.
    pub const ALL: [Self; 7] = [
        obj::FORMAT,
        ply::FORMAT,
        stl::FORMAT,
        off::FORMAT,
        gltf::FORMAT,
        list::JSON,
        list::TOML,
    ];

    /// The format that the extension of `path` names, in letters of either case. An extension `.gz` is skipped.
    ///
    /// # Errors
    /// [`Error::UnknownFormat`], which lists the known extensions; [`Error::Unreadable`] for a folder without one.
    pub fn of_path(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        let is_gz = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gz"));
        let name = if is_gz {
            path.file_stem().map(Path::new)
        } else {
            Some(path)
        };
        let extension = name
            .and_then(Path::extension)
            .and_then(|e| e.to_str())
            .map(str::to_ascii_lowercase);
        extension
            .and_then(|e| {
                Self::ALL
                    .into_iter()
                    .find(|format| format.extensions.contains(&e.as_str()))
            })
            .ok_or_else(|| match path.is_dir() {
                true => Error::Unreadable {
                    path: path.to_owned(),
                    source: is_folder(),
                },
                false => Error::UnknownFormat {
                    path: path.to_owned(),
                    known: known_extensions(),
                },
            })
    }

    /// The format of this [name](Self::name) or extension.
    ///
    /// # Errors
    /// [`Error::UnknownFormat`], which lists the known extensions.
    pub fn named(name: &str) -> Result<Self, Error> {
        Self::ALL
            .into_iter()
            .find(|format| format.name == name || format.extensions.contains(&name))
            .ok_or_else(|| Error::UnknownFormat {
                path: name.into(),
                known: known_extensions(),
            })
    }
}

fn known_extensions() -> String {
    let all: Vec<&str> = Format::ALL
        .iter()
        .flat_map(|format| format.extensions)
        .copied()
        .collect();
    format!("{}, each also with .gz", all.join(", "))
}
