//! Hits, recall and the paper's r(t) against time.

use super::{By, Runs, over, title};
use crate::finding::Figure;
use crate::sweep::row::Row;
use crate::sweep::summary::Group;
use satisfice_draw::plot::{Chart, Panel};

/// |C(t)|, recall(t) and the paper's r(t) beside each other, time linear as in the paper.
#[expect(clippy::cast_precision_loss, reason = "a pixel is coarser than 53 bits")]
pub(super) fn shares(group: &Group, all: &[Runs<'_>]) -> Option<Figure> {
    if !group.timed {
        return None;
    }
    let by = By::Seconds;
    let rows = || all.iter().flat_map(|runs| &runs.rows);
    let slice = rows().find_map(|row| {
        Some(row.report.spec.budget.time?.as_secs_f64() * row.report.spec.budget.slices as f64)
    });
    let end = slice.unwrap_or(0.0);
    let grid: Vec<f64> = (0..=40).map(|k| end * f64::from(k) / 40.0).collect();
    let panel = |what: &str, value: &dyn Fn(&Row, f64) -> f64| Panel {
        x_label: by.label(),
        y_label: what.to_owned(),
        curves: all.iter().map(|runs| over(runs, &grid, by, value)).collect(),
        ..Panel::default()
    };
    let mut panels = vec![panel("|C(t)|", &|row, x| by.hits(row, x) as f64)];
    if let Some(reference) = group.reference_hits.filter(|&count| count > 0) {
        panels.push(panel("recall |C(t)| / |all|", &|row, x| {
            by.hits(row, x) as f64 / reference as f64
        }));
    }
    panels.push(panel("r(t) = |C(t)| / |C(end)|", &|row, x| {
        by.hits(row, x) as f64 / row.report.hits.max(1) as f64
    }));
    Some(Figure {
        name: "shares",
        caption: "The paper's r(t) beside what it hides: an engine that finds little and stops early has r(t) = 1 early. \
                  Median over seeds; bands go from the lower to the upper quartile."
            .to_owned(),
        chart: Chart { title: title(group), panels },
    })
}
