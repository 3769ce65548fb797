//! Which evaluations failed by chance.

use super::record::Record;
use super::units::Units;

/// Points next to one that failed which tell whether it failed by chance.
const NEXT: usize = 8;

/// Whether a model learns from a point: not from duplicates, whose F is not F of something new, nor where F is missing by chance.
pub(super) fn tells(record: &Record, units: &Units, i: usize) -> bool {
    let is_duplicate = record.duplicates.binary_search(&i).is_ok();
    let is_missing = record.values[i].is_nan() && failed_by_chance(record, units, i);
    !is_duplicate && !is_missing
}

/// Whether no more than half of the points next to one that failed have failed, too. Cost: O(D) for each point of the record.
fn failed_by_chance(record: &Record, units: &Units, failed: usize) -> bool {
    let at = record.point(failed);
    let distance = |i: usize| -> f64 {
        let pairs = record.point(i).iter().zip(at).zip(&units.axes);
        pairs.map(|((a, b), unit)| unit.difference(*a, *b).powi(2)).sum()
    };
    let is_other = |&i: &usize| i != failed && record.duplicates.binary_search(&i).is_err();
    let mut others: Vec<(f64, bool)> = (0..record.len())
        .filter(is_other)
        .map(|i| (distance(i), record.values[i].is_nan()))
        .collect();
    if others.len() < NEXT {
        return false;
    }
    others.select_nth_unstable_by(NEXT - 1, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    2 * others[..NEXT].iter().filter(|other| other.1).count() <= NEXT
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Space;
    use crate::engine::model::record::PointKind;

    /// How many of the failures on a grid of 400 points tell something.
    fn telling(fails: impl Fn(usize, usize) -> bool) -> (usize, usize) {
        let units = Units::of(&Space::<f64>::cube(2, 0.0, 1.0).unwrap());
        let mut record = Record::default();
        record.clear(2);
        for (i, j) in (0..400).map(|k| (k / 20, k % 20)) {
            let value = if fails(i, j) { f64::NAN } else { 1.0 };
            record.add(&[i as f64 / 20.0, j as f64 / 20.0], value, PointKind::Miss);
        }
        assert!((0..400).all(|i| record.values[i].is_nan() || tells(&record, &units, i)));
        let failed: Vec<usize> = (0..400).filter(|&i| record.values[i].is_nan()).collect();
        let tell = failed.iter().filter(|&&i| tells(&record, &units, i)).count();
        (tell, failed.len())
    }

    #[test]
    fn failures_of_a_region_tell_and_those_by_chance_do_not() {
        let (tell, failed) = telling(|i, _| i >= 8);
        assert!(failed == 240 && tell >= 220, "{tell}");
        let (tell, failed) = telling(|i, j| (7 * i + 3 * j) % 10 < 2);
        assert!(failed == 80 && tell < 8, "{tell}");
    }

    #[test]
    fn a_duplicate_tells_nothing_and_early_failures_do() {
        let units = Units::of(&Space::<f64>::cube(1, 0.0, 1.0).unwrap());
        let mut record = Record::default();
        record.clear(1);
        record.add(&[0.1], f64::NAN, PointKind::Miss);
        record.add(&[0.2], 0.5, PointKind::Duplicate);
        assert!(tells(&record, &units, 0) && !tells(&record, &units, 1));
    }
}
