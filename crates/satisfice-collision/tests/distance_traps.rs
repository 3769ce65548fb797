//! Traps with known answers, each of which some library gets wrong.
#![allow(clippy::unwrap_used, clippy::excessive_precision)]

mod stress;

use satisfice_collision::distance::{
    DecidedBy, Feature, PairKind, Threshold, edge_edge, triangle_triangle, vertex_edge, vertex_triangle,
    vertex_vertex,
};
use stress::referee::squared_distance;
use stress::{Point, decide, orders, proximity, sizes};

fn threshold(delta: f64) -> Threshold {
    Threshold::new(delta).unwrap()
}

#[test]
fn a_triangle_with_a_doubled_vertex_is_a_segment() {
    let f32s = |p: [f32; 3]| p.map(f64::from);
    let p = f32s([1.100_000_02, -7.900_000_1, 16.587_999_3]);
    let q = f32s([2.276_999_95, -7.900_000_1, 16.318_000_8]);
    let r = f32s([-0.569_999_993, -8.100_000_38, 16.607_000_4]);
    for t in orders(&[q, r, r]) {
        let t = [t[0], t[1], t[2]];
        let near = vertex_triangle::proximity(&p, &t);
        assert_eq!(near.distance, 0.171_478_326_754_061_22);
        assert!(!vertex_triangle::within(
            &p,
            &t,
            threshold(near.distance.next_down())
        ));
        assert!(vertex_triangle::within(
            &p,
            &t,
            threshold(near.distance.next_up())
        ));
    }
    assert_eq!(
        vertex_edge::proximity(&p, &[q, r]).distance,
        0.171_478_326_754_061_22
    );
}

#[test]
fn nearly_parallel_edges_keep_their_distance() {
    let a = [
        [2.235_209_282_240_780_3, -1.706_800_488_570_597_2, 0.0],
        [1.435_750_776_440_373_4, -4.418_812_812_904_743_5, 0.0],
    ];
    let b = [
        [1.851_532_387_737_966_6, -1.593_698_584_852_416_6, 0.0],
        [1.217_103_403_539_870_7, -3.745_879_356_682_980_9, 0.0],
    ];
    // By rational arithmetic 0.39999999999999981830..., between two doubles of which this one is nearer.
    assert_eq!(edge_edge::proximity(&a, &b).distance, 0.399_999_999_999_999_8);
    assert_eq!(edge_edge::proximity(&b, &a).distance, 0.399_999_999_999_999_8);
    assert!(edge_edge::within(&a, &b, threshold(0.4)));
}

#[test]
fn coplanar_overlapping_triangles_are_at_zero_in_all_orders() {
    let a: [Point; 3] = [[0.0, 0.0, 0.0], [0.0, 0.0, 8.0], [8.0, 0.0, 0.0]];
    let b: [Point; 3] = [[2.0, 0.0, 2.0], [1.0, 0.0, 4.0], [9.0, 0.0, 0.0]];
    let mut seen = 0;
    for p in orders(&a) {
        for q in orders(&b) {
            for (a, b) in [(&p, &q), (&q, &p)] {
                assert_eq!(proximity(PairKind::TriangleTriangle, a, b).distance, 0.0);
                assert!(decide(PairKind::TriangleTriangle, a, b, f64::from_bits(1)).within);
                seen += 1;
            }
        }
    }
    assert_eq!(seen, 72);
}

