//! Tests of the generators against closed forms: counts, Euler's characteristic, radii, volumes.
#![allow(clippy::unwrap_used)]

use approx::assert_relative_eq;

use super::teapot_net::{PATCHES, POINTS};
use super::*;
use crate::Mesh;

fn euler(mesh: &Mesh) -> i64 {
    let count = |n: usize| i64::try_from(n).unwrap();
    count(mesh.vertices().len()) - count(mesh.edges().len()) + count(mesh.triangles().len())
}

/// Signed volume by the divergence theorem; positive if the triangles look outward.
fn volume(mesh: &Mesh) -> f64 {
    (0..mesh.triangles().len())
        .map(|t| {
            let [a, b, c] = mesh.triangle(t);
            (a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0]))
                / 6.0
        })
        .sum()
}

/// Every edge of a closed surface belongs to exactly two triangles, once in each direction.
fn assert_closed(mesh: &Mesh) {
    let mut directed: Vec<[u32; 2]> = mesh
        .triangles()
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .collect();
    directed.sort_unstable();
    let before = directed.len();
    directed.dedup();
    assert_eq!(
        directed.len(),
        before,
        "an edge is run through twice in one direction"
    );
    assert!(
        directed
            .iter()
            .all(|&[a, b]| directed.binary_search(&[b, a]).is_ok())
    );
}

#[test]
fn the_control_net_is_whole() {
    let mut used = [false; POINTS.len()];
    PATCHES
        .iter()
        .flatten()
        .for_each(|&p| used[usize::from(p)] = true);
    assert_eq!((POINTS.len(), PATCHES.len()), (290, 32));
    assert!(used.iter().all(|&u| u));
}

#[test]
fn the_teapot_has_the_known_counts() {
    let mesh = teapot(13).unwrap();
    assert_eq!((mesh.vertices().len(), mesh.triangles().len()), (5461, 10_712));
    for n in [1, 2, 3, 8, 20] {
        let mesh = teapot(n).unwrap();
        assert_eq!(mesh.triangles().len(), 64 * n * n - 8 * n);
        let (distinct, _) = crate::mesh::weld(mesh.vertices());
        assert_eq!(distinct.len(), mesh.vertices().len());
    }
}

/// A vertex the exact weld missed would lie within rounding of another one; none does.
#[test]
fn the_teapot_has_no_vertices_that_only_nearly_coincide() {
    let mesh = teapot(6).unwrap();
    let (v, least) = (mesh.vertices(), 1e-9 * mesh.size());
    for i in 0..v.len() {
        for j in 0..i {
            let d2: f64 = (0..3).map(|k| (v[i][k] - v[j][k]).powi(2)).sum();
            assert!(d2.sqrt() > least, "{i} {j} {:?} {:?}", v[i], v[j]);
        }
    }
}

