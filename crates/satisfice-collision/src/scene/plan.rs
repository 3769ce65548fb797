//! The one place that chooses how the pairs of two bodies are found. No choice changes an answer.

use super::pairs::Status;
use crate::broad::Method;

/// How the pairs of two bodies, or of one with itself, are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Plan {
    /// Nothing moved: the known pairs are the answer.
    Unchanged,
    /// The boxes are apart: there are no pairs.
    Apart,
    /// Trees are descended.
    Tree,
    /// A new grid; vertices only.
    Grid,
    /// Every pair is decided.
    All,
}

/// Everything that a plan depends on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Situation {
    /// The method that the user asked for.
    pub(super) method: Method,
    pub(super) status: Status,
    pub(super) is_one_body: bool,
    /// Whether the boxes are apart.
    pub(super) is_apart: bool,
    /// Whether both features are vertices.
    pub(super) is_points: bool,
    /// Whether both trees exist or are shared, so that building them pays at once.
    pub(super) trees_pay: bool,
    /// The greatest share of vertices of a body that moved one by one.
    pub(super) moved_share: f64,
    /// Frames in a row in which a new grid found fewer pairs than there are vertices.
    pub(super) sparse: i16,
}

/// From this share of moved vertices on, a new grid beats a tree that has to be refitted for it.
const MOST_MOVED: f64 = 0.3;
/// After so many frames in which a new grid found few pairs, a tree is built.
pub(super) const SPARSE: i16 = 3;

impl Situation {
    pub(super) fn plan(&self) -> Plan {
        if self.status == Status::Current {
            return Plan::Unchanged;
        }
        if self.is_apart {
            return Plan::Apart;
        }
        match self.method {
            Method::BruteForce => Plan::All,
            Method::Grid if self.is_points => Plan::Grid,
            Method::Auto if self.is_points && self.prefers_grid() => Plan::Grid,
            Method::Grid | Method::Tree | Method::Auto => Plan::Tree,
        }
    }

    fn prefers_grid(&self) -> bool {
        if self.is_one_body && self.sparse >= SPARSE {
            return false;
        }
        (self.status == Status::New && !self.trees_pay) || self.moved_share > MOST_MOVED
    }
}
