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
    /// It was taken. In [eager](Order::Eager) order it is entered at once. In [ordered](Order::Ordered) order it is entered once its batch is complete,
    /// unless an earlier value of that batch ends the slice by a limit of hits or by patience: then it is dropped, as
    /// [`Search::run`](crate::Search::run) makes no use of it, and counts as [`TicketCounts::unused`].
    Taken,
    /// The ticket had a value already: the first one counts.
    Again,
    /// The ticket was forgotten before.
    Late,
    /// The slice had ended, by its limit of hits or by its patience, and the value was dropped. Only in [eager](Order::Eager) order: in the other one
    /// no ticket stays open when a slice ends so.
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
    /// Values taken, the unused ones included.
    pub taken: u64,
    /// Values taken and then dropped because an earlier one of their batch had ended the slice by a limit of hits or by patience; only in
    /// [ordered](Order::Ordered) order. They are no evaluations of the report.
    pub unused: u64,
    /// Values that were dropped because their ticket had one.
    pub again: u64,
    /// Values that were dropped because their ticket was forgotten.
    pub late: u64,
    /// Values that were dropped because the slice had ended by a limit of hits or by patience.
    pub over: u64,
    /// Tickets forgotten.
    pub forgotten: u64,
}
