//! A feature at both ends of a step, and the vertices of a pair of them.

use crate::distance::Point;

/// A feature whose vertices move along straight lines at constant speed: where it is at time 0 and at time 1.
///
/// `F` is a [`Point`], a [`Segment`](crate::distance::Segment) or a [`Triangle`](crate::distance::Triangle).
///
/// ```
/// use satisfice_collision::continuous::Moving;
/// let falling = Moving::new([0.0, 0.0, 1.0], [0.0, 0.0, -1.0]);
/// let at_rest = Moving::at_rest([[0.0; 3], [1.0, 0.0, 0.0]]);
/// assert_eq!(at_rest.from, at_rest.to);
/// assert_eq!(falling.reversed().from, falling.to);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moving<F> {
    /// At time 0.
    pub from: F,
    /// At time 1.
    pub to: F,
}

impl<F: Copy> Moving<F> {
    /// From one place to another.
    #[inline]
    pub fn new(from: F, to: F) -> Self {
        Self { from, to }
    }

    /// A feature that does not move.
    pub fn at_rest(place: F) -> Self {
        Self::new(place, place)
    }

    /// The motion run backwards.
    #[must_use]
    pub fn reversed(self) -> Self {
        Self::new(self.to, self.from)
    }
}

/// The vertices of two moving features.
#[derive(Debug, Clone, Copy)]
pub(super) struct PairMotion<const M: usize, const N: usize> {
    pub(super) from_a: [Point; M],
    pub(super) to_a: [Point; M],
    pub(super) from_b: [Point; N],
    pub(super) to_b: [Point; N],
}

impl<const M: usize, const N: usize> PairMotion<M, N> {
    pub(super) fn coordinates(&self) -> impl Iterator<Item = f64> {
        let points = self
            .from_a
            .iter()
            .chain(&self.to_a)
            .chain(&self.from_b)
            .chain(&self.to_b);
        points.flatten().copied()
    }

    /// Both features as they are at the start.
    pub(super) fn at_rest(&self) -> Self {
        Self {
            to_a: self.from_a,
            to_b: self.from_b,
            ..*self
        }
    }
}
