//! What a study or a group of runs has to show: text, tables, figures, pictures.

use satisfice_draw::plot::Chart;

use crate::table;

/// A chart with the name of its file and what it shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Without extension.
    pub name: &'static str,
    /// A description.
    pub caption: String,
    /// The picture.
    pub chart: Chart,
}

/// The result of a study.
#[derive(Debug, Clone, Default)]
pub struct Finding {
    /// Heading.
    pub title: String,
    /// Paragraphs.
    pub text: Vec<String>,
    /// Tables: a caption, and rows of which the first is the heading.
    pub tables: Vec<(String, Vec<Vec<String>>)>,
    /// Figures.
    pub figures: Vec<Figure>,
    /// Pictures as PNG with caption and file name without extension.
    pub pictures: Vec<(String, String, Vec<u8>)>,
}

impl Finding {
    /// The tables for a terminal.
    #[must_use]
    pub fn table(&self) -> String {
        let mut text = format!("{}\n", self.title);
        for (caption, rows) in &self.tables {
            text.push_str(&format!("  {caption}\n"));
            text.push_str(&table::plain(rows, 4, 0));
        }
        text
    }
}
