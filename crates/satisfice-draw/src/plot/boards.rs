//! Boards with a queen in each column.

/// Boards side by side, under a title.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Boards {
    /// What they show.
    pub title: String,
    /// The boards, left to right.
    pub boards: Vec<Board>,
}

/// A square board.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Board {
    /// The text below it.
    pub caption: String,
    /// The row of each column's queen, from 0 at the bottom; the board is as wide as this is long.
    pub rows: Vec<u32>,
}
