//! The points that an engine has proposed, until all of them are told.

use crate::batch::{Batch, Outcome};
use crate::error::Error;
use crate::scalar::Real;
use crate::state::{Reader, Saved, State};

/// Points with what is known of them.
pub(super) struct Share<S> {
    points: Batch<S>,
    outcomes: Vec<Outcome<S>>,
    /// How many are not told yet.
    waits: usize,
}

impl<S: Real> Share<S> {
    pub(super) fn new(dimension: usize) -> Self {
        Self {
            points: Batch::new(dimension),
            outcomes: Vec::new(),
            waits: 0,
        }
    }

    /// Begins with these points.
    pub(super) fn begin<'a>(&mut self, points: impl Iterator<Item = &'a [S]>) {
        self.points.clear();
        points.for_each(|point| self.points.push(point));
        self.waits = self.points.len();
        self.outcomes.clear();
        self.outcomes.resize(self.waits, Outcome::NotEvaluated);
    }

    pub(super) fn dimension(&self) -> usize {
        self.points.dimension()
    }

    pub(super) fn len(&self) -> usize {
        self.outcomes.len()
    }

    /// Takes the outcome of a point, at the position where it was evaluated.
    pub(super) fn take(&mut self, place: usize, position: &[S], outcome: Outcome<S>) {
        if let Some(known) = self.outcomes.get_mut(place) {
            *known = outcome;
            self.points.point_mut(place).copy_from_slice(position);
            self.waits = self.waits.saturating_sub(1);
        }
    }

    pub(super) fn is_told(&self) -> bool {
        self.waits == 0
    }

    /// The points and their outcomes.
    pub(super) fn told(&self) -> (&Batch<S>, &[Outcome<S>]) {
        (&self.points, &self.outcomes)
    }

    pub(super) fn save(&self, state: &mut State) {
        (
            self.points.positions().to_vec(),
            self.outcomes.clone(),
            self.waits,
        )
            .save(state);
    }

    pub(super) fn restored(dimension: usize, from: &mut Reader<'_>) -> Result<Self, Error> {
        let (positions, outcomes, waits): (Vec<S>, Vec<Outcome<S>>, usize) = from.read()?;
        let points = Batch::from_positions(positions, dimension);
        let fits = |points: &Batch<S>| points.len() == outcomes.len() && waits <= outcomes.len();
        let misfit = || Error::State("a share of its batch does not fit".to_owned());
        Ok(Self {
            points: points.filter(fits).ok_or_else(misfit)?,
            outcomes,
            waits,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_is_told_with_its_last_answer_wherever_the_points_were_evaluated() {
        let mut share = Share::new(1);
        share.begin([[1.0], [2.0], [3.0]].iter().map(|point| &point[..]));
        for (place, at, is_last) in [(2, 3.5, false), (0, 1.0, false), (1, 2.0, true)] {
            assert!(!share.is_told());
            share.take(place, &[at], Outcome::Miss(at));
            assert_eq!(share.is_told(), is_last);
        }
        let (points, outcomes) = share.told();
        assert_eq!(points.positions(), [1.0, 2.0, 3.5]);
        assert_eq!(outcomes, [1.0, 2.0, 3.5].map(Outcome::Miss));
    }
}
