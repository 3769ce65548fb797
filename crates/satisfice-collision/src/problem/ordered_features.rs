//! The features of a body in their order, for any number of problems.

use std::sync::Arc;

use super::side::Side;
use crate::error::Error;
use crate::mesh::{FeatureKind, Mesh};
use crate::order::VertexOrder;

/// The features of one kind of a body, along a Hilbert curve, with the neighbours of each and the boxes around them. All
/// [problems](super::FeaturePairs::between_ordered) of a body can share them; cloning is cheap.
#[derive(Debug, Clone)]
pub struct OrderedFeatures {
    side: Arc<Side>,
    spacing: f64,
}

impl OrderedFeatures {
    /// Puts the features of one kind in order. Cost: O(n log n).
    ///
    /// # Errors
    /// [`Error::Parameter`] for a body without such a feature.
    pub fn new(mesh: &Mesh, kind: FeatureKind) -> Result<Self, Error> {
        let side = Side::new(mesh, kind, VertexOrder::default())?;
        Ok(Self {
            spacing: side.spacing(),
            side: Arc::new(side),
        })
    }

    /// The kind of the features.
    #[must_use]
    pub fn kind(&self) -> FeatureKind {
        self.side.kind
    }

    /// The body.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.side.mesh
    }

    pub(super) fn side(&self) -> &Arc<Side> {
        &self.side
    }

    /// The median length of the body's edges.
    pub(super) fn spacing(&self) -> f64 {
        self.spacing
    }
}
