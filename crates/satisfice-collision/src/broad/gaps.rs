//! Lower bounds of the distances of boxes of two bodies.
//!
//! Boxes are compared in `f64`, so that bodies may be far apart: what is wrong by a rounding of `f32` is the box of a feature in
//! the frame of its own body, not the way between the bodies. With the names of `relative`, a side is wrong by at most
//! e = e_b + sqrt(3) r e_a and 2^-45 times all lengths involved, and the gap g of two boxes proves a distance of at least
//! (g - 2 sqrt(3) e) / s_b.
//!
//! A far coordinate c, one beyond the core of its frame, is wrong by 2^-24 |c| from rounding to `f32`, and by 2^-45 times the
//! largest coordinate of its box from posing, from the matrix and from the sums here, on every axis. Its box is widened by that
//! and more. A side at the edge of its frame is as far out as there are numbers.

use crate::broad::boxes::Group;
use crate::broad::frame::{EDGE, LocalFrame, power_of_two};
use crate::broad::pair_query::PairQuery;
use crate::broad::relative::Composition;
use crate::broad::traverse::{Trees, Visit};

/// Eight boxes in `f64`.
struct Wide {
    lower: [[f64; 8]; 3],
    upper: [[f64; 8]; 3],
}

impl Wide {
    /// Boxes in the unit of their own frame, whose far sides are widened, and the largest coordinate of each.
    fn of(group: &Group, core: f64) -> (Self, [f64; 8]) {
        let mut wide = Self {
            lower: [[0.0; 8]; 3],
            upper: [[0.0; 8]; 3],
        };
        let mut largest = [0.0_f64; 8];
        for k in 0..3 {
            for (l, largest) in largest.iter_mut().enumerate() {
                wide.lower[k][l] = -outside(-group.lower[k][l], core);
                wide.upper[k][l] = outside(group.upper[k][l], core);
                let most = wide.lower[k][l].abs().max(wide.upper[k][l].abs());
                *largest = largest.max(most);
            }
        }
        (wide, largest)
    }

    fn widen(&mut self, by: &[f64; 8]) {
        for k in 0..3 {
            for (l, by) in by.iter().enumerate() {
                self.lower[k][l] -= by;
                self.upper[k][l] += by;
            }
        }
    }
}

/// The upper side of a box, moved outwards if it is far.
#[inline(always)]
fn outside(side: f32, core: f64) -> f64 {
    match f64::from(side) {
        near if near.abs() <= core => near,
        edge if edge >= f64::from(EDGE) => f64::INFINITY,
        far => far + far.abs() * power_of_two(-22),
    }
}

/// The sides of a posed box, moved outwards on all axes if it is far.
pub(super) fn outwards(frame: &LocalFrame, lower: &[f32; 3], upper: &[f32; 3]) -> [[f64; 3]; 2] {
    let lower = lower.map(|side| -outside(-side, frame.half));
    let upper = upper.map(|side| outside(side, frame.half));
    let most = lower
        .iter()
        .chain(&upper)
        .fold(0.0_f64, |most, side| most.max(side.abs()));
    let by = most * power_of_two(-45);
    [lower.map(|side| side - by), upper.map(|side| side + by)]
}

/// How the first tree lies in the frame of the second, and what gaps of boxes prove there.
pub(super) struct Gaps {
    matrix: [[f64; 3]; 3],
    shift: [f64; 3],
    /// A gap exceeds the distance by at most this.
    error: f64,
    scale: f64,
    /// If there are far coordinates, the largest that are not, of either frame.
    core: Option<[f64; 2]>,
    /// What posing may move of a far coordinate of either body, in proportion to it.
    posing: [f64; 2],
}

impl Gaps {
    pub(super) fn new(way: &Composition) -> Self {
        let side = way.b_error
            + 1.7321 * way.ratio * way.a_error
            + power_of_two(-45) * way.lengths
            + power_of_two(-140);
        // squares of larger numbers could overflow, and then nothing is proved
        let sane = way.lengths < power_of_two(500);
        Self {
            matrix: way.matrix.map(|row| row.map(|m| m * way.ratio)),
            shift: way.shift,
            error: if sane { 3.4642 * side } else { f64::INFINITY },
            scale: way.scale,
            core: way.has_far.then_some([way.a_half, way.b_half]),
            posing: [power_of_two(-45) * way.ratio, power_of_two(-45)],
        }
    }

    /// Of a body with itself.
    pub(super) fn within(query: &PairQuery<'_>) -> Self {
        let frame = &query.a.0.frame;
        Self {
            matrix: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            shift: [0.0; 3],
            error: 3.4642 * (frame.error + power_of_two(-45) * frame.half) + power_of_two(-140),
            scale: frame.scale,
            core: frame.has_far.then_some([frame.half; 2]),
            posing: [0.0; 2],
        }
    }

    /// Boxes with a gap whose square is greater are further apart than `distance`.
    pub(super) fn limit(&self, distance: f64) -> f64 {
        let limit = (distance * self.scale + self.error) * (1.0 + power_of_two(-48));
        limit * limit
    }

