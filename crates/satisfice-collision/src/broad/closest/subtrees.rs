//! What is known of the items of every subtree beside their boxes: the least number, and whether all are at one place.

use crate::Shape;
use crate::broad::boxes::BoxTree;

/// Of one tree.
pub(super) struct Subtrees {
    /// The least number of an item below each group, by level.
    least: Vec<Vec<u32>>,
    /// For each item, in the order of the tree, where the run of equal ones begins that it is in.
    runs: Vec<u32>,
}

impl Subtrees {
    /// Looks at each item once.
    pub(super) fn new(tree: &BoxTree, shape: impl Fn(u32) -> Shape) -> Self {
        let least_of = |items: &[u32]| -> Vec<u32> {
            let groups = items.chunks(8);
            groups.filter_map(|group| group.iter().copied().min()).collect()
        };
        let mut least = vec![least_of(&tree.order)];
        while let Some(below) = least.last().filter(|level| level.len() > 1) {
            least.push(least_of(below));
        }
        let mut runs = Vec::with_capacity(tree.order.len());
        let mut before: Option<(u32, Shape)> = None;
        for (place, &item) in (0..).zip(&tree.order) {
            let shape = shape(item);
            let start = before
                .filter(|(_, other)| *other == shape)
                .map_or(place, |(start, _)| start);
            runs.push(start);
            before = Some((start, shape));
        }
        Self { least, runs }
    }

    /// The least number of an item below a group.
    pub(super) fn least(&self, level: u8, group: u32) -> u32 {
        self.least[level as usize][group as usize]
    }

    /// Whether all items below a group have the same coordinates.
    pub(super) fn is_uniform(&self, level: u8, group: u32) -> bool {
        let items = 8_usize << (3 * u32::from(level));
        let start = group as usize * items;
        let end = (start + items).min(self.runs.len());
        self.runs[end - 1] as usize <= start
    }
}
