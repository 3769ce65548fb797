//! A rectangular cloth.

use super::{checked_count, checked_length, checked_vertices, number};
use crate::error::Error;
use crate::mesh::Mesh;

/// A flat cloth of `columns` x `rows` vertices in the plane z = 0, `width` (x) by `height` (y), centred on the origin,
/// numbered row by row. The diagonals of its cells alternate, so that the cloth has no preferred direction.
///
/// ```
/// let cloth = satisfice_collision::generate::cloth(2.0, 1.0, 5, 3)?;
/// assert_eq!((cloth.vertices().len(), cloth.triangles().len()), (15, 16));
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
///
/// # Errors
/// [`Error::Parameter`] unless both lengths are finite and above 0, both counts at least 2, and the vertices at most
/// 2^24.
pub fn cloth(width: f64, height: f64, columns: usize, rows: usize) -> Result<Mesh, Error> {
    checked_length("width", width)?;
    checked_length("height", height)?;
    checked_count("columns", columns, 2, "at least 2 vertices")?;
    checked_count("rows", rows, 2, "at least 2 vertices")?;
    let total = checked_vertices(columns, rows, 0)?;

    let mut vertices = Vec::with_capacity(total);
    for r in 0..rows {
        for c in 0..columns {
            let x = c as f64 / (columns - 1) as f64 - 0.5;
            let y = r as f64 / (rows - 1) as f64 - 0.5;
            vertices.push([width * x, height * y, 0.0]);
        }
    }
    let at = |c: usize, r: usize| number(r * columns + c);
    let mut triangles = Vec::with_capacity(2 * (columns - 1) * (rows - 1));
    for r in 0..rows - 1 {
        for c in 0..columns - 1 {
            let [p, q, s, t] = [at(c, r), at(c + 1, r), at(c + 1, r + 1), at(c, r + 1)];
            if (c + r) % 2 == 0 {
                triangles.extend([[p, q, s], [p, s, t]]);
            } else {
                triangles.extend([[p, q, t], [q, s, t]]);
            }
        }
    }
    Mesh::new(vertices, vec![], triangles)
}
