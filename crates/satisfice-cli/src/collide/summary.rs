//! What a person reads after a collision run: how many pairs, how far apart, and which.

use std::collections::BTreeSet;
use std::fmt::Write;

use satisfice::{Completeness, StopReason};
use satisfice_catalogue::quantity::shown;
use satisfice_collision::FeatureKind;
use satisfice_collision::distance::PairKind;

use super::arguments::Find;
use super::body::NamedBody;
use super::digits::digits;
use super::pairs::Side;
use super::report::{Head, Report};
use crate::message::plain;

/// So many pairs are shown; the report has all of them.
pub(super) const SHOWN_PAIRS: usize = 5;
const SHOWN_BODIES: usize = 10;

/// A title and named lines below it.
pub(super) struct Lines(String);

impl Lines {
    pub(super) fn new(title: String) -> Self {
        Self(title + "\n")
    }

    pub(super) fn text(self) -> String {
        self.0
    }

    pub(super) fn line(&mut self, name: &str, value: &str) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.0, "  {name:<13} {}", plain(value));
    }
}

pub(super) fn summary(report: &Report<'_>) -> String {
    let head = &report.head;
    let kind = report.world.request.kind.name();
    let mut lines = Lines::new(match head.threshold.is_finite() {
        true => format!(
            "{kind} pairs closer than {} by {}",
            shown::exact(head.threshold),
            head.engine
        ),
        false => format!("the closest {kind} pairs by {}", head.engine),
    });
    lines.line("pairs", &count(report));
    let (name, says) = assurance(report);
    lines.line(&name.to_lowercase(), &says);
    if let Some((least, most)) = report.pairs.range() {
        let unmeasured = match head.unmeasured {
            0 => String::new(),
            some => format!("; {} not measured, {}", shown::count(some), over(head)),
        };
        lines.line(
            "distances",
            &format!(
                "{} to {}{unmeasured}",
                below(least, head.threshold),
                below(most, head.threshold)
            ),
        );
    } else if head.unmeasured > 0 {
        lines.line("distances", &format!("not measured, {}", over(head)));
    }
    if let (0, Some(best)) = (head.hits, &head.best) {
        lines.line("closest seen", &format!("{} apart", digits(best.fitness)));
    }
    lines.line("time", &elapsed(&report.head));
    for overlap in report.overlaps.iter().flatten().take(SHOWN_BODIES) {
        lines.line("overlap", &overlap.text(&report.world.bodies));
    }
    if let Some(overlaps) = &report.overlaps {
        match overlaps.len() {
            0 if was_stopped(head) => {
                lines.line(
                    "overlap",
                    &format!("not known: {} before one was found", over(head)),
                );
            }
            0 => lines.line(
                "overlap",
                "none: no surfaces meet and no body lies inside another",
            ),
            more if more > SHOWN_BODIES => {
                lines.line(
                    "",
                    &format!("and {} more overlaps; --json FILE lists all", more - SHOWN_BODIES),
                );
            }
            _ => {}
        }
    }
    if report.world.bodies.len() > 1 && !report.touching.is_empty() {
        lines.line("bodies", &body_names(&report.world.bodies, &report.touching));
    }
    for index in 0..report.pairs.len().min(SHOWN_PAIRS) {
        lines.line(&format!("pair {}", index + 1), &pair(report, index));
    }
    if report.pairs.len() > SHOWN_PAIRS {
        let more = shown::count((report.pairs.len() - SHOWN_PAIRS) as u64);
        lines.line(
            "",
            &format!("and {more} more; --json FILE or --out FILE.csv lists all"),
        );
    }
    for (reason, count) in &report.skipped {
        lines.line("skipped", &format!("{reason}: {}", shown::count(*count)));
    }
    lines.text()
}

fn count(report: &Report<'_>) -> String {
    let head = &report.head;
    let hits = shown::count(head.hits);
    match (head.reference_hits, head.recall) {
        (Some(all), Some(recall)) if all != head.hits => {
            format!("{hits} of {} ({:.1} %)", shown::count(all), 100.0 * recall)
        }
        (Some(_), _) => hits,
        (None, _) => format!("{hits} (how many there are is not known)"),
    }
}

/// How sure the answer is: a name and what it says. Where all pairs are asked for, whether these are all.
pub(super) fn assurance(report: &Report<'_>) -> (&'static str, String) {
    match asked(report) {
        Some(answer) => ("Answer", answer),
        None => ("Completeness", completeness(report)),
    }
}

fn completeness(report: &Report<'_>) -> String {
    let head = &report.head;
    if head.completeness == Completeness::Proved {
        return "proved: these are all".to_owned();
    }
    // An exact method that ends by itself has counted what it cannot list.
    let ended = matches!(head.stop_reason, StopReason::Covered | StopReason::Memory);
    if ended && head.reference_hits.is_some() {
        return "all are counted, but not all are listed".to_owned();
    }
    match head.reference_hits.and_then(|all| all.checked_sub(head.hits)) {
        Some(0) => return "these are all: there are no other pairs".to_owned(),
        Some(1) => return "1 pair not seen".to_owned(),
        Some(more) => return format!("{} pairs not seen", shown::count(more)),
        None => {}
    }
    match (head.unseen_estimate, head.unseen_interval) {
        (Some(unseen), Some((low, high))) => {
            let high = high.map_or_else(|| "no known bound".to_owned(), |high| format!("{high:.0}"));
            format!("unknown: about {unseen:.0} more pairs, {low:.0} to {high}")
        }
        _ => "unknown: there may be more".to_owned(),
    }
}

