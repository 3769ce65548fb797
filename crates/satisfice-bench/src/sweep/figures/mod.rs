//! The figures of a group: recall against evaluations and time, run time against error, run-length distributions, seeds, r(t).

mod error;
mod recall;
mod run_lengths;
mod seeds;
mod shares;

use super::metrics::Moment;
use super::row::Row;
use super::summary::{Group, rows_of};
use crate::finding::Figure;
use crate::statistics::median;
use satisfice_draw::plot::Curve;

/// The number of points of a curve.
const POINTS: usize = 64;
/// The greatest number of curves with bands: more bands hide each other.
const BANDS: usize = 8;

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

/// A chart of a group; `None` if it has nothing to show.
type Draw = fn(&Group, &[Runs<'_>]) -> Option<Figure>;

/// All charts, in the order of a report: a new one is a file beside this one and a line here.
const CHARTS: &[Draw] = &[
    recall::recall,
    error::error,
    run_lengths::run_lengths,
    seeds::seeds,
    shares::shares,
];

/// The figures of a group, from its rows among `rows`.
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
    let mut figures: Vec<Figure> = CHARTS.iter().filter_map(|draw| draw(group, &all)).collect();
    if all.len() > BANDS {
        figures.iter_mut().for_each(without_bands);
    }
    figures
}

fn without_bands(figure: &mut Figure) {
    let curves = figure.chart.panels.iter_mut().flat_map(|panel| &mut panel.curves);
    let bands = curves.filter(|curve| !curve.band.is_empty());
    if bands.map(|curve| curve.band.clear()).count() > 0 {
        figure
            .caption
            .push_str(" With so many curves, their bands are left out.");
    }
}

fn title(group: &Group) -> String {
    format!("{}, {}", group.problem, group.budget)
}

impl By {
    /// Time where a clock limits the group, otherwise evaluations.
    fn of_group(group: &Group) -> Self {
        if group.timed {
            Self::Seconds
        } else {
            Self::Evaluations
        }
    }

    fn of(self, moment: &Moment) -> f64 {
        #[expect(clippy::cast_precision_loss, reason = "counts below 2^53")]
        match self {
            Self::Evaluations => moment.0 as f64,
            Self::Seconds => moment.1,
        }
    }

    /// A value in the unit of the axis.
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

    /// Hits of a run at x.
    fn hits(self, row: &Row, x: f64) -> u64 {
        match self {
            Self::Evaluations => row.hits_by_evaluation(x),
            Self::Seconds => row.hits_by_second(x),
        }
    }

    /// Values from the first event to the end, at equal ratios.
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
        #[expect(clippy::cast_precision_loss, reason = "a few dozen")]
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
