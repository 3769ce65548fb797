//! Welding: vertices of one body that are equal or near each other become one.

use satisfice_catalogue::quantity::shown;
use satisfice_collision::broad::PointGrid;
use satisfice_collision::distance::Threshold;
use satisfice_collision::{Error, Mesh, mesh};

use crate::message;

/// Vertices closer than this part of the body's size look like the two sides of a seam.
const SEAM: f64 = 1e-9;

/// The body with one vertex for all that are equal, or joined by a chain of steps below `distance`: the first of them.
/// Vertices are renumbered in the order of the file; lines and triangles keep their numbers.
pub(super) fn welded(body: &Mesh, distance: f64) -> Result<Mesh, Error> {
    let (vertices, numbers) = merged(body, distance)?;
    let number = |v: u32| numbers[v as usize];
    Mesh::new(
        vertices,
        body.lines().iter().map(|line| line.map(number)).collect(),
        body.triangles()
            .iter()
            .map(|triangle| triangle.map(number))
            .collect(),
    )
}

/// How many vertices lie on others, but for rounding, and the distance that welds them.
pub(super) fn seams(body: &Mesh) -> Result<(usize, f64), Error> {
    let distance = SEAM * body.size();
    let (vertices, _) = merged(body, distance)?;
    Ok((body.vertices().len() - vertices.len(), distance))
}

/// The vertices that remain, and the number of the one that each vertex becomes.
fn merged(body: &Mesh, distance: f64) -> Result<(Vec<[f64; 3]>, Vec<u32>), Error> {
    let (distinct, numbers) = mesh::weld(body.vertices());
    let mut first: Vec<u32> = (0..distinct.len() as u32).collect();
    if distance > 0.0 {
        let mut grid = PointGrid::new();
        for pair in grid.within(&distinct, Threshold::new(distance)?)? {
            let (a, b) = (root(&mut first, pair.a), root(&mut first, pair.b));
            first[a.max(b) as usize] = a.min(b);
        }
    }
    let mut vertices = Vec::new();
    let mut new = vec![0; distinct.len()];
    for v in 0..distinct.len() as u32 {
        let of = root(&mut first, v);
        if of == v {
            new[v as usize] = vertices.len() as u32;
            vertices.push(distinct[v as usize]);
        } else {
            new[v as usize] = new[of as usize];
        }
    }
    Ok((vertices, numbers.into_iter().map(|number| new[number]).collect()))
}

/// The least vertex of the chain that `v` belongs to.
fn root(first: &mut [u32], mut v: u32) -> u32 {
    while first[v as usize] != v {
        let above = first[first[v as usize] as usize];
        first[v as usize] = above;
        v = above;
    }
    v
}

/// What welding changed in all bodies.
#[derive(Debug, Default)]
pub(super) struct Welds {
    vertices: usize,
    merged: usize,
    triangles: usize,
    flattened: usize,
    /// The body that lost most triangles, with their number.
    worst: Option<(usize, String)>,
}

impl Welds {
    /// Adds a body as it was and as it is.
    pub(super) fn note(&mut self, name: &str, before: &Mesh, after: &Mesh) {
        self.vertices += before.vertices().len();
        self.merged += before.vertices().len() - after.vertices().len();
        self.triangles += before.triangles().len();
        // Corners at one place are one after welding, so that these had no area before.
        let has_corners = |mesh: &Mesh, triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|v| mesh.vertex(v));
            a != b && b != c && c != a
        };
        let triangles = before.triangles().iter().zip(after.triangles());
        let flattened = triangles
            .filter(|(old, new)| has_corners(before, old) && !has_corners(after, new))
            .count();
        self.flattened += flattened;
        if flattened > self.worst.as_ref().map_or(0, |(most, _)| *most) {
            self.worst = Some((flattened, name.to_owned()));
        }
    }

    /// Says how many vertices were merged, and warns of triangles that became edges or points.
    pub(super) fn say(&self, distance: f64) {
        let count = |n: usize| shown::count(n as u64);
        message::say(format_args!(
            "note: --weld {} merged {} of {} vertices with others",
            shown::exact(distance),
            count(self.merged),
            count(self.vertices)
        ));
        if let Some((most, name)) = &self.worst {
            message::say(format_args!(
                "warning: --weld {} turned {} of {} triangles into edges or points (most of them, {}, in {name}): is the \
                 distance in the unit of the meshes?",
                shown::exact(distance),
                count(self.flattened),
                count(self.triangles),
                count(*most)
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn chains_of_near_vertices_become_the_first() {
        let at = |x: f64| [x, 0.0, 0.0];
        let body = Mesh::new(
            vec![at(0.0), at(1.0), at(0.2), at(0.1), at(1.0)],
            vec![[1, 4]],
            vec![[3, 1, 2]],
        )
        .unwrap();
        let exact = welded(&body, 0.0).unwrap();
        assert_eq!(exact.vertices(), [at(0.0), at(1.0), at(0.2), at(0.1)]);
        let near = welded(&body, 0.15).unwrap();
        assert_eq!(near.vertices(), [at(0.0), at(1.0)]);
        assert_eq!(
            (near.lines(), near.triangles()),
            (&[[1, 1]][..], &[[0, 1, 0]][..])
        );
        assert_eq!(seams(&body).unwrap().0, 1);
    }
}
