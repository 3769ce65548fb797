//! The kinds of feature pairs, as a value and as types for generic code.

use std::fmt;
use std::str::FromStr;

use super::{Decision, Proximity, Threshold};
use crate::Error;
use crate::mesh::FeatureKind;

/// A kind of pair of features.
///
/// ```
/// use satisfice_collision::{FeatureKind, distance::PairKind};
/// let kind: PairKind = "vertex-triangle".parse()?;
/// assert_eq!(kind.features(), (FeatureKind::Vertex, FeatureKind::Triangle));
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum PairKind {
    /// Point against point.
    VertexVertex,
    /// Point against segment.
    VertexEdge,
    /// Point against triangle.
    VertexTriangle,
    /// Segment against segment.
    EdgeEdge,
    /// Segment against triangle.
    EdgeTriangle,
    /// Triangle against triangle.
    TriangleTriangle,
}

impl PairKind {
    /// Every kind, from the smallest features to the largest.
    pub const ALL: [Self; 6] = [
        Self::VertexVertex,
        Self::VertexEdge,
        Self::VertexTriangle,
        Self::EdgeEdge,
        Self::EdgeTriangle,
        Self::TriangleTriangle,
    ];

    /// The kinds of the first and the second feature.
    #[must_use]
    pub const fn features(self) -> (FeatureKind, FeatureKind) {
        match self {
            Self::VertexVertex => (FeatureKind::Vertex, FeatureKind::Vertex),
            Self::VertexEdge => (FeatureKind::Vertex, FeatureKind::Edge),
            Self::VertexTriangle => (FeatureKind::Vertex, FeatureKind::Triangle),
            Self::EdgeEdge => (FeatureKind::Edge, FeatureKind::Edge),
            Self::EdgeTriangle => (FeatureKind::Edge, FeatureKind::Triangle),
            Self::TriangleTriangle => (FeatureKind::Triangle, FeatureKind::Triangle),
        }
    }

    /// The name used on the command line, for example `vertex-triangle`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::VertexVertex => "vertex-vertex",
            Self::VertexEdge => "vertex-edge",
            Self::VertexTriangle => "vertex-triangle",
            Self::EdgeEdge => "edge-edge",
            Self::EdgeTriangle => "edge-triangle",
            Self::TriangleTriangle => "triangle-triangle",
        }
    }
}

impl fmt::Display for PairKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for PairKind {
    type Err = Error;

    fn from_str(name: &str) -> Result<Self, Error> {
        Self::ALL.into_iter().find(|kind| kind.name() == name).ok_or_else(|| {
            Error::parameter(
                "pairs",
                name,
                "vertex-vertex, vertex-edge, vertex-triangle, edge-edge, edge-triangle or triangle-triangle",
            )
        })
    }
}

/// A kind of feature pair as a type, for code that is generic over it.
pub trait FeaturePair {
    /// The first feature: `Point`, `Segment` or `Triangle`.
    type A: Copy;
    /// The second feature.
    type B: Copy;
    /// The kind as a value.
    const KIND: PairKind;

    /// Whether the distance is below the threshold, and the stage that proved it.
    fn decide(a: &Self::A, b: &Self::B, threshold: Threshold) -> Decision;

    /// Distance and closest points.
    fn proximity(a: &Self::A, b: &Self::B) -> Proximity;

    /// The distance of the proximity.
    #[inline]
    fn distance(a: &Self::A, b: &Self::B) -> f64 {
        Self::proximity(a, b).distance
    }

    /// The distance within a relative error of [`ACCURACY`](super::ACCURACY), faster than a proximity.
    fn measure(a: &Self::A, b: &Self::B) -> f64;

    /// Whether the distance is below the threshold; `false` if a coordinate is not finite.
    #[inline]
    fn within(a: &Self::A, b: &Self::B, threshold: Threshold) -> bool {
        Self::decide(a, b, threshold).within
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn names_come_back_and_unknown_ones_are_refused() {
        for kind in PairKind::ALL {
            assert_eq!(kind.to_string().parse::<PairKind>().unwrap(), kind);
        }
        assert!(
            "triangles"
                .parse::<PairKind>()
                .unwrap_err()
                .to_string()
                .contains("triangle-triangle")
        );
    }
}
