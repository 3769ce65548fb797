//! The summary that a person reads after a run.

use std::fmt::Write;
use std::process::ExitCode;

use satisfice::Completeness;
use satisfice_catalogue::RunReport;
use serde_json::Value;

/// The number of hits shown; all of them are in the JSON report.
const SHOWN: usize = 5;
/// The number of slices shown, the first ones.
const SHOWN_SLICES: usize = 20;
/// Bytes of a solution that are shown.
const LONGEST: usize = 300;

/// The summary of a report.
pub(crate) fn summary(report: &RunReport) -> String {
    summary_with(report, |solution| shortened(&solution.to_string()))
}

/// The summary while all hits are still being counted.
pub(crate) fn before_the_count(report: &RunReport) -> String {
    let show = |solution: &Value| shortened(&solution.to_string());
    text(report, Known::Later, show)
}

/// The lines that follow when all hits have been counted, or have not.
pub(crate) fn count(report: &RunReport) -> String {
    let counted = match (report.reference_hits, report.recall) {
        (Some(all), Some(recall)) => format!("{all} (recall {:.1} %)", 100.0 * recall),
        (Some(all), None) => all.to_string(),
        (None, _) => "not known".to_owned(),
    };
    let mut text = String::new();
    if report.completeness != Completeness::Proved {
        let _ = writeln!(text, "  {:<13} {}", "completeness", completeness(report));
    }
    let _ = writeln!(text, "  {:<13} {counted}", "all hits");
    text
}

/// A solution on one line of a terminal: the first values of a long one.
fn shortened(solution: &str) -> String {
    if solution.len() <= LONGEST {
        return solution.to_owned();
    }
    let end = (0..=LONGEST)
        .rev()
        .find(|&end| solution.is_char_boundary(end))
        .unwrap_or(0);
    let end = solution[..end].rfind(',').unwrap_or(end);
    format!("{}, ... (whole in --json FILE)", &solution[..end])
}

/// The summary of a report, with a function that formats its solutions.
pub(crate) fn summary_with(report: &RunReport, show: impl Fn(&Value) -> String) -> String {
    text(report, Known::Now, show)
}

/// When the number of all hits is known, if it ever is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Known {
    Now,
    Later,
}

fn text(report: &RunReport, known: Known, show: impl Fn(&Value) -> String) -> String {
    let mut text = format!(
        "{} by {}, seed {}\n",
        report.spec.problem, report.spec.engine, report.spec.seed
    );
    let mut line = |name: &str, value: String| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {name:<13} {value}");
    };
    let recall = match (report.reference_hits, report.recall) {
        (Some(reference), Some(recall)) => format!(" of {reference} (recall {:.1} %)", 100.0 * recall),
        (Some(reference), None) => format!(" of {reference}"),
        (None, _) if known == Known::Later => " (all hits are being counted)".to_owned(),
        (None, _) => " (the number of all hits is not known)".to_owned(),
    };
    line("hits", format!("{}{recall}", report.hits));
    if known == Known::Now || report.completeness == Completeness::Proved {
        line("completeness", completeness(report));
    }
    let counts = &report.counts;
    line(
        "evaluations",
        format!(
            "{} ({} calls of the fitness, {} duplicates, {} non-finite)",
            counts.evaluations, counts.fitness_calls, counts.duplicates, counts.non_finite
        ),
    );
    if counts.bound_calls > 0 {
        line(
            "bounds",
            format!("{}, each counted like an evaluation", counts.bound_calls),
        );
    }
    line(
        "time",
        format!(
            "{}{}, {}",
            time(report.elapsed_seconds),
            rate(counts.evaluations, report.elapsed_seconds),
            report.stop_reason
        ),
    );
    for (index, slice) in report.slices.iter().take(SHOWN_SLICES).enumerate() {
        line(
            &format!("slice {}", index + 1),
            format!(
                "{} hits, {} of them new, {} evaluations, {}",
                slice.hits,
                slice.new_hits,
                slice.counts.evaluations,
                time(slice.elapsed_seconds)
            ),
        );
    }
    if report.slices.len() > SHOWN_SLICES {
        line(
            "",
            format!(
                "and {} more slices; --json FILE lists them all",
                report.slices.len() - SHOWN_SLICES
            ),
        );
    }
    if let (true, Some(best)) = (report.solutions.is_empty(), &report.best) {
        let threshold = report.threshold.map_or_else(|| "infinite".to_owned(), digits);
        line(
            "best",
            format!(
                "F = {} at evaluation {}, where a hit is below {threshold}: {}",
                digits(best.fitness),
                best.evaluation,
                show(&best.solution)
            ),
        );
    }
    for (index, found) in report.solutions.iter().take(SHOWN).enumerate() {
        line(
            &format!("hit {}", index + 1),
            format!(
                "{} with F = {} at evaluation {}, {}",
                show(&found.solution),
                digits(found.fitness),
                found.evaluation,
                time(found.seconds)
            ),
        );
    }
    if report.solutions.len() > SHOWN {
        line(
            "",
            format!(
                "and {} more; --json FILE lists them all",
                report.solutions.len() - SHOWN
            ),
        );
    }
    text
}

