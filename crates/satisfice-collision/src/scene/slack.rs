//! The contacts of two bodies that are expected to hold in the next frame, and by how much.
//!
//! A contact whose distance, with the bodies in the expected places, is below the threshold by more than the bodies are away from
//! these places still holds, whatever else is the case.

use crate::Placement;
use crate::broad::Pair;

/// The contacts of a record in the order of falling slack.
pub(super) struct Slack {
    /// Where the bodies are expected; `None` if one deforms: deforming bodies are expected to stay.
    pub(super) places: Option<[Placement; 2]>,
    /// By how much each contact will be below the threshold, rounded down.
    falling: Vec<f32>,
    pub(super) likely: Vec<Pair>,
}

impl Slack {
    /// Orders contacts by their slack, which is at least 0.
    pub(super) fn new(
        places: Option<[Placement; 2]>,
        contacts: &[Pair],
        slack: impl Fn(&Pair) -> f32,
    ) -> Self {
        // numbers that are not negative are ordered as their bits are
        let mut order: Vec<(u32, u32)> = (0..)
            .zip(contacts)
            .map(|(at, pair)| (!slack(pair).to_bits(), at))
            .collect();
        order.sort_unstable();
        Self {
            places,
            falling: order.iter().map(|(bits, _)| f32::from_bits(!bits)).collect(),
            likely: order.iter().map(|(_, at)| contacts[*at as usize]).collect(),
        }
    }

    /// How many of the contacts hold although the bodies are `drift` away from where they were expected.
    pub(super) fn holding(&self, drift: f64) -> usize {
        self.falling.partition_point(|&slack| f64::from(slack) > drift)
    }
}
