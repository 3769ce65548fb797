//! The chart of one record: |C| against evaluations and against time.

use super::{Chart, Curve, Panel};
use crate::record::Record;

/// |C| against evaluations (logarithmic) and against running time, with the number of hits that there are where it is
/// known.
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "a pixel is coarser than 53 bits")]
pub fn chart(record: &Record) -> Chart {
    let mark = record
        .reference_hits
        .map(|reference| (reference as f64, format!("all {reference} hits")));
    let recall = record
        .recall
        .map_or_else(String::new, |recall| format!(", recall {:.1} %", 100.0 * recall));
    let curve = |points: Vec<(f64, f64)>| Curve {
        points,
        ..Curve::default()
    };
    let by_evaluations = record.trace.iter().map(|p| (p.evaluations as f64, p.hits as f64));
    let by_time = record
        .trace
        .iter()
        .map(|p| (1e3 * p.elapsed_seconds, p.hits as f64));
    let panel = |x_label: &str, log_x, points| Panel {
        x_label: x_label.to_owned(),
        y_label: "distinct hits |C|".to_owned(),
        log_x,
        curves: vec![curve(points)],
        mark: mark.clone(),
        ..Panel::default()
    };
    Chart {
        title: format!(
            "{} by {}, seed {}: {} hits{recall}",
            record.problem, record.engine, record.seed, record.hits
        ),
        panels: vec![
            panel("evaluations", true, by_evaluations.collect()),
            panel(
                "time (ms)",
                false,
                std::iter::once((0.0, 0.0)).chain(by_time).collect(),
            ),
        ],
    }
}
