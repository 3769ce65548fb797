//! A format of meshes or scenes.

use std::fmt;

use super::animated::{Frames, Play};
use super::faces::ReadMesh;
use super::source::Folder;
use crate::error::Error;

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

/// Reads a scene, whose files are relative to the folder.
type SceneReader = fn(&[u8], &Folder, Play<'_>) -> Result<Box<dyn Frames>, Error>;

/// How the bytes of a file are read.
#[derive(Clone, Copy)]
pub(super) enum Reader {
    /// One body.
    Mesh(fn(&[u8]) -> Result<ReadMesh, Error>),
    /// Several bodies, which may name further files in the folder, and animations.
    Scene(SceneReader),
}

impl Format {
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
