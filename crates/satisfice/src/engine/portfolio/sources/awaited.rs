//! Points that are out, where answers come one by one, in any order.

use std::collections::BTreeMap;

use crate::engine::portfolio::source::{Source, Tag};
use crate::scalar::Real;

/// Whose each point is, by the number of its batch and its place there.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(super) struct PointsAwaited<S> {
    /// Batches since the slice began.
    batches: u64,
    /// With the step of a trial.
    points: BTreeMap<(u64, usize), (Tag, Vec<S>)>,
}

impl<S> Default for PointsAwaited<S> {
    fn default() -> Self {
        Self {
            batches: 0,
            points: BTreeMap::new(),
        }
    }
}

impl<S: Real> PointsAwaited<S> {
    /// Takes the tags of the next batch, whose trials are rows of as many numbers as there are axes.
    pub(super) fn add(&mut self, tags: &mut Vec<Tag>, trials: &[S], axes: usize) {
        self.batches += 1;
        for (place, tag) in tags.drain(..).enumerate() {
            let point = match tag {
                (Source::Trial, index) => (
                    (Source::Trial, 0),
                    trials[index * axes..(index + 1) * axes].to_vec(),
                ),
                _ => (tag, Vec::new()),
            };
            self.points.insert((self.batches, place), point);
        }
    }

    /// Whose the point was, which is not out any more; writes its trial. `None` if it was not out.
    pub(super) fn take(&mut self, at: (u64, usize), trial: &mut Vec<S>) -> Option<Tag> {
        let (tag, step) = self.points.remove(&at)?;
        *trial = step;
        Some(tag)
    }

    pub(super) fn len(&self) -> usize {
        self.points.len()
    }

    pub(super) fn tags(&self) -> impl Iterator<Item = Tag> {
        self.points.values().map(|&(tag, _)| tag)
    }

    /// Whether every trial has a step in a space of so many axes.
    pub(super) fn fit(&self, axes: usize) -> bool {
        let mut points = self.points.values();
        points.all(|((source, index), step)| *source != Source::Trial || (*index == 0 && step.len() == axes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_known_by_batch_and_place_and_trials_by_their_step() {
        let mut awaited = PointsAwaited::<f64>::default();
        let mut tags = vec![(Source::Trial, 1), (Source::Descent, 2)];
        awaited.add(&mut tags, &[1.0, 2.0, 3.0, 4.0], 2);
        tags.push((Source::Uniform, 0));
        awaited.add(&mut tags, &[], 2);
        assert!(tags.is_empty() && awaited.fit(2) && !awaited.fit(3));
        let mut trial = vec![9.0];
        assert_eq!(awaited.take((2, 0), &mut trial), Some((Source::Uniform, 0)));
        assert!(trial.is_empty());
        assert_eq!(awaited.take((1, 0), &mut trial), Some((Source::Trial, 0)));
        assert_eq!(trial, [3.0, 4.0]);
        assert_eq!(awaited.take((1, 0), &mut trial), None);
        assert!(awaited.tags().eq([(Source::Descent, 2)]));
    }
}
