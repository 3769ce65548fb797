//! Run time against error.

use super::{By, Runs, over, title};
use crate::finding::Figure;
use crate::sweep::row::Row;
use crate::sweep::summary::Group;
use satisfice_draw::plot::{Chart, Curve, Panel};

/// Error is 1 - recall; a complete answer is drawn at half a missing hit.
#[expect(clippy::cast_precision_loss, reason = "a pixel is coarser than 53 bits")]
pub(super) fn error(group: &Group, all: &[Runs<'_>]) -> Option<Figure> {
    let reference = group.reference_hits.filter(|&count| count > 0)?;
    let by = By::of_group(group);
    let grid = by.grid(all);
    let least = 0.5 / reference as f64;
    let missing = |row: &Row, x: f64| (1.0 - by.hits(row, x) as f64 / reference as f64).max(least);
    let mut lines: Vec<Curve> = all
        .iter()
        .map(|runs| Curve {
            band: Vec::new(),
            ..over(runs, &grid, by, missing)
        })
        .collect();
    lines.push(Curve {
        label: Some("Pareto front".to_owned()),
        points: front(&lines),
        marks: true,
        ..Curve::default()
    });
    Some(Figure {
        name: "error",
        caption: "Run time against error: the median share of the hits that are missing. Dots are the Pareto front from a recall of 5 % on: no \
                  method has less error in as little. What is complete is drawn at half a missing hit."
            .to_owned(),
        chart: Chart {
            title: title(group),
            panels: vec![Panel {
                x_label: by.label(),
                y_label: "error 1 - recall".to_owned(),
                log_x: true,
                log_y: true,
                curves: lines,
                mark: None,
            }],
        },
    })
}

/// The points of all curves at which no point with the same or a smaller x has a smaller y.
fn front(curves: &[Curve]) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> = curves
        .iter()
        .flat_map(|curve| curve.points.iter().copied())
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    // A recall below 5 % is left out.
    let mut least = 0.95;
    points.retain(|&(_, y)| {
        let better = y < least;
        if better {
            least = y;
        }
        better
    });
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_has_what_nothing_beats() {
        let curve = |points: &[(f64, f64)]| Curve {
            points: points.to_vec(),
            ..Curve::default()
        };
        let curves = [
            curve(&[(1.0, 0.9), (2.0, 0.5), (4.0, 0.5)]),
            curve(&[(1.0, 1.0), (2.0, 0.6), (3.0, 0.1)]),
        ];
        assert_eq!(front(&curves), [(1.0, 0.9), (2.0, 0.5), (3.0, 0.1)]);
    }
}
