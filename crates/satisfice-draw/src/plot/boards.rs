//! Boards with a queen in each column.

/// Boards side by side, under a title.
///
/// ```
/// use satisfice_draw::plot::{Board, Boards, Format, draw_boards};
/// let board = Board { caption: "four queens".to_owned(), rows: vec![1, 3, 0, 2] };
/// let boards = Boards { title: "Queens".to_owned(), boards: vec![board] };
/// assert!(draw_boards(&boards, Format::Svg)?.starts_with(b"<svg"));
/// # Ok::<(), satisfice_draw::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Boards {
    /// The title.
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
