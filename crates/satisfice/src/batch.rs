//! Points on their way from an engine to the ledger.

use crate::scalar::Real;

/// Positions proposed by an engine: a flat list, `dimension` numbers a point.
#[derive(Debug, Clone, PartialEq)]
pub struct Batch<S> {
    positions: Vec<S>,
    dimension: usize,
    /// Kept beside the coordinates: a division would cost as much as a cheap fitness.
    points: usize,
}

impl<S: Real> Batch<S> {
    /// An empty batch of points with `dimension` coordinates.
    #[must_use]
    pub fn new(dimension: usize) -> Self {
        Self {
            positions: Vec::new(),
            dimension: dimension.max(1),
            points: 0,
        }
    }

    /// A batch of these coordinates, point after point; `None` where the last point is not complete.
    pub(crate) fn from_positions(positions: Vec<S>, dimension: usize) -> Option<Self> {
        let dimension = dimension.max(1);
        let points = positions.len() / dimension;
        positions.len().is_multiple_of(dimension).then_some(Self {
            positions,
            dimension,
            points,
        })
    }

    /// The coordinates, point after point.
    pub(crate) fn positions(&self) -> &[S] {
        &self.positions
    }

    /// Number of points.
    #[inline]
    #[must_use]
    pub fn len(&self) -> usize {
        self.points
    }

    /// Whether there is no point.
    #[inline]
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.points == 0
    }

    /// Number of coordinates a point.
    #[inline]
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// Removes all points, keeps the memory.
    #[inline]
    pub fn clear(&mut self) {
        self.positions.clear();
        self.points = 0;
    }

    /// Keeps the first `points` points.
    #[inline]
    pub fn truncate(&mut self, points: usize) {
        if points < self.points {
            self.positions.truncate(points * self.dimension);
            self.points = points;
        }
    }

    /// Adds a point. One of a wrong length is cut, or filled with NaN, which the space turns into its middle.
    #[inline]
    pub fn push(&mut self, position: &[S]) {
        self.positions
            .extend_from_slice(&position[..position.len().min(self.dimension)]);
        if position.len() < self.dimension {
            self.positions
                .resize(self.positions.len() + self.dimension - position.len(), S::nan());
        }
        self.points += 1;
    }

    /// Adds a point and lets `fill` write its coordinates, which are 0 before.
    #[inline]
    pub fn push_with(&mut self, fill: impl FnOnce(&mut [S])) {
        let start = self.positions.len();
        self.positions.resize(start + self.dimension, S::zero());
        self.points += 1;
        fill(&mut self.positions[start..]);
    }

    /// Point `index`.
    ///
    /// # Panics
    /// If there is no such point.
    #[inline]
    #[must_use]
    pub fn point(&self, index: usize) -> &[S] {
        &self.positions[index * self.dimension..(index + 1) * self.dimension]
    }

    /// Point `index`, to be changed.
    ///
    /// # Panics
    /// If there is no such point.
    #[inline]
    pub fn point_mut(&mut self, index: usize) -> &mut [S] {
        &mut self.positions[index * self.dimension..(index + 1) * self.dimension]
    }

    /// All points, in order.
    #[inline]
    pub fn points(&self) -> impl ExactSizeIterator<Item = &[S]> {
        (0..self.points).map(|index| self.point(index))
    }
}

/// What became of one proposed point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Outcome<S> {
    /// A new hit with this F; it is in C now.
    Hit(S),
    /// Evaluated, finite, not below the threshold.
    Miss(S),
    /// In C already; not evaluated, or found out while evaluating.
    Deleted,
    /// In C already and evaluated all the same, because the engine [keeps found solutions](crate::Engine::deletes).
    Known(S),
    /// F was NaN or infinite.
    NonFinite,
    /// The budget ended before this point's turn.
    NotEvaluated,
}

impl<S: Real> Outcome<S> {
    /// F as a minimiser sees it: infinite where there is no number or where the point is deleted.
    #[inline]
    #[must_use]
    pub fn fitness(self) -> S {
        match self {
            Self::Hit(f) | Self::Miss(f) | Self::Known(f) => f,
            Self::Deleted | Self::NonFinite | Self::NotEvaluated => S::infinity(),
        }
    }

    /// Whether it is a new hit.
    #[inline]
    #[must_use]
    pub fn is_hit(self) -> bool {
        matches!(self, Self::Hit(_))
    }
}
