//! Batches of proposed points, and their outcomes.

use crate::scalar::Real;

/// Positions proposed by an engine: a flat list, `dimension` numbers per point.
///
/// ```
/// use satisfice::Batch;
/// let mut batch = Batch::new(2);
/// batch.push(&[0.5, 1.5]);
/// batch.push_with(|position| position.copy_from_slice(&[2.0, 3.0]));
/// assert_eq!((batch.len(), batch.point(1)), (2, &[2.0, 3.0][..]));
/// ```
#[derive(Debug, Clone)]
pub struct Batch<S> {
    /// The coordinates of `points` points; the rest is memory for reuse, because to shorten and
    /// lengthen a list costs as much as a cheap fitness.
    memory: Vec<S>,
    dimension: usize,
    /// Kept beside the coordinates: so would a division.
    points: usize,
}

impl<S: Real> PartialEq for Batch<S> {
    fn eq(&self, other: &Self) -> bool {
        self.dimension == other.dimension && self.positions() == other.positions()
    }
}

impl<S: Real> Batch<S> {
    /// An empty batch of points with `dimension` coordinates.
    #[must_use]
    pub fn new(dimension: usize) -> Self {
        Self {
            memory: Vec::new(),
            dimension: dimension.max(1),
            points: 0,
        }
    }

    /// A batch of one point.
    pub(crate) fn of_one(position: &[S]) -> Self {
        let mut batch = Self::new(position.len());
        batch.push(position);
        batch
    }

    /// A batch of these coordinates, point after point; `None` if the last point is not complete.
    pub(crate) fn from_positions(positions: Vec<S>, dimension: usize) -> Option<Self> {
        let dimension = dimension.max(1);
        let points = positions.len() / dimension;
        positions.len().is_multiple_of(dimension).then_some(Self {
            memory: positions,
            dimension,
            points,
        })
    }

    /// The coordinates, point after point.
    pub(crate) fn positions(&self) -> &[S] {
        &self.memory[..self.points * self.dimension]
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

    /// Number of coordinates per point.
    #[inline]
    #[must_use]
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// Removes all points and keeps the memory.
    #[inline]
    pub fn clear(&mut self) {
        self.points = 0;
    }

    /// Keeps the first `points` points.
    #[inline]
    pub fn truncate(&mut self, points: usize) {
        self.points = self.points.min(points);
    }

    /// Adds a point. One of a wrong length is cut, or filled with NaN, which the space turns into its middle.
    #[inline]
    pub fn push(&mut self, position: &[S]) {
        let row = self.push_row();
        let given = position.len().min(row.len());
        row[..given].copy_from_slice(&position[..given]);
        row[given..].fill(S::nan());
    }

    /// Adds a point and lets `fill` write its coordinates, which are 0 before.
    #[inline]
    pub fn push_with(&mut self, fill: impl FnOnce(&mut [S])) {
        let row = self.push_row();
        row.fill(S::zero());
        fill(row);
    }

    /// Adds a point with coordinates that are still to be written.
    #[inline]
    pub(crate) fn push_row(&mut self) -> &mut [S] {
        let start = self.points * self.dimension;
        let end = start + self.dimension;
        if self.memory.len() < end {
            self.grow(end);
        }
        self.points += 1;
        &mut self.memory[start..end]
    }

    #[cold]
    fn grow(&mut self, length: usize) {
        self.memory.resize(length, S::zero());
    }

    /// Point `index`.
    ///
    /// # Panics
    /// If there is no such point.
    #[inline]
    #[must_use]
    pub fn point(&self, index: usize) -> &[S] {
        assert!(index < self.points, "there is no such point");
        &self.memory[index * self.dimension..(index + 1) * self.dimension]
    }

    /// Point `index`, to be changed.
    ///
    /// # Panics
    /// If there is no such point.
    #[inline]
    pub fn point_mut(&mut self, index: usize) -> &mut [S] {
        assert!(index < self.points, "there is no such point");
        &mut self.memory[index * self.dimension..(index + 1) * self.dimension]
    }

    /// All points, in order.
    #[inline]
    pub fn points(&self) -> impl ExactSizeIterator<Item = &[S]> {
        (0..self.points).map(|index| self.point(index))
    }
}

/// The outcome of one proposed point.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Outcome<S> {
    /// A new hit with this F; it is in C now.
    Hit(S),
    /// Evaluated, finite, not below the threshold.
    Miss(S),
    /// In C already; not evaluated, or found out while evaluating.
    Deleted,
    /// In C already and evaluated anyway, because the engine [keeps found solutions](crate::Engine::deletes).
    Known(S),
    /// F was NaN or infinite.
    NonFinite,
    /// The budget ended before this point's turn.
    NotEvaluated,
}

impl<S: Real> Outcome<S> {
    /// F as a minimiser sees it: infinite if there is no number or the point is deleted.
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
