//! Tickets, and what is said of them.

/// The number of a solution that is out to be evaluated; counted from 0 in the order asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
pub struct Ticket(pub(super) u64);

impl Ticket {
    /// Its number.
    #[must_use]
    pub fn number(self) -> u64 {
        self.0
    }
}

impl From<u64> for Ticket {
    fn from(number: u64) -> Self {
        Self(number)
    }
}

impl core::fmt::Display for Ticket {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        self.0.fmt(f)
    }
}

/// A solution to evaluate.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Asked<T> {
    /// Under which its fitness is told.
    pub ticket: Ticket,
    /// The solution.
    pub solution: T,
}

/// What became of a told value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Told {
    /// It was taken.
    Taken,
    /// The ticket had a value already: the first one counts.
    Again,
    /// The ticket was forgotten before.
    Late,
    /// The slice had ended, by its number of hits.
    Over,
}

/// In what order answers reach the engines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Order {
    /// In the order asked, whatever the order told.
    Ordered,
    /// In the order told.
    Eager,
}

/// What happened to the tickets of a slice.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct TicketCounts {
    /// Given out.
    pub asked: u64,
    /// Values taken.
    pub taken: u64,
    /// Values that were dropped because their ticket had one.
    pub again: u64,
    /// Values that were dropped because their ticket was forgotten.
    pub late: u64,
    /// Values that were dropped because the slice had ended.
    pub over: u64,
    /// Tickets forgotten.
    pub forgotten: u64,
}
