//! Hits that an engine recombines or goes on from.

use core::ops::Deref;

use crate::error::Error;
use crate::scalar::Real;
use crate::space::Space;
use crate::state::{Part, Reader, Saved, State, read_rows, write_rows};

/// Positions of hits, each moved to [that of its values](Space::centre): so steps between hits are whole, and a checkpoint is short.
/// A slice of all coordinates, row after row.
#[derive(Debug, Clone)]
pub(super) struct HitList<S> {
    coordinates: Vec<S>,
    /// Of each row; 0 before the first one.
    dimension: usize,
}

impl<S> Default for HitList<S> {
    fn default() -> Self {
        Self {
            coordinates: Vec::new(),
            dimension: 0,
        }
    }
}

impl<S> Deref for HitList<S> {
    type Target = [S];

    fn deref(&self) -> &[S] {
        &self.coordinates
    }
}

impl<S: Real> HitList<S> {
    pub(super) fn clear(&mut self) {
        self.coordinates.clear();
    }

    /// Number of hits.
    pub(super) fn rows(&self) -> usize {
        self.coordinates.len() / self.dimension.max(1)
    }

    pub(super) fn row(&self, index: usize) -> &[S] {
        &self.coordinates[index * self.dimension..(index + 1) * self.dimension]
    }

    /// Whether all are of a space of so many axes.
    pub(super) fn fit(&self, dimension: usize) -> bool {
        self.is_empty() || self.dimension == dimension
    }

    /// Adds a hit. Cost: O(D), for permutations O(D log D).
    pub(super) fn push(&mut self, space: &Space<S>, position: &[S]) {
        let start = self.coordinates.len();
        self.dimension = position.len();
        self.coordinates.extend_from_slice(position);
        space.centre(&mut self.coordinates[start..]);
    }
}

impl<S: Real> Part for HitList<S> {
    fn save(&self, state: &mut State) {
        Saved::save(&self.dimension, state);
        write_rows(state, &self.coordinates, self.dimension);
    }

    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        self.dimension = from.read()?;
        self.coordinates = read_rows(from)?;
        if self.rows().checked_mul(self.dimension) == Some(self.coordinates.len()) {
            Ok(())
        } else {
            Err(Error::State("its hits are not whole".to_owned()))
        }
    }
}
