//! The figures of a group: recall against evaluations and time, run time against error, run-length distributions, r(t).

use super::metrics::Moment;
use super::row::Row;
use super::summary::{Group, rows_of};
use crate::finding::Figure;
use crate::statistics::median;
use satisfice_draw::plot::{Chart, Curve, Panel};

/// Points of a curve.
const POINTS: usize = 64;
/// With more curves than this bands hide each other.
const BANDS: usize = 8;
/// Recalls whose costs make a run-length distribution.
const TARGETS: usize = 50;

/// What the horizontal axis counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum By {
    Evaluations,
    Seconds,
}

/// The runs of one engine of a group.
struct Runs<'a> {
    engine: &'a str,
    rows: Vec<&'a Row>,
}

/// The figures of a group, of its rows among `rows`.
#[must_use]
pub fn figures(group: &Group, rows: &[Row]) -> Vec<Figure> {
    let all: Vec<Runs<'_>> = group
        .lines
        .iter()
        .map(|line| Runs {
            engine: &line.engine,
            rows: rows_of(rows, group, &line.engine),
        })
        .collect();
    let by = if group.timed { By::Seconds } else { By::Evaluations };
    let mut figures = vec![curves(group, &all)];
    if let Some(reference) = group.reference_hits.filter(|&count| count > 0) {
        figures.push(error(group, &all, by, reference));
        figures.push(run_lengths(group, &all, by, reference));
    }
    if group.timed {
        figures.push(shares(group, &all));
    }
    if all.len() > BANDS {
        for figure in &mut figures {
            let curves = figure.chart.panels.iter_mut().flat_map(|panel| &mut panel.curves);
            let bands = curves.filter(|curve| !curve.band.is_empty());
            if bands.map(|curve| curve.band.clear()).count() > 0 {
                figure
                    .caption
                    .push_str(" With so many curves, their bands are left out.");
            }
        }
    }
    figures
}

fn title(group: &Group) -> String {
    format!("{}, {}", group.problem, group.budget)
}

impl By {
    fn of(self, moment: &Moment) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "counts below 2^53")]
        match self {
            Self::Evaluations => moment.0 as f64,
            Self::Seconds => moment.1,
        }
    }

    /// In the unit of the axis.
    fn shown(self, x: f64) -> f64 {
        if self == Self::Seconds { 1e3 * x } else { x }
    }

    fn label(self) -> String {
        if self == Self::Seconds {
            "time (ms)"
        } else {
            "evaluations"
        }
        .to_owned()
    }

    /// |C| of a run at x.
    fn hits(self, row: &Row, x: f64) -> u64 {
        match self {
            Self::Evaluations => row.hits_by_evaluation(x),
            Self::Seconds => row.hits_by_second(x),
        }
    }

    /// From the first thing that happens to the end, at equal ratios.
    fn grid(self, all: &[Runs<'_>]) -> Vec<f64> {
        let ends = |row: &&Row| {
            let first = row.curve.iter().map(|moment| self.of(moment)).find(|&x| x > 0.0);
            let last = row.curve.last().map(|moment| self.of(moment));
            first.zip(last)
        };
        let ends: Vec<(f64, f64)> = all
            .iter()
            .flat_map(|runs| runs.rows.iter().filter_map(ends))
            .collect();
        let first = ends
            .iter()
            .fold(f64::INFINITY, |least, (first, _)| least.min(*first));
        let last = ends
            .iter()
            .fold(0.0_f64, |greatest, (_, last)| greatest.max(*last));
        let ratio = last / first;
        #[expect(clippy::cast_precision_loss, reason = "some dozens")]
        (0..POINTS)
            .map(|k| first * ratio.powf(k as f64 / (POINTS - 1) as f64))
            .filter(|x| x.is_finite())
            .collect()
    }
}

/// Median and quartiles of a number over runs.
fn spread(mut numbers: Vec<f64>) -> (f64, (f64, f64)) {
    numbers.sort_by(f64::total_cmp);
    let last = numbers.len().saturating_sub(1);
    let at = |share: usize| numbers.get((last * share + 2) / 4).copied().unwrap_or(0.0);
    (median(&numbers).unwrap_or(0.0), (at(1), at(3)))
}

/// A curve over a grid, with a band of quartiles.
fn over(runs: &Runs<'_>, grid: &[f64], by: By, value: impl Fn(&Row, f64) -> f64) -> Curve {
    let (points, band) = grid
        .iter()
        .map(|&x| {
            let (middle, band) = spread(runs.rows.iter().map(|row| value(row, x)).collect());
            ((by.shown(x), middle), band)
        })
        .unzip();
    Curve {
        label: Some(runs.engine.to_owned()),
        points,
        band,
        ..Curve::default()
    }
}

#[expect(clippy::cast_precision_loss, reason = "a pixel is coarser than 53 bits")]
fn curves(group: &Group, all: &[Runs<'_>]) -> Figure {
    let scale = group
        .reference_hits
        .filter(|&count| count > 0)
        .map_or(1.0, |count| count as f64);
    let what = if scale > 1.0 {
        "recall"
    } else {
        "distinct hits |C|"
    };
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
    Figure {
        name: "recall",
        caption: format!("{what}: median over seeds; bands go from the lower to the upper quartile."),
        chart: Chart {
            title: title(group),
            panels,
        },
    }
}

/// Error is 1 - recall; nothing missing is drawn at half a hit.
#[expect(clippy::cast_precision_loss, reason = "a pixel is coarser than 53 bits")]
fn error(group: &Group, all: &[Runs<'_>], by: By, reference: u64) -> Figure {
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
    Figure {
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
    }
}

/// The points of all curves that no other has a smaller y for at no greater x, where y falls.
fn front(curves: &[Curve]) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> = curves
        .iter()
        .flat_map(|curve| curve.points.iter().copied())
        .collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    // What has next to nothing is no choice.
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

/// The share of runs and targets reached, the targets being equally spaced recalls up to 1.
#[expect(clippy::cast_precision_loss, reason = "a pixel is coarser than 53 bits")]
fn run_lengths(group: &Group, all: &[Runs<'_>], by: By, reference: u64) -> Figure {
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
    Figure {
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
    }
}

/// |C(t)|, recall(t) and the paper's r(t) beside each other, time linear as in the paper.
#[expect(clippy::cast_precision_loss, reason = "a pixel is coarser than 53 bits")]
fn shares(group: &Group, all: &[Runs<'_>]) -> Figure {
    let by = By::Seconds;
    let rows = || all.iter().flat_map(|runs| &runs.rows);
    let slice = rows().find_map(|row| Some(row.key.budget.time_seconds? * row.key.budget.slices as f64));
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
        by.hits(row, x) as f64 / row.hits.max(1) as f64
    }));
    Figure {
        name: "shares",
        caption: "The paper's r(t) beside what it hides: an engine that finds little and stops early has r(t) = 1 early. \
                  Median over seeds; bands go from the lower to the upper quartile."
            .to_owned(),
        chart: Chart { title: title(group), panels },
    }
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
