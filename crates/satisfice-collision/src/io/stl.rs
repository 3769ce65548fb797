//! STL, ASCII or binary. The format has no vertex numbers: corners with equal coordinates become one vertex.

use super::faces::{Faces, ReadMesh};
use super::format::{Format, Reader};
use super::text::{Lines, Words, quoted, real, without_mark};
use crate::error::Error;
use crate::mesh::{finite, weld};

const NAME: &str = "STL";
const HEADER: usize = 84;
const TRIANGLE: usize = 50;
const NORMAL: usize = 12;

pub(super) const FORMAT: Format = Format {
    name: "stl",
    extensions: &["stl"],
    summary: "Stereolithography, ASCII or binary, in single precision; corners with equal coordinates become one vertex",
    reader: Reader::Mesh(parse),
};

fn parse(bytes: &[u8]) -> Result<ReadMesh, Error> {
    let corners = if is_ascii(bytes) {
        ascii(without_mark(NAME, bytes)?)?
    } else {
        binary(bytes)?
    };
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
    faces.mesh(vertices)
}

/// A file is binary if it has exactly the length that a binary header announces. Otherwise it is ASCII if it begins
/// with "solid" and holds no zero byte; the word alone decides nothing, since binary headers may begin with it, too.
fn is_ascii(bytes: &[u8]) -> bool {
    if announced_length(bytes) == Some(bytes.len() as u64) {
        return false;
    }
    let text = bytes
        .strip_prefix(b"\xef\xbb\xbf")
        .unwrap_or(bytes)
        .trim_ascii_start();
    text.get(..5)
        .is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
        && !bytes.contains(&0)
}

fn announced_count(bytes: &[u8]) -> Option<u32> {
    bytes
        .get(HEADER - 4..)?
        .first_chunk()
        .map(|count| u32::from_le_bytes(*count))
}

fn announced_length(bytes: &[u8]) -> Option<u64> {
    announced_count(bytes).map(|count| HEADER as u64 + TRIANGLE as u64 * u64::from(count))
}

/// The corners of the triangles, three of each.
fn binary(bytes: &[u8]) -> Result<Vec<[f64; 3]>, Error> {
    let length = bytes.len();
    let Some((count, announced)) = announced_count(bytes).zip(announced_length(bytes)) else {
        let reason = format!(
            "{length} bytes are neither ASCII, which begins with \"solid\", nor a whole binary header"
        );
        return Err(Error::malformed(NAME, reason));
    };
    let is_text = bytes[..HEADER].iter().all(|byte| (b'\t'..0x7f).contains(byte));
    if announced != length as u64 && is_text {
        let reason = "it is text, but does not begin with \"solid\" as ASCII STL does".to_owned();
        return Err(Error::malformed(NAME, reason));
    }
    if announced != length as u64 {
        let reason = format!(
            "its binary header announces {count} triangles, which take {announced} bytes, but it has {length}"
        );
        return Err(Error::malformed(NAME, reason));
    }
    let mut corners = Vec::with_capacity(3 * count as usize);
    for triangle in bytes[HEADER..].chunks_exact(TRIANGLE) {
        for corner in triangle[NORMAL..].chunks_exact(12).take(3) {
            let coordinate =
                |k: usize| f32::from_le_bytes([corner[k], corner[k + 1], corner[k + 2], corner[k + 3]]);
            let point = [0, 4, 8].map(|k| f64::from(coordinate(k)));
            corners.push(finite(corners.len(), point)?);
        }
    }
    Ok(corners)
}

/// The statements in the order in which they follow each other within a solid.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Expected {
    Solid,
    FacetOrEnd,
    Loop,
    Vertex(u8),
    EndLoop,
    EndFacet,
}

impl Expected {
    fn name(self) -> &'static str {
        match self {
            Self::Solid => "solid",
            Self::FacetOrEnd => "facet or endsolid",
            Self::Loop => "outer loop",
            Self::Vertex(_) => "vertex",
            Self::EndLoop => "endloop",
            Self::EndFacet => "endfacet",
        }
    }
}

/// The corners of the triangles of all solids of a file, three of each.
fn ascii(text: &[u8]) -> Result<Vec<[f64; 3]>, Error> {
    let mut corners = Vec::new();
    let mut expected = Expected::Solid;
    let mut lines = Lines::after(0, text);
    while let Some(line) = lines.next() {
        let mut words = Words(line);
        if let Some(keyword) = words.next() {
            expected = statement(keyword, words, expected, &mut corners)
                .map_err(|error| error.at_line(lines.number()))?;
        }
    }
    match expected {
        Expected::Solid => Ok(corners),
        _ => Err(Error::malformed(NAME, "the file ends inside a solid").at_line(lines.number())),
    }
}

/// Takes a statement; which one is expected next. Names of solids and normals are not examined.
fn statement(
    keyword: &[u8],
    mut words: Words<'_>,
    expected: Expected,
    corners: &mut Vec<[f64; 3]>,
) -> Result<Expected, Error> {
    let keyword = keyword.to_ascii_lowercase();
    match (expected, keyword.as_slice()) {
        (Expected::Solid, b"solid") => return Ok(Expected::FacetOrEnd),
        (Expected::FacetOrEnd, b"endsolid") => return Ok(Expected::Solid),
        (Expected::FacetOrEnd, b"facet") => return Ok(Expected::Loop),
        (Expected::Loop, b"outer") if words.next().is_some_and(|w| w.eq_ignore_ascii_case(b"loop")) => {
            return ended(words, Expected::Vertex(0));
        }
        (Expected::Vertex(n), b"vertex") => {
            corners.push(corner(&mut words, corners.len())?);
            return ended(
                words,
                if n == 2 {
                    Expected::EndLoop
                } else {
                    Expected::Vertex(n + 1)
                },
            );
        }
        (Expected::EndLoop, b"endloop") => return ended(words, Expected::EndFacet),
        (Expected::EndFacet, b"endfacet") => return ended(words, Expected::FacetOrEnd),
        _ => {}
    }
    let facet = match expected {
        Expected::Solid | Expected::FacetOrEnd => String::new(),
        _ => format!("facet {}: ", corners.len() / 3),
    };
    let (keyword, expected) = (quoted(&keyword), expected.name());
    Err(Error::malformed(
        NAME,
        format!("{facet}{keyword} where {expected} is expected"),
    ))
}

fn ended(mut words: Words<'_>, next: Expected) -> Result<Expected, Error> {
    match words.next() {
        None => Ok(next),
        Some(word) => Err(Error::malformed(
            NAME,
            format!("{} is one word too many", quoted(word)),
        )),
    }
}

fn corner(words: &mut Words<'_>, vertex: usize) -> Result<[f64; 3], Error> {
    let mut point = [0.0; 3];
    for coordinate in &mut point {
        let word = words.next().unwrap_or_default();
        let number: f32 = real(word).ok_or_else(|| {
            Error::malformed(NAME, format!("vertex {vertex} has {} for a number", quoted(word)))
        })?;
        *coordinate = f64::from(number);
    }
    finite(vertex, point)
}
