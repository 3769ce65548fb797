//! A torus around the z axis.

use std::f64::consts::TAU;

use super::{checked_count, checked_length, checked_vertices, number};
use crate::error::Error;
use crate::mesh::Mesh;

/// A torus around the z axis: a tube of radius `minor` along a circle of radius `major`, with `around` vertices along that
/// circle and `across` around the tube. `minor > major` gives the spindle torus, which intersects itself.
///
/// # Errors
/// [`Error::Parameter`] unless both radii are finite and above 0, both counts at least 3, and the vertices at most 2^24.
pub fn torus(major: f64, minor: f64, around: usize, across: usize) -> Result<Mesh, Error> {
    checked_length("major radius", major)?;
    checked_length("minor radius", minor)?;
    checked_count("around", around, 3, "at least 3 vertices")?;
    checked_count("across", across, 3, "at least 3 vertices")?;
    let total = checked_vertices(around, across, 0)?;

    let mut vertices = Vec::with_capacity(total);
    let mut triangles = Vec::with_capacity(2 * total);
    let at = |i: usize, j: usize| number(i % around * across + j % across);
    for i in 0..around {
        let (s, c) = (TAU * i as f64 / around as f64).sin_cos();
        for j in 0..across {
            let (t, d) = (TAU * j as f64 / across as f64).sin_cos();
            let r = major + minor * d;
            vertices.push([r * c, r * s, minor * t]);
            triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    Mesh::new(vertices, vec![], triangles)
}
