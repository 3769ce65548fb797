//! What a person reads after a motion was searched.

use satisfice::{Completeness, StopReason};
use satisfice_catalogue::quantity::shown;
use satisfice_collision::FeatureKind;

use super::super::pairs::Side;
use super::super::summary::{Lines, SHOWN_PAIRS, body_names, digits, elapsed};
use super::report::MotionReport;

pub(super) fn summary(report: &MotionReport<'_>) -> String {
    let head = &report.head;
    let kinds: Vec<&str> = report.frames.kinds.iter().map(|kind| kind.name()).collect();
    let what = match head.threshold {
        0.0 => "that touch".to_owned(),
        delta => format!("that come closer than {delta}"),
    };
    let mut lines = Lines::new(format!(
        "{} pairs {what} during the step",
        match kinds.is_empty() {
            true => "feature".to_owned(),
            false => kinds.join(" and "),
        }
    ));
    if !report.frames.request.first {
        lines.line("pairs", &count(report));
        lines.line("completeness", completeness(report));
    }
    if let Some(first) = first_impact(report) {
        lines.line("first impact", &first);
    }
    lines.line("time", &elapsed(head));
    if report.frames.bodies.len() > 1 && !report.touching.is_empty() {
        lines.line("bodies", &body_names(&report.frames.bodies, &report.touching));
    }
    for (index, hit) in report.pairs.iter().take(SHOWN_PAIRS).enumerate() {
        let line = report.line(hit);
        let kind = report.frames.kinds[usize::from(hit.kind)];
        let (kind_a, kind_b) = kind.features();
        let when = match (line.at_start, line.time) {
            (Some(true), _) => "at the start".to_owned(),
            (_, Some(time)) => format!("at {}", moment(time[0])),
            _ => "at a time that was not computed".to_owned(),
        };
        let pair = format!(
            "{} and {}, {when}",
            side(report, kind_a, &line.a),
            side(report, kind_b, &line.b)
        );
        lines.line(&format!("pair {}", index + 1), &pair);
    }
    if report.pairs.len() > SHOWN_PAIRS {
        let more = shown::count((report.pairs.len() - SHOWN_PAIRS) as u64);
        lines.line(
            "",
            &format!("and {more} more, later ones; --json FILE or --out FILE.csv lists all"),
        );
    }
    lines.text()
}

fn count(report: &MotionReport<'_>) -> String {
    let head = &report.head;
    let hits = shown::count(head.hits);
    match head.reference_hits {
        Some(all) if all != head.hits => format!("{hits} of {}", shown::count(all)),
        Some(_) => hits,
        None => format!("{hits} (how many there are is not known)"),
    }
}

pub(super) fn completeness(report: &MotionReport<'_>) -> &'static str {
    let head = &report.head;
    match (head.completeness, head.reference_hits) {
        (Completeness::Proved, _) => "proved: these are all",
        (_, Some(_)) => "all are counted, but not all are listed: --max-pairs N lists more",
        (_, None) => "unknown: there may be more",
    }
}

pub(super) fn first_impact(report: &MotionReport<'_>) -> Option<String> {
    let first = report.first_impact?;
    let [low, high] = first.time;
    let found = !report.pairs.is_empty();
    Some(match (first.proved, found) {
        (true, false) => "none: the step is free, that is proved".to_owned(),
        (true, true) if high == 0.0 => "at the start, that is proved".to_owned(),
        (true, true) => format!("between {low} and {high} of the step, that is proved"),
        (false, true) => format!(
            "between {} and {} of the step so far; an earlier one may exist",
            moment(low),
            moment(high)
        ),
        (false, false) if report.head.stop_reason == StopReason::Covered => "none".to_owned(),
        (false, false) => format!("not before {} of the step; none found so far", moment(low)),
    })
}

/// A time as a part of the step.
fn moment(time: f64) -> String {
    digits(time)
}

fn side(report: &MotionReport<'_>, kind: FeatureKind, side: &Side) -> String {
    let ends = side
        .vertices
        .map_or_else(String::new, |[v, w]| format!(" (vertices {v} and {w})"));
    let body = &report.frames.bodies[side.body].name;
    format!("{} {}{ends} of {body}", kind.name(), side.feature)
}
