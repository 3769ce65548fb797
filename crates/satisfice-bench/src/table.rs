//! Tables as plain text.

use comfy_table::{CellAlignment, Table, presets};

/// Rows below each other without lines, indented by `indent`; the first `left` columns are aligned left, the others right.
#[must_use]
pub fn plain<C: ToString>(rows: &[Vec<C>], indent: u16, left: usize) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING);
    for row in rows {
        table.add_row(row.iter().map(ToString::to_string));
    }
    for (index, column) in table.column_iter_mut().enumerate() {
        column.set_padding((if index == 0 { indent } else { 2 }, 0));
        if index >= left {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    let mut text = String::new();
    for line in table.lines() {
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned() {
        let rows = [vec!["engine", "hits"], vec!["a", "5"], vec!["random", "1,000"]];
        assert_eq!(
            plain(&rows, 2, 1),
            "  engine   hits\n  a           5\n  random  1,000\n"
        );
        assert_eq!(plain::<&str>(&[], 2, 1), "");
    }
}
