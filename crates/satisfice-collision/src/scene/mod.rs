//! Scenes: bodies that move from frame to frame, and which of their features are within a threshold. Exact, and lazy: what
//! cannot have changed or cannot matter is skipped, and every skip is counted.
//!
//! ```
//! use satisfice_collision::distance::{PairKind, Threshold};
//! use satisfice_collision::scene::{Body, Scene};
//! use satisfice_collision::{Placement, generate};
//! let mut scene = Scene::new(PairKind::TriangleTriangle, Threshold::new(0.01)?);
//! let table = scene.add(Body::fixed(generate::torus(1.0, 0.3, 24, 12)?));
//! let ball = scene.add(Body::rigid(generate::icosphere(0.5, 2)?));
//! scene.place(ball, Placement::from_translation([0.0, 0.0, 0.4])?)?;
//! let frame = scene.contacts()?;
//! assert!(frame.contacts.iter().all(|contact| (contact.body_a, contact.body_b) == (table, ball)));
//! scene.place(ball, Placement::from_translation([0.0, 0.0, 5.0])?)?;
//! let frame = scene.contacts()?;
//! assert!(frame.contacts.is_empty() && frame.skips.boxes_apart == 1);
//! # Ok::<(), satisfice_collision::Error>(())
//! ```

mod body;
mod forecast;
mod kept;
mod link;
mod measured;
mod near;
mod pass;
mod query;
mod skips;
mod state;

#[cfg(test)]
mod tests;

pub use body::{Body, Motion};
pub use pass::Pass;
pub use skips::Skips;

use std::collections::BTreeSet;

use crate::broad::{Found, Method, PointGrid, Sorter, TreeJoin, Watch};
use crate::distance::{PairKind, Point, Proximity, Threshold};
use crate::{Error, Placement};
use link::Link;
use state::State;

/// Two features within the threshold. Ordered by bodies, then by features.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Contact {
    /// Body of the first feature. For pairs of equal features the lower number.
    pub body_a: usize,
    /// Body of the second feature.
    pub body_b: usize,
    /// The first feature: a vertex, edge or triangle by its number in its mesh.
    pub a: u32,
    /// The second feature. Inside one body, for pairs of equal features, the higher number.
    pub b: u32,
}

impl Contact {
    /// The numbers of the two bodies, the lower one first.
    #[must_use]
    pub fn bodies(&self) -> (usize, usize) {
        (self.body_a.min(self.body_b), self.body_a.max(self.body_b))
    }
}

/// How complete an answer is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Completeness {
    /// Every pair was decided or excluded by bounds: there are no others.
    Proved,
    /// The budget ended first.
    Unknown,
}

/// The answer for one frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame {
    /// The contacts, sorted.
    pub contacts: Vec<Contact>,
    /// Whether there can be others.
    pub completeness: Completeness,
    /// What was skipped, and why.
    pub skips: Skips,
}

/// Bodies, a kind of feature pair and a threshold.
pub struct Scene {
    kind: PairKind,
    threshold: Threshold,
    method: Method,
    states: Vec<State>,
    excluded: BTreeSet<(usize, usize)>,
    links: Vec<Link>,
    linked: bool,
    filtered: u64,
    /// Counts frames; moves only if something did.
    frame: u64,
    grid: PointGrid,
    join: TreeJoin,
    parallel: bool,
    /// What the next pass may deliver first, in its order...
    laid_out: Vec<Contact>,
    /// ...of which bodies, and in which frame they were measured.
    laid_out_of: Option<(usize, usize, u64)>,
    /// Counts what changes the known pairs within a frame: a pass that began before is of no more use.
    answers: u64,
    /// For sorting.
    found: Found,
    sorter: Sorter,
}

impl Scene {
    /// An empty scene.
    #[must_use]
    pub fn new(kind: PairKind, threshold: Threshold) -> Self {
        Self {
            kind,
            threshold,
            method: Method::Auto,
            states: Vec::new(),
            excluded: BTreeSet::new(),
            links: Vec::new(),
            linked: false,
            filtered: 0,
            frame: 0,
            grid: PointGrid::new(),
            join: TreeJoin::new(),
            parallel: false,
            laid_out: Vec::new(),
            laid_out_of: None,
            answers: 0,
            found: Found::default(),
            sorter: Sorter::default(),
        }
    }

    /// Uses this method instead of what the cost model chooses. No method changes an answer.
    #[must_use]
    pub fn with_method(mut self, method: Method) -> Self {
        self.method = method;
        self
    }

