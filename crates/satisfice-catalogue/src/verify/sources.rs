//! What the sources of an engine proposed and found: rows that grow, and no more hits than there are.

use super::Mismatch;
use crate::report::RunReport;

pub(super) fn check(report: &RunReport, wrong: &mut Vec<Mismatch>) {
    let sources = &report.sources;
    let none = vec![0; sources.names.len()];
    let mut before = (0, &none, &none);
    for (index, row) in sources.rows.iter().enumerate() {
        let place = |part: &str| format!("sources.rows[{index}].{part}");
        if row.evaluations < before.0 || row.evaluations > report.counts.evaluations {
            let expected = format!("from {} to {}", before.0, report.counts.evaluations);
            wrong.push(Mismatch::new(place("evaluations"), row.evaluations, expected));
        }
        for (part, counts, last) in [
            ("proposed", &row.proposed, before.1),
            ("hits", &row.hits, before.2),
        ] {
            let grow = counts.len() == none.len() && counts.iter().zip(last).all(|(now, last)| now >= last);
            if !grow {
                let expected = "a count of each source that does not fall";
                wrong.push(Mismatch::new(place(part), format!("{counts:?}"), expected));
            }
        }
        let found = row.hits.iter().fold(0_u64, |sum, &hits| sum.saturating_add(hits));
        let most = most_hits(report);
        if found > most
            || row
                .hits
                .iter()
                .zip(&row.proposed)
                .any(|(hits, proposed)| hits > proposed)
        {
            let expected = format!("no more than each source has proposed, and {most} of all");
            wrong.push(Mismatch::new(place("hits"), format!("{:?}", row.hits), expected));
        }
        before = (row.evaluations, &row.proposed, &row.hits);
    }
}

/// Each slice and each island counts the hits that are new to it.
fn most_hits(report: &RunReport) -> u64 {
    let of_slices = report.slices.iter().map(|slice| slice.hits);
    let found = of_slices.fold(0_u64, u64::saturating_add).max(report.hits);
    found.saturating_mul(report.spec.islands as u64)
}