    /// Boxes of the first tree in the frame of the second.
    #[inline(always)]
    fn bring(&self, of: &Group) -> Wide {
        let mut wide = Wide {
            lower: [[0.0; 8]; 3],
            upper: [[0.0; 8]; 3],
        };
        for i in 0..3 {
            for l in 0..8 {
                let (mut centre, mut half) = (self.shift[i], 0.0);
                for k in 0..3 {
                    let (low, high) = (f64::from(of.lower[k][l]), f64::from(of.upper[k][l]));
                    centre += self.matrix[i][k] * (0.5 * (low + high));
                    half += self.matrix[i][k].abs() * (0.5 * (high - low));
                }
                wide.lower[i][l] = centre - half;
                wide.upper[i][l] = centre + half;
            }
        }
        wide
    }

    /// Whether one of these boxes has a far coordinate.
    #[inline(always)]
    pub(super) fn concerns(&self, a: &Group, b: &Group) -> bool {
        let is_far = |group: &Group, core: f64| {
            let mut most = [0.0_f32; 8];
            for k in 0..3 {
                for (l, most) in most.iter_mut().enumerate() {
                    // an empty box has none
                    let (low, high) = (-group.lower[k][l], group.upper[k][l]);
                    let side = if low > high { low } else { high };
                    *most = if side > *most { side } else { *most };
                }
            }
            most.iter().any(|&side| f64::from(side) > core)
        };
        self.core
            .is_some_and(|[core_a, core_b]| is_far(a, core_a) || is_far(b, core_b))
    }

    /// Boxes of both trees in the frame of the second, widened where they are far.
    fn bring_far(&self, a: &Group, b: &Group, [core_a, core_b]: [f64; 2]) -> [Wide; 2] {
        let (own, mut most_a) = Wide::of(a, core_a);
        let (mut other, mut most_b) = Wide::of(b, core_b);
        let mut wide = Wide {
            lower: self.shift.map(|shift| [shift; 8]),
            upper: self.shift.map(|shift| [shift; 8]),
        };
        for i in 0..3 {
            for k in 0..3 {
                let m = self.matrix[i][k];
                // not 0 times infinity
                if m == 0.0 {
                    continue;
                }
                for l in 0..8 {
                    let (low, high) = (m * own.lower[k][l], m * own.upper[k][l]);
                    wide.lower[i][l] += if m > 0.0 { low } else { high };
                    wide.upper[i][l] += if m > 0.0 { high } else { low };
                }
            }
        }
        for (wide, most, posing) in [
            (&mut wide, &mut most_a, self.posing[0]),
            (&mut other, &mut most_b, self.posing[1]),
        ] {
            if posing > 0.0 {
                wide.widen(&most.map(|most| most * posing));
            }
        }
        [wide, other]
    }

    /// Of two groups of boxes with far coordinates, the pairs whose squared gap is within a limit: bit `8 i + j`.
    pub(super) fn far_within(&self, a: &Group, b: &Group, limit: f64) -> u64 {
        let squares = self.squares(a, b);
        let lanes = squares.as_flattened().iter().enumerate();
        lanes.fold(0, |near, (lane, &square)| {
            near | u64::from(square <= limit) << lane
        })
    }

    /// The squared gaps between eight boxes and eight others.
    #[inline(always)]
    pub(super) fn squares(&self, a: &Group, b: &Group) -> [[f64; 8]; 8] {
        let Some(core) = self.core else {
            return squares(&self.bring(a), &b.lower, &b.upper);
        };
        let [a, b] = self.bring_far(a, b, core);
        squares(&a, &b.lower, &b.upper)
    }
}

/// The squared gaps between eight boxes and eight others, whose sides these are.
#[inline(always)]
fn squares<T: Into<f64> + Copy>(a: &Wide, lower: &[[T; 8]; 3], upper: &[[T; 8]; 3]) -> [[f64; 8]; 8] {
    let mut squares = [[0.0; 8]; 8];
    for k in 0..3 {
        for (i, row) in squares.iter_mut().enumerate() {
            let (low, high) = (a.lower[k][i], a.upper[k][i]);
            for (l, square) in row.iter_mut().enumerate() {
                let below = lower[k][l].into() - high;
                let above = low - upper[k][l].into();
                let gap = if below > above { below } else { above };
                // not NaN, which proves nothing
                let gap = if gap > 0.0 { gap } else { 0.0 };
                *square += gap * gap;
            }
        }
    }
    squares
}

/// What a descent knows of the boxes that have far coordinates.
pub(crate) struct FarBoxes {
    gaps: Gaps,
    limit: f64,
}

impl FarBoxes {
    /// For a query of which `way` brings the first tree into the frame of the second, unless both are one; `None` if nothing is far.
    pub(crate) fn new(query: &PairQuery<'_>, way: Option<&Composition>) -> Option<Self> {
        let gaps = match way {
            Some(way) if way.has_far => Gaps::new(way),
            None if query.a.0.frame.has_far => Gaps::within(query),
            _ => return None,
        };
        let limit = gaps.limit(query.threshold.get());
        Some(Self { gaps, limit })
    }

    /// Whether a group of one tree or of the other has far coordinates.
    #[inline(always)]
    pub(crate) fn concern(&self, trees: &Trees<'_>, at: Visit) -> bool {
        let mut rooms = [Group::EMPTY; 2];
        let [a, b] = trees.groups(at, &mut rooms);
        self.gaps.concerns(a, b)
    }

    /// The pairs of boxes of two groups that may be within the threshold.
    #[inline(never)]
    pub(crate) fn within(&self, trees: &Trees<'_>, at: Visit) -> u64 {
        let mut rooms = [Group::EMPTY; 2];
        let [a, b] = trees.groups(at, &mut rooms);
        self.gaps.far_within(a, b, self.limit)
    }
}
