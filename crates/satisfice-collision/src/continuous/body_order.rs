//! The order of a tree's features: those of a body stay together, and so do those of bodies near each other.
//!
//! Groups that are small beside a body have features of no other body, because their boxes would reach from one body to the next. Lanes
//! are left empty for that, at most an eighth as many as a body has features on either side of it.

use std::ops::Range;

use super::boxes::LANES;
use super::tree::MIXED;
use crate::broad::order_by_median;

/// No feature: the box of the lane is empty, apart from all others.
pub(super) const HOLE: u32 = u32::MAX;

/// A body whose features go into a tree.
pub(super) struct InOrder<'o> {
    pub(super) body: u32,
    /// Whether features of the body collide with each other.
    pub(super) collides_with_itself: bool,
    /// The centre of the box around the body, times four.
    pub(super) centre: [f32; 3],
    /// The number of the body's first feature.
    pub(super) first: u32,
    /// The body's features in their order, counted from its first one.
    pub(super) order: &'o [u32],
}

/// What is in the lanes of the lowest level.
pub(super) struct Layout {
    /// The feature of each lane, or [`HOLE`].
    pub(super) order: Vec<u32>,
    /// The rigid body that each lane belongs to, or [`MIXED`]; empty if no body is rigid.
    pub(super) owners: Vec<u32>,
    /// The bodies in the order of their numbers, and the lanes of each.
    pub(super) bodies: Vec<(u32, Range<usize>)>,
}

/// Gives lanes to bodies, in an order in which runs of bodies are compact: boxes around several bodies would otherwise be as large as the
/// scene, and meet each other. Cost: O(n) for n features and O(b log b) for b bodies.
pub(super) fn lay_out(bodies: &[InOrder<'_>]) -> Layout {
    let mut order = Vec::with_capacity(bodies.iter().map(|body| body.order.len()).sum());
    let (mut owners, mut lanes) = (Vec::new(), Vec::with_capacity(bodies.len()));
    let has_rigid = bodies.iter().any(|body| !body.collides_with_itself);
    for next in order_by_median(bodies.iter().map(|body| body.centre), false) {
        let body = &bodies[next as usize];
        let run = run_of(body.order.len());
        order.resize(order.len().next_multiple_of(run), HOLE);
        let first = order.len();
        order.extend(body.order.iter().map(|feature| feature + body.first));
        lanes.push((body.body, first..order.len()));
        order.resize(order.len().next_multiple_of(run), HOLE);
        if has_rigid {
            let rigid = if body.collides_with_itself {
                MIXED
            } else {
                body.body
            };
            owners.resize(order.len(), rigid);
        }
    }
    // nothing follows the last body
    while order.pop_if(|feature| *feature == HOLE).is_some() {}
    owners.truncate(order.len());
    lanes.sort_unstable_by_key(|&(body, _)| body);
    Layout {
        order,
        owners,
        bodies: lanes,
    }
}

/// The lanes that have a feature, and the feature.
pub(super) fn filled(lanes: &[u32]) -> impl Iterator<Item = (usize, u32)> {
    let lanes = lanes.iter().copied().enumerate();
    lanes.filter(|&(_, feature)| feature != HOLE)
}

/// A body of so many features begins and ends at a multiple of this: the largest power of eight that is at most an eighth of them, or 1.
fn run_of(features: usize) -> usize {
    let mut run = 1;
    while run * LANES * LANES <= features {
        run *= LANES;
    }
    run
}
