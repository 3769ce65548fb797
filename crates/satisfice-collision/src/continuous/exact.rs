//! Decisions without rounding: which polynomial conditions decide whether a moving hull comes near the origin.
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

use super::divisors::common;
use super::form::{Form, FormVector, cross, difference, dot};
use super::hull::{Face, Parts};
use super::integers::{Differences, Interval};
use super::motion::PairMotion;
use super::system::System;

/// Whether a hit happens during a part of the step: a distance below delta, or 0 for a delta of 0.
#[cold]
pub(super) fn is_hit<const M: usize, const N: usize>(
    motion: &PairMotion<M, N>,
    delta: f64,
    parts: Parts,
    during: Interval,
) -> bool {
    let conditions = Conditions::new(motion, delta, during);
    conditions
        .any(parts, &mut |system| system.is_solvable().then_some(()))
        .is_some()
}

/// The first piece of a part of the step, cut into `2^levels` pieces, that contains the infimum of the hits, by number.
#[cold]
pub(super) fn earliest<const M: usize, const N: usize>(
    motion: &PairMotion<M, N>,
    delta: f64,
    parts: Parts,
    during: Interval,
    levels: u32,
) -> Option<u64> {
    let conditions = Conditions::new(motion, delta, during);
    let mut first: Option<u64> = None;
    let _ = conditions.any(parts, &mut |system| {
        if let Some(piece) = system.earliest(levels) {
            first = Some(first.map_or(piece, |first| first.min(piece)));
        }
        None
    });
    first
}

struct Conditions {
    corners: Vec<FormVector>,
    /// Delta squared as a form of degree 2; `None` for touching.
    delta_squared: Option<Form>,
}

type Solver<'s> = &'s mut dyn FnMut(&System) -> Option<()>;

impl Conditions {
    fn new<const M: usize, const N: usize>(motion: &PairMotion<M, N>, delta: f64, during: Interval) -> Self {
        let differences = Differences::new(motion, delta, during);
        let delta_squared = (!differences.delta.is_zero()).then(|| {
            let squared = &differences.delta * &differences.delta;
            Form::new(vec![squared]).raised(2)
        });
        Self {
            corners: differences.corners,
            delta_squared,
        }
    }

    /// Asks for every part's system until one answers, the face first: where its plane stays away from the origin, so do
    /// all parts.
    fn any(&self, parts: Parts, solve: Solver<'_>) -> Option<()> {
        if let Some(face) = parts.face {
            let height = self.height(face);
            if self.delta_squared.is_none() && is_never_zero(&height) {
                return None;
            }
            if let Some(()) = solve(&self.face(face, height)) {
                return Some(());
            }
        }
        for &[i, j] in parts.edges {
            if let Some(()) = solve(&self.edge(i, j)) {
                return Some(());
            }
        }
        self.corners.iter().find_map(|w| solve(&self.corner(w)))
    }

    fn corner(&self, w: &FormVector) -> System {
        match &self.delta_squared {
            None => System {
                equation: common(w),
                positive: Vec::new(),
            },
            Some(squared) => System {
                equation: None,
                positive: vec![squared - &dot(w, w)],
            },
        }
    }

    fn edge(&self, i: usize, j: usize) -> System {
        let w = &self.corners[i];
        let x = difference(&self.corners[j], w);
        let (wx, xx) = (dot(w, &x), dot(&x, &x));
        let mut positive = vec![&xx + &wx];
        let equation = match &self.delta_squared {
            None => common(&cross(w, &x)),
            Some(squared) => {
                let apart = &(&dot(w, w) * &xx) - &(&wx * &wx);
                positive.push(&(squared * &xx) - &apart);
                None
            }
        };
        positive.push(-wx);
        System { equation, positive }
    }

    /// The volume that the corners of a face span with the origin.
    fn height(&self, face: Face) -> Form {
        let [w, p, q] = face.corners.map(|corner| &self.corners[corner]);
        dot(w, &cross(&difference(p, w), &difference(q, w)))
    }

    fn face(&self, face: Face, height: Form) -> System {
        let [w, p, q] = face.corners.map(|corner| &self.corners[corner]);
        let (x, y) = (difference(p, w), difference(q, w));
        let (xx, yy, xy) = (dot(&x, &x), dot(&y, &y), dot(&x, &y));
        let (wx, wy) = (dot(w, &x), dot(w, &y));
        let gram = &(&xx * &yy) - &(&xy * &xy);
        let u = &(&xy * &wy) - &(&yy * &wx);
        let v = &(&xy * &wx) - &(&xx * &wy);
        let mut positive = if face.is_parallelogram {
            vec![&gram - &u, &gram - &v]
        } else {
            vec![&(&gram - &u) - &v]
        };
        positive.extend([u, v]);
        let equation = match &self.delta_squared {
            None => (!height.is_zero()).then_some(height),
            Some(squared) => {
                positive.push(&(squared * &gram) - &(&height * &height));
                None
            }
        };
        System { equation, positive }
    }
}

/// Whether the signs of the coefficients tell that there is no root with `0 <= t <= 1`.
fn is_never_zero(form: &Form) -> bool {
    form.sign_at_start() * form.sign_at_end() > 0 && form.sign_changes() == 0
}
