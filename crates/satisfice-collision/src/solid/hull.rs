//! The convex hull of points that come one by one, with facets by their distance from the origin.

use crate::distance::Point;
use crate::distance::orientation::side_of_plane;

/// A triangle of the hull.
#[derive(Debug, Clone, Copy)]
pub(super) struct Facet {
    /// Counter-clockwise as seen from outside.
    corners: [u32; 3],
    /// Outwards, of length 1.
    pub(super) normal: Point,
    /// The height of its plane above the origin, negative if the origin lies outside.
    pub(super) offset: f64,
}

/// Which facets a point sees is decided exactly, so that rounding never tears the surface.
#[derive(Debug)]
pub(super) struct ConvexHull {
    points: Vec<Point>,
    facets: Vec<Facet>,
}

impl ConvexHull {
    /// Of four points; `None` if they lie in a plane.
    pub(super) fn new(points: [Point; 4]) -> Option<Self> {
        let mut hull = Self {
            points: points.to_vec(),
            facets: Vec::new(),
        };
        for [a, b, c, apex] in [[0, 1, 2, 3], [0, 1, 3, 2], [0, 2, 3, 1], [1, 2, 3, 0]] {
            let corners = [a, b, c].map(|v: usize| points[v]);
            match side_of_plane(corners, points[apex]) {
                0 => return None,
                1 => hull.add([a as u32, b as u32, c as u32]),
                _ => hull.add([a as u32, c as u32, b as u32]),
            }
        }
        Some(hull)
    }

    fn add(&mut self, corners: [u32; 3]) {
        let [a, b, c] = corners.map(|v| self.points[v as usize]);
        let (x, y) = (sub(b, a), sub(c, a));
        let normal = cross(x, y);
        let length = dot(normal, normal).sqrt();
        let normal = normal.map(|c| c / length);
        // Of three heights that agree but for rounding, the least.
        let offset = [a, b, c].map(|p| dot(normal, p));
        self.facets.push(Facet {
            corners,
            normal,
            offset: offset[0].min(offset[1]).min(offset[2]),
        });
    }

    /// The facet whose plane is closest to the origin.
    pub(super) fn closest(&self) -> Option<Facet> {
        let sound = self.facets.iter().filter(|facet| facet.offset.is_finite());
        sound
            .min_by(|one, two| one.offset.total_cmp(&two.offset))
            .copied()
    }

    /// Adds a point. `false` if it is a corner already, or lies inside.
    pub(super) fn insert(&mut self, point: Point) -> bool {
        if self.points.contains(&point) {
            return false;
        }
        let new = self.points.len() as u32;
        // Facets in one plane with the point go as well, so that no new facet is without area.
        let (seen, kept): (Vec<Facet>, Vec<Facet>) = self
            .facets
            .iter()
            .partition(|facet| side_of_plane(facet.corners.map(|v| self.points[v as usize]), point) <= 0);
        let sees_outside =
            |facet: &Facet| side_of_plane(facet.corners.map(|v| self.points[v as usize]), point) < 0;
        if kept.is_empty() || !seen.iter().any(sees_outside) {
            return false;
        }
        let mut sides: Vec<[u32; 2]> = seen
            .iter()
            .flat_map(|facet| {
                let [a, b, c] = facet.corners;
                [[a, b], [b, c], [c, a]]
            })
            .collect();
        sides.sort_unstable();
        let is_rim = |&[a, b]: &[u32; 2]| sides.binary_search(&[b, a]).is_err();
        let rim: Vec<[u32; 2]> = sides.iter().copied().filter(is_rim).collect();
        self.points.push(point);
        self.facets = kept;
        for [a, b] in rim {
            self.add([a, b, new]);
        }
        true
    }
}

pub(super) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn cross(a: Point, b: Point) -> Point {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}
