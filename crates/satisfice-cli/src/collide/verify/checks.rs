//! What a report says against what it should say, collected.

use satisfice_catalogue::Mismatch;
use serde::Serialize;

#[derive(Debug, Default)]
pub(in super::super) struct Checks {
    wrong: Vec<Mismatch>,
}

impl Checks {
    /// The value at a place, which is wrong unless `holds`.
    pub(in super::super) fn that(
        &mut self,
        holds: bool,
        place: impl Into<String>,
        found: impl Serialize,
        expected: impl ToString,
    ) {
        if !holds {
            let found = serde_json::to_value(found).unwrap_or_default();
            self.wrong.push(Mismatch::new(place, found, expected));
        }
    }

    /// The value at a place, which has to be this one; `why` ends the sentence.
    pub(in super::super) fn equal<T: Serialize + PartialEq>(
        &mut self,
        place: &str,
        found: &T,
        expected: &T,
        why: &str,
    ) {
        let wanted = serde_json::to_value(expected).unwrap_or_default();
        self.that(found == expected, place, found, format!("{wanted}, {why}"));
    }

    pub(in super::super) fn wrong(self) -> Vec<Mismatch> {
        self.wrong
    }
}
