//! Worlds: bodies that move from frame to frame, and which of their features are within a threshold. Exact, and lazy: the cost
//! of a frame depends on what moved in it, not on how many bodies there are.
//!
//! ```
//! use satisfice_collision::distance::{PairKind, Threshold};
//! use satisfice_collision::scene::{Body, World};
//! use satisfice_collision::{Placement, generate};
//! let mut world = World::new(PairKind::TriangleTriangle, Threshold::new(0.01)?);
//! let table = world.add(Body::fixed(generate::torus(1.0, 0.3, 24, 12)?))?;
//! let ball = world.add(Body::rigid(generate::icosphere(0.5, 2)?))?;
//! world.place(ball, Placement::from_translation([0.5, 0.0, 0.4])?)?;
//! world.update()?;
//! assert!(world.contacts().count() > 0);
//! assert!(world.contacts().all(|contact| contact.bodies() == (table, ball)));
//! world.place(ball, Placement::from_translation([0.0, 0.0, 5.0])?)?;
//! let update = world.update()?;
//! assert!(world.contacts().count() == 0 && update.skips.boxes_apart == 1);
//! assert!(world.changes().all(|change| change.kind == satisfice_collision::scene::ChangeKind::Ended));
//! # Ok::<(), satisfice_collision::Error>(())
//! ```

mod ahead;
mod body;
mod body_tree;
mod changes;
mod contact;
mod count;
mod debug;
mod deforming;
mod extent;
mod filter;
mod lent;
mod measure;
mod membership;
mod movers;
mod narrow;
mod outdated;
mod pairs;
mod pass;
mod plan;
mod query;
mod settle;
mod shared_mesh;
mod skips;
mod slack;
mod state;
mod update;
mod whereabouts;

#[cfg(test)]
mod tests;

pub use body::{Body, BodyId, Motion};
pub use changes::{BodyChange, Change, ChangeKind};
pub use contact::{Completeness, Contact, Frame, Update};
pub use pass::Pass;
pub use query::{NearestFeature, RayHit};
pub use shared_mesh::SharedMesh;
pub use skips::Skips;

use std::sync::atomic::{AtomicU64, Ordering};

use crate::broad::{Box32, Method, Pair};
use crate::distance::{self, PairKind, Proximity, Threshold};
use crate::{Aabb, CompactPlacement, Error, FeatureKind, Placement};
use body_tree::BodyTree;
use changes::Log;
use membership::Membership;
use movers::Movers;
use narrow::Workspace;
use pairs::{Record, Records};
use state::{Present, State};
use whereabouts::{Room, Whereabouts};

/// How many worlds there have been.
static WORLDS: AtomicU64 = AtomicU64::new(0);

/// Bodies, a kind of feature pair and a threshold.
///
/// Changes of bodies take effect at the next query: [`World::update`] brings the contacts up to date, and costs nothing for what
/// did not change. Other questions, such as [`World::touching`] and [`World::distance`], take in the changes, too, but do not look for
/// all contacts: until the next update [`World::contacts`] may then leave out contacts of bodies that changed. Those that it lists are true,
/// and of two bodies that did not change it lists all.
///
/// ```
/// use satisfice_collision::scene::{Body, SharedMesh, World};
/// use satisfice_collision::{Placement, distance::{PairKind, Threshold}, generate};
/// let ball = SharedMesh::from(generate::icosphere(1.0, 2)?);
/// let mut world = World::new(PairKind::TriangleTriangle, Threshold::new(0.1)?);
/// world.add(Body::fixed(ball.clone()))?;
/// let moving = world.add(Body::rigid(ball))?;
/// world.place(moving, Placement::from_translation([3.0, 0.0, 0.0])?)?;
/// world.update()?;
/// assert_eq!(world.contacts().count(), 0);
/// world.place(moving, Placement::from_translation([2.05, 0.0, 0.0])?)?;
/// world.update()?;
/// assert!(world.contacts().count() > 0);
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
pub struct World {
    kind: PairKind,
    threshold: Threshold,
    method: Method,
    parallel: bool,
    /// By slot; `None` where a body was removed.
    states: Vec<Option<State>>,
    /// By slot, those of removed bodies too.
    whereabouts: Vec<Whereabouts>,
    /// By slot, where rigid bodies may go without leaving their boxes in the tree.
    rooms: Vec<Room>,
    /// By slot, the boxes of fixed and rigid bodies in their own coordinates; empty where there is none, or `f32` is too coarse.
    hulls: Vec<Box32>,
    /// The generations of the next bodies in free slots, and these slots.
    free: Vec<BodyId>,
    membership: Membership,
    tree: BodyTree,
    pairs: Records,
    /// What moves in the next frame.
    movers: Movers,
    /// Bodies whose partners must be found again; some may have been removed since, or be listed twice.
    unpaired: Vec<u32>,
    /// Records to examine.
    dirty: Vec<u32>,
    /// Whether one of them may have been removed since, or be listed twice.
    has_removed_dirty: bool,
    /// Whether one of them may have contacts of this frame or the last one.
    has_known_dirty: bool,
    /// Tells worlds apart, for their passes.
    number: u64,
    /// Counts the frames in which something changed.
    frame: u64,
    /// The frame before the first one whose movers are not marked in their records yet.
    unmarked_since: Option<u64>,
    /// Whether contacts are measured between frames, which needs to know where bodies came from.
    predicts: bool,
    /// Where the bodies that moved in this frame came from; empty unless `predicts`. Some may have been removed since.
    came_from: Vec<(BodyId, CompactPlacement)>,
    /// Counts the changes of the known contacts: each ends the passes that began before.
    answers: u64,
    log: Log,
    workspaces: Vec<Workspace>,
}

