//! The order in which a tree takes bodies: neighbours in it are near each other.

use std::ops::Range;

use crate::broad::{greater, lesser, order_by_median};

/// The features of each body and the body if it is rigid, in an order in which runs of bodies are compact: boxes around several bodies
/// would otherwise be as large as the scene, and meet each other.
pub(super) fn by_place(middles: &[[f32; 3]], bodies: &[(usize, u32)]) -> Vec<(Range<usize>, u32)> {
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
