//! Meshes written as OBJ.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use crate::error::Error;
use crate::mesh::Mesh;

/// Writes a mesh as OBJ. Read back, it is the same to the bit.
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
        let mut out = BufWriter::new(File::create(path)?);
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
