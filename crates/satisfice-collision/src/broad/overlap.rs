//! The region of each of two bodies that can have partners in the other: the overlap of their inflated boxes, tightened.

use super::clip::{BlockBounds, inflate, intersection, union};
use crate::Aabb;

/// Finds the parts of two bodies that can have partners in the other. Keeps its memory from call to call.
#[derive(Debug, Default)]
pub(crate) struct OverlapFinder {
    /// The runs of each body that reach into its region, ascending: often neighbours, so that work is shared out by these and
    /// not by all.
    pub(crate) runs: [Vec<u32>; 2],
}

impl OverlapFinder {
    /// For each body the region in which its points can be within `delta` of the other's; `None` if the bodies are apart.
    pub(crate) fn find(&mut self, a: &BlockBounds, b: &BlockBounds, delta: f64) -> Option<[Aabb; 2]> {
        let mut regions = [b.whole()?, a.whole()?].map(|whole| inflate(&whole, delta));
        intersection(&a.whole()?, &regions[0])?;
        // what is left of one body, run by run, tightens the region of the other
        for body in [0, 1, 0] {
            let (runs, list) = ([a, b][body], &mut self.runs[body]);
            runs.inside(&regions[body], list);
            let bounds = |&run: &u32| intersection(&runs.boxes()[run as usize], &regions[body]);
            let left = list.iter().filter_map(bounds);
            let left = left.reduce(|left, part| union(&left, &part))?;
            regions[1 - body] = intersection(&regions[1 - body], &inflate(&left, delta))?;
        }
        // that of the second body has become smaller since
        let [_, list] = &mut self.runs;
        list.retain(|&run| intersection(&b.boxes()[run as usize], &regions[1]).is_some());
        Some(regions)
    }
}