    /// Works on the current rayon pool. The answers are the same.
    #[must_use]
    pub fn parallel(mut self) -> Self {
        self.grid = PointGrid::parallel();
        self.join = TreeJoin::parallel();
        self.parallel = true;
        self
    }

    /// Adds a body; returns its number.
    pub fn add(&mut self, body: Body) -> usize {
        self.states.push(State::new(body));
        self.linked = false;
        self.states.len() - 1
    }

    /// Keeps two bodies (or one and itself) from colliding.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a body does not exist.
    pub fn exclude(&mut self, a: usize, b: usize) -> Result<(), Error> {
        self.known(a)?;
        self.known(b)?;
        self.excluded.insert((a.min(b), a.max(b)));
        self.linked = false;
        Ok(())
    }

    /// Puts a rigid body somewhere for the next frame.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the body does not exist or is not rigid; [`Error::NonFiniteVertex`] if a vertex would leave the
    /// range of numbers. The scene is then as before.
    pub fn place(&mut self, body: usize, placement: Placement) -> Result<(), Error> {
        self.known(body)?;
        self.states[body].place(placement)
    }

    /// Puts the vertices of a deforming body somewhere for the next frame.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the body does not exist, is not deforming or has another number of vertices;
    /// [`Error::NonFiniteVertex`]. The scene is then as before.
    pub fn deform(&mut self, body: usize, vertices: &[Point]) -> Result<(), Error> {
        self.known(body)?;
        self.states[body].deform(vertices)
    }

    fn known(&self, body: usize) -> Result<(), Error> {
        if body < self.states.len() {
            Ok(())
        } else {
            Err(Error::parameter("body", body, "a number that `add` returned"))
        }
    }

    /// How many bodies there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.states.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.states.is_empty()
    }

    /// Every contact of the frame that `place` and `deform` described. What is known from the last frame is used.
    ///
    /// # Errors
    /// Only what `place` and `deform` would have refused; never for a scene that was built through them.
    pub fn contacts(&mut self) -> Result<Frame, Error> {
        self.watched(&Watch::none())
    }

    /// The same until `stop` says so, which is asked every 20 us to 10 ms from every thread that works, and told how many pairs
    /// there are by now (those that a filter will leave out included). What was found until then is the answer; which pairs
    /// these are depends on the time, on the method and on the threads, unlike those of a [`Pass`]. The next call starts anew.
    ///
    /// # Errors
    /// As [`Scene::contacts`].
    pub fn contacts_until(&mut self, stop: &(dyn Fn(usize) -> bool + Sync)) -> Result<Frame, Error> {
        self.watched(&Watch::until(stop))
    }

    fn watched(&mut self, watch: &Watch<'_>) -> Result<Frame, Error> {
        self.settle();
        let mut skips = self.start_skips();
        let mut contacts = Vec::new();
        for at in 0..self.links.len() {
            if watch.stopped() {
                break;
            }
            self.enumerate(at, &mut skips, watch)?;
            let link = &self.links[at];
            contacts.extend(link.pairs.iter().map(|pair| link.contact(*pair)));
        }
        Ok(Frame {
            contacts,
            completeness: match watch.stopped() {
                true => Completeness::Unknown,
                false => Completeness::Proved,
            },
            skips,
        })
    }

    /// Distance and closest points of a contact, or of any pair of features.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a body or a feature does not exist.
    pub fn proximity(&self, contact: Contact) -> Result<Proximity, Error> {
        let (kind_a, kind_b) = self.kind.features();
        for (body, kind, feature) in [
            (contact.body_a, kind_a, contact.a),
            (contact.body_b, kind_b, contact.b),
        ] {
            self.known(body)?;
            if feature as usize >= self.states[body].count(kind) {
                return Err(Error::parameter(
                    "feature",
                    feature,
                    "a number of a feature of its body",
                ));
            }
        }
        Ok(self.proximity_of(contact))
    }

    /// Goes to the next frame, and lists the pairs of bodies if they are not.
    fn settle(&mut self) {
        if !self.linked {
            self.link();
        }
        if self.states.iter().any(State::is_pending) {
            self.frame += 1;
            self.states.iter_mut().for_each(State::settle);
        }
    }

    fn start_skips(&self) -> Skips {
        let rigid = self
            .states
            .iter()
            .filter(|state| state.body.motion != Motion::Deforming)
            .count();
        Skips {
            filtered_bodies: self.filtered,
            rigid_self: rigid as u64,
            ..Skips::default()
        }
    }
}
