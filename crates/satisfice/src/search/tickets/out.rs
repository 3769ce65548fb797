//! Which points are out, looked up by their values: with thousands of open tickets a comparison with each would take longer than
//! an evaluation.

use std::collections::BTreeMap;

use crate::scalar::Real;
use crate::space::Axis;

use super::lane::Open;

/// How many open tickets have the same values; nothing before it is first asked for, as in a slice that was restored.
#[derive(Debug, Default)]
pub(super) struct PointsOut(Option<BTreeMap<Vec<u64>, usize>>);

impl PointsOut {
    /// Whether one of the open tickets has the values of this position.
    pub(super) fn contains<S: Real, T>(
        &mut self,
        axes: &[Axis<S>],
        position: &[S],
        open: &BTreeMap<u64, Open<S, T>>,
    ) -> bool {
        let counts = self.0.get_or_insert_with(|| {
            let mut counts = BTreeMap::new();
            for open in open.values() {
                *counts.entry(values(axes, &open.position)).or_default() += 1;
            }
            counts
        });
        !position.is_empty() && counts.contains_key(&values(axes, position))
    }

    /// Notes that a ticket with this position is open.
    pub(super) fn add<S: Real>(&mut self, axes: &[Axis<S>], position: &[S]) {
        if let Some(counts) = &mut self.0 {
            *counts.entry(values(axes, position)).or_default() += 1;
        }
    }

    /// Notes that a ticket with this position is open no more.
    pub(super) fn remove<S: Real>(&mut self, axes: &[Axis<S>], position: &[S]) {
        let Some(counts) = &mut self.0 else { return };
        let values = values(axes, position);
        if let Some(count) = counts.get_mut(&values) {
            *count -= 1;
            if *count == 0 {
                counts.remove(&values);
            }
        }
    }
}

/// The values of a position as words that are equal where the values are.
fn values<S: Real>(axes: &[Axis<S>], position: &[S]) -> Vec<u64> {
    let pairs = position.iter().zip(axes);
    // A zero has one sign.
    pairs
        .map(|(&x, axis)| (axis.value(x) + S::zero()).to_word())
        .collect()
}
