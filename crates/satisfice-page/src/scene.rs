//! The page of a scene: what it holds.

mod encode;
mod markup;

use crate::error::Error;
use crate::shell;

/// What makes up a feature.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FeatureKind {
    /// A corner.
    Vertex,
    /// An edge: numbered in the order of its lower, then its higher vertex, over the lines and the sides of triangles.
    Edge,
    /// A triangle.
    Triangle,
}

impl FeatureKind {
    fn name(self) -> &'static str {
        match self {
            Self::Vertex => "vertex",
            Self::Edge => "edge",
            Self::Triangle => "triangle",
        }
    }
}

/// Which axis points upwards at first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Up {
    /// The first coordinate.
    X,
    /// The second.
    Y,
    /// The third.
    #[default]
    Z,
}

/// A feature of a body, both by number from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Feature {
    /// The body, as [`ScenePage::body`] numbers them.
    pub body: usize,
    /// What makes it up.
    pub kind: FeatureKind,
    /// The feature in the body.
    pub number: u32,
}

/// A pair of features that are close, with their closest points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    features: [Feature; 2],
    points: [[f64; 3]; 2],
    distance: f64,
    evaluation: f64,
    seconds: f64,
    impact: f64,
    is_missed: bool,
}

impl Contact {
    /// A pair with the closest points of its two features, in the coordinates of the bodies.
    #[must_use]
    pub fn new(features: [Feature; 2], points: [[f64; 3]; 2]) -> Self {
        Self {
            features,
            points,
            distance: f64::NAN,
            evaluation: f64::NAN,
            seconds: f64::NAN,
            impact: f64::NAN,
            is_missed: false,
        }
    }

    /// The distance of the two features. Not known by default.
    #[must_use]
    pub fn distance(mut self, distance: f64) -> Self {
        self.distance = distance;
        self
    }

    /// Which evaluation of a search found it, from 1, and how many seconds after the start of its frame. Not known by default.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "counts below 2^53")]
    pub fn found(mut self, evaluation: u64, seconds: f64) -> Self {
        self.evaluation = evaluation as f64;
        self.seconds = seconds;
        self
    }

    /// When the two features first are that close, as a share of the step from one frame to the next. Not known by default.
    #[must_use]
    pub fn impact(mut self, time: f64) -> Self {
        self.impact = time;
        self
    }

    /// Marks a pair that exists and was not found.
    #[must_use]
    pub fn missed(mut self) -> Self {
        self.is_missed = true;
        self
    }
}

#[derive(Debug, Clone)]
struct Body {
    name: String,
    triangles: Vec<[u32; 3]>,
    lines: Vec<[u32; 2]>,
    /// Frames in which it moves, in order, and where its vertices are from then on. The first frame is the first entry.
    positions: Vec<(usize, Vec<[f64; 3]>)>,
}

#[derive(Debug, Clone, Default)]
struct Frame {
    label: String,
    contacts: Vec<Contact>,
    /// Pairs found and all pairs, where there are more than the page lists, or where it is known.
    hits: Option<u64>,
    reference: Option<u64>,
    facts: Vec<(String, String)>,
}

/// A page that shows a scene: bodies, contacts, frames.
///
/// There is one frame at first; [`frame`](Self::frame) begins the next. Contacts, moves and counts belong to the last frame.
///
/// ```
/// use satisfice_page::{Contact, Feature, FeatureKind, ScenePage};
/// let mut page = ScenePage::new("Two triangles");
/// let low = page.body("low", &[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]], &[]);
/// let high = page.body("high", &[[0.0, 0.0, 0.1], [1.0, 0.0, 0.5], [0.0, 1.0, 0.5]], &[[0, 1, 2]], &[]);
/// let features = [low, high].map(|body| Feature { body, kind: FeatureKind::Triangle, number: 0 });
/// page.contact(Contact::new(features, [[0.0; 3], [0.0, 0.0, 0.1]]).distance(0.1));
/// page.frame("lifted");
/// page.move_body(high, &[[0.0, 0.0, 1.1], [1.0, 0.0, 1.5], [0.0, 1.0, 1.5]])?;
/// assert!(page.html()?.starts_with("<!DOCTYPE html>"));
/// # Ok::<(), satisfice_page::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ScenePage {
    title: String,
    up: Up,
    threshold: Option<f64>,
    method: Option<String>,
    facts: Vec<(String, String)>,
    bodies: Vec<Body>,
    frames: Vec<Frame>,
    now: usize,
}

