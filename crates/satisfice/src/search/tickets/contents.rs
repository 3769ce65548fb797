//! What a checkpoint holds of tickets.

use super::log::{TicketLog, ValueBits};
use super::ticket::{Order, TicketCounts};
use crate::state::State;

/// The tickets of a slice.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(in crate::search) struct SavedTickets<T> {
    pub(super) order: Order,
    pub(super) next: u64,
    pub(super) open: Vec<(u64, T)>,
    pub(super) forgotten: Vec<u64>,
    pub(super) counts: TicketCounts,
    pub(super) waits: bool,
    pub(super) log: TicketLog<T>,
    pub(super) informed: Vec<(T, ValueBits)>,
    pub(super) state: State,
}
