//! Which polynomial conditions decide whether a moving hull comes near the origin.
//!
//! The nearest point of a hull lies inside one of its parts: a corner, an edge or the face. For each part the conditions
//! say that the nearest point of its line or plane is strictly inside the part and that it is near. With corners w, directions
//! x and y (all linear in the time), gram = |x|^2 |y|^2 - (x.y)^2 and height = w.(x cross y):
//!
//! | part | nearer than delta | contains the origin | strictly inside |
//! |---|---|---|---|
//! | corner | delta^2 - w.w > 0 | w = 0 | |
//! | edge | delta^2 x.x - (w.w x.x - (w.x)^2) > 0 | w cross x = 0 | -w.x > 0, x.x + w.x > 0 |
//! | face | delta^2 gram - height^2 > 0 | height = 0 | u > 0, v > 0, gram - u - v > 0 (or gram - u > 0, gram - v > 0) |
//!
//! with degrees 2, 4, 6; 1, 2, 3; 2 and 4. A part whose directions are dependent fails the strict conditions and is left to its own
//! parts, so degenerate edges and triangles need no case of their own, nor do motions within a plane: an equation that holds
//! all the time drops out, and strict inequalities remain.

use std::cell::LazyCell;

use super::hull::{Face, Parts};

/// A polynomial of the time, exact or rounded.
pub(super) trait Polynomial: Clone {
    fn plus(&self, other: &Self) -> Self;
    fn minus(&self, other: &Self) -> Self;
    fn times(&self, other: &Self) -> Self;
    fn negated(&self) -> Self;
}

/// A part of a hull.
#[derive(Debug, Clone, Copy)]
pub(super) enum Part {
    Face(Face),
    /// Between the corners of these numbers.
    Edge(usize, usize),
    Corner(usize),
}

impl Parts {
    /// All parts of a hull with so many corners, the face first: where its plane stays away from the origin, so do all parts.
    pub(super) fn all(self, corners: usize) -> impl Iterator<Item = Part> {
        let edges = self.edges.iter().map(|&[i, j]| Part::Edge(i, j));
        let face = self.face.into_iter().map(Part::Face);
        face.chain(edges).chain((0..corners).map(Part::Corner))
    }
}

/// What has to hold at one time for the nearest point of a hull to be inside a part and near.
#[derive(Debug, Clone)]
pub(super) struct Posed<P> {
    /// All of these are 0.
    pub(super) zero: Vec<P>,
    /// All of these are above 0.
    pub(super) positive: Vec<P>,
}

/// A hull as polynomials over a part of the step.
pub(super) struct Conditions<P> {
    pub(super) corners: Vec<[P; 3]>,
    /// Delta squared as a polynomial of degree 2; `None` for touching.
    pub(super) delta_squared: Option<P>,
}

impl<P: Polynomial> Conditions<P> {
    /// The conditions of a part, without the inequalities whose bits are set in `left_out`; they are numbered as they come in the list of all.
    pub(super) fn of(&self, part: Part, left_out: u32) -> Posed<P> {
        let wanted = Wanted {
            left_out,
            number: 0,
            positive: Vec::new(),
        };
        match part {
            Part::Face(face) => self.face(face, wanted),
            Part::Edge(i, j) => self.edge(i, j, wanted),
            Part::Corner(i) => self.corner(i, wanted),
        }
    }

    fn corner(&self, i: usize, mut wanted: Wanted<P>) -> Posed<P> {
        let w = &self.corners[i];
        let mut zero = Vec::new();
        match &self.delta_squared {
            None => zero.extend_from_slice(w),
            Some(squared) => wanted.add(|| squared.minus(&dot(w, w))),
        }
        Posed {
            zero,
            positive: wanted.positive,
        }
    }

    fn edge(&self, i: usize, j: usize, mut wanted: Wanted<P>) -> Posed<P> {
        let w = &self.corners[i];
        let x = difference(&self.corners[j], w);
        let (wx, xx) = (LazyCell::new(|| dot(w, &x)), LazyCell::new(|| dot(&x, &x)));
        wanted.add(|| xx.plus(&wx));
        let mut zero = Vec::new();
        match &self.delta_squared {
            None => zero.extend(cross(w, &x)),
            Some(squared) => wanted.add(|| {
                let apart = dot(w, w).times(&xx).minus(&wx.times(&wx));
                squared.times(&xx).minus(&apart)
            }),
        }
        wanted.add(|| wx.negated());
        Posed {
            zero,
            positive: wanted.positive,
        }
    }

    fn face(&self, face: Face, mut wanted: Wanted<P>) -> Posed<P> {
        let [w, p, q] = face.corners.map(|corner| &self.corners[corner]);
        let (x, y) = (difference(p, w), difference(q, w));
        let height = dot(w, &cross(&x, &y));
        let (xx, yy) = (LazyCell::new(|| dot(&x, &x)), LazyCell::new(|| dot(&y, &y)));
        let (wx, wy) = (LazyCell::new(|| dot(w, &x)), LazyCell::new(|| dot(w, &y)));
        let xy = LazyCell::new(|| dot(&x, &y));
        let gram = LazyCell::new(|| xx.times(&yy).minus(&xy.times(&xy)));
        let u = LazyCell::new(|| xy.times(&wy).minus(&yy.times(&wx)));
        let v = LazyCell::new(|| xy.times(&wx).minus(&xx.times(&wy)));
        if face.is_parallelogram {
            wanted.add(|| gram.minus(&u));
            wanted.add(|| gram.minus(&v));
        } else {
            wanted.add(|| gram.minus(&u).minus(&v));
        }
        wanted.add(|| u.clone());
        wanted.add(|| v.clone());
        let mut zero = Vec::new();
        match &self.delta_squared {
            None => zero.push(height),
            Some(squared) => wanted.add(|| squared.times(&gram).minus(&height.times(&height))),
        }
        Posed {
            zero,
            positive: wanted.positive,
        }
    }
}

/// Collects inequalities; one that is left out is not computed.
struct Wanted<P> {
    left_out: u32,
    number: u32,
    positive: Vec<P>,
}

impl<P> Wanted<P> {
    fn add(&mut self, form: impl FnOnce() -> P) {
        if self.left_out >> self.number & 1 == 0 {
            self.positive.push(form());
        }
        self.number += 1;
    }
}

fn difference<P: Polynomial>(p: &[P; 3], q: &[P; 3]) -> [P; 3] {
    [0, 1, 2].map(|k| p[k].minus(&q[k]))
}

fn dot<P: Polynomial>(p: &[P; 3], q: &[P; 3]) -> P {
    let [x, y, z] = [0, 1, 2].map(|k| p[k].times(&q[k]));
    x.plus(&y).plus(&z)
}

fn cross<P: Polynomial>(p: &[P; 3], q: &[P; 3]) -> [P; 3] {
    [(1, 2), (2, 0), (0, 1)].map(|(k, l)| p[k].times(&q[l]).minus(&p[l].times(&q[k])))
}
