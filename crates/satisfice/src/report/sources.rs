//! What the sources of an engine proposed and found, over a run.

use serde::{Deserialize, Serialize};

/// What the sources of an engine proposed and found, over a run: for engines that [have several](crate::Engine::sources).
///
/// A row is written about ten times a decade of evaluations, and at the end.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SourceTrace {
    /// The sources.
    pub names: Vec<String>,
    /// Their counts, as the evaluations grow.
    pub rows: Vec<SourceRow>,
}

/// A row of a [`SourceTrace`].
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SourceRow {
    /// Evaluations so far, those of no source included: probes, start points, hits of the slice before.
    pub evaluations: u64,
    /// Candidates that each source has proposed so far.
    pub proposed: Vec<u64>,
    /// Hits among them that were new, in their island.
    pub hits: Vec<u64>,
}

/// What a source of an engine has proposed and found since the slice began.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SourceCount {
    /// Its name, in a word or two.
    pub name: &'static str,
    /// Candidates.
    pub proposed: u64,
    /// New hits among them.
    pub hits: u64,
}

impl SourceTrace {
    /// Whether the engine has no sources.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Writes a row of the sums over several engines of one kind; none for engines without sources.
    pub(crate) fn record(&mut self, evaluations: u64, engines: impl IntoIterator<Item = Vec<SourceCount>>) {
        let mut engines = engines.into_iter();
        let Some(first) = engines.next().filter(|counts| !counts.is_empty()) else {
            return;
        };
        if self.names.len() != first.len() {
            self.names = first.iter().map(|count| count.name.to_owned()).collect();
        }
        let mut row = SourceRow {
            evaluations,
            proposed: first.iter().map(|count| count.proposed).collect(),
            hits: first.iter().map(|count| count.hits).collect(),
        };
        for counts in engines {
            for (place, count) in counts.iter().enumerate().take(row.proposed.len()) {
                row.proposed[place] += count.proposed;
                row.hits[place] += count.hits;
            }
        }
        match self.rows.last_mut() {
            Some(last) if last.evaluations >= evaluations => *last = row,
            _ => self.rows.push(row),
        }
    }

    /// Adds the rows of a run that followed, after so many evaluations.
    pub(crate) fn append(&mut self, next: &Self, before: u64) {
        if self.rows.is_empty() {
            self.names.clone_from(&next.names);
        }
        if self.names != next.names {
            return;
        }
        let none = vec![0; self.names.len()];
        let (proposed, hits) = match self.rows.last() {
            Some(last) => (last.proposed.clone(), last.hits.clone()),
            None => (none.clone(), none),
        };
        let sums = |a: &[u64], b: &[u64]| a.iter().zip(b).map(|(a, b)| a + b).collect();
        self.rows.extend(next.rows.iter().map(|row| SourceRow {
            evaluations: before + row.evaluations,
            proposed: sums(&proposed, &row.proposed),
            hits: sums(&hits, &row.hits),
        }));
    }
}
