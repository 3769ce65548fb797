//! Tests of the mesh type: what it refuses, and what it derives against naive counterparts.
#![allow(clippy::unwrap_used)]

use proptest::prelude::*;

use super::finite::AXES;
use super::*;

fn points(n: usize) -> Vec<[f64; 3]> {
    (0..n).map(|i| [i as f64, (i * i) as f64, -(i as f64)]).collect()
}

#[test]
fn refuses_a_body_without_vertices() {
    assert!(matches!(Mesh::new(vec![], vec![], vec![]), Err(Error::EmptyMesh)));
}

#[test]
fn names_the_vertex_and_the_coordinate_that_is_not_finite() {
    for (axis, value) in [(0, f64::NAN), (1, f64::INFINITY), (2, f64::NEG_INFINITY)] {
        let mut vertices = points(5);
        vertices[3][axis] = value;
        let error = Mesh::new(vertices, vec![], vec![]).unwrap_err();
        assert!(matches!(error, Error::NonFiniteVertex { vertex: 3, axis: a, .. } if a == AXES[axis]));
        let letter = AXES[axis];
        assert!(
            error
                .to_string()
                .starts_with(&format!("vertex 3 has {letter} = "))
        );
    }
}

#[test]
fn names_the_element_whose_index_is_out_of_range() {
    let error = Mesh::new(points(3), vec![[0, 1], [1, 3]], vec![]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "edge 1 names vertex 3, but the mesh has 3 vertices (0 to 2)"
    );
    let error = Mesh::new(points(3), vec![], vec![[0, 1, u32::MAX]]).unwrap_err();
    assert!(matches!(
        error,
        Error::IndexOutOfRange {
            element: Element::Triangle,
            index: 0,
            ..
        }
    ));
}

#[test]
fn accepts_vertices_alone_edges_alone_and_degenerate_triangles() {
    let alone = Mesh::new(points(1), vec![], vec![]).unwrap();
    assert_eq!((alone.size(), alone.edges().len()), (0.0, 0));
    let wire = Mesh::new(points(3), vec![[2, 0], [0, 2], [1, 1]], vec![]).unwrap();
    assert_eq!(wire.edges(), [[0, 2]]);
    assert_eq!(wire.lines().len(), 3);
    let degenerate = Mesh::new(points(3), vec![], vec![[0, 0, 1], [2, 2, 2]]).unwrap();
    assert_eq!(degenerate.edges(), [[0, 1]]);
    assert_eq!(degenerate.triangles().len(), 2);
}

#[test]
fn frames_share_the_body_and_are_checked() {
    let mesh = Mesh::new(points(3), vec![], vec![[0, 1, 2]]).unwrap();
    let moved = mesh
        .with_vertices(points(3).iter().map(|p| [p[0] + 1.0, p[1], p[2]]).collect())
        .unwrap();
    assert!(mesh.same_body(&moved) && mesh != moved);
    assert!(matches!(
        mesh.with_vertices(points(2)),
        Err(Error::Parameter { .. })
    ));
    assert!(mesh.with_vertices(vec![[f64::NAN; 3]; 3]).is_err());
}

#[test]
fn size_is_the_longest_extent() {
    let mesh = Mesh::new(vec![[-1.0, 2.0, 0.0], [1.0, 7.0, -3.0]], vec![], vec![]).unwrap();
    let bounds = mesh.bounds();
    assert_eq!(
        bounds,
        Aabb {
            min: [-1.0, 2.0, -3.0],
            max: [1.0, 7.0, 0.0]
        }
    );
    assert_eq!((bounds.longest_axis(), mesh.size()), (1, 5.0));
    assert_eq!(Aabb::point([0.0; 3]).longest_axis(), 0);
}

/// Graph distances by Floyd and Warshall, the referee of the rings.
fn all_distances(n: usize, edges: &[[u32; 2]]) -> Vec<Vec<usize>> {
    let mut d = vec![vec![usize::MAX / 2; n]; n];
    for (i, row) in d.iter_mut().enumerate() {
        row[i] = 0;
    }
    for &[a, b] in edges {
        d[a as usize][b as usize] = 1;
        d[b as usize][a as usize] = 1;
    }
    for k in 0..n {
        for i in 0..n {
            for j in 0..n {
                d[i][j] = d[i][j].min(d[i][k] + d[k][j]);
            }
        }
    }
    d
}

proptest! {
    #[test]
    fn welding_agrees_with_comparing_all_pairs(
        coarse in prop::collection::vec(prop::array::uniform3(-1_i32..=1), 0..40),
        signs in any::<u64>(),
    ) {
        // Few distinct coordinates, zeros of both signs.
        let points: Vec<[f64; 3]> = coarse
            .iter()
            .enumerate()
            .map(|(i, p)| p.map(|c| if c == 0 && signs >> (i % 64) & 1 == 1 { -0.0 } else { f64::from(c) }))
            .collect();
        let (distinct, number) = weld(&points);
        for (i, p) in points.iter().enumerate() {
            prop_assert_eq!(*p, distinct[number[i]]);
            for (j, q) in points.iter().enumerate() {
                prop_assert_eq!(p == q, number[i] == number[j]);
            }
        }
        let mut next = 0;
        for n in number {
            prop_assert!(n <= next);
            next += usize::from(n == next);
        }
        prop_assert_eq!(next, distinct.len());
    }

    #[test]
    fn edges_and_rings_agree_with_naive_ones(
        n in 1_usize..12,
        raw in prop::collection::vec((0_u32..12, 0_u32..12, 0_u32..12), 0..14),
        raw_lines in prop::collection::vec((0_u32..12, 0_u32..12), 0..6),
        width in 0_usize..5,
    ) {
        let m = n as u32;
        let triangles: Vec<_> = raw.iter().map(|&(a, b, c)| [a % m, b % m, c % m]).collect();
        let lines: Vec<_> = raw_lines.iter().map(|&(a, b)| [a % m, b % m]).collect();
        let mesh = Mesh::new(points(n), lines.clone(), triangles.clone()).unwrap();

        let mut naive = std::collections::BTreeSet::new();
        for t in &triangles {
            for (a, b) in [(t[0], t[1]), (t[0], t[2]), (t[1], t[2])] {
                if a != b { naive.insert([a.min(b), a.max(b)]); }
            }
        }
        for &[a, b] in &lines {
            if a != b { naive.insert([a.min(b), a.max(b)]); }
        }
        prop_assert_eq!(mesh.edges(), naive.into_iter().collect::<Vec<_>>());

        let d = all_distances(n, mesh.edges());
        let rings = mesh.adjacency().rings(width);
        for (i, row) in d.iter().enumerate() {
            let v = i as u32;
            let expected: Vec<u32> =
                (0..n).filter(|&j| j != i && row[j] <= width).map(|j| j as u32).collect();
            prop_assert_eq!(rings.neighbours(v), &expected[..]);
            prop_assert_eq!(mesh.adjacency().ring(v, width), expected);
            for (j, &distance) in row.iter().enumerate() {
                prop_assert_eq!(mesh.adjacency().contains(v, j as u32), distance == 1);
            }
        }
    }
}
