//! A graph to try neighbours on.

use core::ops::Range;

use crate::Axis;
use crate::context::Context;
use crate::space::{Region, Space};

/// Two axes; neighbours share one of both coordinates: more than [`points_at_once`].
pub(super) struct Rooks {
    pub(super) space: Space<f64>,
    pub(super) planned: Option<u64>,
    pub(super) seconds_an_evaluation: Option<f64>,
}

pub(super) const SIDE: usize = 200;

impl Context<f64> for Rooks {
    fn space(&self) -> &Space<f64> {
        &self.space
    }
    fn threshold(&self) -> f64 {
        0.0
    }
    fn elapsed_share(&self) -> f64 {
        0.0
    }
    fn evaluations(&self) -> u64 {
        0
    }
    fn evaluations_planned(&self) -> Option<u64> {
        self.planned
    }
    fn seconds_an_evaluation(&self) -> Option<f64> {
        self.seconds_an_evaluation
    }
    fn hits(&self) -> usize {
        0
    }
    fn is_deleted(&self, _: &[f64]) -> bool {
        false
    }
    fn neighbour_count(&self, _: &[f64]) -> usize {
        2 * SIDE
    }
    fn neighbours(&self, of: &[f64], indices: Range<usize>, visit: &mut dyn FnMut(usize, &[f64])) {
        for index in indices.start..indices.end.min(2 * SIDE) {
            let mut neighbour = [of[0], of[1]];
            neighbour[index / SIDE] = (index % SIDE) as f64;
            if neighbour != [of[0], of[1]] {
                visit(index, &neighbour);
            }
        }
    }
    fn offers_neighbours(&self) -> bool {
        true
    }
    fn lower_bound(&self, _: &Region<f64>) -> Option<f64> {
        None
    }
    fn previous_hits(&self) -> usize {
        0
    }
    fn previous_hit(&self, _: usize, _: &mut [f64]) -> bool {
        false
    }
}

pub(super) fn rooks() -> Rooks {
    Rooks {
        space: Space::new([
            Axis::integer(0, SIDE as i64 - 1),
            Axis::integer(0, SIDE as i64 - 1),
        ])
        .unwrap(),
        planned: None,
        seconds_an_evaluation: None,
    }
}
