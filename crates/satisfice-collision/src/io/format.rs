//! The formats: one line for each.

use std::fmt;
use std::path::Path;

use super::scene::PlacedMesh;
use super::source::Folder;
use super::{gltf, list, obj, off, ply, stl};
use crate::error::Error;
use crate::mesh::Mesh;

/// A file format of meshes or scenes.
///
/// ```
/// use satisfice_collision::io::Format;
/// assert_eq!(Format::of_path("bunny.PLY.gz")?.name(), "ply");
/// assert_eq!(Format::named("obj")?.extensions(), ["obj"]);
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
#[derive(Clone, Copy)]
pub struct Format {
    pub(super) name: &'static str,
    pub(super) extensions: &'static [&'static str],
    pub(super) summary: &'static str,
    pub(super) reader: Reader,
}

/// How the bytes of a file are read.
#[derive(Clone, Copy)]
pub(super) enum Reader {
    /// One body.
    Mesh(fn(&[u8]) -> Result<Mesh, Error>),
    /// Several bodies, which may name further files in the folder.
    Scene(fn(&[u8], &Folder) -> Result<Vec<PlacedMesh>, Error>),
}

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
    /// [`Error::UnknownFormat`], which lists the known extensions.
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
            .ok_or_else(|| Error::UnknownFormat {
                path: path.to_owned(),
                known: known_extensions(),
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

    /// The name, e.g. `obj`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// The extensions of its files, in small letters.
    #[must_use]
    pub fn extensions(&self) -> &'static [&'static str] {
        self.extensions
    }

    /// What is read of it, in a line.
    #[must_use]
    pub fn summary(&self) -> &'static str {
        self.summary
    }

    /// Whether a file may hold several bodies with names and placements.
    #[must_use]
    pub fn is_scene(&self) -> bool {
        matches!(self.reader, Reader::Scene(_))
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

impl PartialEq for Format {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for Format {}

impl fmt::Debug for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Format").field(&self.name).finish()
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}
