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
    pub(super) fn of(&self, part: Part) -> Posed<P> {
        match part {
            Part::Face(face) => self.face(face),
            Part::Edge(i, j) => self.edge(i, j),
            Part::Corner(i) => self.corner(i),
        }
    }

    fn corner(&self, i: usize) -> Posed<P> {
        let w = &self.corners[i];
        match &self.delta_squared {
            None => Posed {
                zero: w.to_vec(),
                positive: Vec::new(),
            },
            Some(squared) => Posed {
                zero: Vec::new(),
                positive: vec![squared.minus(&dot(w, w))],
            },
        }
    }

    fn edge(&self, i: usize, j: usize) -> Posed<P> {
        let w = &self.corners[i];
        let x = difference(&self.corners[j], w);
        let (wx, xx) = (dot(w, &x), dot(&x, &x));
        let mut positive = vec![xx.plus(&wx)];
        let zero = match &self.delta_squared {
            None => cross(w, &x).into(),
            Some(squared) => {
                let apart = dot(w, w).times(&xx).minus(&wx.times(&wx));
                positive.push(squared.times(&xx).minus(&apart));
                Vec::new()
            }
        };
        positive.push(wx.negated());
        Posed { zero, positive }
    }

    fn face(&self, face: Face) -> Posed<P> {
        let [w, p, q] = face.corners.map(|corner| &self.corners[corner]);
        let (x, y) = (difference(p, w), difference(q, w));
        let height = dot(w, &cross(&x, &y));
        let (xx, yy, xy) = (dot(&x, &x), dot(&y, &y), dot(&x, &y));
        let (wx, wy) = (dot(w, &x), dot(w, &y));
        let gram = xx.times(&yy).minus(&xy.times(&xy));
        let u = xy.times(&wy).minus(&yy.times(&wx));
        let v = xy.times(&wx).minus(&xx.times(&wy));
        let mut positive = if face.is_parallelogram {
            vec![gram.minus(&u), gram.minus(&v)]
        } else {
            vec![gram.minus(&u).minus(&v)]
        };
        positive.extend([u, v]);
        let zero = match &self.delta_squared {
            None => vec![height],
            Some(squared) => {
                positive.push(squared.times(&gram).minus(&height.times(&height)));
                Vec::new()
            }
        };
        Posed { zero, positive }
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
