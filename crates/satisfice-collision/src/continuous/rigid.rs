//! Rigid motions with rotation, by linear pieces with a proved distance from the true path.
//!
//! A vertex at distance r from the axis moves on a helix. Between the ends of a piece in which the body turns by an angle b, the
//! straight motion at constant speed is never farther from it than `r b^2 / 8` (the error of linear interpolation, with
//! `r b^2` as the bound of the second derivative). The rounding of the computed ends is added.

use std::collections::BTreeSet;

use super::step::{MovingContact, Step};
use super::{Separation, vector::dot};
use crate::distance::{PairKind, Point};
use crate::{Error, Mesh};

/// Distances this far apart, as a part of the size of the scene, are told apart without integers; far closer ones take
/// milliseconds for each pair.
const EASY: f64 = 1e-9;
/// The most pieces that a step is cut into.
const MOST_PIECES: u32 = 1 << 16;

/// A body that turns and moves at constant speed during a step. Its vertices at the start are those of its mesh.
///
/// ```
/// use satisfice_collision::continuous::RigidMotion;
/// let quarter_turn = RigidMotion {
///     centre: [0.0; 3],
///     axis: [0.0, 0.0, 1.0],
///     angle: std::f64::consts::FRAC_PI_2,
///     translation: [0.0; 3],
/// };
/// let [x, y, _] = quarter_turn.at([1.0, 0.0, 0.0], 0.5)?;
/// assert!((x - 0.5_f64.sqrt()).abs() < 1e-15 && (y - x).abs() < 1e-15);
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidMotion {
    /// A point on the axis at the start of the step.
    pub centre: Point,
    /// The direction of the axis, of any length above 0.
    pub axis: Point,
    /// By how much the body turns during the step, in radians, counter-clockwise seen against the axis. Any number of turns.
    pub angle: f64,
    /// By how much the centre moves during the step.
    pub translation: Point,
}

/// Pairs of rigid bodies that hit while they turn.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RigidHits {
    /// Pairs that certainly hit.
    pub certain: Vec<MovingContact>,
    /// Pairs that come within delta and the distance between the linear pieces and the true path, so that they may hit.
    /// Together with the certain ones these are all that can.
    pub possible: Vec<MovingContact>,
    /// The number of linear pieces.
    pub pieces: u32,
}

impl RigidMotion {
    /// No motion.
    pub const REST: Self = Self {
        centre: [0.0; 3],
        axis: [0.0, 0.0, 1.0],
        angle: 0.0,
        translation: [0.0; 3],
    };

    /// Where a vertex that starts at `point` is at a time in `[0, 1]` (Rodrigues' formula).
    ///
    /// # Errors
    /// [`Error::Parameter`] if the axis has no length or a number is not finite.
    pub fn at(&self, point: Point, time: f64) -> Result<Point, Error> {
        Ok(self.place(self.unit_axis()?, point, time))
    }

    fn place(&self, axis: Point, point: Point, time: f64) -> Point {
        let p: Point = std::array::from_fn(|k| point[k] - self.centre[k]);
        let (sin, cos) = (self.angle * time).sin_cos();
        let along = dot(axis, p) * (1.0 - cos);
        let turned = super::vector::cross(axis, p);
        std::array::from_fn(|k| {
            let local = p[k] * cos + turned[k] * sin + axis[k] * along;
            local + self.centre[k] + time * self.translation[k]
        })
    }

    fn unit_axis(&self) -> Result<Point, Error> {
        let all = self.centre.iter().chain(&self.translation).chain([&self.angle]);
        let largest = super::vector::largest(self.axis);
        let finite = all.chain(&self.axis).all(|x| x.is_finite());
        if !finite || largest == 0.0 {
            return Err(Error::parameter(
                "rigid motion",
                format!("{self:?}"),
                "finite numbers, and an axis longer than 0",
            ));
        }
        let axis = self.axis.map(|x| x / largest);
        let length = dot(axis, axis).sqrt();
        Ok(axis.map(|x| x / length))
    }

    /// The largest distance of a vertex from the centre.
    fn radius(&self, mesh: &Mesh) -> f64 {
        let squared = mesh.vertices().iter().map(|p| {
            let d: Point = std::array::from_fn(|k| p[k] - self.centre[k]);
            dot(d, d)
        });
        squared.fold(0.0_f64, f64::max).sqrt() * (1.0 + 1e-14)
    }