impl ScenePage {
    /// A page without bodies.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            up: Up::default(),
            threshold: None,
            method: None,
            facts: Vec::new(),
            bodies: Vec::new(),
            frames: vec![Frame::default()],
            now: 0,
        }
    }

    /// Which axis points upwards. z by default.
    pub fn up(&mut self, up: Up) {
        self.up = up;
    }

    /// Pairs closer than this are contacts, in the unit of the bodies. By default the page does not say.
    pub fn threshold(&mut self, threshold: f64) {
        self.threshold = Some(threshold);
    }

    /// The engine or exact method that found the contacts. By default the page does not say.
    pub fn method(&mut self, name: impl Into<String>) {
        self.method = Some(name.into());
    }

    /// A line of the legend that is true of the whole page.
    pub fn fact(&mut self, name: impl Into<String>, value: impl Into<String>) {
        self.facts.push((name.into(), value.into()));
    }

    /// Adds a body as it is in the first frame: positions of its vertices, triangles and lines by vertex number. Returns its
    /// number, from 0. It is drawn by its triangles and lines, or by its vertices where it has neither.
    pub fn body(
        &mut self,
        name: impl Into<String>,
        vertices: &[[f64; 3]],
        triangles: &[[u32; 3]],
        lines: &[[u32; 2]],
    ) -> usize {
        self.bodies.push(Body {
            name: name.into(),
            triangles: triangles.to_vec(),
            lines: lines.to_vec(),
            positions: vec![(0, vertices.to_vec())],
        });
        self.bodies.len() - 1
    }

    /// Begins a frame, or names the first one if nothing was said of it yet.
    pub fn frame(&mut self, label: impl Into<String>) {
        let first = &self.frames[0];
        let is_new = self.now == 0 && first.label.is_empty() && first.contacts.is_empty();
        if !is_new {
            self.frames.push(Frame::default());
            self.now += 1;
        }
        self.frames[self.now].label = label.into();
    }

    /// Where the vertices of a body are from this frame on.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a body that does not exist.
    pub fn move_body(&mut self, body: usize, vertices: &[[f64; 3]]) -> Result<(), Error> {
        let now = self.now;
        let count = self.bodies.len();
        let unknown = Error::Unknown {
            what: "body",
            number: body,
            count,
        };
        let positions = &mut self.bodies.get_mut(body).ok_or(unknown)?.positions;
        match positions.last_mut() {
            Some((frame, last)) if *frame == now => *last = vertices.to_vec(),
            Some((_, last)) if *last == vertices => {}
            _ => positions.push((now, vertices.to_vec())),
        }
        Ok(())
    }

    /// Adds a contact to this frame.
    pub fn contact(&mut self, contact: Contact) {
        self.frames[self.now].contacts.push(contact);
    }

    /// How many pairs were found in this frame, if the page lists only some of them, and how many there are, if that is known.
    pub fn counts(&mut self, hits: Option<u64>, reference: Option<u64>) {
        let frame = &mut self.frames[self.now];
        (frame.hits, frame.reference) = (hits, reference);
    }

    /// A line of the legend that is true of this frame.
    pub fn frame_fact(&mut self, name: impl Into<String>, value: impl Into<String>) {
        self.frames[self.now].facts.push((name.into(), value.into()));
    }

    /// The page.
    ///
    /// Positions are rounded to a 65,535th of the scene's size, or finer where the threshold asks for it; distances and times
    /// to eight digits.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a contact or a triangle of what does not exist, [`Error::NotFinite`] for coordinates that are not
    /// finite, [`Error::Vertices`] for a body that moves to another number of vertices.
    ///
    /// Cost: O(vertices times frames in which they move + contacts log contacts).
    pub fn html(&self) -> Result<String, Error> {
        let data = encode::encode(self)?;
        let scripts = [
            include_str!("web/camera.js"),
            include_str!("web/stage.js"),
            include_str!("web/scene.js"),
            include_str!("web/panel.js"),
        ];
        Ok(shell::page(
            &self.title,
            "scene",
            &markup::markup(&self.title),
            &data,
            &scripts,
        ))
    }
}
