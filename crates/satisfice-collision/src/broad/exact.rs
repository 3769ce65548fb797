//! The exact decision for pairs of points that the fast filter leaves open.

use crate::distance::{Threshold, vertex_vertex};

/// Two bodies (or one twice) and the threshold.
pub(crate) struct ExactTest<'a> {
    pub(crate) a: &'a [[f64; 3]],
    pub(crate) b: &'a [[f64; 3]],
    pub(crate) threshold: Threshold,
}

impl ExactTest<'_> {
    /// Whether point `a` of the first and point `b` of the second body are closer than the threshold.
    #[inline(never)]
    #[cold]
    pub(crate) fn closer(&self, a: u32, b: u32) -> bool {
        vertex_vertex::within(&self.a[a as usize], &self.b[b as usize], self.threshold)
    }
}
