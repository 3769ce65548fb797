//! How far apart distinct hits are, learned from points that turned out to be the same as a known hit.
//!
//! A problem may recognise a hit only once it is evaluated (its canonical form is polished). The engine cannot ask for
//! that radius, but it can learn it.

use super::reach::is_at_most;
use super::record::Record;
use super::units::Units;

/// Outcomes that the radius is learned from: the latest.
const LATEST: usize = 64;

/// The radius around hits, in units of the axes, that best tells duplicates from new hits: with the fewest of the latest
/// outcomes on the wrong side. 0 where there are no duplicates.
pub(super) fn radius(record: &Record, units: &Units) -> f64 {
    if record.duplicates.is_empty() {
        return 0.0;
    }
    let duplicates = record
        .duplicates
        .iter()
        .rev()
        .take(LATEST)
        .map(|&i| (nearest(record, units, i), false));
    let hits = record
        .hits
        .iter()
        .rev()
        .take(LATEST)
        .map(|&i| (nearest(record, units, i), true));
    let mut all: Vec<(f64, bool)> = duplicates.chain(hits).filter(|(d, _)| d.is_finite()).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Errors of a radius just below the first: all duplicates.
    let mut errors = all.iter().filter(|(_, is_new)| !is_new).count();
    let mut best = (errors, 0.0);
    for &(distance, is_new) in &all {
        errors = if is_new { errors + 1 } else { errors - 1 };
        if errors < best.0 {
            best = (errors, distance);
        }
    }
    // Halfway to the next new hit; without one, twice as far, so that a region of one answer is left soon.
    let (_, last) = best;
    let next = all.iter().find(|&&(distance, is_new)| is_new && distance > last);
    next.map_or(2.0 * last, |&(next, _)| (last + next.min(3.0 * last)) / 2.0)
}

/// Distance of point `i` to the nearest hit before it.
fn nearest(record: &Record, units: &Units, i: usize) -> f64 {
    let x = record.point(i);
    let before = record.hits.iter().take_while(|&&hit| hit < i);
    before
        .map(|&hit| square(units, record.point(hit), x))
        .fold(f64::INFINITY, f64::min)
        .sqrt()
}

/// Whether a point is within the radius of a hit or of a duplicate.
pub(super) fn is_duplicate(record: &Record, units: &Units, radius: f64, x: &[f64]) -> bool {
    radius > 0.0
        && record
            .answers()
            .any(|answer| is_at_most(squares(units, answer, x), radius * radius))
}

fn square(units: &Units, a: &[f64], b: &[f64]) -> f64 {
    squares(units, a, b).sum()
}

#[inline]
fn squares(units: &Units, a: &[f64], b: &[f64]) -> impl Iterator<Item = f64> {
    let pairs = a.iter().zip(b).zip(&units.axes);
    pairs.map(|((a, b), unit)| unit.difference(*a, *b).powi(2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::model::record::PointKind;

    #[test]
    fn the_radius_parts_duplicates_from_hits() {
        let mut record = Record::default();
        record.clear(1);
        for (x, kind) in [
            (0.1, PointKind::Hit),
            (0.13, PointKind::Duplicate),
            (0.15, PointKind::Duplicate),
            (0.3, PointKind::Hit),
            (0.25, PointKind::Duplicate),
            (0.9, PointKind::Hit),
        ] {
            record.add(&[x], -1.0, kind);
        }
        let units = Units::of(&crate::space::Space::<f64>::cube(1, 0.0, 1.0).unwrap());
        let radius = radius(&record, &units);
        // Duplicates are up to 0.05 from a hit; new hits are 0.2 and more away.
        assert!((radius - 0.1).abs() < 1e-12, "{radius}");
        let (axes, numbers, lists) = record.saved();
        let restored = Record::restored(axes, numbers, lists).unwrap();
        for record in [record, restored] {
            assert!(is_duplicate(&record, &units, radius, &[0.95]));
            assert!(
                is_duplicate(&record, &units, radius, &[0.2]),
                "beside a duplicate"
            );
            assert!(!is_duplicate(&record, &units, radius, &[0.6]));
        }
    }
}
