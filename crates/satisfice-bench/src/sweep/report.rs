//! One self-contained page for a sweep: figures, tables, the the command.

use std::fmt::Write;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use crate::finding::Figure;

use super::plan::Plan;
use super::summary::{Group, cells, heading};
use crate::finding::Finding;
use satisfice_catalogue::quantity::shown;

const PAGE: &str = include_str!("report.html");
/// Groups of a part that are shown unfolded.
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
    missing: usize,
) -> String {
    let suite = &plan.suite;
    let mut body = String::new();
    let mut line = |text: String| {
        body.push_str(&text);
        body.push('\n');
    };
    line(format!("<p>{}</p>", escape(&suite.about)));
    if missing > 0 {
        line(format!(
            "<p class=\"note\">{missing} of {} runs have not ended: the command below goes on.</p>",
            plan.runs.len()
        ));
    }
    line(format!(
        "<p>Made by</p><pre id=\"command\">{}</pre>",
        escape(command)
    ));
    line(String::from(
        "<p>Runs limited by evaluations went on side by side, and their times are not shown; runs limited by a time went on \
         last, one at a time, while the program did nothing else. Reference counts were made before, outside any clock. \
         Numbers are medians over seeds, intervals 95 % bootstrap intervals of the median; an engine is compared with another \
         seed by seed by the exact sign test, p corrected after Holm for the lines of its table.</p>",
    ));
    for part in &suite.parts {
        let of_part: Vec<&Shown<'_>> = groups
            .iter()
            .filter(|shown| shown.group.part == part.name)
            .collect();
        line(format!("<h2>{}</h2>", escape(&part.name)));
        if of_part.len() > 1 {
            line(overview(&of_part));
        }
        for (place, shown) in of_part.iter().enumerate() {
            let open = if place < UNFOLDED { " open" } else { "" };
            line(format!(
                "<details{open}><summary>{}, {}</summary>",
                escape(&shown.group.problem),
                shown.group.budget
            ));
            line(table(shown.group));
            line(waste(shown.group));
            for (figure, svg) in &shown.figures {
                line(format!(
                    "<figure>{svg}<figcaption>{}</figcaption></figure>",
                    escape(&figure.caption)
                ));
            }
            line("</details>".to_owned());
        }
    }
    findings
        .iter()
        .for_each(|(finding, figures)| line(study(finding, figures)));
    line("<h2>The machine</h2><table>".to_owned());
    for (what, value) in satisfice_catalogue::machine() {
        line(format!(
            "<tr><td>{}</td><td class=\"text\">{}</td></tr>",
            escape(&what),
            escape(&value)
        ));
    }
    line(format!(
        "</table><h2>The suite</h2><pre>{}</pre>",
        escape(&suite.text)
    ));
    PAGE.replace("{{title}}", &escape(&suite.title))
        .replace("{{body}}", &body)
}