/// Refuses a feature that a body does not have.
#[inline]
fn exists(state: &State, kind: FeatureKind, feature: u32) -> Result<(), Error> {
    if (feature as usize) < state.count(kind) {
        return Ok(());
    }
    Err(Error::parameter(
        "feature",
        feature,
        "a number of a feature of its body",
    ))
}

/// There is no such body.
#[cold]
fn unknown(body: BodyId) -> Error {
    Error::parameter(
        "body",
        body,
        "there is no such body; it was removed, or the handle is from another world",
    )
}

/// Pushes to a list that grows by an eighth, so that little of its room is empty.
fn push<T>(list: &mut Vec<T>, item: T) {
    if list.len() == list.capacity() {
        list.reserve_exact(list.len() / 8 + 4);
    }
    list.push(item);
}

impl World {
    /// An empty world.
    #[must_use]
    pub fn new(kind: PairKind, threshold: Threshold) -> Self {
        Self {
            kind,
            threshold,
            method: Method::Auto,
            parallel: false,
            states: Vec::new(),
            whereabouts: Vec::new(),
            rooms: Vec::new(),
            hulls: Vec::new(),
            free: Vec::new(),
            membership: Membership::default(),
            tree: BodyTree::default(),
            pairs: Records::default(),
            movers: Movers::default(),
            unpaired: Vec::new(),
            dirty: Vec::new(),
            has_removed_dirty: false,
            has_known_dirty: false,
            number: WORLDS.fetch_add(1, Ordering::Relaxed),
            frame: 0,
            unmarked_since: None,
            predicts: false,
            came_from: Vec::new(),
            answers: 0,
            log: Log::default(),
            workspaces: vec![Workspace::new(false)],
        }
    }

    /// Uses this method for all pairs of bodies. Default: [`Method::Auto`], the planner's choice. No method changes an answer.
    #[must_use]
    pub fn with_method(mut self, method: Method) -> Self {
        self.method = method;
        self
    }

    /// Works on the current rayon pool. Default: on the calling thread alone. The answers are the same.
    #[must_use]
    pub fn parallel(mut self) -> Self {
        self.parallel = true;
        self.workspaces = vec![Workspace::new(true)];
        self
    }

    /// The kind of feature pair that the world looks for.
    #[must_use]
    pub fn kind(&self) -> PairKind {
        self.kind
    }

    /// The kinds of the two features of a pair.
    #[must_use]
    pub fn feature_kinds(&self) -> (FeatureKind, FeatureKind) {
        self.kind.features()
    }

    /// The threshold of the last or the next frame.
    #[must_use]
    pub fn threshold(&self) -> Threshold {
        self.threshold
    }

    /// How many bodies there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.states.len() - self.free.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The bodies, by index.
    pub fn bodies(&self) -> impl Iterator<Item = BodyId> {
        let states = (0..).zip(self.states.iter().zip(&self.whereabouts));
        states.filter_map(|(slot, (state, whereabouts))| {
            state.as_ref().map(|_| BodyId {
                slot,
                generation: whereabouts.generation,
            })
        })
    }

    /// Whether a handle names a body of this world.
    #[must_use]
    pub fn contains(&self, body: BodyId) -> bool {
        self.known(body).is_ok()
    }

    /// The mesh of a body, as it was added or replaced.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is no such body.
    pub fn mesh(&self, body: BodyId) -> Result<&SharedMesh, Error> {
        Ok(&self.known(body)?.state().mesh)
    }

    /// The placement of a body in the last frame; the identity for a deforming body.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is no such body.
    pub fn placement(&self, body: BodyId) -> Result<Placement, Error> {
        Ok(self.known(body)?.placement())
    }

    /// A box that holds a body in the last frame, at most a few roundings wider than its posed box.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is no such body.
    pub fn bounds(&self, body: BodyId) -> Result<Aabb, Error> {
        Ok(self.known(body)?.bounds())
    }

