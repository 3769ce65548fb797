//! What was not done, and why.

/// Work that a query left out, counted by reason, in the order in which the reasons are tried.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Skips {
    /// Pairs of bodies (a body with itself included) that groups, masks or an exclusion keep from colliding.
    pub filtered_bodies: u64,
    /// Fixed and rigid bodies, whose features do not move among themselves.
    pub rigid_self: u64,
    /// Pairs of bodies of which neither moved since the last frame.
    pub unmoved_bodies: u64,
    /// Pairs of bodies whose inflated boxes do not meet.
    pub boxes_apart: u64,
    /// Pairs of bodies whose list from an earlier frame, made with a margin, still held.
    pub skin_lists: u64,
    /// Vertices outside the overlap of two bodies.
    pub outside_overlap: u64,
    /// Vertices inside the overlap without a cell of the other body nearby.
    pub without_partner: u64,
    /// Pairs of features kept from the last frame because neither moved.
    pub unmoved_pairs: u64,
    /// Contacts of the last frame that still hold, as the bodies' motion alone says: they were closer than it is long, or their
    /// then closest points are near enough still.
    pub held_by_motion: u64,
    /// Pairs of near features that are neighbours on the mesh.
    pub mesh_neighbours: u64,
    /// Pairs of near features with a vertex that the predicate leaves out.
    pub filtered_vertices: u64,
}

impl Skips {
    /// Reasons and counts, in order.
    #[must_use]
    pub fn by_reason(&self) -> [(&'static str, u64); 11] {
        [
            ("body pairs filtered", self.filtered_bodies),
            ("self-pairs of rigid bodies", self.rigid_self),
            ("body pairs that did not move", self.unmoved_bodies),
            ("body pairs whose inflated boxes are apart", self.boxes_apart),
            ("body pairs answered from a list with a margin", self.skin_lists),
            ("vertices outside the overlap", self.outside_overlap),
            ("vertices without a partner nearby", self.without_partner),
            ("pairs that did not move", self.unmoved_pairs),
            ("contacts that hold by the bound of motion", self.held_by_motion),
            ("pairs of mesh neighbours", self.mesh_neighbours),
            ("pairs with a filtered vertex", self.filtered_vertices),
        ]
    }
}
