//! Empirical run-length distributions.

use super::{By, Runs, title};
use crate::finding::Figure;
use crate::sweep::row::Row;
use crate::sweep::summary::Group;
use satisfice_draw::plot::{Chart, Curve, Panel};

/// Recalls whose costs make a run-length distribution.
const TARGETS: usize = 50;

/// The share of runs and targets reached, the targets being equally spaced recalls up to 1.
#[expect(clippy::cast_precision_loss, reason = "a pixel is coarser than 53 bits")]
pub(super) fn run_lengths(group: &Group, all: &[Runs<'_>]) -> Option<Figure> {
    let reference = group.reference_hits.filter(|&count| count > 0)?;
    let by = By::of_group(group);
    let grid = by.grid(all);
    let reached = |runs: &Runs<'_>, x: f64| {
        let of_run = |row: &&Row| {
            let hits = by.hits(row, x);
            (1..=TARGETS)
                .filter(|&k| hits as f64 >= k as f64 / TARGETS as f64 * reference as f64)
                .count()
        };
        runs.rows.iter().map(of_run).sum::<usize>() as f64 / (TARGETS * runs.rows.len().max(1)) as f64
    };
    Some(Figure {
        name: "run-lengths",
        caption: format!(
            "Empirical run-length distributions: the share of all pairs of a run and one of {TARGETS} targets, the recalls \
             from {} % to 100 %, that are reached.",
            100 / TARGETS
        ),
        chart: Chart {
            title: title(group),
            panels: vec![Panel {
                x_label: by.label(),
                y_label: "runs and targets reached".to_owned(),
                log_x: true,
                curves: all
                    .iter()
                    .map(|runs| Curve {
                        label: Some(runs.engine.to_owned()),
                        points: grid.iter().map(|&x| (by.shown(x), reached(runs, x))).collect(),
                        steps: true,
                        ..Curve::default()
                    })
                    .collect(),
                ..Panel::default()
            }],
        },
    })
}
