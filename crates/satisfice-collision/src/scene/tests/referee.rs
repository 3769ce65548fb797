//! Brute force over all pairs of features of all bodies.

use super::super::{BodyId, Contact};
use crate::distance::{
    PairKind, Point, Threshold, edge_edge, edge_triangle, triangle_triangle, vertex_edge, vertex_triangle,
    vertex_vertex,
};
use crate::{Mesh, Placement};

pub(super) const KINDS: [PairKind; 6] = [
    PairKind::VertexVertex,
    PairKind::VertexEdge,
    PairKind::VertexTriangle,
    PairKind::EdgeEdge,
    PairKind::EdgeTriangle,
    PairKind::TriangleTriangle,
];

/// What the referee knows of a body: its posed mesh and whether it collides with itself, beyond which ring.
pub(super) struct PosedMesh {
    pub(super) mesh: Mesh,
    pub(super) ring: Option<usize>,
}

pub(super) fn turn(angle: f64, by: [f64; 3]) -> Placement {
    let turned = Placement::from_axis_angle([0.2, 1.0, 0.3], angle).unwrap();
    turned.moved(by).unwrap()
}

/// How many corners the two features of a pair have.
fn corners(kind: PairKind) -> (usize, usize) {
    match kind {
        PairKind::VertexVertex => (1, 1),
        PairKind::VertexEdge => (1, 2),
        PairKind::VertexTriangle => (1, 3),
        PairKind::EdgeEdge => (2, 2),
        PairKind::EdgeTriangle => (2, 3),
        PairKind::TriangleTriangle => (3, 3),
    }
}

fn features(mesh: &Mesh, corners: usize) -> Vec<Vec<u32>> {
    match corners {
        1 => (0..mesh.vertices().len() as u32).map(|v| vec![v]).collect(),
        2 => mesh.edges().iter().map(|e| e.to_vec()).collect(),
        _ => mesh.triangles().iter().map(|t| t.to_vec()).collect(),
    }
}

fn within(kind: PairKind, a: &[Point], b: &[Point], threshold: Threshold) -> bool {
    match kind {
        PairKind::VertexVertex => vertex_vertex::within(&a[0], &b[0], threshold),
        PairKind::VertexEdge => vertex_edge::within(&a[0], &[b[0], b[1]], threshold),
        PairKind::VertexTriangle => vertex_triangle::within(&a[0], &[b[0], b[1], b[2]], threshold),
        PairKind::EdgeEdge => edge_edge::within(&[a[0], a[1]], &[b[0], b[1]], threshold),
        PairKind::EdgeTriangle => edge_triangle::within(&[a[0], a[1]], &[b[0], b[1], b[2]], threshold),
        PairKind::TriangleTriangle => {
            triangle_triangle::within(&[a[0], a[1], a[2]], &[b[0], b[1], b[2]], threshold)
        }
    }
}

/// All pairs of features of two bodies, or of one with itself if `ring` says what to exclude.
pub(super) fn pairs(
    kind: PairKind,
    one: &Mesh,
    two: &Mesh,
    ring: Option<usize>,
    threshold: Threshold,
) -> Vec<[u32; 2]> {
    let (corners_a, corners_b) = corners(kind);
    let (of_a, of_b) = (features(one, corners_a), features(two, corners_b));
    let points = |mesh: &Mesh, of: &[u32]| of.iter().map(|&v| mesh.vertex(v)).collect::<Vec<_>>();
    let points_b: Vec<_> = of_b.iter().map(|b| points(two, b)).collect();
    let mut found = Vec::new();
    for (i, a) in of_a.iter().enumerate() {
        let around: Vec<u32> = match ring {
            Some(width) => a
                .iter()
                .flat_map(|&v| [one.adjacency().ring(v, width), vec![v]].concat())
                .collect(),
            None => Vec::new(),
        };
        let points_a = points(one, a);
        for (j, b) in of_b.iter().enumerate() {
            let twice = ring.is_some() && corners_a == corners_b && j <= i;
            if !twice
                && !b.iter().any(|v| around.contains(v))
                && within(kind, &points_a, &points_b[j], threshold)
            {
                found.push([i as u32, j as u32]);
            }
        }
    }
    found
}

/// All contacts of bodies that were added in this order, by trying everything.
pub(super) fn contacts(bodies: &[PosedMesh], kind: PairKind, delta: f64) -> Vec<Contact> {
    let threshold = Threshold::new(delta).unwrap();
    let (corners_a, corners_b) = corners(kind);
    let mut contacts = Vec::new();
    for (body_a, one) in bodies.iter().enumerate() {
        for (body_b, two) in bodies.iter().enumerate() {
            let own = body_a == body_b;
            if (corners_a == corners_b && body_a > body_b) || (own && one.ring.is_none()) {
                continue;
            }
            let ring = one.ring.filter(|_| own);
            let found = pairs(kind, &one.mesh, &two.mesh, ring, threshold);
            contacts.extend(found.into_iter().map(|[a, b]| Contact {
                body_a: BodyId::nth(body_a as u32),
                body_b: BodyId::nth(body_b as u32),
                a,
                b,
            }));
        }
    }
    contacts.sort_unstable();
    contacts
}
