//! The rivals, each by its own recipe: kiddo 6.3, parry3d 0.31 (`f32`) and parry3d-f64 0.31.

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;
use parry3d::partitioning::{Bvh, BvhBuildStrategy, BvhNode};

use crate::table::Pairs;

type Point = [f32; 3];

/// The coordinates rounded to `f32`, as both want them.
pub(crate) fn single(points: &[[f64; 3]]) -> Vec<Point> {
    let mut rounded = Vec::new();
    round(points, &mut rounded);
    rounded
}

/// The same in a list that is there already.
pub(crate) fn round(points: &[[f64; 3]], rounded: &mut Vec<Point>) {
    rounded.clear();
    rounded.extend(points.iter().map(|p| p.map(|c| c as f32)));
}

/// kiddo: one tree built, one query a point.
pub(crate) fn kiddo(a: &[Point], b: &[Point], r: f32) -> Pairs {
    let tree: ImmutableKdTree<f32, 3> = ImmutableKdTree::new_from_slice(b).expect("finite points");
    let mut pairs = Pairs::new();
    for (i, p) in a.iter().enumerate() {
        let near = tree
            .query(p)
            .within::<SquaredEuclidean<f32>>(r * r)
            .unsorted()
            .execute();
        pairs.extend(near.into_iter().map(|n| (i as u32, n.item)));
    }
    pairs
}

fn around(p: &Point, by: f32) -> Aabb {
    let (centre, by) = (Vector::new(p[0], p[1], p[2]), Vector::new(by, by, by));
    Aabb::new(centre - by, centre + by)
}

/// parry: a tree of points, inflated by `by`.
pub(crate) fn parry_tree(points: &[Point], by: f32) -> Bvh {
    Bvh::from_iter(
        BvhBuildStrategy::Binned,
        points.iter().map(|p| around(p, by)).enumerate(),
    )
}

fn near(p: &Point, q: &Point, r: f32) -> bool {
    (0..3).map(|k| (p[k] - q[k]) * (p[k] - q[k])).sum::<f32>() < r * r
}

/// parry: two trees traversed together, then filtered by distance.
pub(crate) fn parry_pairs(tree_a: &Bvh, tree_b: &Bvh, a: &[Point], b: &[Point], r: f32) -> Pairs {
    tree_a
        .leaf_pairs(tree_b, BvhNode::intersects)
        .filter(|&(i, j)| near(&a[i as usize], &b[j as usize], r))
        .collect()
}

/// parry: one tree moved to new points, refitted, and traversed against itself.
pub(crate) fn parry_refit(tree: &mut Bvh, points: &[Point], r: f32) -> Pairs {
    for (i, p) in points.iter().enumerate() {
        tree.insert_or_update_partially(around(p, r / 2.0), i as u32, 0.0);
    }
    tree.refit_without_opt();
    let mut pairs = Pairs::new();
    tree.traverse_bvtt_single_tree::<false>(&mut Default::default(), &mut |i, j| {
        if near(&points[i as usize], &points[j as usize], r) {
            pairs.push((i.min(j), i.max(j)));
        }
    });
    pairs
}

macro_rules! triangles {
    ($name:ident, $parry:ident, $real:ty) => {
        /// parry: trees of triangles built, candidates by their boxes, each decided by its distance. `b` is none for one body
        /// with itself, where triangles that share a vertex do not count.
        pub(crate) fn $name(
            a: &satisfice_collision::Mesh,
            b: Option<&satisfice_collision::Mesh>,
            r: f64,
        ) -> Pairs {
            use $parry::bounding_volume::{Aabb, BoundingVolume};
            use $parry::math::{Pose, Vector};
            use $parry::partitioning::{Bvh, BvhBuildStrategy, BvhNode};
            use $parry::shape::{Shape, Triangle};
            let shapes = |mesh: &satisfice_collision::Mesh| -> Vec<Triangle> {
                let corner = |p: [f64; 3]| Vector::new(p[0] as $real, p[1] as $real, p[2] as $real);
                (0..mesh.triangles().len())
                    .map(|t| {
                        let [p, q, r] = mesh.triangle(t).map(corner);
                        Triangle::new(p, q, r)
                    })
                    .collect()
            };
            let here = Pose::IDENTITY;
            let tree = |shapes: &[Triangle], by: f64| {
                let boxes = shapes
                    .iter()
                    .map(|t| -> Aabb { t.compute_aabb(&here).loosened(by as $real) });
                Bvh::from_iter(BvhBuildStrategy::Binned, boxes.enumerate())
            };
            let within = |p: &Triangle, q: &Triangle| {
                let distance = $parry::query::distance(&here, p, &here, q)
                    .expect("two triangles")
                    .distance;
                f64::from(distance) < r
            };
            let of_a = shapes(a);
            let mut pairs = Pairs::new();
            if let Some(b) = b {
                let of_b = shapes(b);
                let (tree_a, tree_b) = (tree(&of_a, r), tree(&of_b, 0.0));
                for (i, j) in tree_a.leaf_pairs(&tree_b, BvhNode::intersects) {
                    if within(&of_a[i as usize], &of_b[j as usize]) {
                        pairs.push((i, j));
                    }
                }
            } else {
                let one = tree(&of_a, r / 2.0);
                let corners = a.triangles();
                one.traverse_bvtt_single_tree::<false>(&mut Default::default(), &mut |i, j| {
                    let apart = !corners[i as usize]
                        .iter()
                        .any(|v| corners[j as usize].contains(v));
                    if apart && within(&of_a[i as usize], &of_a[j as usize]) {
                        pairs.push((i.min(j), i.max(j)));
                    }
                });
            }
            pairs
        }
    };
}

triangles!(parry_triangles_f32, parry3d, f32);
triangles!(parry_triangles_f64, parry3d_f64, f64);
