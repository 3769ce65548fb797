//! The slices of a report: what they add up to, and which hits each of them found first.

use satisfice::Counts;

use super::Mismatch;
use crate::method;
use crate::report::{RunReport, SliceReport};

/// Sums of times are rounded.
const ROUNDING: f64 = 1e-9;

pub(super) fn check(report: &RunReport, wrong: &mut Vec<Mismatch>) {
    let (slices, most) = (&report.slices, report.spec.budget.slices);
    let count = slices.len() as u64;
    // One slice is not listed on its own, and an exact method has none.
    let may_be_none = most == 1 || method::find(&report.spec.engine).is_some();
    if count > most || (count == 0 && !may_be_none) {
        wrong.push(Mismatch::new("slices", count, format!("from 1 to {most}")));
    }
    let Some(last) = slices.last() else { return };
    sums(report, wrong);
    each(report, wrong);
    if (last.stop_reason, last.completeness) != (report.stop_reason, report.completeness) {
        let said = format!("{:?}, {:?}", last.stop_reason, last.completeness);
        let expected = format!("{:?}, {:?}, as the run", report.stop_reason, report.completeness);
        wrong.push(Mismatch::new(
            format!("slices[{}].stop_reason", count - 1),
            said,
            expected,
        ));
    }
}

fn sums(report: &RunReport, wrong: &mut Vec<Mismatch>) {
    type Part = fn(&Counts) -> u64;
    let parts: [(&str, Part); 9] = [
        ("evaluations", |counts| counts.evaluations),
        ("fitness_calls", |counts| counts.fitness_calls),
        ("duplicates", |counts| counts.duplicates),
        ("non_finite", |counts| counts.non_finite),
        ("verified", |counts| counts.verified),
        ("probes", |counts| counts.probes),
        ("informed", |counts| counts.informed),
        ("neighbour_calls", |counts| counts.neighbour_calls),
        ("bound_calls", |counts| counts.bound_calls),
    ];
    let sum =
        |part: &dyn Fn(&SliceReport) -> u64| report.slices.iter().map(part).fold(0, u64::saturating_add);
    let counts = parts.map(|(place, part)| (place, part(&report.counts), sum(&|slice| part(&slice.counts))));
    let hits = ("hits", report.hits, sum(&|slice| slice.new_hits));
    for (place, found, expected) in counts.into_iter().chain([hits]) {
        if found != expected {
            let expected = format!("{expected}, the sum over the slices");
            wrong.push(Mismatch::new(place, found, expected));
        }
    }
    type Time = fn(&SliceReport) -> f64;
    let times: [(&str, f64, Time); 2] = [
        ("elapsed_seconds", report.elapsed_seconds, |slice| {
            slice.elapsed_seconds
        }),
        ("overshoot_seconds", report.overshoot_seconds, |slice| {
            slice.overshoot_seconds
        }),
    ];
    for (place, found, part) in times {
        let expected: f64 = report.slices.iter().map(part).sum();
        if (found - expected).abs() > ROUNDING * expected.abs() {
            let expected = format!("{expected}, the sum over the slices");
            wrong.push(Mismatch::new(place, found, expected));
        }
    }
}

fn each(report: &RunReport, wrong: &mut Vec<Mismatch>) {
    let mut evaluations = 0_u64;
    for (index, slice) in report.slices.iter().enumerate() {
        let before = report
            .solutions
            .partition_point(|found| found.evaluation <= evaluations) as u64;
        evaluations = evaluations.saturating_add(slice.counts.evaluations);
        let after = report
            .solutions
            .partition_point(|found| found.evaluation <= evaluations) as u64;
        let place = |part: &str| format!("slices[{index}].{part}");
        if slice.new_hits != after.saturating_sub(before) {
            let expected = format!("{}, as the solutions say", after.saturating_sub(before));
            wrong.push(Mismatch::new(place("new_hits"), slice.new_hits, expected));
        }
        // All hits of the first slice are new. Later ones may be near several that are known, and so are more than those.
        let most = match index {
            0 => slice.new_hits,
            _ => slice.counts.evaluations,
        };
        if slice.hits < slice.new_hits || slice.hits > most {
            let expected = format!("from {} to {most}", slice.new_hits);
            wrong.push(Mismatch::new(place("hits"), slice.hits, expected));
        }
    }
}
