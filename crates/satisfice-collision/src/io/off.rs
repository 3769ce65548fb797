//! OFF: a line of counts, then a line for each vertex and each face.

use super::faces::{Faces, ReadMesh, checked_index};
use super::format::{Format, Reader};
use super::text::{Lines, Words, as_written, quoted, real, whole, without_comment, without_mark};
use crate::error::{Element, Error};
use crate::mesh::finite;

const NAME: &str = "OFF";

pub(super) const FORMAT: Format = Format {
    name: "off",
    extensions: &["off"],
    summary: "Object file format, ASCII: vertices and faces; polygons are cut into triangles, and normals, texture coordinates and colours are passed over",
    reader: Reader::Mesh(parse),
};

fn malformed(reason: impl std::fmt::Display) -> Error {
    Error::malformed(NAME, reason)
}

fn parse(bytes: &[u8]) -> Result<ReadMesh, Error> {
    let mut file = File {
        lines: Lines::after(0, without_mark(NAME, bytes)?),
        vertices: Vec::new(),
        faces: Faces::default(),
    };
    match file.read() {
        Ok(()) => file.faces.mesh(file.vertices),
        Err(error) => Err(error.at_line(file.lines.number().max(1))),
    }
}

struct File<'a> {
    lines: Lines<'a>,
    vertices: Vec<[f64; 3]>,
    faces: Faces,
}

impl<'a> File<'a> {
    /// The next line that is neither blank nor a comment.
    fn line(&mut self) -> Option<Words<'a>> {
        self.lines
            .by_ref()
            .map(|line| without_comment(line).trim_ascii())
            .find(|line| !line.is_empty())
            .map(Words)
    }

    fn read(&mut self) -> Result<(), Error> {
        let [vertices, faces] = self.counts()?;
        for vertex in 0..vertices {
            let words = self.expect("vertex", vertex, vertices)?;
            self.vertices.push(position(words, vertex)?);
        }
        for face in 0..faces {
            let words = self.expect("face", face, faces)?;
            self.face(words, face)?;
        }
        match self.line() {
            None => Ok(()),
            Some(_) => Err(malformed("a line follows the last face that the counts announce")),
        }
    }

    fn expect(&mut self, what: &str, index: usize, count: usize) -> Result<Words<'a>, Error> {
        self.line()
            .ok_or_else(|| malformed(format!("it ends before {what} {index} of {count}")))
    }

    /// The numbers of vertices and faces. They follow the keyword `OFF`, also on its line, which may lack.
    fn counts(&mut self) -> Result<[usize; 2], Error> {
        let empty = || malformed("it has no line of counts");
        let first = self.line().ok_or_else(empty)?;
        let digits = first
            .0
            .iter()
            .position(u8::is_ascii_digit)
            .unwrap_or(first.0.len());
        let (keyword, counts) = first.0.split_at(digits);
        check_keyword(first.0, keyword.trim_ascii())?;
        let words = if counts.is_empty() {
            self.line().ok_or_else(empty)?
        } else {
            Words(counts)
        };
        let numbers: Option<Vec<usize>> = words
            .clone()
            .map(|word| whole(word).and_then(|n| usize::try_from(n).ok()))
            .collect();
        // The number of edges, which comes third, is often left out or wrong.
        match numbers.as_deref() {
            Some([vertices, faces] | [vertices, faces, _]) => Ok([*vertices, *faces]),
            _ => Err(malformed(format!(
                "{} where the numbers of vertices, faces and edges belong",
                quoted(words.0.trim_ascii())
            ))),
        }
    }

    fn face(&mut self, mut words: Words<'a>, face: usize) -> Result<(), Error> {
        let word = words.next().unwrap_or_default();
        let count = whole(word).filter(|count| *count >= 0).ok_or_else(|| {
            malformed(format!(
                "face {face} has {} for its number of corners",
                quoted(word)
            ))
        })?;
        let mut corners = Vec::new();
        for _ in 0..count {
            let word = words.next().unwrap_or_default();
            let vertex = whole(word).ok_or_else(|| {
                malformed(format!(
                    "face {face} has {} where a vertex number belongs",
                    quoted(word)
                ))
            })?;
            corners.push(checked_index(Element::Face, face, vertex, self.vertices.len())?);
        }
        // A colour: an index into a table, or 3 or 4 components.
        let colour = words.clone().count();
        if colour > 4 || words.any(|word| real::<f64>(word).is_none()) {
            return Err(malformed(format!(
                "face {face} has more words than {count} corners and a colour"
            )));
        }
        self.faces.add(&corners);
        Ok(())
    }
}

/// The keyword may announce texture coordinates, colours and normals, as in `STCNOFF`.
fn check_keyword(line: &[u8], keyword: &[u8]) -> Result<(), Error> {
    if Words(line).nth(1) == Some(b"BINARY") {
        return Err(Error::unsupported(
            NAME,
            "the binary variant is not supported; save the mesh as ASCII",
        ));
    }
    match keyword {
        b"" if !line.ends_with(b"OFF") => Ok(()),
        b"OFF" | b"COFF" | b"NOFF" | b"CNOFF" | b"STOFF" | b"STCOFF" | b"STNOFF" | b"STCNOFF" => Ok(()),
        _ if keyword.ends_with(b"OFF") || line.ends_with(b"OFF") => Err(Error::unsupported(
            NAME,
            "only coordinates of three dimensions are supported",
        )),
        _ => Err(malformed(format!("{} where OFF belongs", quoted(keyword)))),
    }
}

/// The position of a vertex. Up to nine numbers may follow: a normal, a colour and texture coordinates.
fn position(words: Words<'_>, vertex: usize) -> Result<[f64; 3], Error> {
    let mut point = [0.0; 3];
    let mut count = 0;
    for word in words.clone() {
        let number: f64 = real(word)
            .ok_or_else(|| malformed(format!("vertex {vertex} has {} for a number", quoted(word))))?;
        if let Some(coordinate) = point.get_mut(count) {
            *coordinate = number;
        }
        count += 1;
    }
    if !(3..=12).contains(&count) {
        return Err(malformed(format!("vertex {vertex} has {count} numbers")));
    }
    finite(vertex, point).map_err(|error| as_written(NAME, error, words))
}
