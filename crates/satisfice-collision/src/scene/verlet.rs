//! Every pair of two bodies that was within the threshold plus a margin: complete until the bodies have used the margin up.
//!
//! Verlet 1967, doi 10.1103/PhysRev.159.98. The bounds of motion of both bodies are subtracted from the margin frame by frame.

use crate::broad::Pair;

/// A list and what is left of its margin.
pub(super) struct VerletList {
    /// The pairs within the wider threshold, sorted.
    pub(super) pairs: Vec<Pair>,
    margin: f64,
}

impl VerletList {
    pub(super) fn new(pairs: Vec<Pair>, margin: f64) -> Self {
        Self { pairs, margin }
    }

    /// One of the bodies has moved by at most `motion`.
    pub(super) fn spend(&mut self, motion: f64) {
        self.margin -= motion;
    }

    /// Whether the list is still complete.
    pub(super) fn holds(&self) -> bool {
        self.margin > 0.0
    }
}
