//! OBJ, by way of `tobj`.
//!
//! `tobj` serves renderers: it drops vertices that no face uses and renumbers the others by first use, object by
//! object, does not know `p`, takes a polyline for a polygon, refuses files in which only some vertices have colours,
//! and names neither line nor element in its errors. So it is handed a plainer file, made line by line as it reads:
//! positions, each followed by a face of that one vertex (which keeps the numbering of the file), and lines and faces
//! with position indices only, checked on the way.

use std::io::{self, BufRead, Read};
use std::str::Lines;

use super::{Faces, checked_index};
use crate::error::{Element, Error};
use crate::mesh::Mesh;

const FORMAT: &str = "OBJ";

pub(super) fn parse(bytes: &[u8]) -> Result<Mesh, Error> {
    let text = String::from_utf8_lossy(bytes);
    let mut plain = Plain::new(text.strip_prefix('\u{feff}').unwrap_or(&text));
    // Neither triangulated (that blows points and lines up into triangles) nor split by texture coordinates.
    let read = tobj::load_obj_buf(&mut plain, &tobj::LoadOptions::default(), |_| {
        Ok(Default::default())
    });
    plain.check()?;
    let (models, _) = read.map_err(|error| Error::malformed(FORMAT, error).at_line(plain.line))?;

    let mut vertices = Vec::with_capacity(plain.vertices);
    let mut faces = Faces::default();
    for tobj::Model { mesh, .. } in models {
        vertices.extend(mesh.positions.chunks_exact(3).map(|p| [p[0], p[1], p[2]]));
        let mut rest = &mesh.indices[..];
        for arity in mesh.face_arities {
            let (corners, others) = rest.split_at(rest.len().min(arity as usize));
            faces.add(corners);
            rest = others;
        }
    }
    Mesh::new(vertices, faces.lines, faces.triangles)
}

/// The plainer file, produced line by line.
struct Plain<'a> {
    source: Lines<'a>,
    /// Number of the last line taken from the source.
    line: usize,
    buffer: Vec<u8>,
    consumed: usize,
    vertices: usize,
    faces: usize,
    edges: usize,
    points: usize,
    /// References to vertices not yet seen: they may still follow.
    forward: Vec<Reference>,
    error: Option<Error>,
}

#[derive(Clone, Copy)]
struct Reference {
    line: usize,
    element: Element,
    index: usize,
    vertex: i64,
}

impl<'a> Plain<'a> {
    fn new(text: &'a str) -> Self {
        Self {
            source: text.lines(),
            line: 0,
            buffer: Vec::new(),
            consumed: 0,
            vertices: 0,
            faces: 0,
            edges: 0,
            points: 0,
            forward: Vec::new(),
            error: None,
        }
    }

    /// The first thing wrong with the indices, once the source has been read.
    fn check(&mut self) -> Result<(), Error> {
        // Where reading stopped early, vertices may only seem to be missing.
        if self.error.is_none() && self.source.clone().next().is_none() {
            for r in &self.forward {
                checked_index(r.element, r.index, r.vertex, self.vertices)
                    .map_err(|error| error.at_line(r.line))?;
            }
        }
        self.error
            .take()
            .map_or(Ok(()), |error| Err(error.at_line(self.line)))
    }

    /// Takes one logical line of the source (a backslash at its end continues it); `false` at the end.
    fn advance(&mut self) -> Result<bool, Error> {
        let Some(first) = self.source.next() else {
            return Ok(false);
        };
        self.line += 1;
        let mut joined;
        let mut logical = first;
        if first.ends_with('\\') {
            joined = String::new();
            let mut part = first;
            while let Some(head) = part.strip_suffix('\\') {
                joined.push_str(head);
                joined.push(' ');
                part = self.source.next().unwrap_or("");
                self.line += 1;
            }
            joined.push_str(part);
            logical = &joined;
        }
        let mut words = logical.split('#').next().unwrap_or("").split_whitespace();
        match words.next() {
            Some("v") => self.vertex(&words.collect::<Vec<_>>()),
            Some("f") => self.element(Element::Face, &words.collect::<Vec<_>>())?,
            Some("l") => self.element(Element::Edge, &words.collect::<Vec<_>>())?,
            Some("p") => self.element(Element::Point, &words.collect::<Vec<_>>())?,
            _ => {}
        }
        Ok(true)
    }

    /// A position with its weight but without colours, and the face that makes `tobj` keep it.
    fn vertex(&mut self, words: &[&str]) {
        let kept = if words.len() >= 6 { 3 } else { words.len() };
        self.emit("v", words[..kept].iter().copied());
        self.emit("f", ["-1"]);
        self.vertices += 1;
    }

    fn element(&mut self, element: Element, words: &[&str]) -> Result<(), Error> {
        if words.is_empty() {
            return Err(Error::malformed(FORMAT, format!("a {element} without vertices")));
        }
        let counter = match element {
            Element::Edge => &mut self.edges,
            Element::Point => &mut self.points,
            _ => &mut self.faces,
        };
        let index = *counter;
        *counter += 1;
        let corners: Vec<String> = words
            .iter()
            .map(|word| self.corner(element, index, word))
            .collect::<Result<_, _>>()?;
        match element {
            // Every vertex is kept anyway.
            Element::Point => {}
            Element::Edge => {
                for pair in corners.windows(2) {
                    self.emit("f", pair.iter().map(String::as_str));
                }
            }
            _ => self.emit("f", corners.iter().map(String::as_str)),
        }
        Ok(())
    }

    /// The position index of a corner `v/vt/vn`, made absolute; counted from 1 in the answer, from 0 in errors.
    fn corner(&mut self, element: Element, index: usize, word: &str) -> Result<String, Error> {
        let position = word.split('/').next().unwrap_or("");
        let given: i64 = position.parse().map_err(|_| {
            Error::malformed(FORMAT, format!("{element} {index} has the vertex index {word:?}"))
        })?;
        let vertices = self.vertices;
        let vertex = if given < 0 {
            given.saturating_add_unsigned(vertices as u64)
        } else {
            given - 1
        };
        match checked_index(element, index, vertex, vertices) {
            Err(error) if vertex < 0 => return Err(error),
            Err(_) => self.forward.push(Reference {
                line: self.line,
                element,
                index,
                vertex,
            }),
            Ok(_) => {}
        }
        Ok((i128::from(vertex) + 1).to_string())
    }

    fn emit<'w>(&mut self, keyword: &str, words: impl IntoIterator<Item = &'w str>) {
        self.buffer.extend_from_slice(keyword.as_bytes());
        for word in words {
            self.buffer.push(b' ');
            self.buffer.extend_from_slice(word.as_bytes());
        }
        self.buffer.push(b'\n');
    }
}

impl Read for Plain<'_> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let count = self.fill_buf()?.read(out)?;
        self.consume(count);
        Ok(count)
    }
}

impl BufRead for Plain<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        while self.consumed == self.buffer.len() && self.error.is_none() {
            self.buffer.clear();
            self.consumed = 0;
            match self.advance() {
                Ok(true) => {}
                Ok(false) => break,
                Err(error) => self.error = Some(error),
            }
        }
        Ok(&self.buffer[self.consumed..])
    }

    fn consume(&mut self, count: usize) {
        self.consumed = (self.consumed + count).min(self.buffer.len());
    }
}
