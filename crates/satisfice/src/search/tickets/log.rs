//! What was asked and told, in that order.

use super::Ticket;
use crate::scalar::Real;

/// A fitness, bit by bit: NaN and infinities survive every format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct ValueBits(u64);

impl ValueBits {
    /// Of a value; `f32` values are widened exactly.
    #[must_use]
    pub fn of<S: Real>(value: S) -> Self {
        Self(value.f64().to_bits())
    }

    /// The value.
    #[must_use]
    pub fn value<S: Real>(self) -> S {
        S::of(f64::from_bits(self.0))
    }
}

/// One thing that happened to a slice of tickets.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum TicketEvent<T> {
    /// [`Tickets::ask`](super::Tickets::ask): how many were wanted, and how many were given.
    Asked {
        /// Wanted.
        wanted: u64,
        /// Given, with the next numbers.
        given: u64,
    },
    /// [`Tickets::tell`](super::Tickets::tell).
    Told {
        /// The ticket.
        ticket: Ticket,
        /// Its fitness.
        value: ValueBits,
    },
    /// [`Tickets::forget`](super::Tickets::forget).
    Forgotten {
        /// The ticket.
        ticket: Ticket,
    },
    /// [`Tickets::inform`](super::Tickets::inform).
    Informed {
        /// The solution.
        solution: T,
        /// Its fitness.
        value: ValueBits,
    },
}

/// Everything that happened to a slice of tickets. Memory: the solution's, and 24 bytes an event.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct TicketLog<T> {
    events: Vec<TicketEvent<T>>,
}

impl<T> Default for TicketLog<T> {
    fn default() -> Self {
        Self { events: Vec::new() }
    }
}

impl<T> TicketLog<T> {
    /// The events, in order.
    #[must_use]
    pub fn events(&self) -> &[TicketEvent<T>] {
        &self.events
    }

    /// Appends an event; asking for nothing is none.
    pub(super) fn push(&mut self, event: TicketEvent<T>) {
        if !matches!(event, TicketEvent::Asked { wanted: 0, .. }) {
            self.events.push(event);
        }
    }
}
