//! Files of meshes and scenes. A file is read whole or refused with the reason and, in text, the line.
//!
//! [`read`] takes one body, [`read_scene`] all of a scene with names and placements, [`AnimatedScene`] plays animations;
//! [`Format::ALL`] lists the formats.
//! Files may be compressed by gzip. Coordinates are `f64`. A new format is a file here and a line in `registry.rs`.
//!
//! Faces of more than three corners become triangles: a fan about the first corner where this covers the polygon, as for every convex one, or else
//! triangles that do, seen along the normal of the face. A face that crosses itself, or has so many corners that this takes too long, stays a
//! fan; [`AnimatedScene::uncut_faces`] counts them.

mod animated;
mod ears;
mod faces;
mod format;
mod gltf;
mod hollows;
mod list;
mod obj;
mod off;
mod ply;
mod registry;
mod scene;
mod source;
mod stl;
mod text;
mod transform;
mod write;

use std::io::Read;
use std::path::Path;
use std::sync::Arc;

pub use animated::AnimatedScene;
pub use faces::UncutFaces;
pub use format::Format;
pub use scene::PlacedMesh;
pub use write::{save_obj, write_obj};

use crate::error::Error;
use crate::mesh::Mesh;
use crate::placement::Placement;
use animated::{Frames, Play};
use format::Reader;
use source::Folder;

/// Reads a mesh. The extension of the file names its format; a scene must consist of one body, which is put in its place.
///
/// # Errors
/// [`Error::UnknownFormat`], [`Error::Unreadable`], or [`Error::InFile`] around what [`parse`] reports.
///
/// ```no_run
/// let bunny = satisfice_collision::io::read("bunny.obj")?;
/// println!("{} triangles", bunny.triangles().len());
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
pub fn read(path: impl AsRef<Path>) -> Result<Mesh, Error> {
    let path = path.as_ref();
    let format = Format::of_path(path)?;
    let bytes = source::file(path)?;
    mesh(format, &bytes, Folder::of(path)).map_err(|error| error.in_file(path))
}

/// Reads the bodies of a scene. The extension of the file names its format; a file of one mesh is a scene of one body,
/// which is called like the file.
///
/// # Errors
/// As [`read`]; [`Error::InBody`] says which body is wrong.
///
/// ```no_run
/// for body in satisfice_collision::io::read_scene("factory.glb")? {
///     println!("{}: {} triangles", body.name, body.mesh.triangles().len());
/// }
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
pub fn read_scene(path: impl AsRef<Path>) -> Result<Vec<PlacedMesh>, Error> {
    let path = path.as_ref();
    let scene = AnimatedScene::read_resting(path)?;
    scene.at_rest().map_err(|error| error.in_file(path))
}

/// Reads the bodies of a scene from a stream, e.g. from standard input. Names of further files inside are relative to
/// `folder`; a single mesh is called `name`.
///
/// # Errors
/// [`Error::Unreadable`], also for a stream of more than 1 GiB, and the errors of [`parse`].
///
/// ```
/// use satisfice_collision::io::{Format, read_scene_from};
/// let bodies = read_scene_from(&b"v 0 0 0"[..], Format::named("obj")?, "stdin", ".")?;
/// assert_eq!((bodies.len(), bodies[0].name.as_str()), (1, "stdin"));
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
pub fn read_scene_from(
    stream: impl Read,
    format: Format,
    name: &str,
    folder: impl AsRef<Path>,
) -> Result<Vec<PlacedMesh>, Error> {
    let scene = AnimatedScene::read_resting_from(stream, format, name, folder)?;
    scene.at_rest().map_err(|error| error.in_file("-".as_ref()))
}

/// Reads a mesh from the contents of a file. Scenes that name further files look for them in the working directory.
///
/// # Errors
/// [`Error::Malformed`] for bytes that do not follow the format, [`Error::Unsupported`] for parts of a format that are
/// not read, and the errors of [`Mesh::new`]; all may be inside an [`Error::AtLine`]. Never panics, whatever the bytes.
///
/// ```
/// use satisfice_collision::io::{Format, parse};
/// let obj = Format::named("obj")?;
/// let square = parse(obj, b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4")?;
/// assert_eq!(square.triangles(), [[0, 1, 2], [0, 2, 3]]);
/// let error = parse(obj, b"v 0 0 0\nv 1 nan 0").unwrap_err();
/// assert_eq!(error.to_string(), "line 2: vertex 1 has y = NaN; coordinates must be finite");
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
pub fn parse(format: Format, bytes: &[u8]) -> Result<Mesh, Error> {
    mesh(format, bytes, Folder::new("."))
}

fn mesh(format: Format, bytes: &[u8], folder: Folder) -> Result<Mesh, Error> {
    if let Reader::Mesh(parse) = format.reader {
        return parse(bytes).map(|read| read.mesh);
    }
    let scene = AnimatedScene::of(format, bytes, folder, "", Play::Nothing)?;
    match scene.at_rest()?.as_slice() {
        [body] => body.placed().map(Arc::unwrap_or_clone),
        bodies => {
            let what = format!("the scene has {} bodies, but one mesh is asked for", bodies.len());
            Err(Error::unsupported(format.name(), what))
        }
    }
}

fn frames(
    format: Format,
    bytes: &[u8],
    folder: &Folder,
    name: &str,
    play: Play<'_>,
) -> Result<Box<dyn Frames>, Error> {
    match format.reader {
        Reader::Mesh(parse) => {
            let read = parse(bytes)?;
            folder.note_own_uncut(read.uncut);
            Ok(Box::new(PlacedMesh {
                name: name.to_owned(),
                mesh: Arc::new(read.mesh),
                placement: Placement::IDENTITY,
            }))
        }
        Reader::Scene(parse) => parse(bytes, folder, play),
    }
}

#[cfg(test)]
mod tests;