    /// A bound of the numbers that a vertex is placed with.
    fn size(&self, mesh: &Mesh) -> f64 {
        let largest = |p: Point| super::vector::largest(p);
        self.radius(mesh) * (2.0 + self.angle.abs()) + largest(self.centre) + largest(self.translation)
    }

    /// How far `pieces` linear pieces are from the true path at most, rounding included.
    fn deviation(&self, mesh: &Mesh, pieces: u32) -> f64 {
        let angle = self.angle / f64::from(pieces);
        // Rounding: fewer than 64 operations, each on numbers of at most `size`; the angle itself is rounded, too.
        self.radius(mesh) * angle * angle / 8.0 * (1.0 + 1e-14) + 64.0 * f64::EPSILON * self.size(mesh)
    }

    /// The least number of pieces for a deviation of at most `tolerance` beside rounding.
    fn pieces(&self, mesh: &Mesh, tolerance: f64) -> u32 {
        let pieces = (self.radius(mesh) * self.angle * self.angle / (8.0 * tolerance))
            .sqrt()
            .ceil();
        // NaN and infinity become the most.
        if pieces < f64::from(MOST_PIECES) {
            (pieces as u32).max(1)
        } else {
            MOST_PIECES
        }
    }
}

/// All pairs of features of different bodies that come nearer than delta while the bodies turn and move.
///
/// `tolerance` is how far the linear pieces may be from the true path, in the unit of the coordinates. No hit is missed,
/// whatever it is; it decides how many pairs remain `possible`. For a delta of 0 all hits are only `possible`, without a rotation,
/// too: the rounding of where a vertex is makes a touch a miss. [`Step`] decides touching for given ends exactly.
/// Cost: two [`Step::hits`] for each piece.
///
/// # Errors
/// [`Error::Parameter`] for a motion that is not finite, a tolerance that is not above 0, or a kind that [`Step::hits`] refuses.
pub fn rigid_hits(
    bodies: &[(&Mesh, RigidMotion)],
    kind: PairKind,
    separation: Separation,
    tolerance: f64,
) -> Result<RigidHits, Error> {
    if tolerance.is_nan() || tolerance <= 0.0 {
        return Err(Error::parameter("tolerance", tolerance, "a length above 0"));
    }
    let axes = bodies
        .iter()
        .map(|(_, motion)| motion.unit_axis())
        .collect::<Result<Vec<Point>, Error>>()?;
    let pieces = bodies
        .iter()
        .map(|(mesh, motion)| motion.pieces(mesh, tolerance))
        .max()
        .unwrap_or(1);
    // Two bodies are off by the two largest deviations at most.
    let mut deviations: Vec<f64> = bodies
        .iter()
        .map(|(mesh, motion)| motion.deviation(mesh, pieces))
        .collect();
    deviations.sort_by(|a, b| b.total_cmp(a));
    let off = deviations.iter().take(2).sum::<f64>() * (1.0 + 1e-14);
    let size = bodies
        .iter()
        .map(|(mesh, motion)| motion.size(mesh))
        .fold(0.0, f64::max);
    let off = off.max(tolerance.min(EASY * size));
    let delta = separation.get();
    // A touching pair is below every positive distance, so a step of rounding makes the enlarged question contain it.
    let wide = Separation::new((delta + off).next_up())?;
    let narrow = (delta - off).next_down();
    let frame = |time: f64| -> Vec<Vec<Point>> {
        let placed = bodies.iter().zip(&axes).map(|((mesh, motion), &axis)| {
            let place = |&p: &Point| motion.place(axis, p, time);
            mesh.vertices().iter().map(place).collect()
        });
        placed.collect()
    };
    let (mut certain, mut possible) = (BTreeSet::new(), BTreeSet::new());
    let mut from = frame(0.0);
    for piece in 1..=pieces {
        let to = frame(f64::from(piece) / f64::from(pieces));
        let mut step = Step::new();
        for ((mesh, _), (from, to)) in bodies.iter().zip(from.into_iter().zip(&to)) {
            step.add_rigid(&mesh.with_vertices(from)?, to)?;
        }
        possible.extend(step.hits(kind, wide)?.pairs);
        if narrow > 0.0 {
            certain.extend(step.hits(kind, Separation::new(narrow)?)?.pairs);
        }
        from = to;
    }
    Ok(RigidHits {
        possible: possible.difference(&certain).copied().collect(),
        certain: certain.into_iter().collect(),
        pieces,
    })
}
