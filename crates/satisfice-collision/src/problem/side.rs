//! One body of a vertex-pair problem: its mesh, and which of its vertices stands at which position.

use super::ranges::Ranges;
use crate::error::Error;
use crate::mesh::{Aabb, Adjacency, Mesh};
use crate::order::VertexOrder;

/// A body and the order of its chosen vertices.
#[derive(Debug, Clone)]
pub(super) struct Side {
    pub(super) mesh: Mesh,
    pub(super) order: VertexOrder,
    /// Position to vertex.
    pub(super) vertex_at: Vec<u32>,
    /// Vertex to position, [`ABSENT`] for a vertex that was not chosen.
    position_of: Vec<u32>,
    /// Chosen vertices next to each other, across the gaps that others leave.
    pub(super) neighbours: Adjacency,
    ranges: Ranges,
}

const ABSENT: u32 = u32::MAX;

impl Side {
    pub(super) fn new(mesh: &Mesh, order: VertexOrder, chosen: &[u32]) -> Self {
        let points: Vec<[f64; 3]> = chosen.iter().map(|&v| mesh.vertex(v)).collect();
        let vertex_at: Vec<u32> = order
            .permutation(&points)
            .into_iter()
            .map(|k| chosen[k as usize])
            .collect();
        let mut position_of = vec![ABSENT; mesh.vertices().len()];
        for (position, &v) in vertex_at.iter().enumerate() {
            position_of[v as usize] = position as u32;
        }
        let neighbours = mesh.adjacency().bridged(|v| position_of[v as usize] != ABSENT);
        Self {
            ranges: ranges_of(mesh, &vertex_at),
            mesh: mesh.clone(),
            order,
            vertex_at,
            position_of,
            neighbours,
        }
    }

    pub(super) fn all(mesh: &Mesh) -> Self {
        Self::new(
            mesh,
            VertexOrder::default(),
            &(0..mesh.vertices().len() as u32).collect::<Vec<_>>(),
        )
    }

    /// The chosen vertices by number.
    pub(super) fn chosen(&self) -> Vec<u32> {
        let mut chosen = self.vertex_at.clone();
        chosen.sort_unstable();
        chosen
    }

    pub(super) fn choose(&self, vertices: &[u32]) -> Result<Self, Error> {
        let mut chosen = vertices.to_vec();
        chosen.sort_unstable();
        chosen.dedup();
        let total = self.mesh.vertices().len();
        match chosen.last() {
            None => Err(Error::parameter(
                "chosen vertices",
                0,
                "at least one vertex of each body",
            )),
            Some(&last) if last as usize >= total => Err(Error::parameter(
                "chosen vertices",
                last,
                "vertex numbers below the number of vertices",
            )),
            Some(_) => Ok(Self::new(&self.mesh, self.order, &chosen)),
        }
    }

    #[inline]
    pub(super) fn vertex(&self, value: f64) -> u32 {
        // A float beyond the range saturates; the last position takes what is too large.
        self.vertex_at[(value as usize).min(self.vertex_at.len() - 1)]
    }

    pub(super) fn position(&self, vertex: u32) -> Option<f64> {
        let position = self.position_of.get(vertex as usize)?;
        (*position != ABSENT).then(|| f64::from(*position))
    }

    #[inline]
    pub(super) fn point(&self, vertex: u32) -> Option<&[f64; 3]> {
        self.mesh.vertices().get(vertex as usize)
    }

    pub(super) fn chosen_points(&self) -> (Vec<u32>, Vec<[f64; 3]>) {
        let chosen = self.chosen();
        let points = chosen.iter().map(|&v| self.mesh.vertex(v)).collect();
        (chosen, points)
    }

    /// The body has moved or changed its shape.
    pub(super) fn go_to(&mut self, mesh: Mesh) {
        self.mesh = mesh;
        self.ranges = ranges_of(&self.mesh, &self.vertex_at);
    }

    /// The box around the vertices at the positions from `first` to `last`, as they stand on an axis.
    pub(super) fn around(&self, first: f64, last: f64) -> Aabb {
        let end = self.vertex_at.len() - 1;
        let first = (first as usize).min(end);
        let last = (last as usize).clamp(first, end);
        self.ranges.around(first, last, |position| {
            Aabb::point(self.mesh.vertex(self.vertex_at[position]))
        })
    }

    /// The median length of the edges; infinite where it overflows, 0 without edges.
    pub(super) fn spacing(&self) -> f64 {
        spacing(&self.mesh)
    }
}

fn ranges_of(mesh: &Mesh, vertex_at: &[u32]) -> Ranges {
    Ranges::new(vertex_at.len(), |position| {
        Aabb::point(mesh.vertex(vertex_at[position]))
    })
}

/// The median length of a mesh's edges; infinite where it overflows, 0 without edges.
pub(super) fn spacing(mesh: &Mesh) -> f64 {
    let mut squares: Vec<f64> = mesh
        .edges()
        .iter()
        .map(|&[i, j]| square(&mesh.vertex(i), &mesh.vertex(j)))
        .collect();
    if squares.is_empty() {
        return 0.0;
    }
    let middle = squares.len() / 2;
    squares.select_nth_unstable_by(middle, f64::total_cmp).1.sqrt()
}

#[inline]
pub(super) fn square(p: &[f64; 3], q: &[f64; 3]) -> f64 {
    let [x, y, z] = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    x * x + y * y + z * z
}
