//! STL, by way of `stl_io`.
//!
//! `stl_io` takes whatever begins with "solid " for ascii, also a binary file with such a header; it wants a name after
//! "solid", reads only the first solid of a file, refuses ascii normals that are not finite, and takes 0.0 and -0.0 for
//! different places. So the encoding is decided here, an ascii file is made plain first, and the corners are welded
//! here.

use std::io::Cursor;

use super::Faces;
use crate::error::Error;
use crate::mesh::{Mesh, weld};

const FORMAT: &str = "STL";
const HEADER: usize = 84;
const TRIANGLE: usize = 50;

pub(super) fn parse(bytes: &[u8]) -> Result<Mesh, Error> {
    let plain = if is_ascii(bytes) {
        plain_ascii(bytes)?
    } else {
        plain_binary(bytes)?
    };
    let mut input = Cursor::new(plain);
    let reader = stl_io::create_stl_reader(&mut input).map_err(|error| Error::malformed(FORMAT, error))?;

    let mut corners: Vec<[f64; 3]> = Vec::new();
    for (facet, triangle) in reader.enumerate() {
        let triangle =
            triangle.map_err(|error| Error::malformed(FORMAT, format!("facet {facet}: {error}")))?;
        for vertex in triangle.vertices {
            let corner = vertex.0.map(f64::from);
            if let Some(k) = corner.iter().position(|c| !c.is_finite()) {
                let axis = ['x', 'y', 'z'][k];
                return Err(Error::NonFiniteVertex {
                    vertex: corners.len(),
                    axis,
                    value: corner[k],
                });
            }
            corners.push(corner);
        }
    }
    let (vertices, number) = weld(&corners);
    if u32::try_from(vertices.len()).is_err() {
        return Err(Error::TooManyVertices {
            vertices: vertices.len(),
        });
    }
    let mut faces = Faces::default();
    for corners in number.chunks_exact(3) {
        faces.add(&[corners[0] as u32, corners[1] as u32, corners[2] as u32]);
    }
    Mesh::new(vertices, faces.lines, faces.triangles)
}

/// Binary is what has exactly the length that a binary header announces; of the rest, what begins with "solid" and
/// holds no zero byte is ascii.
fn is_ascii(bytes: &[u8]) -> bool {
    if announced_length(bytes) == Some(bytes.len() as u64) {
        return false;
    }
    let start = bytes.trim_ascii_start();
    start
        .get(..5)
        .is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
        && !bytes.contains(&0)
}

fn announced_length(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(HEADER - 4..HEADER)?;
    let count = u32::from_le_bytes([count[0], count[1], count[2], count[3]]);
    Some(HEADER as u64 + TRIANGLE as u64 * u64::from(count))
}

/// The file with an empty header, so that it can not be taken for ascii.
fn plain_binary(bytes: &[u8]) -> Result<Vec<u8>, Error> {
    let length = bytes.len();
    match announced_length(bytes) {
        None => Err(Error::malformed(
            FORMAT,
            format!("{length} bytes are neither ascii STL, which begins with \"solid\", nor a binary header"),
        )),
        Some(announced) if announced > length as u64 => Err(Error::malformed(
            FORMAT,
            format!("a binary file that announces {announced} bytes has {length}"),
        )),
        Some(_) => {
            let mut plain = bytes.to_vec();
            plain[..HEADER - 4].fill(0);
            Ok(plain)
        }
    }
}

/// The facets of all solids of a file as one solid, in small letters, with normals of zero.
fn plain_ascii(bytes: &[u8]) -> Result<Vec<u8>, Error> {
    let text = String::from_utf8_lossy(bytes).to_ascii_lowercase();
    let mut plain = String::from("solid \n");
    let mut inside = false;
    let mut corners = 0_usize;
    for (k, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        match words.next() {
            None => {}
            Some("solid") => inside = true,
            Some("endsolid") => inside = false,
            Some(_) if !inside => {
                let error = Error::malformed(FORMAT, format!("{:?} outside of a solid", line.trim()));
                return Err(error.at_line(k + 1));
            }
            Some("facet") => plain.push_str("facet normal 0 0 0\n"),
            Some("vertex") => {
                check_corner(words, corners).map_err(|error| error.at_line(k + 1))?;
                corners += 1;
                plain.push_str(line);
                plain.push('\n');
            }
            Some(_) => {
                plain.push_str(line);
                plain.push('\n');
            }
        }
    }
    if inside {
        return Err(Error::malformed(FORMAT, "the file ends inside a solid"));
    }
    plain.push_str("endsolid\n");
    Ok(plain.into_bytes())
}

/// `stl_io` refuses coordinates that are not finite without naming the vertex; this names it. What is no number is left
/// to `stl_io`.
fn check_corner<'a>(words: impl Iterator<Item = &'a str>, vertex: usize) -> Result<(), Error> {
    for (axis, word) in ['x', 'y', 'z'].into_iter().zip(words) {
        match word.parse::<f32>() {
            Ok(value) if !value.is_finite() => {
                return Err(Error::NonFiniteVertex {
                    vertex,
                    axis,
                    value: f64::from(value),
                });
            }
            _ => {}
        }
    }
    Ok(())
}
