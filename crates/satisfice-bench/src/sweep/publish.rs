//! Writes the files of a finished sweep, apart from `results.jsonl`.

use std::path::{Path, PathBuf};

use super::figures::figures;
use super::plan::Plan;
use super::row::Row;
use super::summary::{Group, groups, rows_of};
use super::{files, ioh, regret, report};
use crate::error::Error;
use crate::finding::Figure;
use crate::finding::Finding;
use satisfice_draw::plot::{Format, draw};
use satisfice_page::ComparePage;

/// The files of a folder that a sweep writes anew. What is not among them is added to (`results.jsonl`), left as it is if it differs
/// (`shard.json`), or written as it was read (`suite.toml`).
#[must_use]
pub fn replaced(folder: &Path) -> Vec<PathBuf> {
    ["regret.md", "summary.json", report::COMPARE, "report.html"]
        .map(|name| folder.join(name))
        .into()
}

/// Writes `suite.toml`, `summary.json`, the folder `ioh`, the figures as SVG and PNG, `compare.html`, where engines are switched
/// on and off, with a comparison `regret.md`, and `report.html`, which contains the rest of it, the findings of studies and the `command` that made it; returns the groups of the summary.
///
/// # Errors
/// [`Error::File`] if a file cannot be written, [`Error::Draw`] if a figure cannot be encoded.
pub fn publish(
    folder: &Path,
    plan: &Plan,
    rows: &[Row],
    findings: &[Finding],
    command: &str,
) -> Result<Vec<Group>, Error> {
    let groups = groups(plan, rows);
    let regret = regret::finding(plan, &groups, rows);
    if let Some(finding) = &regret {
        files::write(
            &folder.join("regret.md"),
            regret::markdown(finding, command).as_bytes(),
        )?;
    }
    files::write(&folder.join("suite.toml"), plan.suite.text.as_bytes())?;
    files::write(
        &folder.join("summary.json"),
        &satisfice_catalogue::json::to_vec(&groups)?,
    )?;
    ioh::export(&folder.join("ioh"), &groups, rows)?;
    let place = folder.join("figures");
    let mut shown = Vec::new();
    for (number, group) in (1..).zip(&groups) {
        // With a comparison there are hundreds of groups; the page beside the report draws them as they are looked at.
        let drawn = if regret.is_some() {
            Vec::new()
        } else {
            figures(group, rows)
        };
        let drawn = drawn.into_iter().map(|figure| {
            let stem = format!("{number:02}-{}", figure.name);
            draw_into(&place, &stem, figure)
        });
        shown.push(report::Shown {
            group,
            figures: drawn.collect::<Result<_, _>>()?,
        });
    }
    let mut found = Vec::new();
    for finding in regret.iter().chain(findings) {
        let drawn = finding
            .figures
            .iter()
            .map(|figure| draw_into(&place, figure.name, figure.clone()));
        found.push((finding, drawn.collect::<Result<Vec<_>, _>>()?));
        for (_, name, png) in &finding.pictures {
            files::write(&place.join(format!("{name}.png")), png)?;
        }
    }
    if !groups.is_empty() {
        files::write(
            &folder.join(report::COMPARE),
            compare(plan, &groups, rows)?.as_bytes(),
        )?;
    }
    let page = report::page(plan, &shown, &found, command, plan.len() - rows.len() as u64);
    files::write(&folder.join("report.html"), page.as_bytes())?;
    Ok(groups)
}

/// The page on which engines are switched on and off.
fn compare(plan: &Plan, groups: &[Group], rows: &[Row]) -> Result<String, Error> {
    let mut page = ComparePage::new(&plan.suite.title);
    page.link("report.html", "the report");
    for group in groups {
        let title = format!("{}: {}, {}", group.part, group.problem, group.budget);
        page.problem(title, group.reference_hits, group.timed);
        for line in &group.lines {
            for row in rows_of(rows, group, &line.engine) {
                let curve = row.curve.iter().map(|moment| (moment.0, moment.1, moment.2));
                page.run(&line.engine, row.report.spec.seed, curve);
            }
        }
    }
    Ok(page.html()?)
}

/// Draws a figure as SVG and PNG; returns it with its SVG.
fn draw_into(folder: &Path, stem: &str, figure: Figure) -> Result<(Figure, String), Error> {
    let svg = draw(&figure.chart, Format::Svg)?;
    files::write(&folder.join(format!("{stem}.svg")), &svg)?;
    files::write(
        &folder.join(format!("{stem}.png")),
        &draw(&figure.chart, Format::Png)?,
    )?;
    Ok((figure, String::from_utf8_lossy(&svg).into_owned()))
}
