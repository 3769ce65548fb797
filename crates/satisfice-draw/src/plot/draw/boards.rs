//! Draws boards.

use kuva::render::color::Color;
use kuva::render::render::{PathData, Primitive, Scene, TextAnchor};

use super::{encode, title_size};
use crate::error::Error;
use crate::plot::{Board, Boards, Format};

/// Edge of a board, space around it and height of the title, in units; a PNG has two pixels per unit.
const EDGE: f64 = 216.0;
const GAP: f64 = 34.0;
const TITLE: f64 = 44.0;
const LIGHT: &str = "#f2ead9";
const DARK: &str = "#b9cfdd";
const QUEEN: &str = "#1b1b1b";

/// A queen in a unit square, y downwards: crown, points and base.
const CROWN: [(f64, f64); 11] = [
    (0.16, 0.26),
    (0.30, 0.56),
    (0.335, 0.17),
    (0.435, 0.54),
    (0.50, 0.13),
    (0.565, 0.54),
    (0.665, 0.17),
    (0.70, 0.56),
    (0.84, 0.26),
    (0.755, 0.74),
    (0.245, 0.74),
];
const PEARLS: [(f64, f64); 5] = [
    (0.16, 0.24),
    (0.335, 0.15),
    (0.5, 0.11),
    (0.665, 0.15),
    (0.84, 0.24),
];

/// Draws boards. The same boards give the same bytes.
///
/// # Errors
/// [`Error::Chart`] if the picture cannot be encoded.
pub fn draw_boards(boards: &Boards, format: Format) -> Result<Vec<u8>, Error> {
    let width = GAP + (EDGE + GAP) * boards.boards.len().max(1) as f64;
    let mut scene = Scene::new(width, TITLE + EDGE + 2.0 * GAP);
    let size = title_size(&boards.title, width);
    text(&mut scene, (0.5 * width, 28.0), &boards.title, size);
    for (index, board) in boards.boards.iter().enumerate() {
        let left = GAP + (EDGE + GAP) * index as f64;
        draw(&mut scene, board, (left, TITLE));
        let below = TITLE + EDGE + 40.0;
        text(&mut scene, (left + 0.5 * EDGE, below), &board.caption, 12);
    }
    encode(&scene, format)
}

fn draw(scene: &mut Scene, board: &Board, (left, top): (f64, f64)) {
    let n = board.rows.len();
    let cell = EDGE / n.max(1) as f64;
    for column in 0..n {
        let x = left + cell * column as f64;
        for row in 0..n {
            scene.add(Primitive::Rect {
                x,
                y: top + EDGE - cell * (row + 1) as f64,
                width: cell,
                height: cell,
                fill: Color::from(if (row + column) % 2 == 0 { DARK } else { LIGHT }),
                stroke: None,
                stroke_width: None,
                opacity: None,
            });
        }
        // Letters for columns and numbers for rows, as on a chess board.
        let letter = u8::try_from(column)
            .ok()
            .filter(|c| *c < 26)
            .map(|c| char::from(b'a' + c));
        let letter = letter.map_or_else(|| (column + 1).to_string(), String::from);
        text(scene, (x + 0.5 * cell, top + EDGE + 15.0), &letter, 11);
        let middle = top + EDGE - cell * (column as f64 + 0.5) + 4.0;
        text(scene, (left - 10.0, middle), &(column + 1).to_string(), 11);
    }
    for (column, &row) in board.rows.iter().enumerate() {
        let corner = (
            left + cell * column as f64,
            top + EDGE - cell * (f64::from(row) + 1.0),
        );
        queen(scene, corner, cell);
    }
}

fn queen(scene: &mut Scene, (left, top): (f64, f64), cell: f64) {
    let mut outline = String::new();
    for (index, (x, y)) in CROWN.iter().enumerate() {
        let word = if index == 0 { 'M' } else { 'L' };
        outline.push_str(&format!("{word} {:.2} {:.2} ", left + cell * x, top + cell * y));
    }
    outline.push('Z');
    scene.add(Primitive::Path(Box::new(PathData {
        d: outline,
        fill: Some(Color::from(QUEEN)),
        stroke: Color::None,
        stroke_width: 0.0,
        opacity: None,
        stroke_dasharray: None,
    })));
    for (x, y) in PEARLS {
        scene.add(Primitive::Circle {
            cx: left + cell * x,
            cy: top + cell * y,
            r: 0.045 * cell,
            fill: Color::from(QUEEN),
            fill_opacity: None,
            stroke: None,
            stroke_width: None,
        });
    }
    scene.add(Primitive::Rect {
        x: left + 0.23 * cell,
        y: top + 0.78 * cell,
        width: 0.54 * cell,
        height: 0.09 * cell,
        fill: Color::from(QUEEN),
        stroke: None,
        stroke_width: None,
        opacity: None,
    });
}

fn text(scene: &mut Scene, (x, y): (f64, f64), content: &str, size: u32) {
    scene.add(Primitive::Text {
        x,
        y,
        content: content.to_owned(),
        size,
        anchor: TextAnchor::Middle,
        rotate: None,
        bold: false,
        color: None,
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_board_has_a_square_a_cell_and_a_queen_a_column() {
        let boards = |rows: Vec<u32>| Boards {
            title: "queens".to_owned(),
            boards: vec![Board {
                caption: "rows & columns".to_owned(),
                rows,
            }],
        };
        let svg =
            |rows: Vec<u32>| String::from_utf8(draw_boards(&boards(rows), Format::Svg).unwrap()).unwrap();
        let four = svg(vec![1, 3, 0, 2]);
        assert_eq!(four.matches(LIGHT).count() + four.matches(DARK).count(), 16);
        assert_eq!(four.matches("<path").count(), 4);
        assert!(four.contains("rows &amp; columns"));
        assert_ne!(four, svg(vec![2, 0, 3, 1]));
        assert_eq!(svg(Vec::new()).matches("<path").count(), 0);
    }
}
