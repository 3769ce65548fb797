//! The regions of two bodies that can have partners in the other: the overlap of their inflated boxes, tightened.

use super::clip::{Runs, inflate, intersection, union};
use crate::Aabb;

/// For each body the region in which its points can be within `delta` of the other's; `None` if the bodies are apart.
pub(crate) fn regions(a: &Runs, b: &Runs, delta: f64) -> Option<[Aabb; 2]> {
    let mut regions = [b.whole()?, a.whole()?].map(|whole| inflate(&whole, delta));
    intersection(&a.whole()?, &regions[0])?;
    // what is left of one body, run by run, tightens the region of the other
    for body in [0, 1, 0] {
        let parts = [a, b][body]
            .boxes()
            .iter()
            .filter_map(|bounds| intersection(bounds, &regions[body]));
        let left = parts.reduce(|left, part| union(&left, &part))?;
        regions[1 - body] = intersection(&regions[1 - body], &inflate(&left, delta))?;
    }
    Some(regions)
}