/// Points of the surface by the Bernstein sum instead of de Casteljau's algorithm.
#[test]
fn the_teapot_lies_on_its_patches() {
    let n = 4;
    let mesh = teapot(n).unwrap();
    let rounding = 1e-14 * mesh.size();
    let bernstein = |t: f64| {
        let s = 1.0 - t;
        [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
    };
    for patch in &PATCHES {
        for i in 0..=n {
            for j in 0..=n {
                let (bu, bv) = (bernstein(i as f64 / n as f64), bernstein(j as f64 / n as f64));
                let expected: [f64; 3] = std::array::from_fn(|x| {
                    (0..16)
                        .map(|k| bu[k / 4] * bv[k % 4] * POINTS[usize::from(patch[k])][x])
                        .sum()
                });
                let nearest = mesh
                    .vertices()
                    .iter()
                    .map(|v| (0..3).map(|x| (v[x] - expected[x]).powi(2)).sum::<f64>())
                    .fold(f64::INFINITY, f64::min);
                assert!(nearest.sqrt() < rounding);
            }
        }
    }
    let bounds = mesh.bounds();
    assert_eq!(bounds.longest_axis(), 0, "handle and spout lie along x");
    assert_eq!(bounds.min[2], 0.0);
}

#[test]
fn spheres_are_closed_round_and_look_outward() {
    for (mesh, vertices, loss) in [
        (uv_sphere(2.0, 40, 30).unwrap(), 40 * 29 + 2, 0.02),
        (uv_sphere(2.0, 3, 2).unwrap(), 5, 0.9),
        (icosphere(2.0, 0).unwrap(), 12, 0.5),
        (icosphere(2.0, 4).unwrap(), 10 * 256 + 2, 0.01),
    ] {
        assert_eq!(mesh.vertices().len(), vertices);
        assert_closed(&mesh);
        assert_eq!(euler(&mesh), 2);
        for v in mesh.vertices() {
            assert_relative_eq!(
                v.iter().map(|c| c * c).sum::<f64>().sqrt(),
                2.0,
                max_relative = 1e-14
            );
        }
        let full = 4.0 / 3.0 * std::f64::consts::PI * 8.0;
        let held = volume(&mesh);
        assert!(held < full && held > (1.0 - loss) * full, "{held} of {full}");
    }
}

#[test]
fn the_torus_is_closed_and_has_genus_one() {
    let mesh = torus(3.0, 1.0, 96, 48).unwrap();
    assert_closed(&mesh);
    assert_eq!((mesh.vertices().len(), euler(&mesh)), (96 * 48, 0));
    for v in mesh.vertices() {
        let r = v[0].hypot(v[1]) - 3.0;
        assert_relative_eq!(r.hypot(v[2]), 1.0, max_relative = 1e-13);
    }
    let full = 2.0 * std::f64::consts::PI.powi(2) * 3.0;
    assert_relative_eq!(volume(&mesh), full, max_relative = 0.01);
}

#[test]
fn the_cloth_is_a_disc_of_the_right_size() {
    let mesh = cloth(2.0, 1.0, 5, 3).unwrap();
    assert_eq!(
        (mesh.vertices().len(), mesh.triangles().len(), euler(&mesh)),
        (15, 16, 1)
    );
    let bounds = mesh.bounds();
    assert_eq!((bounds.min, bounds.max), ([-1.0, -0.5, 0.0], [1.0, 0.5, 0.0]));
}

#[test]
fn parameters_out_of_range_are_refused_by_name() {
    let named = |result: Result<Mesh, Error>, name: &str| match result {
        Err(Error::Parameter { parameter, .. }) => assert_eq!(parameter, name),
        other => panic!("{name}: {:?}", other.map(|m| m.vertices().len())),
    };
    named(teapot(0), "segments");
    named(teapot(724), "number of vertices");
    named(teapot(usize::MAX), "number of vertices");
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        named(uv_sphere(bad, 8, 8), "radius");
        named(icosphere(bad, 1), "radius");
        named(torus(bad, 1.0, 8, 8), "major radius");
        named(torus(1.0, bad, 8, 8), "minor radius");
        named(cloth(bad, 1.0, 8, 8), "width");
        named(cloth(1.0, bad, 8, 8), "height");
    }
    named(uv_sphere(1.0, 2, 8), "meridians");
    named(uv_sphere(1.0, 8, 1), "parallels");
    named(uv_sphere(1.0, usize::MAX, usize::MAX), "number of vertices");
    named(icosphere(1.0, 11), "subdivisions");
    named(torus(1.0, 1.0, 2, 8), "around");
    named(torus(1.0, 1.0, 8, 2), "across");
    named(cloth(1.0, 1.0, 1, 8), "columns");
    named(cloth(1.0, 1.0, 8, 1), "rows");
    assert!(matches!(
        torus(1.7e308, 1.7e308, 8, 8),
        Err(Error::NonFiniteVertex { .. })
    ));
}

/// Layers a gap apart on the mean, nowhere nearer than a tenth of it, no edge four times shorter or twice longer than in the flat cloth.
#[test]
fn pleats_lie_upon_each_other() {
    let (columns, rows, layers, gap) = (91, 13, 4, 0.1);
    for phase in [0.0, 0.3] {
        let mesh = pleats(columns, rows, layers, gap, phase).unwrap();
        let flat = cloth(3.0, 1.0, columns, rows).unwrap();
        assert_eq!(mesh.triangles(), flat.triangles());
        let length = |mesh: &Mesh, [v, w]: [u32; 2]| {
            let (p, q) = (mesh.vertex(v), mesh.vertex(w));
            (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt()
        };
        for &edge in mesh.edges() {
            let stretch = length(&mesh, edge) / length(&flat, edge);
            assert!((0.25..2.0).contains(&stretch), "{stretch}");
        }
        let bounds = mesh.bounds();
        assert!(bounds.extents()[2] > 3.0 * gap && bounds.extents()[2] < 4.0 * gap);
        assert!(bounds.extents()[0] < 3.0 / 4.0 + gap);
    }
    let [a, b] = [0.0, 1.0].map(|phase| pleats(columns, rows, layers, gap, phase).unwrap());
    assert_relative_eq!(a.vertex(77)[2], b.vertex(77)[2], epsilon = 1e-12);
    for bad in [
        pleats(1, 9, 2, 0.1, 0.0),
        pleats(9, 9, 0, 0.1, 0.0),
        pleats(9, 9, 2, -0.1, 0.0),
        pleats(9, 9, 40, 0.1, 0.0),
        pleats(9, 9, 2, 0.1, f64::NAN),
    ] {
        assert!(matches!(bad, Err(Error::Parameter { .. })));
    }
}
