//! What a person reads after a motion was searched.

use satisfice::{Completeness, StopReason};
use satisfice_catalogue::quantity::shown;
use satisfice_collision::FeatureKind;

use super::super::digits::digits;
use super::super::pairs::Side;
use super::super::summary::{Lines, SHOWN_PAIRS, body_names, elapsed};
use super::report::{FirstImpact, MotionReport};

pub(super) fn summary(report: &MotionReport<'_>) -> String {
    let head = &report.head;
    let kinds: Vec<&str> = report.frames.kinds.iter().map(|kind| kind.name()).collect();
    let what = match head.threshold {
        0.0 => "that touch".to_owned(),
        delta => format!("that come closer than {}", shown::exact(delta)),
    };
    let mut lines = Lines::new(format!(
        "{} pairs {what} during the step",
        match kinds.is_empty() {
            true => "feature".to_owned(),
            false => kinds.join(" and "),
        }
    ));
    if let Some(times) = report.frames.request.ends.times() {
        let [from, to] = times.seconds.map(shown::exact);
        lines.line("step", &format!("from {from} s to {to} s of the animation"));
    }
    if !report.frames.request.first {
        lines.line("pairs", &count(report));
        lines.line("completeness", completeness(report));
    }
    lines.line("first impact", &first_impact(report));
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
            (_, Some(time)) => format!("at {}", moment(report, time[0])),
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
        let more = (report.pairs.len() - SHOWN_PAIRS) as u64;
        lines.line("", &not_shown(more, report.head.unmeasured));
    }
    lines.text()
}

/// What is said of listed pairs that are not shown. One without a time may be earlier than those shown.
fn not_shown(more: u64, untimed: u64) -> String {
    let order = match untimed {
        0 => ", later ones".to_owned(),
        some => format!(", {} of them without a time", shown::count(some.min(more))),
    };
    format!(
        "and {} more{order}; --json FILE or --out FILE.csv lists all",
        shown::count(more)
    )
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
        (_, Some(_)) if head.stop_reason == StopReason::Hits => {
            "all are counted, but --hits asks for so many only, which need not be the earliest"
        }
        (_, Some(_)) => "all are counted, but not all are listed: --max-pairs N lists more",
        (_, None) => "unknown: there may be more",
    }
}

pub(super) fn first_impact(report: &MotionReport<'_>) -> String {
    let Some(first) = report.first_impact else {
        return unknown_first(report.head.hits, report.head.unmeasured);
    };
    let [low, high] = first.time;
    let found = !report.pairs.is_empty();
    let request = &report.frames.request;
    match (first.proved, found) {
        (true, false) => match (request.pairs, request.ends.times()) {
            (Some(kind), _) => format!("none: no {} pair comes that near, that is proved", kind.name()),
            (None, Some(_)) => "none: the straight step is free, that is proved".to_owned(),
            (None, None) => "none: the step is free, that is proved".to_owned(),
        },
        (true, true) if high == 0.0 => "at the start, that is proved".to_owned(),
        (true, true) => format!("{}, that is proved", bounds(first)),
        (false, true) => format!("{} so far; an earlier one may exist", bounds(first)),
        (false, false) if report.head.stop_reason == StopReason::Covered => "none".to_owned(),
        (false, false) => format!(
            "not before {} of the step; none found so far",
            bound(low, Towards::Below)
        ),
    }
}

/// Why the listed pairs do not tell the first impact.
fn unknown_first(listed: u64, untimed: u64) -> String {
    let why = match untimed {
        0 => "an earlier pair may not be listed".to_owned(),
        some => format!(
            "the times of {} of the {} listed pairs were not computed",
            shown::count(some),
            shown::count(listed)
        ),
    };
    format!("not known: {why}; --first finds it")
}

/// A time as a part of the step, and in seconds where the ends of the step are times of animations.
fn moment(report: &MotionReport<'_>, time: f64) -> String {
    match report.frames.request.ends.times() {
        Some(times) => format!("{} ({} s)", digits(time), digits(times.at(time))),
        None => digits(time),
    }
}

/// Two bounds of a time of the step, and in seconds where they are known.
fn bounds(first: FirstImpact) -> String {
    let [low, high] = first.time;
    let parts = format!(
        "between {} and {} of the step",
        bound(low, Towards::Below),
        bound(high, Towards::Above)
    );
    match first.seconds {
        Some([_, late]) => format!("{parts}, at {} s of the animation", digits(late)),
        None => parts,
    }
}

/// Where a bound may be rounded to.
#[derive(Clone, Copy, PartialEq)]
enum Towards {
    Below,
    Above,
}

/// A bound of a time with eight significant digits at most, rounded so that it remains a bound.
fn bound(time: f64, towards: Towards) -> String {
    let is_bound = |x: f64| match towards {
        Towards::Below => x <= time,
        Towards::Above => x >= time,
    };
    let text = format!("{time:.7e}");
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let mut digits: i64 = digits.replace('.', "").parse().unwrap_or_default();
    let exponent = exponent.parse::<i32>().unwrap_or_default() - 7;
    let mut rounded = || {
        let rounded = format!("{digits}e{exponent}").parse().unwrap_or(time);
        digits += if towards == Towards::Below { -1 } else { 1 };
        rounded
    };
    let shown = [rounded(), rounded()].into_iter().find(|&x| is_bound(x));
    match shown.unwrap_or(time) {
        0.0 => "0".to_owned(),
        x if x < 1e-3 => format!("{x:e}"),
        x => x.to_string(),
    }
}

fn side(report: &MotionReport<'_>, kind: FeatureKind, side: &Side) -> String {
    let ends = side
        .vertices
        .map_or_else(String::new, |[v, w]| format!(" (vertices {v} and {w})"));
    let body = &report.frames.bodies[side.body].name;
    format!("{} {}{ends} of {body}", kind.name(), side.feature)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_without_a_time_are_not_called_later_ones() {
        assert_eq!(
            not_shown(7, 0),
            "and 7 more, later ones; --json FILE or --out FILE.csv lists all"
        );
        assert_eq!(
            not_shown(113_849, 87_102),
            "and 113,849 more, 87,102 of them without a time; --json FILE or --out FILE.csv lists all"
        );
        assert_eq!(
            unknown_first(113_854, 87_102),
            "not known: the times of 87,102 of the 113,854 listed pairs were not computed; --first finds it"
        );
    }

    #[test]
    fn bounds_have_few_digits_and_remain_bounds() {
        for (time, below, above) in [
            (0.0, "0", "0"),
            (1.0, "1", "1"),
            (0.5, "0.5", "0.5"),
            (0.449_999_999_983_1, "0.44999999", "0.45"),
            (6.716_123_456_789e-6, "6.7161234e-6", "6.7161235e-6"),
            (0.999_999_999_9, "0.9999999", "1"),
        ] {
            assert_eq!(bound(time, Towards::Below), below);
            assert_eq!(bound(time, Towards::Above), above);
        }
        for n in 1..2000_u32 {
            let time = 1.0 / f64::from(n);
            let [low, high] =
                [Towards::Below, Towards::Above].map(|towards| bound(time, towards).parse::<f64>());
            assert!(low.is_ok_and(|low| low <= time) && high.is_ok_and(|high| time <= high));
        }
    }
}
