//! One self-contained page for a sweep: figures, tables, the command.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use satisfice_catalogue::quantity::shown;

use super::plan::Plan;
use super::summary::{Group, cells, heading, legend, unique};
use crate::finding::{Figure, Finding};

/// The page on which engines are switched on and off, beside the report.
pub(super) const COMPARE: &str = "compare.html";
const STYLE: &str = include_str!("report.css");
const HOW: &str = "Runs limited by evaluations ran side by side, and their times are not shown; runs limited by a time ran last, \
    one at a time, while the program did nothing else. Reference counts were made before, outside any clock. Numbers are medians \
    over seeds, intervals 95 % bootstrap intervals of the median (of fewer than six runs, their range); an engine is compared with another seed by seed by the exact \
    sign test, p corrected after Holm for the lines of its table.";
/// The number of groups of a part that are shown unfolded.
const UNFOLDED: usize = 3;

/// A group with its figures, drawn as SVG.
pub(super) struct Shown<'a> {
    pub(super) group: &'a Group,
    pub(super) figures: Vec<(Figure, String)>,
}

/// The page. `missing` runs have not ended; `command` made it.
pub(super) fn page(
    plan: &Plan,
    groups: &[Shown<'_>],
    findings: &[(&Finding, Vec<(Figure, String)>)],
    command: &str,
    missing: u64,
) -> String {
    let suite = &plan.suite;
    let body = html! {
        p { (suite.about) }
        @if missing > 0 {
            p.note { (missing) " of " (plan.len()) " runs have not ended: the command below continues." }
        }
        p { "Made by" }
        pre #command { (command) }
        p { (HOW) }
        @if !groups.is_empty() {
            p { a href=(COMPARE) { "Every run, to look into" } ": engines switched on and off, seed by seed, with figures." }
        }
        @if suite.regret.is_some() { (studies(findings)) }
        @for part in &suite.parts {
            (of_part(&part.name, groups))
        }
        @if suite.regret.is_none() { (studies(findings)) }
        h2 { "The machine" }
        div.wide {
            table {
                @for (what, value) in satisfice_catalogue::machine() {
                    tr { td { (what) } td.text { (value) } }
                }
            }
        }
        h2 { "The suite" }
        pre { (suite.text) }
    };
    whole(&suite.title, &body).into_string()
}

fn whole(title: &str, body: &Markup) -> Markup {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { (title) }
                (body)
            }
        }
    }
}

fn of_part(name: &str, groups: &[Shown<'_>]) -> Markup {
    let of_part: Vec<&Shown<'_>> = groups.iter().filter(|shown| shown.group.part == name).collect();
    html! {
        h2 { (name) }
        @if of_part.len() > 1 { (overview(&of_part)) }
        @for (place, shown) in of_part.iter().enumerate() {
            details open[place < UNFOLDED] {
                summary { (shown.group.problem) ", " (shown.group.budget) }
                (results(shown.group))
                (waste(shown.group))
                (figures(&shown.figures))
            }
        }
    }
}

/// Median recall, or hits where the number of all is not known, of every engine on every problem of a part.
fn overview(groups: &[&Shown<'_>]) -> Markup {
    let lines = groups.iter().flat_map(|shown| &shown.group.lines);
    let engines = unique(lines.map(|line| line.engine.as_str()));
    let budgets = unique(groups.iter().map(|shown| shown.group.budget.as_str()));
    let cell = |group: &Group, engine: &str| {
        let line = group.lines.iter().find(|line| line.engine == engine);
        match line.map(|line| (line.recall, line.hits)) {
            Some((Some(recall), _)) => {
                let shade = format!("background:rgba(0,114,178,{:.2})", 0.45 * recall.median);
                html! { td style=(shade) { (format!("{:.1} %", 100.0 * recall.median)) } }
            }
            Some((None, hits)) => html! { td { (shown::number(hits.median)) } },
            None => html! { td { "-" } },
        }
    };
    html! {
        p { "Median recall at the end (hits where the number of all is not known):" }
        div.wide {
            table {
                tr {
                    th { "problem" }
                    th { "all hits" }
                    @for engine in &engines { th { (engine) } }
                }
                @for shown in groups {
                    tr {
                        td {
                            (shown.group.problem)
                            @if budgets.len() > 1 { ", " (shown.group.budget) }
                        }
                        td { (shown.group.reference_hits.map_or_else(|| "?".to_owned(), shown::count)) }
                        @for engine in &engines { (cell(shown.group, engine)) }
                    }
                }
            }
        }
    }
}

/// A table whose first row is its heading.
fn table(rows: &[Vec<String>]) -> Markup {
    html! {
        div.wide {
            table {
                @for (place, row) in rows.iter().enumerate() {
                    tr {
                        @for cell in row {
                            @if place == 0 { th { (cell) } } @else { td { (cell) } }
                        }
                    }
                }
            }
        }
    }
}

fn results(group: &Group) -> Markup {
    let all = group
        .reference_hits
        .map_or_else(|| "not known".to_owned(), shown::count);
    let mut rows = vec![heading(group)];
    rows.extend(group.lines.iter().map(|line| cells(group, line)));
    html! {
        p {
            "All hits: " (all) "."
            @if let Some(beside) = &group.beside { " Beside them: " (beside) "." }
        }
        (table(&rows))
        @if let Some(legend) = legend(group) { p { (legend) "." } }
    }
}

/// First hit, area, duplicates, precision, r(t).
fn waste(group: &Group) -> Markup {
    let mut names: Vec<String> = [
        "engine",
        "first hit at",
        "mean recall over evaluations",
        "repeated",
        "hits per fitness call",
    ]
    .map(str::to_owned)
    .into();
    if group.timed {
        names.push("mean recall over time".to_owned());
        let times = group.at_seconds.iter();
        names.extend(times.map(|&time| format!("r({})", shown::seconds(time))));
    }
    let share = |share: Option<f64>| share.map_or_else(|| "-".to_owned(), |share| format!("{share:.3}"));
    let mut rows = vec![names];
    for line in &group.lines {
        let first = line.first_hit.evaluations;
        let mut cells = vec![
            line.engine.clone(),
            first.map_or_else(|| "never".to_owned(), |first| shown::number(first.median)),
            share(line.area_evaluations.map(|area| area.median)),
            format!("{:.1} %", 100.0 * line.duplicates.median),
            shown::number(line.precision.median),
        ];
        if group.timed {
            cells.push(share(line.area_seconds.map(|area| area.median)));
            cells.extend(line.r.iter().map(|r| format!("{:.2}", r.median)));
        }
        rows.push(cells);
    }
    table(&rows)
}

/// Figures that are SVG already.
fn figures(figures: &[(Figure, String)]) -> Markup {
    html! {
        @for (figure, svg) in figures {
            figure { (PreEscaped(svg)) figcaption { (figure.caption) } }
        }
    }
}

fn studies(findings: &[(&Finding, Vec<(Figure, String)>)]) -> Markup {
    html! {
        @for (finding, figures) in findings {
            (study(finding, figures))
        }
    }
}

/// A study: text, tables, figures, pictures.
fn study(finding: &Finding, drawn: &[(Figure, String)]) -> Markup {
    html! {
        h2 { (finding.title) }
        @for paragraph in &finding.text { p { (paragraph) } }
        @for (caption, rows) in &finding.tables {
            p { (caption) }
            (table(rows))
        }
        (figures(drawn))
        @for (caption, name, png) in &finding.pictures {
            figure {
                img alt=(name) src={ "data:image/png;base64," (STANDARD.encode(png)) };
                figcaption { (caption) }
            }
        }
    }
}
