//! All ways to put six queens on a board so that none attacks another, drawn as boards.
//!
//! `cargo run --release -p satisfice-draw --example six_queens`; writes to `out/six_queens`, or to the folder `SATISFICE_OUT`.

use std::error::Error;

use satisfice_draw::plot::{Board, Boards, draw_boards};
use satisfice_problems::{Queens, backtrack};

mod gallery;

fn main() -> Result<(), Box<dyn Error>> {
    let problem = Queens::new(6)?;
    let mut exact: Vec<Vec<u32>> = Vec::new();
    let tree = backtrack(&problem, 1_000_000, &mut |rows| exact.push(rows.to_vec()));
    assert!(tree.complete);
    let report = gallery::search(&problem, 200_000, tree.solutions)?;
    println!("{report}");

    let mut solutions: Vec<Vec<u32>> = report.hits().map(|hit| hit.solution.clone()).collect();
    solutions.sort();
    for rows in &solutions {
        assert!(
            is_peaceful(rows),
            "{rows:?} is reported, but two of its queens attack"
        );
    }
    assert_eq!(solutions, exact, "backtracking finds others");
    println!(
        "{} solutions, as backtracking finds them in {} nodes; there is one but for rotations and reflections",
        tree.solutions, tree.nodes
    );
    let images: Vec<Vec<u32>> = symmetric(&solutions[0]);
    assert!(solutions.iter().all(|rows| images.contains(rows)));

    let boards = Boards {
        title: "Six queens: all 4 solutions".to_owned(),
        boards: solutions
            .iter()
            .map(|rows| Board {
                caption: format!("rows {}", places(rows)),
                rows: rows.clone(),
            })
            .collect(),
    };
    gallery::save("six_queens", |format| draw_boards(&boards, format))
}

/// The row of the queen in each column from left to right, from 1.
fn places(rows: &[u32]) -> String {
    let words: Vec<_> = rows.iter().map(|row| (row + 1).to_string()).collect();
    words.join(" ")
}

/// No two queens share a row or a diagonal. Counted along lines; the problem itself looks at pairs.
fn is_peaceful(rows: &[u32]) -> bool {
    let n = rows.len() as u32;
    let on = |line: &dyn Fn(u32, u32) -> u32| {
        let mut lines: Vec<u32> = (0..).zip(rows).map(|(column, row)| line(column, *row)).collect();
        lines.sort_unstable();
        lines.dedup();
        lines.len() == rows.len()
    };
    on(&|_, row| row) && on(&|column, row| column + row) && on(&|column, row| n + column - row)
}

/// The eight rotations and reflections of the board.
fn symmetric(rows: &[u32]) -> Vec<Vec<u32>> {
    let n = rows.len();
    let turned = |rows: &Vec<u32>| {
        let mut other = vec![0; n];
        for (column, &row) in rows.iter().enumerate() {
            other[row as usize] = (n - 1 - column) as u32;
        }
        other
    };
    let mut images = vec![rows.to_vec()];
    for _ in 0..3 {
        images.push(turned(&images[images.len() - 1]));
    }
    let reflected = images.iter().map(|rows| rows.iter().rev().copied().collect());
    let reflected: Vec<_> = reflected.collect();
    images.extend(reflected);
    images
}
