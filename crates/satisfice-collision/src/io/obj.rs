//! OBJ: vertices `v`, points `p`, lines `l` and faces `f`.
//!
//! The reader is our own, since the kept ones serve renderers: `tobj` drops vertices without a face, renumbers the
//! others and names no line in its errors.

use super::faces::{Faces, ReadMesh, checked_index};
use super::format::{Format, Reader};
use super::text::{Lines, Words, as_written, quoted, real, whole, without_comment, without_mark};
use crate::error::{Element, Error};
use crate::mesh::finite;

const NAME: &str = "OBJ";

pub(super) const FORMAT: Format = Format {
    name: "obj",
    extensions: &["obj"],
    summary: "Wavefront OBJ: vertices, points, lines and faces; polygons are cut into triangles, and faces of two corners are lines",
    reader: Reader::Mesh(parse),
};

fn parse(bytes: &[u8]) -> Result<ReadMesh, Error> {
    let mut file = Contents::default();
    let mut lines = Lines::after(0, without_mark(NAME, bytes)?);
    let mut joined = Vec::new();
    while let Some(first) = lines.next() {
        let line = continued(first, &mut lines, &mut joined);
        file.statement(without_comment(line), lines.number())
            .map_err(|error| error.at_line(lines.number()))?;
    }
    file.mesh()
}

/// A logical line: a backslash at the end of a line continues it.
fn continued<'j, 't: 'j>(first: &'t [u8], lines: &mut Lines<'t>, joined: &'j mut Vec<u8>) -> &'j [u8] {
    let Some(mut head) = first.strip_suffix(b"\\") else {
        return first;
    };
    joined.clear();
    loop {
        joined.extend_from_slice(head);
        joined.push(b' ');
        let next = lines.next().unwrap_or_default();
        match next.strip_suffix(b"\\") {
            Some(more) => head = more,
            None => {
                joined.extend_from_slice(next);
                return joined;
            }
        }
    }
}

#[derive(Default)]
struct Contents {
    vertices: Vec<[f64; 3]>,
    faces: Faces,
    /// How many faces, lines and points there are so far.
    counts: [usize; 3],
    corners: Vec<u32>,
    /// References to vertices that had not been seen yet, each to a higher one than those before. A reference that is
    /// not the highest so far cannot be the first one out of range.
    forward: Vec<Reference>,
}

struct Reference {
    line: usize,
    element: Element,
    index: usize,
    vertex: i64,
}

impl Contents {
    fn statement(&mut self, line: &[u8], number: usize) -> Result<(), Error> {
        let mut words = Words(line);
        match words.next() {
            None => Ok(()),
            Some(b"v") => self.vertex(words),
            Some(b"f" | b"fo") => self.element(Element::Face, words, number),
            Some(b"l") => self.element(Element::Edge, words, number),
            Some(b"p") => self.element(Element::Point, words, number),
            Some(keyword) => passed_over(keyword),
        }
    }

    fn vertex(&mut self, words: Words<'_>) -> Result<(), Error> {
        let mut numbers = [0.0; 7];
        let mut count = 0;
        for word in words.clone() {
            let number = real(word).ok_or_else(|| {
                Error::malformed(NAME, format!("a vertex has {} for a number", quoted(word)))
            })?;
            if let Some(slot) = numbers.get_mut(count) {
                *slot = number;
            }
            count += 1;
        }
        let [x, y, z, w, ..] = numbers;
        let point = match count {
            3 | 6 | 7 => [x, y, z],
            4 if w == 0.0 => return Err(Error::malformed(NAME, "a vertex has the weight 0")),
            4 => [x / w, y / w, z / w],
            _ => {
                let reason = format!(
                    "a vertex of {count} numbers: 3 are a position, a 4th is its weight, 6 or 7 end with a colour"
                );
                return Err(Error::malformed(NAME, reason));
            }
        };
        let point = finite(self.vertices.len(), point).map_err(|error| as_written(NAME, error, words))?;
        self.vertices.push(point);
        Ok(())
    }

