//! Work that was skipped, by reason.

/// Work that a query left out, counted by reason, in the order in which the reasons are tried.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Skips {
    /// Pairs of bodies (a body with itself included) that groups, masks or an exclusion keep from colliding.
    pub filtered_bodies: u64,
    /// Fixed and rigid bodies, whose features do not move relative to each other.
    pub rigid_self: u64,
    /// Pairs of bodies whose inflated boxes do not meet. Most of them are never visited.
    pub boxes_apart: u64,
    /// Pairs of bodies whose boxes meet, but neither of which has moved since their contacts were found.
    pub unmoved_bodies: u64,
    /// Vertices outside the overlap of two bodies.
    pub outside_overlap: u64,
    /// Vertices inside the overlap without a cell of the other body nearby.
    pub without_partner: u64,
    /// Pairs of features kept from the last frame because neither moved.
    pub unmoved_pairs: u64,
    /// Contacts of the last frame that still hold because their features were closer than the bodies have moved.
    pub held_by_motion: u64,
    /// Pairs of near features that are neighbours on the mesh.
    pub mesh_neighbours: u64,
    /// Pairs of near features with a vertex that the predicate of [`Body::with_vertices`](super::Body::with_vertices) refuses.
    pub filtered_vertices: u64,
}

impl Skips {
    /// Reasons and counts, in order.
    #[must_use]
    pub fn by_reason(&self) -> [(&'static str, u64); 10] {
        [
            ("body pairs filtered", self.filtered_bodies),
            ("self-pairs of rigid bodies", self.rigid_self),
            ("body pairs whose inflated boxes are apart", self.boxes_apart),
            ("body pairs that did not move", self.unmoved_bodies),
            ("vertices outside the overlap", self.outside_overlap),
            ("vertices without a partner nearby", self.without_partner),
            ("pairs that did not move", self.unmoved_pairs),
            ("contacts that hold by the bound of motion", self.held_by_motion),
            ("pairs of mesh neighbours", self.mesh_neighbours),
            ("pairs with a filtered vertex", self.filtered_vertices),
        ]
    }

    /// Adds the counts of a part of the work.
    pub(super) fn add(&mut self, other: &Self) {
        let Self {
            filtered_bodies,
            rigid_self,
            boxes_apart,
            unmoved_bodies,
            outside_overlap,
            without_partner,
            unmoved_pairs,
            held_by_motion,
            mesh_neighbours,
            filtered_vertices,
        } = other;
        self.filtered_bodies += filtered_bodies;
        self.rigid_self += rigid_self;
        self.boxes_apart += boxes_apart;
        self.unmoved_bodies += unmoved_bodies;
        self.outside_overlap += outside_overlap;
        self.without_partner += without_partner;
        self.unmoved_pairs += unmoved_pairs;
        self.held_by_motion += held_by_motion;
        self.mesh_neighbours += mesh_neighbours;
        self.filtered_vertices += filtered_vertices;
    }
}
