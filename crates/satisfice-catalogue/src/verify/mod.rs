//! Whether a report is correct: its solutions are evaluated again, and its accounting is checked.

mod accounting;
mod slices;
mod solutions;
mod sources;
mod unseen;

use core::fmt;

pub use accounting::accounting;
pub use solutions::{LISTED_BEFORE, best_by, solutions, solutions_by};

use crate::report::{RunReport, recall};

/// A value in a report that does not fit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mismatch {
    /// The place in the report, e.g. `solutions[3].fitness`.
    pub place: String,
    /// The value in the report.
    pub found: String,
    /// The value expected.
    pub expected: String,
}

impl Mismatch {
    /// A mismatch at `place`: `found` instead of `expected`.
    #[must_use]
    #[expect(
        clippy::needless_pass_by_value,
        reason = "a number or a text, by value or by reference"
    )]
    pub fn new(place: impl Into<String>, found: impl ToString, expected: impl ToString) -> Self {
        Self {
            place: place.into(),
            found: found.to_string(),
            expected: expected.to_string(),
        }
    }
}

impl fmt::Display for Mismatch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: found {}, expected {}",
            self.place, self.found, self.expected
        )
    }
}

/// Checks the counts of a report against the number of all hits, where that is known.
#[must_use]
pub fn reference(report: &RunReport, reference: Option<u64>) -> Vec<Mismatch> {
    let mut mismatches = Vec::new();
    // An interrupted run has not counted the reference.
    if let (Some(found), Some(expected)) = (report.reference_hits, reference)
        && found != expected
    {
        mismatches.push(Mismatch::new("reference_hits", found, expected));
    }
    if report.reference_hits.is_some() && reference.is_none() {
        mismatches.push(Mismatch::new(
            "reference_hits",
            report.reference_hits.unwrap_or_default(),
            "null: the number of hits of this problem is not known",
        ));
    }
    let expected = report
        .reference_hits
        .and_then(|reference| recall(report.hits, reference));
    if report.recall != expected {
        mismatches.push(Mismatch::new("recall", shown(report.recall), shown(expected)));
    }
    if let Some(reference) = reference {
        if report.hits > reference {
            mismatches.push(Mismatch::new(
                "hits",
                report.hits,
                format!("at most all {reference}"),
            ));
        }
        if report.completeness == satisfice::Completeness::Proved && report.hits != reference {
            mismatches.push(Mismatch::new(
                "completeness",
                "Proved",
                format!(
                    "Unknown: there are {reference} hits and {} are listed",
                    report.hits
                ),
            ));
        }
    }
    mismatches
}

fn shown(value: Option<f64>) -> String {
    value.map_or_else(|| "null".to_owned(), |value| value.to_string())
}
