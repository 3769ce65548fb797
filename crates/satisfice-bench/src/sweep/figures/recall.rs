//! Recall, or hits, against evaluations and time.

use super::{By, Runs, over, title};
use crate::finding::Figure;
use crate::sweep::summary::Group;
use satisfice_draw::plot::{Chart, Panel};

#[expect(clippy::cast_precision_loss, reason = "a pixel is coarser than 53 bits")]
pub(super) fn recall(group: &Group, all: &[Runs<'_>]) -> Option<Figure> {
    let scale = group
        .reference_hits
        .filter(|&count| count > 0)
        .map_or(1.0, |count| count as f64);
    let what = if scale > 1.0 { "recall" } else { "distinct hits" };
    let panel = |by: By| Panel {
        x_label: by.label(),
        y_label: what.to_owned(),
        log_x: true,
        curves: {
            let grid = by.grid(all);
            all.iter()
                .map(|runs| over(runs, &grid, by, |row, x| by.hits(row, x) as f64 / scale))
                .collect()
        },
        mark: group.reference_hits.map(|count| {
            (
                if scale > 1.0 { 1.0 } else { count as f64 },
                format!("all {count} hits"),
            )
        }),
        ..Panel::default()
    };
    let mut panels = vec![panel(By::Evaluations)];
    if group.timed {
        panels.push(panel(By::Seconds));
    }
    Some(Figure {
        name: "recall",
        caption: format!("{what}: median over seeds; bands go from the lower to the upper quartile."),
        chart: Chart {
            title: title(group),
            panels,
        },
    })
}
