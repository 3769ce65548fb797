//! The shapes that the differences of two features span.
//!
//! A pair is as far apart as the origin is from the hull of the differences `a_i - b_j` (in the order `i N + j`): a point, a
//! segment, a triangle or a parallelogram, whose corners move along straight lines.

use super::nearest::{self, Nearest};
use crate::distance::Point;

/// A plane part `w + u x + v y` of a hull.
#[derive(Debug, Clone, Copy)]
pub(super) struct Face {
    /// The numbers of the corners `w`, `w + x` and `w + y`.
    pub(super) corners: [usize; 3],
    /// Whether `u` and `v` go up to 1 each, as in a parallelogram. In a triangle their sum does.
    pub(super) is_parallelogram: bool,
}

/// The edges and the face of a hull by the numbers of their corners.
#[derive(Debug, Clone, Copy)]
pub(super) struct Parts {
    pub(super) edges: &'static [[usize; 2]],
    pub(super) face: Option<Face>,
}

/// A hull with `K` corners.
pub(super) trait Hull<const K: usize> {
    const PARTS: Parts;

    /// An approximately nearest point to the origin, and a direction that may separate the hull from it.
    fn nearest(corners: &[Point; K]) -> Nearest;

    /// Whether the origin lies inside, seen along `axis`: cyclic pairs of corners on whose two-dimensional cross products
    /// the answer depends. Either all of them have one sign (a triangle), or the first two have different signs and the last
    /// two have different signs (a parallelogram).
    const SIDES: &'static [[usize; 2]] = &[];
}

/// Vertex and vertex.
pub(super) struct PointHull;

impl Hull<1> for PointHull {
    const PARTS: Parts = Parts {
        edges: &[],
        face: None,
    };

    #[inline(always)]
    fn nearest(corners: &[Point; 1]) -> Nearest {
        Nearest {
            point: corners[0],
            direction: corners[0],
        }
    }
}

/// Vertex and edge.
pub(super) struct SegmentHull;

impl Hull<2> for SegmentHull {
    const PARTS: Parts = Parts {
        edges: &[[0, 1]],
        face: None,
    };

    #[inline(always)]
    fn nearest(corners: &[Point; 2]) -> Nearest {
        nearest::segment(corners[0], corners[1])
    }
}

/// Vertex and triangle.
pub(super) struct TriangleHull;

impl Hull<3> for TriangleHull {
    const PARTS: Parts = Parts {
        edges: &[[0, 1], [1, 2], [2, 0]],
        face: Some(Face {
            corners: [0, 1, 2],
            is_parallelogram: false,
        }),
    };
    const SIDES: &'static [[usize; 2]] = &[[1, 2], [2, 0], [0, 1]];

    #[inline(always)]
    fn nearest(corners: &[Point; 3]) -> Nearest {
        nearest::triangle(corners)
    }
}

/// Edge and edge.
pub(super) struct ParallelogramHull;

impl Hull<4> for ParallelogramHull {
    const PARTS: Parts = Parts {
        edges: &[[0, 1], [2, 3], [0, 2], [1, 3]],
        face: Some(Face {
            corners: [0, 2, 1],
            is_parallelogram: true,
        }),
    };
    const SIDES: &'static [[usize; 2]] = &[[0, 1], [2, 3], [0, 2], [1, 3]];

    #[inline(always)]
    fn nearest(corners: &[Point; 4]) -> Nearest {
        nearest::parallelogram(corners)
    }
}