/// What is known of the hits that the report does not list.
pub(crate) fn completeness(report: &RunReport) -> String {
    if report.completeness == Completeness::Proved {
        return "proved: these are all".to_owned();
    }
    // A number that is known says more than an estimate of it.
    match report.reference_hits.and_then(|all| all.checked_sub(report.hits)) {
        Some(0) => return "these are all: the problem has no other hits".to_owned(),
        Some(left) => return format!("{left} of the problem's {} hits not seen", left + report.hits),
        None => {}
    }
    match (report.unseen_estimate, report.unseen_interval) {
        (Some(estimate), Some(interval)) => format!("unknown: {}", unseen(estimate, interval)),
        _ => match report.failed {
            0 => "unknown: there may be more".to_owned(),
            1 => "unknown: the evaluation that failed may be a hit".to_owned(),
            failed => format!("unknown: the {failed} evaluations that failed may be hits"),
        },
    }
}

/// How many hits are not seen. An estimate that no probe supports is not shown: then the interval is all there is.
fn unseen(estimate: f64, (low, high): (f64, Option<f64>)) -> String {
    let supported = estimate >= 0.5 || high.is_some_and(|high| high < 1.0);
    match (supported, high) {
        (true, Some(high)) => format!(
            "{} hits not seen by estimate, {} to {}",
            whole(estimate),
            whole(low),
            whole(high)
        ),
        (true, None) => format!(
            "{} hits not seen by estimate, at least {}",
            whole(estimate),
            whole(low)
        ),
        (false, Some(high)) => format!("{} to {} hits not seen", whole(low), whole(high)),
        (false, None) => "how many hits are not seen has no known bound".to_owned(),
    }
}

/// A whole number, a large one by its exponent.
fn whole(x: f64) -> String {
    if x < 1e9 {
        format!("{x:.0}")
    } else {
        format!("{x:.1e}")
    }
}

/// 0 with a hit, 1 without.
pub(crate) fn exit_code(report: &RunReport) -> ExitCode {
    ExitCode::from(u8::from(report.hits == 0))
}

/// Six digits of a number, small ones by their exponent.
pub(crate) fn digits(x: f64) -> String {
    let x = x + 0.0; // no minus before a zero
    if x != 0.0 && (x.abs() < 1e-3 || x.abs() >= 1e15) {
        format!("{x:.5e}")
    } else {
        format!("{x:.6}")
    }
}

/// A time in a unit that suits it.
fn time(seconds: f64) -> String {
    if seconds < 1e-3 {
        format!("{:.1} us", 1e6 * seconds)
    } else if seconds < 1.0 {
        format!("{:.1} ms", 1e3 * seconds)
    } else {
        format!("{seconds:.2} s")
    }
}

#[expect(clippy::cast_precision_loss, reason = "shown to three digits")]
fn rate(evaluations: u64, seconds: f64) -> String {
    if seconds <= 0.0 {
        return String::new();
    }
    let rate = evaluations as f64 / seconds;
    let (value, unit) = match rate {
        r if r >= 1e6 => (r / 1e6, "million "),
        r if r >= 1e3 => (r / 1e3, "thousand "),
        r => (r, ""),
    };
    format!(" ({value:.1} {unit}evaluations a second)")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_solutions_are_cut_between_values() {
        assert_eq!(shortened("[1,2]"), "[1,2]");
        let long = format!("[{}7]", "1234,".repeat(100));
        let cut = shortened(&long);
        assert!(long.starts_with(cut.strip_suffix(", ... (whole in --json FILE)").unwrap()));
        assert!(cut.len() < LONGEST + 40 && cut.contains("1234, ..."));
        assert!(shortened(&"ü".repeat(400)).starts_with("üüü"));
    }

    #[test]
    fn a_known_number_of_hits_replaces_the_estimate() {
        let spec = satisfice_catalogue::RunSpec::new("random");
        let mut report = RunReport::new(spec);
        report.unseen_estimate = Some(0.0);
        report.unseen_interval = Some((0.0, Some(26_115.0)));
        report.hits = 83;
        assert_eq!(completeness(&report), "unknown: 0 to 26115 hits not seen");
        for (all, says) in [
            (92, "9 of the problem's 92 hits not seen"),
            (83, "these are all: the problem has no other hits"),
            // Where hits are told apart more finely than they were counted.
            (80, "unknown: 0 to 26115 hits not seen"),
        ] {
            report.set_reference(Some(all));
            assert_eq!(completeness(&report), says);
        }
        assert!(
            before_the_count(&report)
                .lines()
                .all(|line| !line.contains("completeness"))
        );
        assert_eq!(
            count(&report),
            "  completeness  unknown: 0 to 26115 hits not seen\n  all hits      80 (recall 103.8 %)\n"
        );
    }

    #[test]
    fn an_estimate_is_shown_where_it_says_something() {
        let shown = [
            (unseen(0.0, (0.0, Some(343_064.0))), "0 to 343064 hits not seen"),
            (
                unseen(0.0, (0.0, Some(0.0))),
                "0 hits not seen by estimate, 0 to 0",
            ),
            (
                unseen(12.4, (3.0, Some(40.0))),
                "12 hits not seen by estimate, 3 to 40",
            ),
            (
                unseen(12.4, (3.0, None)),
                "12 hits not seen by estimate, at least 3",
            ),
            (
                unseen(0.0, (0.0, None)),
                "how many hits are not seen has no known bound",
            ),
            (unseen(0.0, (0.0, Some(1e92))), "0 to 1.0e92 hits not seen"),
        ];
        for (text, wanted) in shown {
            assert_eq!(text, wanted);
        }
    }

    #[test]
    fn a_zero_has_no_sign_and_a_large_number_few_digits() {
        assert_eq!(digits(-0.0), "0.000000");
        assert_eq!(digits(-1e-9), "-1.00000e-9");
        assert_eq!(digits(1.5e92), "1.50000e92");
    }
}
