//! What waits in the search for the first impact, and in which order.

use std::cmp::Ordering;

/// Two groups of boxes that wait.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Waiting {
    /// When their boxes first meet.
    pub(super) time: f64,
    pub(super) kind: u8,
    pub(super) a: GroupOrFeature,
    pub(super) b: GroupOrFeature,
}

/// A group of boxes, or a feature.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct GroupOrFeature {
    pub(super) level: u8,
    pub(super) group: u32,
}

/// The level of nodes that are features.
pub(super) const FEATURE: u8 = u8::MAX;

impl Eq for Waiting {}

impl Ord for Waiting {
    /// The earliest is the greatest; among equals the lowest in the tree.
    fn cmp(&self, other: &Self) -> Ordering {
        let depth = |waiting: &Self| {
            (
                waiting.a.level != FEATURE,
                waiting.a.level.wrapping_add(waiting.b.level),
            )
        };
        let place = |waiting: &Self| (waiting.kind, waiting.a.group, waiting.b.group);
        other
            .time
            .total_cmp(&self.time)
            .then_with(|| depth(other).cmp(&depth(self)))
            .then_with(|| place(other).cmp(&place(self)))
    }
}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
