//! The box and the ball around a mesh, and those of its placements.

use crate::broad::Box32;
use crate::mesh::Point;
use crate::{Aabb, Mesh, Placement};

/// The box of the vertices in the coordinates of the mesh, and a ball around its centre that holds them.
#[derive(Debug)]
pub(super) struct Extent {
    bounds: Aabb,
    centre: Point,
    /// Half of its sides.
    half: Point,
    /// Of the ball; infinite where it cannot be computed.
    radius: f64,
    /// The largest coordinates of its two corners, added up.
    size: f64,
}

impl Extent {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let bounds = mesh.bounds();
        let centre = std::array::from_fn(|k| bounds.min[k] / 2.0 + bounds.max[k] / 2.0);
        let square = |p: &Point| (0..3).map(|k| (p[k] - centre[k]).powi(2)).sum::<f64>();
        let farthest = mesh.vertices().iter().map(square).fold(0.0, f64::max);
        Self {
            centre,
            // squares below 1e-300 may have lost their digits
            radius: farthest.sqrt() * (1.0 + 1e-12) + 1e-150,
            half: std::array::from_fn(|k| bounds.max[k] / 2.0 - bounds.min[k] / 2.0),
            size: largest(&bounds.min) + largest(&bounds.max),
            bounds,
        }
    }

    /// The centre of the ball. Posed, it is the centre of a ball around the posed vertices, up to [`blur`](Self::blur).
    pub(super) fn centre(&self) -> Point {
        self.centre
    }

    /// The radius of the ball.
    pub(super) fn radius(&self) -> f64 {
        self.radius
    }

    /// At least how far rounding moves a posed vertex, and the centre, where no coordinate of the centre exceeds `farthest`.
    pub(super) fn blur(&self, farthest: f64) -> f64 {
        // the translation is the difference of the centres
        1e-14 * (2.0 * self.size + farthest)
    }

    /// At least the largest coordinate.
    pub(super) fn size(&self) -> f64 {
        self.size
    }

    /// The box of the vertices, rounded outwards; the empty one where `f32` is too coarse for it.
    pub(super) fn hull(&self) -> Box32 {
        let hull = Box32::outside(&self.bounds.min, &self.bounds.max);
        let wider = |k: usize| {
            [
                self.bounds.min[k] - f64::from(hull.min[k]),
                f64::from(hull.max[k]) - self.bounds.max[k],
            ]
        };
        let fits = |by: f64| (0.0..=1e-3 * self.bounds.size()).contains(&by);
        match (0..3).all(|k| wider(k).into_iter().all(fits)) {
            true => hull,
            false => Box32::EMPTY,
        }
    }

    /// Whether no vertex leaves the range of numbers as long as the translation is small too.
    pub(super) fn is_small(&self) -> bool {
        4.0 * self.size < SMALL
    }

    /// A box that holds the posed vertices. A rotated box has its rotated centre, and half sides by the absolute matrix; posing
    /// rounds in proportion to the lengths involved.
    pub(super) fn posed(&self, placement: &Placement) -> Aabb {
        if *placement == Placement::IDENTITY {
            return self.bounds;
        }
        let slack = self.rounding(placement);
        let rotation = placement.rotation();
        let centre = placement.apply(self.centre);
        let sides: Point = std::array::from_fn(|i| {
            let [x, y, z] = rotation[i];
            x.abs() * self.half[0] + y.abs() * self.half[1] + z.abs() * self.half[2] + slack
        });
        Aabb {
            min: std::array::from_fn(|i| centre[i] - sides[i]),
            max: std::array::from_fn(|i| centre[i] + sides[i]),
        }
    }

    /// A box that holds the vertices after a translation.
    pub(super) fn moved(&self, translation: &Point) -> Aabb {
        if *translation == [0.0; 3] {
            return self.bounds;
        }
        let slack = 1e-14 * (self.size + largest(translation));
        Aabb {
            min: std::array::from_fn(|i| self.centre[i] + translation[i] - (self.half[i] + slack)),
            max: std::array::from_fn(|i| self.centre[i] + translation[i] + (self.half[i] + slack)),
        }
    }

    /// A bound on the motion of all vertices between two placements. The motion is an affine function of the point, so that it
    /// is longest at a corner; without a rotation it is the same everywhere.
    pub(super) fn motion(&self, one: &Placement, two: &Placement) -> f64 {
        let square =
            |old: Point, new: Point| -> f64 { (0..3).map(|k| (new[k] - old[k]) * (new[k] - old[k])).sum() };
        let square = if one.rotation() == two.rotation() {
            square(one.translation(), two.translation())
        } else {
            let ways = self
                .corners()
                .map(|corner| square(one.apply(corner), two.apply(corner)));
            ways.into_iter().fold(0.0, f64::max)
        };
        square.sqrt() * (1.0 + 1e-12) + 4.0 * (self.rounding(one) + self.rounding(two)) + 1e-153
    }

    fn corners(&self) -> [Point; 8] {
        let sides = [self.bounds.min, self.bounds.max];
        std::array::from_fn(|c| [sides[c & 1][0], sides[c >> 1 & 1][1], sides[c >> 2][2]])
    }

    fn rounding(&self, placement: &Placement) -> f64 {
        1e-14 * (self.size + largest(&placement.translation()))
    }
}

/// Twice this is a number.
const SMALL: f64 = f64::MAX / 4.0;

/// Whether a body that [is small](Extent::is_small) stays in the range of numbers after this translation.
#[inline]
pub(super) fn is_small(translation: &[f64; 3]) -> bool {
    translation
        .iter()
        .fold(true, |small, c| small & (c.abs() < SMALL))
}

/// The largest absolute coordinate.
pub(super) fn largest(v: &[f64; 3]) -> f64 {
    v.iter().fold(0.0_f64, |most, c| most.max(c.abs()))
}
