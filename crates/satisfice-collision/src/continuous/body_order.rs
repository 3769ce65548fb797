//! The order of a tree's features: those of a body stay together, and so do those of bodies near each other.
//!
//! Groups that are small beside a body have features of no other body, because their boxes would reach from one body to the next. Lanes
//! are left empty for that, at most an eighth as many as a body has features on either side of it.

use std::ops::Range;

use super::tree::LANES;
use crate::broad::{greater, lesser, order_by_median};

/// No feature: the box of the lane is empty, apart from all others.
pub(super) const HOLE: u32 = u32::MAX;

/// The feature of each lane, or [`HOLE`], and the rigid body it belongs to. `middles` order the features on each axis, `bodies` are where
/// the features of each body begin, and the body if it is rigid.
pub(super) fn order_of(middles: &[[f32; 3]], bodies: &[(usize, u32)]) -> (Vec<u32>, Vec<u32>) {
    let mut order = Vec::with_capacity(middles.len());
    let mut owners = Vec::new();
    for (features, rigid) in by_place(middles, bodies) {
        let (first, run) = (features.start as u32, run_of(features.len()));
        order.resize(order.len().next_multiple_of(run), HOLE);
        let within = order_by_median(middles[features].iter().copied(), false);
        order.extend(within.into_iter().map(|feature| feature + first));
        order.resize(order.len().next_multiple_of(run), HOLE);
        owners.resize(order.len(), rigid);
    }
    // nothing follows the last body
    while order.pop_if(|feature| *feature == HOLE).is_some() {}
    owners.truncate(order.len());
    (order, owners)
}

/// The lanes that have a feature, and the feature.
pub(super) fn filled(lanes: &[u32]) -> impl Iterator<Item = (usize, u32)> {
    let lanes = lanes.iter().copied().enumerate();
    lanes.filter(|&(_, feature)| feature != HOLE)
}

/// The features of each body and the body if it is rigid, in an order in which runs of bodies are compact: boxes around several bodies
/// would otherwise be as large as the scene, and meet each other.
fn by_place(middles: &[[f32; 3]], bodies: &[(usize, u32)]) -> Vec<(Range<usize>, u32)> {
    let ends = bodies.iter().skip(1).map(|&(next, _)| next);
    let bodies: Vec<_> = bodies
        .iter()
        .zip(ends.chain([middles.len()]))
        .map(|(&(first, rigid), end)| (first..end, rigid))
        .filter(|(features, _)| !features.is_empty())
        .collect();
    let twice_centre = |(features, _): &(Range<usize>, u32)| {
        let (mut least, mut most) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for middle in &middles[features.clone()] {
            for k in 0..3 {
                least[k] = lesser(middle[k], least[k]);
                most[k] = greater(middle[k], most[k]);
            }
        }
        [0, 1, 2].map(|k| least[k] + most[k])
    };
    let order = order_by_median(bodies.iter().map(twice_centre), false);
    order
        .into_iter()
        .map(|body| bodies[body as usize].clone())
        .collect()
}

/// A body of so many features begins and ends at a multiple of this: the largest power of eight that is at most an eighth of them, or 1.
fn run_of(features: usize) -> usize {
    let mut run = 1;
    while run * LANES * LANES <= features {
        run *= LANES;
    }
    run
}
