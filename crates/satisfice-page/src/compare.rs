//! The page of a comparison: how the hits of each engine come in, seed by seed.

use maud::{Markup, html};
use serde_json::{Value, json};

use crate::error::Error;
use crate::pack::Pack;
use crate::shell;

/// A page that compares engines on one or more problems: curves of hits with engines switched on and off, seeds as thin lines,
/// and figures under the pointer.
///
/// ```
/// use satisfice_page::ComparePage;
/// let mut page = ComparePage::new("Two engines");
/// page.problem("islands, 100 evaluations", Some(12), false);
/// page.run("random", 1, [(10, 1e-5, 1), (100, 1e-4, 3)]);
/// page.run("portfolio", 1, [(7, 1e-5, 1), (60, 1e-4, 12)]);
/// assert!(page.html()?.starts_with("<!DOCTYPE html>"));
/// # Ok::<(), satisfice_page::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ComparePage {
    title: String,
    back: Option<(String, String)>,
    groups: Vec<Group>,
}

#[derive(Debug, Clone)]
struct Group {
    title: String,
    reference: Option<u64>,
    timed: bool,
    engines: Vec<(String, Vec<Run>)>,
}

#[derive(Debug, Clone)]
struct Run {
    seed: u64,
    /// Evaluations, seconds, hits.
    curve: Vec<[f64; 3]>,
}

impl ComparePage {
    /// A page without problems.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            back: None,
            groups: Vec::new(),
        }
    }

    /// A link to another page beside this one, such as the report that this one belongs to: its file and what it is called.
    pub fn link(&mut self, file: impl Into<String>, text: impl Into<String>) {
        self.back = Some((file.into(), text.into()));
    }

    /// Begins a problem: what it is called, the number of all its hits where that is known, and whether its times mean anything.
    pub fn problem(&mut self, title: impl Into<String>, reference: Option<u64>, timed: bool) {
        self.groups.push(Group {
            title: title.into(),
            reference,
            timed,
            engines: Vec::new(),
        });
    }

    /// A run of an engine on the last problem: evaluations, seconds and hits at moments in order. Without a problem it has no
    /// effect.
    #[expect(clippy::cast_precision_loss, reason = "counts below 2^53")]
    pub fn run(&mut self, engine: &str, seed: u64, curve: impl IntoIterator<Item = (u64, f64, u64)>) {
        let Some(group) = self.groups.last_mut() else {
            return;
        };
        let curve = curve.into_iter();
        let run = Run {
            seed,
            curve: curve
                .map(|(evaluations, seconds, hits)| [evaluations as f64, seconds, hits as f64])
                .collect(),
        };
        match group.engines.iter_mut().find(|(name, _)| name == engine) {
            Some((_, runs)) => runs.push(run),
            None => group.engines.push((engine.to_owned(), vec![run])),
        }
    }

    /// The page.
    ///
    /// # Errors
    /// [`Error::Pack`] if the data cannot be compressed.
    pub fn html(&self) -> Result<String, Error> {
        let mut pack = Pack::default();
        let points = || {
            let engines = self.groups.iter().flat_map(|group| &group.engines);
            engines.flat_map(|(_, runs)| runs).flat_map(|run| &run.curve)
        };
        for (k, name) in ["evaluations", "seconds", "hits"].iter().enumerate() {
            pack.exact(name, &points().map(|point| point[k]).collect::<Vec<_>>());
        }
        let runs = |runs: &[Run]| -> Vec<Value> {
            runs.iter()
                .map(|run| json!({ "seed": run.seed.to_string(), "points": run.curve.len() }))
                .collect()
        };
        let groups = self.groups.iter().map(|group| {
            let engines = group.engines.iter();
            json!({
                "title": group.title,
                "reference": group.reference,
                "timed": group.timed,
                "engines": engines.map(|(name, all)| json!({ "name": name, "runs": runs(all) })).collect::<Vec<_>>(),
            })
        });
        let header = json!({ "title": self.title, "groups": groups.collect::<Vec<_>>() });
        let data = pack.finish(header)?;
        let scripts = [include_str!("web/chart.js"), include_str!("web/compare.js")];
        Ok(shell::page(
            &self.title,
            "compare",
            &self.markup(),
            &data,
            &scripts,
        ))
    }

    fn markup(&self) -> Markup {
        html! {
            header {
                h1 { (self.title) }
                @if let Some((file, text)) = &self.back { a href=(file) { (text) } }
            }
            div.below {
                div.row #engines {}
                div.row {
                    button #all type="button" { "All" }
                    button #none type="button" { "None" }
                    label { input #seeds type="checkbox" checked; " every seed" }
                    label { input #log type="checkbox" checked; " logarithmic" }
                }
                div #charts {}
            }
            div #tip hidden {}
        }
    }
}
