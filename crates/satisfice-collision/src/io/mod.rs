//! Mesh files: OBJ, PLY and STL are read, OBJ is written; all in `f64`.

mod obj;
mod ply;
mod stl;

use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use crate::error::{Element, Error};
use crate::mesh::Mesh;

/// A mesh format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// Wavefront OBJ: vertices `v`, points `p`, lines `l` and faces `f`; all else is passed over. Polygons are cut into
    /// fans about their first corner, so concave ones may overlap themselves.
    Obj,
    /// The Stanford polygon format, ascii or binary in either byte order: elements `vertex`, `face` and `edge`.
    Ply,
    /// Stereolithography, ascii or binary. Coordinates are `f32` by format; vertices with equal coordinates are one.
    Stl,
}

impl Format {
    /// The formats.
    pub const ALL: [Self; 3] = [Self::Obj, Self::Ply, Self::Stl];

    /// The format that the extension of `path` names, in letters of either case.
    ///
    /// # Errors
    /// [`Error::UnknownFormat`], which lists the known extensions.
    pub fn of_path(path: impl AsRef<Path>) -> Result<Self, Error> {
        let path = path.as_ref();
        let extension = path
            .extension()
            .and_then(|e| e.to_str())
            .map(str::to_ascii_lowercase);
        match extension.as_deref() {
            Some("obj") => Ok(Self::Obj),
            Some("ply") => Ok(Self::Ply),
            Some("stl") => Ok(Self::Stl),
            _ => Err(Error::UnknownFormat {
                path: path.to_owned(),
                known: "obj, ply, stl",
            }),
        }
    }
}

/// Reads a mesh; its format goes by the extension of the file.
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
    let bytes = fs::read(path).map_err(|source| Error::Unreadable {
        path: path.to_owned(),
        source,
    })?;
    parse(format, &bytes).map_err(|source| Error::InFile {
        path: path.to_owned(),
        source: Box::new(source),
    })
}

/// Reads a mesh from the contents of a file.
///
/// # Errors
/// [`Error::Malformed`] for what does not follow the format, and the errors of [`Mesh::new`]; both may stand inside an
/// [`Error::AtLine`]. Never panics, whatever the bytes.
///
/// ```
/// use satisfice_collision::io::{Format, parse};
/// let square = parse(Format::Obj, b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4")?;
/// assert_eq!(square.triangles(), [[0, 1, 2], [0, 2, 3]]);
/// let error = parse(Format::Obj, b"v 0 0 0\nv 1 nan 0").unwrap_err();
/// assert_eq!(error.to_string(), "vertex 1 has y = NaN; coordinates must be finite");
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
pub fn parse(format: Format, bytes: &[u8]) -> Result<Mesh, Error> {
    match format {
        Format::Obj => obj::parse(bytes),
        Format::Ply => ply::parse(bytes),
        Format::Stl => stl::parse(bytes),
    }
}

/// Writes a mesh as OBJ; read back it is the same to the bit.
///
/// # Errors
/// What `out` reports.
pub fn write_obj(mesh: &Mesh, out: &mut impl Write) -> io::Result<()> {
    for [x, y, z] in mesh.vertices() {
        // `{:?}` is the shortest text that reads back as the same number.
        writeln!(out, "v {x:?} {y:?} {z:?}")?;
    }
    for [a, b] in mesh.lines().iter().map(one_based) {
        writeln!(out, "l {a} {b}")?;
    }
    for [a, b, c] in mesh.triangles().iter().map(one_based) {
        writeln!(out, "f {a} {b} {c}")?;
    }
    Ok(())
}

/// Writes a mesh into an OBJ file.
///
/// # Errors
/// [`Error::Unwritable`].
pub fn save_obj(mesh: &Mesh, path: impl AsRef<Path>) -> Result<(), Error> {
    let path = path.as_ref();
    let save = || {
        let mut out = BufWriter::new(fs::File::create(path)?);
        write_obj(mesh, &mut out)?;
        out.flush()
    };
    save().map_err(|source| Error::Unwritable {
        path: path.to_owned(),
        source,
    })
}

fn one_based<const N: usize>(corners: &[u32; N]) -> [u64; N] {
    corners.map(|v| u64::from(v) + 1)
}

/// Faces being collected: polygons become fans, faces of two corners lines, those of one nothing more than their
/// vertex.
#[derive(Default)]
struct Faces {
    lines: Vec<[u32; 2]>,
    triangles: Vec<[u32; 3]>,
}

impl Faces {
    fn add(&mut self, corners: &[u32]) {
        match *corners {
            [] | [_] => {}
            [a, b] => self.lines.push([a, b]),
            [a, ref rest @ ..] => self.triangles.extend(rest.windows(2).map(|w| [a, w[0], w[1]])),
        }
    }
}

/// A vertex number from a file, counted from 0, if there are that many.
fn checked_index(element: Element, index: usize, vertex: i64, vertices: usize) -> Result<u32, Error> {
    u32::try_from(vertex)
        .ok()
        .filter(|&v| (v as usize) < vertices)
        .ok_or(Error::IndexOutOfRange {
            element,
            index,
            vertex,
            vertices,
        })
}

#[cfg(test)]
mod tests;
