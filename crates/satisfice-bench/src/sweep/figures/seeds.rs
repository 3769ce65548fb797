//! Hits at the end of every run, sorted: how much a result owes to its seed.

use super::{Runs, title};
use crate::finding::Figure;
use crate::sweep::summary::Group;
use satisfice_draw::plot::{Chart, Curve, Panel};

/// The fewest seeds that have a distribution.
const SEEDS: usize = 4;

/// Hits at the end of every run, sorted: the quantiles over seeds.
pub(super) fn seeds(group: &Group, all: &[Runs<'_>]) -> Option<Figure> {
    if all.iter().all(|runs| runs.rows.len() < SEEDS) {
        return None;
    }
    let curves = all.iter().map(|runs| {
        let mut hits: Vec<u64> = runs.rows.iter().map(|row| row.report.hits).collect();
        hits.sort_unstable();
        Curve {
            label: Some(runs.engine.to_owned()),
            points: quantiles(&hits),
            steps: true,
            ..Curve::default()
        }
    });
    Some(Figure {
        name: "seeds",
        caption: "Hits at the end of every run, from the worst seed to the best: a flat line owes nothing to its seed.".to_owned(),
        chart: Chart {
            title: title(group),
            panels: vec![Panel {
                x_label: "share of the seeds".to_owned(),
                y_label: "hits at the end".to_owned(),
                curves: curves.collect(),
                ..Panel::default()
            }],
        },
    })
}

/// The steps of the quantile function of sorted counts: each count where its share begins, the last one at 1 as well.
#[expect(clippy::cast_precision_loss, reason = "a pixel is coarser than 53 bits")]
fn quantiles(sorted: &[u64]) -> Vec<(f64, f64)> {
    let begins = |index: usize| index as f64 / sorted.len() as f64;
    let steps = sorted
        .iter()
        .enumerate()
        .map(|(index, &hits)| (begins(index), hits as f64));
    steps
        .chain(sorted.last().map(|&hits| (1.0, hits as f64)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::quantiles;

    #[test]
    fn a_count_has_its_share_of_the_axis() {
        assert_eq!(
            quantiles(&[0, 7, 9, 9]),
            [(0.0, 0.0), (0.25, 7.0), (0.5, 9.0), (0.75, 9.0), (1.0, 9.0)]
        );
        assert!(quantiles(&[]).is_empty());
    }
}
