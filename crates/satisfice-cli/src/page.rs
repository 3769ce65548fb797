//! The page of a run: its hits, how they came in, and what the report says of them.

use std::path::Path;

use anyhow::bail;
use satisfice_catalogue::RunReport;
use satisfice_catalogue::quantity::shown;
use satisfice_page::SearchPage;

use crate::summary;

/// A page lists at most so many hits, evenly chosen; it says so.
pub(crate) const LISTED: usize = 100_000;

/// Refuses a file that is not a page, before the work begins.
pub(crate) fn check(path: Option<&Path>) -> anyhow::Result<()> {
    let is_page = |path: &Path| {
        let ending = path.extension().unwrap_or_default();
        path == Path::new("-")
            || ["html", "htm"]
                .iter()
                .any(|html| ending.eq_ignore_ascii_case(html))
    };
    match path {
        Some(path) if !is_page(path) => bail!("cannot write {}: a page is an .html file", path.display()),
        _ => Ok(()),
    }
}

/// At most `most` of so many, evenly chosen.
pub(crate) fn evenly(count: usize, most: usize) -> impl Iterator<Item = usize> {
    (0..count).step_by(count.div_ceil(most).max(1))
}

/// The page of a report.
pub(crate) fn html(report: &RunReport) -> anyhow::Result<String> {
    let spec = &report.spec;
    let mut page = SearchPage::new(format!("{} by {}, seed {}", spec.problem, spec.engine, spec.seed));
    page.counts(Some(report.hits), report.reference_hits);
    if let Some(threshold) = report.threshold {
        page.fact("F below", threshold.to_string());
    }
    page.fact("Completeness", summary::completeness(report));
    page.fact("Evaluations", shown::count(report.counts.evaluations));
    if report.counts.bound_calls > 0 {
        page.fact("Bounds", shown::count(report.counts.bound_calls));
    }
    page.fact("Time", shown::seconds(report.elapsed_seconds));
    page.fact("End", report.stop_reason.to_string());
    if let Some(best) = &report.best {
        page.fact(
            "Least F",
            format!(
                "{} at evaluation {}",
                summary::digits(best.fitness),
                shown::count(best.evaluation)
            ),
        );
    }
    for (name, settings) in [
        ("Problem", &spec.problem_parameters),
        ("Engine", &spec.engine_parameters),
    ] {
        let texts = settings.texts();
        if !texts.is_empty() {
            let texts: Vec<String> = texts
                .iter()
                .map(|(name, value)| format!("{name}={value}"))
                .collect();
            page.fact(name, texts.join(" "));
        }
    }
    for point in &report.trace {
        page.trace(point.evaluations, point.elapsed_seconds, point.hits);
    }
    page.sources(report.sources.names.iter().cloned());
    for row in &report.sources.rows {
        page.source_row(row.evaluations, &row.proposed, &row.hits);
    }
    for index in evenly(report.solutions.len(), LISTED) {
        let hit = &report.solutions[index];
        page.hit(&hit.solution, hit.fitness, hit.evaluation, hit.seconds);
    }
    Ok(page.html()?)
}
