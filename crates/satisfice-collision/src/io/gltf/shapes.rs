//! The meshes of a glTF document.

use super::buffers::Buffers;
use super::document;
use super::malformed;
use crate::error::{Element, Error};
use crate::io::faces::{Faces, checked_index};
use crate::mesh::Mesh;

/// All primitives of a mesh as one body, or `None` if there is no vertex. Primitives that name the same positions share
/// vertices.
pub(super) fn body(mesh: &document::MeshObject, buffers: &mut Buffers<'_>) -> Result<Option<Mesh>, Error> {
    let mut vertices = Vec::new();
    let mut faces = Faces::default();
    // Accessor, first vertex and number of vertices.
    let mut known: Vec<(usize, usize, usize)> = Vec::new();
    for primitive in &mesh.primitives {
        // Without positions there is nothing to see.
        let Some(accessor) = primitive.attributes.position else {
            continue;
        };
        let (first, count) = match known.iter().find(|(a, ..)| *a == accessor) {
            Some(&(_, first, count)) => (first, count),
            None => {
                let positions = buffers.vectors::<3>(accessor)?;
                known.push((accessor, vertices.len(), positions.len()));
                vertices.extend_from_slice(&positions);
                (vertices.len() - positions.len(), positions.len())
            }
        };
        let mut corners = match primitive.indices {
            Some(accessor) => buffers.indices(accessor)?,
            None => {
                (0..u32::try_from(count).map_err(|_| Error::TooManyVertices { vertices: count })?).collect()
            }
        };
        for (index, corner) in corners.iter_mut().enumerate() {
            let checked = checked_index(Element::Corner, index, i64::from(*corner), count)?;
            *corner = u32::try_from(first + checked as usize).map_err(|_| Error::TooManyVertices {
                vertices: vertices.len(),
            })?;
        }
        add(&mut faces, primitive.mode.unwrap_or(4), &corners)?;
    }
    if vertices.is_empty() {
        return Ok(None);
    }
    faces.mesh(vertices).map(|read| Some(read.mesh))
}

/// Adds the lines or triangles that the corners form in this mode.
fn add(faces: &mut Faces, mode: u64, corners: &[u32]) -> Result<(), Error> {
    let whole = |of: usize| match corners.len() % of {
        0 => Ok(()),
        _ => Err(malformed(format!(
            "{} corners are not a multiple of {of}",
            corners.len()
        ))),
    };
    match mode {
        0 => {}
        1 => {
            whole(2)?;
            faces.lines.extend(corners.chunks_exact(2).map(|c| [c[0], c[1]]));
        }
        2 | 3 => {
            faces.lines.extend(corners.windows(2).map(|c| [c[0], c[1]]));
            if let (2, [first, .., last]) = (mode, corners) {
                faces.lines.push([*last, *first]);
            }
        }
        4 => {
            whole(3)?;
            faces
                .triangles
                .extend(corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]]));
        }
        5 => {
            let turned = |(k, c): (usize, &[u32])| {
                if k % 2 == 0 {
                    [c[0], c[1], c[2]]
                } else {
                    [c[1], c[0], c[2]]
                }
            };
            let strip = corners.windows(3).enumerate().map(turned);
            // Repeated corners only lead the strip elsewhere.
            faces
                .triangles
                .extend(strip.filter(|[a, b, c]| a != b && b != c && c != a));
        }
        6 => faces.add(corners),
        _ => return Err(malformed(format!("unknown mode {mode} of a primitive"))),
    }
    Ok(())
}
