//! Faces of a file cut into triangles, and the check of their vertex numbers.

use std::path::PathBuf;

use super::ears::{Cut, cut};
use crate::Mesh;
use crate::error::{Element, Error};
use crate::mesh::Point;

/// Faces collected from a file: polygons are cut into triangles, faces of two corners become lines, and those of one corner add
/// nothing to their vertex.
#[derive(Default)]
pub(super) struct Faces {
    pub(super) lines: Vec<[u32; 2]>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Of each polygon of more than three corners the first of its triangles, and how many these are. Until all vertices are known they
    /// are a fan about its first corner, from which its corners can be told.
    polygons: Vec<[usize; 2]>,
}

/// A mesh as it was read.
pub(super) struct ReadMesh {
    pub(super) mesh: Mesh,
    /// How many of its faces stay fans that do not cover them.
    pub(super) uncut: usize,
}

/// Faces of a file that could not be cut into triangles that cover them: those that cross themselves, seen along their normal, and
/// those of very many corners that take too long. Each stays a fan about its first corner, which covers other points than the face.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UncutFaces {
    /// The file; `-` for a stream.
    pub file: PathBuf,
    /// How many there are.
    pub faces: usize,
}

impl Faces {
    pub(super) fn add(&mut self, corners: &[u32]) {
        match *corners {
            [] | [_] => {}
            [a, b] => self.lines.push([a, b]),
            [a, b, c] => self.triangles.push([a, b, c]),
            [a, ref rest @ ..] => {
                self.polygons.push([self.triangles.len(), rest.len() - 1]);
                self.triangles.extend(rest.windows(2).map(|w| [a, w[0], w[1]]));
            }
        }
    }

    /// The mesh of these faces and vertices, polygons cut as [`cut`] does.
    ///
    /// # Errors
    /// Those of [`Mesh::new`].
    pub(super) fn mesh(mut self, vertices: Vec<Point>) -> Result<ReadMesh, Error> {
        let mut corners = Vec::new();
        let mut uncut = 0;
        for [first, count] in self.polygons {
            let fan = &mut self.triangles[first..first + count];
            corners.clear();
            corners.extend_from_slice(&fan[0][..2]);
            corners.extend(fan.iter().map(|triangle| triangle[2]));
            let is_known = corners.iter().all(|&v| (v as usize) < vertices.len());
            if !is_known {
                continue;
            }
            match cut(&corners, &vertices) {
                Cut::Fan => {}
                Cut::Ears(ears) => fan.copy_from_slice(&ears),
                Cut::Nothing => uncut += 1,
            }
        }
        let mesh = Mesh::new(vertices, self.lines, self.triangles)?;
        Ok(ReadMesh { mesh, uncut })
    }
}

/// A vertex number from a file, counted from 0.
///
/// # Errors
/// [`Error::IndexOutOfRange`] unless it is below `vertices`.
pub(super) fn checked_index(
    element: Element,
    index: usize,
    vertex: i64,
    vertices: usize,
) -> Result<u32, Error> {
    u32::try_from(vertex)
        .ok()
        .filter(|&v| (v as usize) < vertices)
        .ok_or(Error::IndexOutOfRange {
            element,
            index,
            vertex,
            vertices,
            first: 0,
        })
}