#[test]
fn thin_needle_and_point_triangles_agree_with_the_referee() {
    let triangles: [[Point; 3]; 6] = [
        [[0.0, 0.0, 0.0], [8000.0, 0.0, 0.0], [4000.0, 1.0, 0.0]],
        [[-1.0, 0.5, 3.0], [1.0, 0.5, 3.0], [0.0, 0.5 + 1e-9, 3.0]],
        [[2.0, 2.0, 2.0]; 3],
        [[1.0, 7.0, -3.0], [1.0, 7.0, -3.0], [4.0, -2.0, 9.0]],
        [[0.1, 0.1, 0.1], [0.2, 0.2, 0.2], [0.3, 0.3, 0.3]],
        [[3999.0, 0.25, 1e-3], [3999.5, 0.25, -1e-3], [4000.0, 0.5, 5.0]],
    ];
    // A whole scene scaled until squares underflow or overflow, or moved away from the origin.
    for scale in [1.0, 1e-10, 1e10, 1e-162, 1e150, 1e-305] {
        for offset in [0.0, 1e7] {
            for a in &triangles {
                for b in &triangles {
                    let place = |t: &[Point; 3]| t.map(|p| p.map(|x| (x + offset) * scale));
                    let (a, b) = (place(a), place(b));
                    for kind in PairKind::ALL {
                        let (m, n) = sizes(kind);
                        let truth = squared_distance(&a[..m], &b[..n]);
                        let near = proximity(kind, &a[..m], &b[..n]);
                        assert!(
                            truth.error_in_ulp(near.distance) <= 1.0,
                            "{kind} {a:?} {b:?} {near:?}"
                        );
                        for factor in [0.5, 1.0 - 1e-15, 1.0, 1.0 + 1e-15, 2.0] {
                            let delta = near.distance * factor;
                            if delta > 0.0 {
                                let within = decide(kind, &a[..m], &b[..n], delta).within;
                                assert_eq!(within, truth.is_below(delta), "{kind} {a:?} {b:?} {delta:e}");
                            }
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn the_threshold_is_strict() {
    let floor = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for height in [0.25, 0.1, 1e-7, 1e-200, 3e200] {
        let above = floor.map(|[x, y, _]| [x, y, height]);
        let at = triangle_triangle::decide(&floor, &above, threshold(height));
        assert!(!at.within && at.by == DecidedBy::Exact, "{at:?}");
        assert!(triangle_triangle::within(
            &floor,
            &above,
            threshold(height.next_up())
        ));
        assert!(!triangle_triangle::within(
            &floor,
            &above,
            threshold(height.next_down())
        ));
    }
    // 3-4-5 in integers: equality in a rounded square root as well.
    assert!(!vertex_vertex::within(
        &[0.0; 3],
        &[3.0, 4.0, 0.0],
        threshold(5.0)
    ));
}

#[test]
fn a_threshold_does_not_change_a_distance_below_it() {
    let floor = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let above = floor.map(|[x, y, _]| [x + 0.1, y + 0.1, 0.125]);
    for delta in [0.126, 1.0, 1e10, 1e300, f64::MAX] {
        assert!(
            triangle_triangle::within(&floor, &above, threshold(delta)),
            "{delta}"
        );
    }
    assert_eq!(triangle_triangle::proximity(&floor, &above).distance, 0.125);
}

#[test]
fn coordinates_up_to_the_largest_number_do_not_overflow() {
    let most = (f64::MAX / 2.0).next_down();
    let a = [[-most, -most, -most], [-most, most, -most], [most, -most, -most]];
    let b = a.map(|[x, y, _]| [x, y, most]);
    let near = triangle_triangle::proximity(&a, &b);
    assert_eq!(near.distance, 2.0 * most);
    assert!(!triangle_triangle::within(&a, &b, threshold(2.0 * most)));
    assert!(triangle_triangle::within(&a, &b, threshold(f64::MAX)));
    // Even differences that overflow are decided; only the distance itself cannot be represented.
    let corner = [f64::MAX; 3];
    assert!(!vertex_vertex::within(
        &corner,
        &corner.map(|x: f64| -x),
        threshold(f64::MAX)
    ));
    assert_eq!(
        vertex_vertex::proximity(&corner, &corner.map(|x: f64| -x)).distance,
        f64::INFINITY
    );
    assert!(vertex_vertex::within(
        &corner,
        &corner,
        threshold(f64::from_bits(1))
    ));
}

#[test]
fn what_is_not_finite_is_no_hit_and_says_so() {
    let t = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for vertex in 0..6 {
            for axis in 0..3 {
                let mut pair = [t, t];
                pair[vertex / 3][vertex % 3][axis] = bad;
                for kind in PairKind::ALL {
                    let (m, n) = sizes(kind);
                    if if vertex < 3 { vertex < m } else { vertex - 3 < n } {
                        let decision = decide(kind, &pair[0][..m], &pair[1][..n], 10.0);
                        assert!(!decision.within && decision.by == DecidedBy::NotFinite, "{kind}");
                        let near = proximity(kind, &pair[0][..m], &pair[1][..n]);
                        assert!(
                            near.distance.is_nan() && near.by == DecidedBy::NotFinite,
                            "{kind}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn closest_points_and_features_are_named() {
    let face = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
    let near = vertex_triangle::proximity(&[1.0, 1.0, 2.0], &face);
    assert_eq!((near.distance, near.point_b), (2.0, [1.0, 1.0, 0.0]));
    assert_eq!(
        (near.feature_a, near.feature_b),
        (Feature::Vertex(0), Feature::Face)
    );
    assert_eq!(near.weights_b, [0.5, 0.25, 0.25]);
    let near = vertex_triangle::proximity(&[3.0, 3.0, 0.0], &face);
    assert_eq!(
        (near.point_b, near.feature_b),
        ([2.0, 2.0, 0.0], Feature::Edge(1))
    );
    let near = vertex_triangle::proximity(&[-1.0, 5.0, 0.0], &face);
    assert_eq!(
        (near.point_b, near.feature_b),
        ([0.0, 4.0, 0.0], Feature::Vertex(2))
    );
    let near = edge_edge::proximity(
        &[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]],
        &[[0.0, -1.0, 3.0], [0.0, 1.0, 3.0]],
    );
    assert_eq!((near.point_a, near.point_b), ([0.0, 0.0, 0.0], [0.0, 0.0, 3.0]));
    assert_eq!(
        (near.feature_a, near.feature_b),
        (Feature::Edge(0), Feature::Edge(0))
    );
}
