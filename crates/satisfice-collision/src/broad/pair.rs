//! A pair of serial numbers.

/// A pair of serial numbers. Ordered by `a`, then by `b`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Pair {
    /// Number in the first body; in the only body the lower number.
    pub a: u32,
    /// Number in the second body; in the only body the higher number.
    pub b: u32,
}