/// How long it took and why it ended.
pub(super) fn elapsed(head: &Head) -> String {
    let late = match head.overshoot_seconds {
        late if late > 0.0 => format!(", {} beyond the limit", shown::seconds(late)),
        _ => String::new(),
    };
    let elapsed = shown::seconds(head.elapsed_seconds);
    let end = match head.stop_reason {
        // All that was asked for was found before all pairs were examined.
        StopReason::Exhausted => StopReason::Covered,
        reason => reason,
    };
    format!("{elapsed}{late}, {end}")
}

/// Why no more was done.
fn over(head: &Head) -> &'static str {
    match head.stop_reason {
        StopReason::Cancelled => "the search was interrupted",
        _ => "the time was over",
    }
}

fn was_stopped(head: &Head) -> bool {
    matches!(head.stop_reason, StopReason::Cancelled | StopReason::Time)
}

/// What is sure about a list that is asked not to have all pairs, unless it has all.
fn asked(report: &Report<'_>) -> Option<String> {
    let request = &report.world.request;
    let was_stopped = report.head.answer != Completeness::Proved;
    let has_all = report.head.completeness == Completeness::Proved;
    let features = match request.kind {
        PairKind::VertexVertex => "vertices",
        PairKind::VertexEdge => "a vertex and an edge",
        PairKind::VertexTriangle => "a vertex and a triangle",
        PairKind::EdgeEdge => "edges",
        PairKind::EdgeTriangle | PairKind::TriangleTriangle => "surfaces",
    };
    let said = match request.find {
        Find::All => return None,
        Find::First | Find::Closest(_) if has_all => return None,
        Find::Touching if was_stopped => {
            "unknown: one pair of each two bodies that were found to touch; others may touch as well"
                .to_owned()
        }
        Find::Touching if request.solid => format!(
            "proved: no other bodies touch, which means: {features} closer than the threshold, or one inside the other; one pair of each two is listed"
        ),
        Find::Touching => format!(
            "proved: no other bodies touch, which means: {features} closer than the threshold; one pair of each two is listed; --solid also finds bodies inside others"
        ),
        Find::First if was_stopped => "unknown: no pair was found until then".to_owned(),
        Find::First => "one pair, whichever is found first".to_owned(),
        Find::Closest(_) if was_stopped => {
            "unknown: the closest of the pairs found; others may be closer".to_owned()
        }
        Find::Closest(_) => "proved: no other pair is closer".to_owned(),
    };
    Some(said)
}

/// The bodies that have pairs with each other, by their names.
pub(super) fn body_names(bodies: &[NamedBody], touching: &BTreeSet<[usize; 2]>) -> String {
    let name = |body: usize| &bodies[body].name;
    let mut text: Vec<String> = touching
        .iter()
        .take(SHOWN_BODIES)
        .map(|&[a, b]| format!("{} - {}", name(a), name(b)))
        .collect();
    let more = touching.len() - text.len();
    if more > 0 {
        text.push(format!("and {} more", shown::count(more as u64)));
    }
    text.join(", ")
}

/// So many pairs, in words.
pub(super) fn pairs_in_words(count: usize) -> String {
    match count {
        1 => "1 pair".to_owned(),
        many => format!("{many} pairs"),
    }
}

/// A distance below the threshold, which its digits must not reach by rounding.
fn below(distance: f64, threshold: f64) -> String {
    let text = digits(distance);
    let is_rounded_up = distance < threshold && text.parse::<f64>().is_ok_and(|shown| shown >= threshold);
    match is_rounded_up {
        true => format!("just below {}", shown::exact(threshold)),
        false => text,
    }
}

fn pair(report: &Report<'_>, index: usize) -> String {
    let (kind_a, kind_b) = report.world.kinds();
    let line = report.pairs.line(index, report.world);
    let apart = line.distance.map_or_else(
        || "not measured".to_owned(),
        |distance| format!("{} apart", below(distance, report.head.threshold)),
    );
    let places = line.witness.map_or_else(String::new, |near| {
        let [a, b] = [near.point_a, near.point_b].map(|point| point.map(digits).join(" "));
        format!(", from ({a}) to ({b})")
    });
    format!(
        "{} and {}, {apart}{places}",
        side(report, kind_a, &line.a),
        side(report, kind_b, &line.b)
    )
}

fn side(report: &Report<'_>, kind: FeatureKind, side: &Side) -> String {
    let ends = side
        .vertices
        .map_or_else(String::new, |[v, w]| format!(" (vertices {v} and {w})"));
    let body = &report.world.bodies[side.body].name;
    format!("{} {}{ends} of {body}", kind.name(), side.feature)
}
