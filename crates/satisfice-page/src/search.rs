//! The page of a search: its hits in any two of their coordinates, how they came in, and a table of them.

use maud::{Markup, html};
use serde_json::{Value, json};

use crate::error::Error;
use crate::pack::Pack;
use crate::shell;

/// A solution with more coordinates is shown as text.
const COORDINATES: usize = 256;

/// A page that shows a search: hits over any two axes and over all of them, filtered by brushing; hits against evaluations and
/// time; which sources of the engine the candidates came from; a table of the hits sorted by F.
///
/// Solutions are JSON of any kind. Where all of them have numbers in the same places, such as vectors of one length, each place
/// is an axis; otherwise they are texts, and the axes are F, the evaluation and the time.
///
/// ```
/// use satisfice_page::SearchPage;
/// use serde_json::json;
/// let mut page = SearchPage::new("Two hits on a plane");
/// page.hit(&json!([0.25, 1.5]), 0.01, 17, 1e-5);
/// page.hit(&json!([0.75, 1.0]), 0.02, 40, 3e-5);
/// page.trace(17, 1e-5, 1);
/// page.trace(40, 3e-5, 2);
/// assert!(page.html()?.starts_with("<!DOCTYPE html>"));
/// # Ok::<(), satisfice_page::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct SearchPage {
    title: String,
    facts: Vec<(String, String)>,
    total: Option<u64>,
    reference: Option<u64>,
    /// Evaluations, seconds, hits.
    trace: Vec<[f64; 3]>,
    sources: Vec<String>,
    source_rows: Vec<SourceRow>,
    hits: Vec<Hit>,
}

/// What each source had proposed and found after so many evaluations.
#[derive(Debug, Clone)]
struct SourceRow {
    evaluations: u64,
    proposed: Vec<u64>,
    hits: Vec<u64>,
}

#[derive(Debug, Clone)]
struct Hit {
    solution: Value,
    /// F, evaluation, seconds.
    numbers: [f64; 3],
}

#[expect(clippy::cast_precision_loss, reason = "counts below 2^53")]
impl SearchPage {
    /// A page without hits.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            facts: Vec::new(),
            total: None,
            reference: None,
            trace: Vec::new(),
            sources: Vec::new(),
            source_rows: Vec::new(),
            hits: Vec::new(),
        }
    }

    /// A line of the legend.
    pub fn fact(&mut self, name: impl Into<String>, value: impl Into<String>) {
        self.facts.push((name.into(), value.into()));
    }

    /// How many hits the search found, if the page lists only some of them, and how many there are, if that is known.
    pub fn counts(&mut self, total: Option<u64>, reference: Option<u64>) {
        (self.total, self.reference) = (total, reference);
    }

    /// So many hits were found after so many evaluations and seconds; in order.
    pub fn trace(&mut self, evaluations: u64, seconds: f64, hits: u64) {
        self.trace.push([evaluations as f64, seconds, hits as f64]);
    }

    /// The sources from which the engine took its candidates, if it has several.
    pub fn sources(&mut self, names: impl IntoIterator<Item = String>) {
        self.sources = names.into_iter().collect();
    }

    /// So many candidates were taken from each of the [sources](SearchPage::sources) after so many evaluations, and so many of them were
    /// hits; in order.
    pub fn source_row(&mut self, evaluations: u64, proposed: &[u64], hits: &[u64]) {
        self.source_rows.push(SourceRow {
            evaluations,
            proposed: proposed.to_vec(),
            hits: hits.to_vec(),
        });
    }

    /// A hit: its solution, F of it, the evaluation that found it, from 1, and after how many seconds.
    pub fn hit(&mut self, solution: &Value, fitness: f64, evaluation: u64, seconds: f64) {
        self.hits.push(Hit {
            solution: solution.clone(),
            numbers: [fitness, evaluation as f64, seconds],
        });
    }

    /// The page.
    ///
    /// # Errors
    /// [`Error::Pack`] if the data cannot be compressed.
    pub fn html(&self) -> Result<String, Error> {
        let mut pack = Pack::default();
        let axes = self.axes();
        for (k, (_, values)) in axes.iter().enumerate() {
            pack.exact(&format!("axis {k}"), values);
        }
        for (k, name) in ["fitness", "evaluation", "seconds"].iter().enumerate() {
            pack.exact(
                name,
                &self.hits.iter().map(|hit| hit.numbers[k]).collect::<Vec<_>>(),
            );
        }
        for (k, name) in ["trace evaluations", "trace seconds", "trace hits"]
            .iter()
            .enumerate()
        {
            pack.exact(name, &self.trace.iter().map(|point| point[k]).collect::<Vec<_>>());
        }
        let column = |of: &dyn Fn(&SourceRow) -> u64| -> Vec<f64> {
            self.source_rows.iter().map(|row| of(row) as f64).collect()
        };
        pack.exact("source evaluations", &column(&|row| row.evaluations));
        for k in 0..self.sources.len() {
            let at = |counts: &[u64]| counts.get(k).copied().unwrap_or(0);
            pack.exact(&format!("source proposed {k}"), &column(&|row| at(&row.proposed)));
            pack.exact(&format!("source hits {k}"), &column(&|row| at(&row.hits)));
        }
        let sources: &[String] = if self.source_rows.is_empty() {
            &[]
        } else {
            &self.sources
        };
        let is_vector = |hit: &Hit| {
            let list = hit.solution.as_array();
            list.is_some_and(|list| list.len() == axes.len() && list.iter().all(Value::is_number))
        };
        let texts: Vec<String> = self.hits.iter().map(|hit| hit.solution.to_string()).collect();
        let header = json!({
            "title": self.title,
            "facts": self.facts,
            "total": self.total.unwrap_or(self.hits.len() as u64),
            "reference": self.reference,
            "sources": sources,
            "axes": axes.iter().map(|(name, _)| name).collect::<Vec<_>>(),
            // Vectors are shown from their coordinates.
            "texts": (!self.hits.iter().all(is_vector)).then_some(texts),
        });
        let data = pack.finish(header)?;
        let scripts = [
            include_str!("web/chart.js"),
            include_str!("web/sources.js"),
            include_str!("web/search.js"),
        ];
        Ok(shell::page(
            &self.title,
            "search",
            &markup(&self.title),
            &data,
            &scripts,
        ))
    }

    /// The places that have a number in every solution, with the numbers.
    fn axes(&self) -> Vec<(String, Vec<f64>)> {
        let mut all: Vec<(String, Vec<f64>)> = Vec::new();
        for (k, hit) in self.hits.iter().enumerate() {
            let mut found = Vec::new();
            numbers(&hit.solution, "x", &mut found);
            if k == 0 {
                all = found
                    .into_iter()
                    .map(|(name, value)| (name, vec![value]))
                    .collect();
            } else if found.len() == all.len() && found.iter().zip(&all).all(|(a, b)| a.0 == b.0) {
                for ((_, values), (_, value)) in all.iter_mut().zip(found) {
                    values.push(value);
                }
            } else {
                return Vec::new();
            }
            if all.len() > COORDINATES {
                return Vec::new();
            }
        }
        all
    }
}

