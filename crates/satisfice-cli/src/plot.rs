//! The chart of one report: hits against evaluations and against time.

use satisfice::TracePoint;
use satisfice_catalogue::RunReport;
use satisfice_draw::plot::{Chart, Curve, Panel};

use crate::page::evenly;

/// A curve has a step for at most so many hits, evenly chosen: more than a chart has rows of pixels.
const STEPS: usize = 4_000;

/// How the hits came in: what the search noted now and then, and each hit at its own evaluation and time.
fn growth(report: &RunReport) -> Vec<TracePoint> {
    let found = &report.solutions;
    let steps = evenly(found.len(), STEPS).map(|place| TracePoint {
        evaluations: found[place].evaluation,
        elapsed_seconds: found[place].seconds,
        hits: place as u64 + 1,
    });
    let mut points: Vec<TracePoint> = report.trace.iter().copied().chain(steps).collect();
    points.sort_by_key(|point| (point.evaluations, point.hits));
    points
}

/// Hits against evaluations (logarithmic) and against running time, with the number of all hits where it is known.
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "a pixel is coarser than 53 bits")]
pub(crate) fn chart(report: &RunReport) -> Chart {
    let mark = report
        .reference_hits
        .map(|reference| (reference as f64, format!("all {reference} hits")));
    let recall = report
        .recall
        .map_or_else(String::new, |recall| format!(", recall {:.1} %", 100.0 * recall));
    let curve = |points: Vec<(f64, f64)>| Curve {
        points,
        // Between two hits their number does not rise.
        steps: true,
        ..Curve::default()
    };
    let growth = growth(report);
    let by_evaluations = growth.iter().map(|p| (p.evaluations as f64, p.hits as f64));
    let by_time = growth.iter().map(|p| (1e3 * p.elapsed_seconds, p.hits as f64));
    let panel = |x_label: &str, log_x, points| Panel {
        x_label: x_label.to_owned(),
        y_label: "distinct hits".to_owned(),
        log_x,
        curves: vec![curve(points)],
        mark: mark.clone(),
        ..Panel::default()
    };
    Chart {
        title: format!(
            "{} by {}, seed {}: {} hits{recall}",
            report.spec.problem, report.spec.engine, report.spec.seed, report.hits
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

#[cfg(test)]
mod tests {
    use satisfice_catalogue::{RunControl, RunSpec, catalogue};
    use satisfice_draw::plot::{Format, draw};

    use super::*;

    fn queens(evaluations: u64) -> RunReport {
        let problem = catalogue::find("queens").unwrap().build([("n", "4")]).unwrap();
        let spec = RunSpec::new("random").evaluations(evaluations);
        let mut report = problem.run(&spec, RunControl::default()).unwrap();
        report.set_reference(problem.reference_hits());
        report
    }

    #[test]
    fn the_chart_of_a_record_is_drawn_the_same_twice_in_both_formats() {
        let chart = chart(&queens(20_000));
        assert_eq!(chart.panels.len(), 2);
        assert!(chart.panels.iter().all(|panel| panel.curves[0].steps));
        assert_eq!(chart.panels[0].curves[0].points.last(), Some(&(20_000.0, 2.0)));
        let svg = String::from_utf8(draw(&chart, Format::Svg).unwrap()).unwrap();
        for text in ["<svg", "evaluations", "time (ms)", "all 2 hits", "recall 100.0 %"] {
            assert!(svg.contains(text), "{text}");
        }
        let png = draw(&chart, Format::Png).unwrap();
        assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
        assert!(draw(&chart, Format::Png).unwrap() == png);
        assert!(draw(&chart, Format::Svg).unwrap() == svg.into_bytes());
    }

    /// The number of hits that a curve of steps shows.
    fn at(points: &[(f64, f64)], x: f64) -> f64 {
        let before = points.iter().take_while(|point| point.0 <= x);
        before.last().map_or(0.0, |point| point.1)
    }

    #[test]
    fn a_curve_rises_where_the_hits_were_found() {
        let problem = catalogue::find("disc-packing")
            .unwrap()
            .build([("discs", "2")])
            .unwrap();
        let spec = RunSpec::new("random").evaluations(20_000);
        let mut report = problem.run(&spec, RunControl::default()).unwrap();
        assert!(report.hits > 20);
        for copies in [1, 1_000] {
            // Many hits at a time: the curve is thinned.
            let copied = report.solutions.iter().flat_map(|hit| vec![hit.clone(); copies]);
            report.solutions = copied.collect();
            report.trace.retain(|point| point.evaluations == 20_000);
            report.trace[0].hits = report.solutions.len() as u64;
            let chart = chart(&report);
            let [by_evaluations, by_time] = [0, 1].map(|panel| &chart.panels[panel].curves[0].points);
            assert!(by_time.len() < report.solutions.len().min(STEPS) + 10);
            let close = (report.solutions.len() / STEPS) as f64 + 1.0;
            for (place, hit) in report
                .solutions
                .iter()
                .enumerate()
                .skip(copies - 1)
                .step_by(copies)
            {
                let found = place as f64 + 1.0;
                for shown in [
                    at(by_evaluations, hit.evaluation as f64),
                    at(by_time, 1e3 * hit.seconds),
                ] {
                    assert!(shown <= found && found < shown + close, "{shown} of {found}");
                }
            }
        }
    }

    #[test]
    fn charts_with_little_or_nothing_in_them_are_drawn() {
        let mut report = queens(1);
        for points in [0, 1] {
            report.trace.truncate(points);
            for format in [Format::Svg, Format::Png] {
                assert!(draw(&chart(&report), format).unwrap().len() > 1000);
            }
        }
    }
}
