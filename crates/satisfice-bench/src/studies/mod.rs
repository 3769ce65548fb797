//! Studies: what a grid of engines and problems cannot say, such as a scene that moves. A suite names them.

mod cloth_frames;

use satisfice::Cancel;

use crate::error::Error;
use crate::sweep::figures::Figure;

/// What a study found.
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

/// What runs a study.
pub type Run = fn(u64, &Cancel, &mut dyn FnMut(&str)) -> Result<Option<Finding>, Error>;

/// A study.
#[derive(Debug, Clone, Copy)]
pub struct Study {
    /// Its name.
    pub name: &'static str,
    /// Runs it; `None` once it is cancelled. It is told how many seeds to use, and tells how far it is.
    pub run: Run,
}

/// All of them.
pub static STUDIES: &[Study] = &[
    Study {
        name: "cloth-frames",
        run: cloth_frames::run,
    },
    Study {
        name: "cloth-frames-smoke",
        run: cloth_frames::smoke,
    },
];

/// The study with this name.
///
/// # Errors
/// [`Error::Search`] with the nearest name.
pub fn find(name: &str) -> Result<&'static Study, Error> {
    let unknown = || satisfice::Error::unknown("study", name, STUDIES.iter().map(|study| study.name));
    STUDIES
        .iter()
        .find(|study| study.name == name)
        .ok_or_else(|| unknown().into())
}

impl Finding {
    /// The tables for a terminal.
    #[must_use]
    pub fn table(&self) -> String {
        let mut text = format!("{}\n", self.title);
        for (caption, rows) in &self.tables {
            text.push_str(&format!("  {caption}\n"));
            let columns = rows.first().map_or(0, Vec::len);
            let width = |column: usize| {
                rows.iter()
                    .map(|row| row[column].chars().count())
                    .max()
                    .unwrap_or(0)
            };
            let widths: Vec<usize> = (0..columns).map(width).collect();
            for row in rows {
                let cells = row
                    .iter()
                    .zip(&widths)
                    .map(|(cell, width)| format!("{cell:>width$}"));
                text.push_str(&format!("    {}\n", cells.collect::<Vec<_>>().join("  ")));
            }
        }
        text
    }
}