    /// Bytes held beside the meshes and their trees.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let elsewhere = self.states.iter().flatten().map(State::bytes);
        self.states.capacity() * size_of::<Option<State>>()
            + elsewhere.sum::<usize>()
            + self.rooms.capacity() * size_of::<Room>()
            + self.whereabouts.capacity() * size_of::<Whereabouts>()
            + self.hulls.capacity() * size_of::<Box32>()
            + self.tree.bytes()
            + self.pairs.bytes()
            + (self.unpaired.capacity() + self.dirty.capacity()) * 4
            + self.movers.bytes()
            + self.came_from.capacity() * size_of::<(BodyId, CompactPlacement)>()
    }

    /// How many pairs of bodies are kept because their boxes meet, or nearly.
    #[must_use]
    pub fn kept_pairs(&self) -> usize {
        self.pairs.len()
    }

    /// Distance and closest points of a contact, or of any pair of features, in the last frame.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a body or a feature does not exist.
    pub fn proximity(&self, contact: Contact) -> Result<Proximity, Error> {
        for (body, kind, feature) in self.sides(contact) {
            let known = self.known(body)?;
            exists(&known, kind, feature)?;
        }
        Ok(self.proximity_of(
            [contact.body_a.slot, contact.body_b.slot],
            Pair {
                a: contact.a,
                b: contact.b,
            },
        ))
    }

    /// Appends the distances of contacts, or of any pairs of features, in the last frame: those of their [proximities](Self::proximity), faster.
    ///
    /// # Errors
    /// As [`World::proximity`]; then the distances before the first contact that does not exist have been appended.
    pub fn contact_distances(&self, contacts: &[Contact], distances: &mut Vec<f64>) -> Result<(), Error> {
        for run in contacts.chunk_by(|one, next| (one.body_a, one.body_b) == (next.body_a, next.body_b)) {
            let [(body_a, kind_a, _), (body_b, kind_b, _)] = self.sides(run[0]);
            let (a, b) = (self.known(body_a)?, self.known(body_b)?);
            for contact in run {
                exists(&a, kind_a, contact.a)?;
                exists(&b, kind_b, contact.b)?;
                distances.push(distance::distance(
                    &a.shape(kind_a, contact.a),
                    &b.shape(kind_b, contact.b),
                ));
            }
        }
        Ok(())
    }

    /// Body, kind and number of both features.
    fn sides(&self, contact: Contact) -> [(BodyId, FeatureKind, u32); 2] {
        let (kind_a, kind_b) = self.feature_kinds();
        [
            (contact.body_a, kind_a, contact.a),
            (contact.body_b, kind_b, contact.b),
        ]
    }

    /// Distance and closest points; the features exist.
    fn proximity_of(&self, [a, b]: [u32; 2], Pair { a: i, b: j }: Pair) -> Proximity {
        let (kind_a, kind_b) = self.kind.features();
        let (a, b) = (self.state(a), self.state(b));
        distance::proximity(&a.shape(kind_a, i), &b.shape(kind_b, j))
    }

    /// The body that a handle names.
    fn known(&self, body: BodyId) -> Result<Present<'_>, Error> {
        let slot = body.slot as usize;
        match (self.states.get(slot), self.whereabouts.get(slot)) {
            (Some(Some(state)), Some(whereabouts)) if whereabouts.generation == body.generation => {
                Ok(state.at(whereabouts, self.frame))
            }
            _ => Err(unknown(body)),
        }
    }

    /// The body in a slot that is known to hold one.
    #[inline]
    #[expect(
        clippy::expect_used,
        reason = "records, lists and the tree name only slots with a body"
    )]
    fn state(&self, slot: u32) -> Present<'_> {
        let state = self.states[slot as usize].as_ref().expect("a body in its slot");
        state.at(&self.whereabouts[slot as usize], self.frame)
    }

    #[expect(clippy::expect_used, reason = "as `state`")]
    fn state_mut(&mut self, slot: u32) -> &mut State {
        self.states[slot as usize].as_mut().expect("a body in its slot")
    }

    fn id(&self, slot: u32) -> BodyId {
        BodyId {
            slot,
            generation: self.whereabouts[slot as usize].generation,
        }
    }

    /// How far no vertex of a body moved in the present frame.
    fn motion_of(&self, slot: u32) -> f64 {
        let state = self.state(slot);
        if state.moved_at() == self.frame {
            state.motion
        } else {
            0.0
        }
    }

    fn contact(&self, record: &Record, pair: Pair) -> Contact {
        let [a, b] = record.bodies;
        Contact {
            body_a: self.id(a),
            body_b: self.id(b),
            a: pair.a,
            b: pair.b,
        }
    }
}
