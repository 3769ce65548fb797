//! Spheres around the origin: by longitude and latitude, and from the icosahedron.

use std::f64::consts::{PI, TAU};

use super::{checked_count, checked_length, checked_vertices, number};
use crate::error::Error;
use crate::mesh::Mesh;

/// A sphere around the origin with `meridians` vertices on each of `parallels - 1` circles of latitude and one at each
/// pole, which lie on the z axis.
///
/// # Errors
/// [`Error::Parameter`] unless `radius` is finite and above 0, `meridians` at least 3, `parallels` at least 2, and the
/// vertices at most 2^24.
pub fn uv_sphere(radius: f64, meridians: usize, parallels: usize) -> Result<Mesh, Error> {
    checked_length("radius", radius)?;
    checked_count("meridians", meridians, 3, "at least 3 meridians")?;
    checked_count("parallels", parallels, 2, "at least 2 strips of latitude")?;
    let total = checked_vertices(meridians, parallels - 1, 2)?;

    let mut vertices = Vec::with_capacity(total);
    vertices.push([0.0, 0.0, radius]);
    for p in 1..parallels {
        let (sin, cos) = (PI * p as f64 / parallels as f64).sin_cos();
        for m in 0..meridians {
            let (s, c) = (TAU * m as f64 / meridians as f64).sin_cos();
            vertices.push([radius * sin * c, radius * sin * s, radius * cos]);
        }
    }
    vertices.push([0.0, 0.0, -radius]);

    let at = |p: usize, m: usize| number(1 + (p - 1) * meridians + m % meridians);
    let south = number(total - 1);
    let mut triangles = Vec::with_capacity(2 * (total - 2));
    for m in 0..meridians {
        triangles.push([0, at(1, m), at(1, m + 1)]);
        for p in 1..parallels - 1 {
            triangles.push([at(p, m), at(p + 1, m), at(p + 1, m + 1)]);
            triangles.push([at(p, m), at(p + 1, m + 1), at(p, m + 1)]);
        }
        triangles.push([south, at(parallels - 1, m + 1), at(parallels - 1, m)]);
    }
    Mesh::new(vertices, vec![], triangles)
}

/// A sphere around the origin: an icosahedron whose triangles are quartered `subdivisions` times, with every new vertex
/// moved to the radius. It has 10 * 4^k + 2 vertices with nearly even spacing.
///
/// # Errors
/// [`Error::Parameter`] unless `radius` is finite and above 0 and `subdivisions` at most 10.
pub fn icosphere(radius: f64, subdivisions: u32) -> Result<Mesh, Error> {
    checked_length("radius", radius)?;
    if subdivisions > 10 {
        return Err(Error::parameter("subdivisions", subdivisions, "0 to 10"));
    }
    let phi = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut vertices: Vec<[f64; 3]> = Vec::new();
    for (s, t) in [(-1.0, phi), (1.0, phi), (-1.0, -phi), (1.0, -phi)] {
        vertices.push([s, t, 0.0]);
        vertices.push([0.0, s, t]);
        vertices.push([t, 0.0, s]);
    }
    vertices.iter_mut().for_each(|v| *v = unit(*v));
    let mut triangles = icosahedron_faces(&vertices);

    for _ in 0..subdivisions {
        let edges = Mesh::new(vertices.clone(), vec![], triangles.clone())?
            .edges()
            .to_vec();
        let old = vertices.len();
        vertices.extend(
            edges
                .iter()
                .map(|&[a, b]| {
                    let (a, b) = (vertices[a as usize], vertices[b as usize]);
                    unit([a[0] + b[0], a[1] + b[1], a[2] + b[2]])
                })
                .collect::<Vec<_>>(),
        );
        let middle = |a: u32, b: u32| {
            let (Ok(e) | Err(e)) = edges.binary_search(&[a.min(b), a.max(b)]);
            number(old + e)
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
                [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
            })
            .collect();
    }
    let vertices = vertices.iter().map(|v| v.map(|c| c * radius)).collect();
    Mesh::new(vertices, vec![], triangles)
}

/// The 20 triples of mutually nearest vertices, counter-clockwise as seen from outside.
fn icosahedron_faces(vertices: &[[f64; 3]]) -> Vec<[u32; 3]> {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    // Neighbours on the unit icosahedron have a dot product of 1/sqrt 5, all others at most -1/sqrt 5.
    let joined = |a: usize, b: usize| dot(vertices[a], vertices[b]) > 0.0;
    let mut faces = Vec::with_capacity(20);
    for a in 0..vertices.len() {
        for b in a + 1..vertices.len() {
            for c in b + 1..vertices.len() {
                if joined(a, b) && joined(b, c) && joined(a, c) {
                    let [p, q, r] = [vertices[a], vertices[b], vertices[c]];
                    let cross = [
                        q[1] * r[2] - q[2] * r[1],
                        q[2] * r[0] - q[0] * r[2],
                        q[0] * r[1] - q[1] * r[0],
                    ];
                    let [x, y, z] = [number(a), number(b), number(c)];
                    faces.push(if dot(p, cross) > 0.0 { [x, y, z] } else { [x, z, y] });
                }
            }
        }
    }
    faces
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    v.map(|c| c / length)
}
