//! What a finished sweep leaves in its folder beside `results.jsonl`.

use std::path::Path;

use super::figures::figures;
use super::plan::Plan;
use super::row::Row;
use super::summary::{Group, groups};
use super::{files, ioh, report};
use crate::error::Error;
use crate::plot::{Format, draw};

/// Writes `suite.toml`, `summary.json`, the folder `ioh`, the figures as SVG and PNG, and `report.html`, which holds all of
/// it and says that `command` made it; returns the groups of the summary.
///
/// # Errors
/// [`Error::File`] where a file cannot be written, [`Error::Chart`] where a figure cannot be encoded.
pub fn publish(folder: &Path, plan: &Plan, rows: &[Row], command: &str) -> Result<Vec<Group>, Error> {
    let groups = groups(plan, rows);
    files::write(&folder.join("suite.toml"), plan.suite.text.as_bytes())?;
    files::write(&folder.join("summary.json"), &crate::json::to_vec(&groups)?)?;
    ioh::export(&folder.join("ioh"), &groups, rows)?;
    let mut shown = Vec::new();
    for (number, group) in (1..).zip(&groups) {
        let mut drawn = Vec::new();
        for figure in figures(group, rows) {
            let stem = format!("{number:02}-{}", figure.name);
            let svg = draw(&figure.chart, Format::Svg)?;
            files::write(&folder.join("figures").join(format!("{stem}.svg")), &svg)?;
            files::write(
                &folder.join("figures").join(format!("{stem}.png")),
                &draw(&figure.chart, Format::Png)?,
            )?;
            drawn.push((figure, String::from_utf8_lossy(&svg).into_owned()));
        }
        shown.push(report::Shown {
            group,
            figures: drawn,
        });
    }
    let page = report::page(plan, &shown, command, plan.runs.len() - rows.len());
    files::write(&folder.join("report.html"), page.as_bytes())?;
    Ok(groups)
}