/// The numbers within a value, each with its place.
fn numbers(value: &Value, place: &str, found: &mut Vec<(String, f64)>) {
    match value {
        Value::Number(number) => found.push((place.to_owned(), number.as_f64().unwrap_or(f64::NAN))),
        Value::Bool(truth) => found.push((place.to_owned(), f64::from(u8::from(*truth)))),
        Value::Array(list) => {
            for (k, part) in list.iter().enumerate() {
                numbers(
                    part,
                    &format!(
                        "{place}{}{k}",
                        if place.ends_with(char::is_numeric) {
                            "."
                        } else {
                            ""
                        }
                    ),
                    found,
                );
            }
        }
        Value::Object(map) => {
            for (name, part) in map {
                let place = if place == "x" {
                    name.clone()
                } else {
                    format!("{place}.{name}")
                };
                numbers(part, &place, found);
            }
        }
        Value::Null | Value::String(_) => {}
    }
}

fn markup(title: &str) -> Markup {
    html! {
        header { h1 { (title) } }
        div.below {
            dl #facts.columns aria-live="polite" {}
            div.row {
                div #chips.row {}
                button #clear type="button" hidden { "Select all hits" }
            }
            p.hint { "Drag across a chart to select hits; click to take that back. Colours: least F orange, greatest blue." }
            div.pair {
                section {
                    div.row { h2 { "Hits" } label { "over " select #xaxis {} } label { "and " select #yaxis {} } }
                    canvas #scatter.plot role="img" aria-label="Hits over two axes; the table below lists them" {}
                }
                section {
                    h2 { "Side by side" }
                    canvas #parallel.plot role="img" aria-label="Every hit as a line across all axes" {}
                    p.hint #omitted {}
                }
                section {
                    div.row { h2 { "Against evaluations" } label { input #log type="checkbox" checked; " logarithmic" } }
                    canvas #evaluations.plot role="img" aria-label="Hits against evaluations" {}
                }
                section { h2 { "Against time" } canvas #times.plot role="img" aria-label="Hits against time" {} }
            }
            section #sources hidden {
                h2 { "Sources of candidates" }
                div.pair {
                    canvas #sourceshares.plot role="img" aria-label="Which share of the candidates came from which source, against evaluations; the totals are in the table below" {}
                    canvas #sourcehits.plot role="img" aria-label="Hits of each source against evaluations" {}
                }
                div.wide { table #sourcetable {} }
            }
            form #filter.row {
                label { "Select by " select #faxis {} }
                label { "from " input #from type="number" step="any"; }
                label { "to " input #until type="number" step="any"; }
                button { "Select" }
            }
            section #picked hidden { h2 { "Hit" } dl #pickedfacts {} }
            div.row { h2 { "Table" } button #copy type="button" { "Copy as CSV" } span #copied role="status" {} }
            p #listed {}
            div.wide { table #hits {} }
            div.row #pages { button #back type="button" { "Back" } button #more type="button" { "More" } }
        }
        div #tip hidden {}
    }
}
