//! The chart of one report: hits against evaluations and against time.

use satisfice_catalogue::RunReport;
use satisfice_draw::plot::{Chart, Curve, Panel};

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
        // Between two points of the trace the number of hits does not rise evenly.
        steps: true,
        ..Curve::default()
    };
    let by_evaluations = report.trace.iter().map(|p| (p.evaluations as f64, p.hits as f64));
    let by_time = report
        .trace
        .iter()
        .map(|p| (1e3 * p.elapsed_seconds, p.hits as f64));
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