/// Median recall, or hits where nothing is known, of every engine on every problem of a part.
fn overview(groups: &[&Shown<'_>]) -> String {
    let mut engines: Vec<&str> = Vec::new();
    for line in groups.iter().flat_map(|shown| &shown.group.lines) {
        if !engines.contains(&line.engine.as_str()) {
            engines.push(&line.engine);
        }
    }
    let mut text = String::from(
        "<p>Median recall at the end (hits where the number of all is not known):</p><div class=\"wide\"><table><tr><th>problem</th><th>all hits</th>",
    );
    engines
        .iter()
        .for_each(|engine| text.push_str(&format!("<th>{}</th>", escape(engine))));
    text.push_str("</tr>");
    for shown in groups {
        let group = shown.group;
        let all = group.reference_hits.map_or_else(|| "?".to_owned(), shown::count);
        // Writing to a string cannot fail.
        let _ = write!(text, "<tr><td>{}</td><td>{all}</td>", escape(&group.problem));
        for engine in &engines {
            let line = group.lines.iter().find(|line| line.engine == *engine);
            let _ = match line.map(|line| (line.recall, line.hits)) {
                Some((Some(recall), _)) => write!(
                    text,
                    "<td style=\"background:rgba(0,114,178,{:.2})\">{:.1} %</td>",
                    0.45 * recall.median,
                    100.0 * recall.median
                ),
                Some((None, hits)) => write!(text, "<td>{}</td>", shown::number(hits.median)),
                None => write!(text, "<td>-</td>"),
            };
        }
        text.push_str("</tr>\n");
    }
    text.push_str("</table></div>");
    text
}

fn row(tag: &str, cells: impl IntoIterator<Item = String>) -> String {
    let cells: String = cells
        .into_iter()
        .map(|cell| format!("<{tag}>{}</{tag}>", escape(&cell)))
        .collect();
    format!("<tr>{cells}</tr>\n")
}

fn table(group: &Group) -> String {
    let all = group
        .reference_hits
        .map_or_else(|| "not known".to_owned(), shown::count);
    let beside = group
        .beside
        .as_ref()
        .map_or_else(String::new, |text| format!(" Beside them: {}.", escape(text)));
    let mut text = format!(
        "<p>Hits that there are: {all}.{beside}</p><div class=\"wide\"><table>{}",
        row("th", heading(group))
    );
    group
        .lines
        .iter()
        .for_each(|line| text.push_str(&row("td", cells(group, line))));
    text + "</table></div>"
}

/// First hit, area, duplicates, precision, r(t).
fn waste(group: &Group) -> String {
    let mut names: Vec<String> = [
        "engine",
        "first hit at",
        "mean recall over evaluations",
        "repeated",
        "hits a fitness call",
    ]
    .map(str::to_owned)
    .into();
    if group.timed {
        names.push("mean recall over time".to_owned());
        names.extend(
            group
                .at_seconds
                .iter()
                .map(|&time| format!("r({})", shown::seconds(time))),
        );
    }
    let mut text = format!("<div class=\"wide\"><table>{}", row("th", names));
    for line in &group.lines {
        let share = |share: Option<f64>| share.map_or_else(|| "-".to_owned(), |share| format!("{share:.3}"));
        let mut cells = vec![
            line.engine.clone(),
            line.first_hit
                .evaluations
                .map_or_else(|| "never".to_owned(), |first| shown::number(first.median)),
            share(line.area_evaluations.map(|area| area.median)),
            format!("{:.1} %", 100.0 * line.duplicates.median),
            shown::number(line.precision.median),
        ];
        if group.timed {
            cells.push(share(line.area_seconds.map(|area| area.median)));
            cells.extend(line.r.iter().map(|r| format!("{:.2}", r.median)));
        }
        text.push_str(&row("td", cells));
    }
    text + "</table></div>"
}

/// A study: text, tables, figures, pictures.
fn study(finding: &Finding, figures: &[(Figure, String)]) -> String {
    let mut text = format!("<h2>{}</h2>\n", escape(&finding.title));
    finding
        .text
        .iter()
        .for_each(|paragraph| text.push_str(&format!("<p>{}</p>\n", escape(paragraph))));
    for (caption, rows) in &finding.tables {
        let mut tag = "th";
        text.push_str(&format!("<p>{}</p><div class=\"wide\"><table>", escape(caption)));
        for cells in rows {
            text.push_str(&row(tag, cells.clone()));
            tag = "td";
        }
        text.push_str("</table></div>\n");
    }
    for (figure, svg) in figures {
        text.push_str(&format!(
            "<figure>{svg}<figcaption>{}</figcaption></figure>\n",
            escape(&figure.caption)
        ));
    }
    for (caption, name, png) in &finding.pictures {
        let data = STANDARD.encode(png);
        let (name, caption) = (escape(name), escape(caption));
        text.push_str(&format!(
            "<figure><img alt=\"{name}\" src=\"data:image/png;base64,{data}\"><figcaption>{caption}</figcaption></figure>\n"
        ));
    }
    text
}

/// As text within a page.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
