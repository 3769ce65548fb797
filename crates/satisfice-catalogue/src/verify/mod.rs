//! Whether a record is true: its solutions are evaluated anew, its books are checked against each other.

mod books;
mod solutions;

use core::fmt;

pub use books::books;
pub use solutions::{LISTED_BEFORE, solutions, solutions_by};

use crate::record::{Record, recall};

/// Something in a record that does not fit.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mismatch {
    /// Where in the record, e.g. `solutions[3].fitness`.
    pub place: String,
    /// What stands there.
    pub found: String,
    /// What should.
    pub expected: String,
}

impl Mismatch {
    /// At `place`, `found` stands instead of `expected`.
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

/// Checks the counts of a record against the true number of hits, where that is known.
#[must_use]
pub fn reference(record: &Record, reference: Option<u64>) -> Vec<Mismatch> {
    let mut mismatches = Vec::new();
    // A run that was interrupted has not counted the reference.
    if let (Some(found), Some(expected)) = (record.reference_hits, reference)
        && found != expected
    {
        mismatches.push(Mismatch::new("reference_hits", found, expected));
    }
    if record.reference_hits.is_some() && reference.is_none() {
        mismatches.push(Mismatch::new(
            "reference_hits",
            record.reference_hits.unwrap_or_default(),
            "null: the number of hits of this problem is not known",
        ));
    }
    let expected = record
        .reference_hits
        .and_then(|reference| recall(record.hits, reference));
    if record.recall != expected {
        mismatches.push(Mismatch::new("recall", shown(record.recall), shown(expected)));
    }
    if let Some(reference) = reference {
        if record.hits > reference {
            mismatches.push(Mismatch::new(
                "hits",
                record.hits,
                format!("at most the {reference} that there are"),
            ));
        }
        if record.completeness == satisfice::Completeness::Proved && record.hits != reference {
            mismatches.push(Mismatch::new(
                "completeness",
                "Proved",
                format!(
                    "Unknown: there are {reference} hits and {} are listed",
                    record.hits
                ),
            ));
        }
    }
    mismatches
}

fn shown(value: Option<f64>) -> String {
    value.map_or_else(|| "null".to_owned(), |value| value.to_string())
}
