//! The Utah teapot, evaluated from its control net.

use super::teapot_net::{PATCHES, POINTS};
use super::{checked_count, checked_vertices, number};
use crate::error::Error;
use crate::mesh::{Mesh, weld};

/// The Utah teapot with `segments` segments on every edge of its 32 bicubic patches, welded, z up.
///
/// Patches that share an edge share its vertices exactly. The triangles that collapse at the tip of the lid and in the
/// centre of the bottom are omitted. Handle, spout, lid and body touch or intersect without being joined, as in the
/// original. 32 n^2 quadrilaterals give 64 n^2 - 8 n triangles.
///
/// # Errors
/// [`Error::Parameter`] unless `segments` is between 1 and 723 (2^24 vertices).
///
/// Source of the control points: M. Newell, doctoral thesis, University of Utah, 1975.
///
/// ```
/// let teapot = satisfice_collision::generate::teapot(13)?;
/// assert_eq!((teapot.vertices().len(), teapot.triangles().len()), (5461, 10712));
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
pub fn teapot(segments: usize) -> Result<Mesh, Error> {
    let n = checked_count("segments", segments, 1, "at least 1 segment a patch edge")?;
    let side = n.saturating_add(1);
    checked_vertices(PATCHES.len(), side.saturating_mul(side), 0)?;

    let mut points = Vec::with_capacity(PATCHES.len() * side * side);
    for patch in &PATCHES {
        let net: [[[f64; 3]; 4]; 4] =
            std::array::from_fn(|i| std::array::from_fn(|j| POINTS[usize::from(patch[4 * i + j])]));
        for i in 0..=n {
            for j in 0..=n {
                points.push(patch_point(&net, i, j, n));
            }
        }
    }
    let (vertices, vertex_of) = weld(&points);

    let mut triangles = Vec::with_capacity(2 * PATCHES.len() * n * n);
    for patch in 0..PATCHES.len() {
        let at = |i: usize, j: usize| number(vertex_of[patch * side * side + i * side + j]);
        for i in 0..n {
            for j in 0..n {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                for [p, q, r] in [[a, b, c], [a, c, d]] {
                    if p != q && q != r && r != p {
                        triangles.push([p, q, r]);
                    }
                }
            }
        }
    }
    Mesh::new(vertices, vec![], triangles)
}

/// The patch at (i / n, j / n). A point on the boundary depends on the boundary curve alone, so that both neighbours
/// compute the same bits.
fn patch_point(net: &[[[f64; 3]; 4]; 4], i: usize, j: usize, n: usize) -> [f64; 3] {
    let column = |k: usize| net.map(|row| row[k]);
    if i == 0 || i == n {
        boundary_point(net[if i == 0 { 0 } else { 3 }], j, n)
    } else if j == 0 || j == n {
        boundary_point(column(if j == 0 { 0 } else { 3 }), i, n)
    } else {
        let (u, v) = (i as f64 / n as f64, j as f64 / n as f64);
        curve_point(net.map(|row| curve_point(row, v)), u)
    }
}

/// A boundary curve at k / n, always evaluated from its lexicographically lower end.
fn boundary_point(curve: [[f64; 3]; 4], k: usize, n: usize) -> [f64; 3] {
    if k == 0 {
        return curve[0];
    }
    if k == n {
        return curve[3];
    }
    let backward = [curve[3], curve[2], curve[1], curve[0]];
    if backward < curve {
        curve_point(backward, (n - k) as f64 / n as f64)
    } else {
        curve_point(curve, k as f64 / n as f64)
    }
}

/// de Casteljau's algorithm. In the form a + t (b - a) a curve whose control points coincide is exactly that point.
fn curve_point(mut points: [[f64; 3]; 4], t: f64) -> [f64; 3] {
    for degree in (1..4).rev() {
        for k in 0..degree {
            let (a, b) = (points[k], points[k + 1]);
            points[k] = std::array::from_fn(|x| a[x] + t * (b[x] - a[x]));
        }
    }
    points[0]
}