    fn element(&mut self, element: Element, words: Words<'_>, line: usize) -> Result<(), Error> {
        let (counter, least) = match element {
            Element::Edge => (1, 2),
            Element::Point => (2, 1),
            _ => (0, 1),
        };
        let index = self.counts[counter];
        self.counts[counter] += 1;
        self.corners.clear();
        for word in words {
            let corner = self.corner(element, index, word, line)?;
            self.corners.push(corner);
        }
        if self.corners.len() < least {
            let vertices = if least == 1 {
                "without vertices"
            } else {
                "of fewer than two vertices"
            };
            return Err(Error::malformed(
                NAME,
                format!("{element} {index} is one {vertices}"),
            ));
        }
        match element {
            // Points add nothing to their vertices.
            Element::Point => {}
            Element::Edge => self
                .faces
                .lines
                .extend(self.corners.windows(2).map(|w| [w[0], w[1]])),
            _ => self.faces.add(&self.corners),
        }
        Ok(())
    }

    /// The vertex of a corner `v`, `v/vt`, `v//vn` or `v/vt/vn`, counted from 0. It may follow later in the file.
    fn corner(&mut self, element: Element, index: usize, word: &[u8], line: usize) -> Result<u32, Error> {
        let refuse = || {
            let word = quoted(word);
            Error::malformed(
                NAME,
                format!("{element} {index} has {word} where a vertex number belongs"),
            )
        };
        let position = word.iter().position(|b| *b == b'/').unwrap_or(word.len());
        let given = whole(&word[..position]).ok_or_else(refuse)?;
        let others = word[position..].split(|b| *b == b'/').skip(1);
        if others.clone().count() > 2 || others.into_iter().any(|w| !w.is_empty() && whole(w).is_none()) {
            return Err(refuse());
        }
        if given == 0 {
            let reason = format!("{element} {index} names vertex 0: OBJ counts vertices from 1");
            return Err(Error::malformed(NAME, reason));
        }
        let vertices = self.vertices.len();
        let vertex = if given < 0 {
            let vertex = given.saturating_add_unsigned(vertices as u64);
            if vertex < 0 {
                let before = match vertices {
                    1 => "1 vertex stands".to_owned(),
                    many => format!("{many} vertices stand"),
                };
                let reason = format!(
                    "{element} {index} names vertex {given}, counted backwards, but only {before} before it"
                );
                return Err(Error::malformed(NAME, reason));
            }
            vertex
        } else {
            given - 1
        };
        if vertex < vertices as i64 || vertex > i64::from(u32::MAX) {
            return checked_index(element, index, vertex, vertices).map_err(counted_from_1);
        }
        if self.forward.last().is_none_or(|last| last.vertex < vertex) {
            self.forward.push(Reference {
                line,
                element,
                index,
                vertex,
            });
        }
        Ok(vertex as u32)
    }

    fn mesh(self) -> Result<ReadMesh, Error> {
        for r in &self.forward {
            checked_index(r.element, r.index, r.vertex, self.vertices.len())
                .map_err(|error| counted_from_1(error).at_line(r.line))?;
        }
        self.faces.mesh(self.vertices)
    }
}

/// The error of a vertex number, in numbers that the user finds in the file.
fn counted_from_1(mut error: Error) -> Error {
    if let Error::IndexOutOfRange { first, .. } = &mut error {
        *first = 1;
    }
    error
}

/// What says nothing about positions is passed over; geometry of other kinds is refused, not lost.
fn passed_over(keyword: &[u8]) -> Result<(), Error> {
    match keyword {
        b"vt" | b"vn" | b"vp" | b"g" | b"o" | b"s" | b"mg" | b"usemtl" | b"mtllib" | b"usemap"
        | b"maplib" | b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"shadow_obj" | b"trace_obj"
        | b"ctech" | b"stech" => Ok(()),
        b"curv" | b"curv2" | b"surf" | b"cstype" | b"deg" | b"bmat" | b"step" | b"parm" | b"trim"
        | b"hole" | b"scrv" | b"sp" | b"end" | b"con" | b"bzp" | b"bsp" | b"cdc" | b"cdp" | b"res" => {
            Err(Error::unsupported(
                NAME,
                "free-form curves and surfaces are not supported; export the object as polygons",
            ))
        }
        _ => Err(Error::malformed(
            NAME,
            format!("unknown keyword {}", quoted(keyword)),
        )),
    }
}
