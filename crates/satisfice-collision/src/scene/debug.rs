//! Worlds, bodies and passes in one line, without their meshes.

use std::fmt;

use super::{Body, Pass, World};
use crate::Mesh;

/// A mesh by its counts.
struct Counts<'m>(&'m Mesh);

impl fmt::Debug for Counts<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [vertices, edges, triangles] = [
            self.0.vertices().len(),
            self.0.lines().len(),
            self.0.triangles().len(),
        ];
        write!(f, "{vertices} vertices, {edges} lines, {triangles} triangles")
    }
}

impl fmt::Debug for Body {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Body")
            .field("motion", &self.motion)
            .field("mesh", &Counts(self.mesh.mesh()))
            .field("placement", &self.placement)
            .field("groups", &self.groups)
            .field("mask", &self.mask)
            .finish_non_exhaustive()
    }
}

impl fmt::Debug for World {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("World")
            .field("kind", &self.kind)
            .field("threshold", &self.threshold)
            .field("bodies", &self.len())
            .field("kept_pairs", &self.kept_pairs())
            .finish_non_exhaustive()
    }
}

impl fmt::Debug for Pass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Pass")
            .field("found", &self.found())
            .field("completeness", &self.completeness())
            .field("skips", &self.skips())
            .finish_non_exhaustive()
    }
}
