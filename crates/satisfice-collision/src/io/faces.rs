//! Faces of a file cut into triangles, and the check of their vertex numbers.

use crate::error::{Element, Error};

/// Faces collected from a file: polygons become fans about their first corner, faces of two corners become lines, and
/// those of one corner add nothing to their vertex.
#[derive(Default)]
pub(super) struct Faces {
    pub(super) lines: Vec<[u32; 2]>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Faces {
    pub(super) fn add(&mut self, corners: &[u32]) {
        match *corners {
            [] | [_] => {}
            [a, b] => self.lines.push([a, b]),
            [a, b, c] => self.triangles.push([a, b, c]),
            [a, ref rest @ ..] => self.triangles.extend(rest.windows(2).map(|w| [a, w[0], w[1]])),
        }
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
        })
}
