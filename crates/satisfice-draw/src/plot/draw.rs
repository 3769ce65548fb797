//! Draws charts. Only this file and its folder know the plotting library.

mod boards;
mod map;
mod outline;

pub use boards::draw_boards;
pub use map::draw_maps;

use kuva::backend::png::PngBackend;
use kuva::backend::svg::SvgBackend;
use kuva::plot::{LinePlot, LineStyle, ScatterPlot};
use kuva::render::annotations::ReferenceLine;
use kuva::render::figure::Figure;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use kuva::render::render::Scene;

use satisfice::Identity;

use super::{Chart, Format, Panel};
use crate::error::Error;

/// Size of a panel in units; a PNG has two pixels per unit.
const PANEL: (f64, f64) = (480.0, 360.0);

/// Width of the only panel of a chart.
const ALONE: f64 = 640.0;

/// Height of a legend without lines, and of a line, in the same units.
const LEGEND: (f64, f64) = (56.0, 18.5);

/// Okabe and Ito's colours, which colour-blind readers can distinguish, without their yellow, which is faint on white
/// (<https://jfly.uni-koeln.de/color/>).
const COLOURS: [&str; 7] = [
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000",
];
/// Line styles that remain distinct in black and white; 7 colours and 4 styles make 28 different curves.
const STYLES: [LineStyle; 4] = [
    LineStyle::Solid,
    LineStyle::Dashed,
    LineStyle::Dotted,
    LineStyle::DashDot,
];

/// Draws a chart. The same chart gives the same bytes.
///
/// # Errors
/// [`Error::Chart`] if the picture cannot be encoded.
pub fn draw(chart: &Chart, format: Format) -> Result<Vec<u8>, Error> {
    let (plots, layouts): (Vec<_>, Vec<_>) = chart.panels.iter().map(panel).unzip();
    let labels = |panel: &Panel| {
        panel
            .curves
            .iter()
            .map(|curve| curve.label.clone())
            .collect::<Vec<_>>()
    };
    let one_legend = chart.panels.len() > 1
        && labels(&chart.panels[0]).iter().any(Option::is_some)
        && chart
            .panels
            .iter()
            .all(|panel| labels(panel) == labels(&chart.panels[0]));
    // Every curve has a line in the legend.
    let entries = chart.panels.iter().map(|panel| panel.curves.len()).max();
    let height = PANEL.1.max(LEGEND.0 + LEGEND.1 * entries.unwrap_or(0) as f64);
    // The only panel shares its width with its legend.
    let width = if chart.panels.len() == 1 { ALONE } else { PANEL.0 };
    let figure = Figure::new(1, chart.panels.len().max(1))
        .with_title(chart.title.clone())
        .with_title_size(title_size(&chart.title, width * chart.panels.len().max(1) as f64))
        .with_plots(plots)
        .with_layouts(layouts)
        .with_cell_size(width, height);
    let figure = if one_legend {
        figure.with_shared_legend()
    } else {
        figure
    };
    encode(&figure.render(), format)
}

fn encode(scene: &Scene, format: Format) -> Result<Vec<u8>, Error> {
    match format {
        Format::Svg => Ok(scalable(own_ids(&SvgBackend::new().render_scene(scene))).into_bytes()),
        Format::Png => PngBackend::new().render_scene(scene).map_err(Error::Chart),
    }
}

/// The library gives only a size; with a view box a page can scale the whole picture.
fn scalable(svg: String) -> String {
    let head = svg.split_once('>').map_or("", |(head, _)| head);
    let field = |name: &str| head.split_once(name)?.1.split_once('"').map(|(value, _)| value);
    match (field(" width=\""), field(" height=\"")) {
        (Some(width), Some(height)) if !head.contains("viewBox") => {
            let view = format!("<svg viewBox=\"0 0 {width} {height}\"");
            svg.replacen("<svg", &view, 1)
        }
        _ => svg,
    }
}

/// A size at which a title fits, with letters as wide as 0.62 of it.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "from 7 to 16"
)]
fn title_size(title: &str, width: f64) -> u32 {
    let letters = title.chars().count().max(1) as f64;
    (width / (0.62 * letters)).clamp(7.0, 16.0) as u32
}

/// The library numbers clip paths over all pictures of a process. This numbers them within the picture, under a name made from
/// its contents: the same picture has the same bytes, and several pictures can share one page.
fn own_ids(svg: &str) -> String {
    const PREFIX: &str = "kuva-clip-";
    let mut pieces = svg.split(PREFIX);
    let mut text = vec![pieces.next().unwrap_or_default()];
    let (mut seen, mut numbers) = (Vec::new(), Vec::new());
    for piece in pieces {
        let digits = piece.len() - piece.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let (number, rest) = piece.split_at(digits);
        let index = seen.iter().position(|&known| known == number);
        numbers.push(index.unwrap_or_else(|| {
            seen.push(number);
            seen.len() - 1
        }));
        text.push(rest);
    }
    let picture = (text.concat(), &numbers).key();
    let mut svg = text[0].to_owned();
    for (number, rest) in numbers.iter().zip(&text[1..]) {
        svg.push_str(&format!("clip-{picture:016x}-{number}{rest}"));
    }
    svg
}

fn panel(panel: &Panel) -> (Vec<Plot>, Layout) {
    let visible = |x: f64, y: f64| {
        x.is_finite() && y.is_finite() && (!panel.log_x || x > 0.0) && (!panel.log_y || y > 0.0)
    };
    let mut plots = Vec::new();
    let (mut least, mut greatest) = ((f64::INFINITY, f64::INFINITY), (0.0_f64, 0.0_f64));
    for (index, curve) in panel.curves.iter().enumerate() {
        let banded = curve.band.len() == curve.points.len();
        let points = || curve.points.iter().enumerate();
        let shown: Vec<usize> = points()
            .filter(|&(i, &(x, y))| {
                visible(x, y) && (!banded || (visible(x, curve.band[i].0) && visible(x, curve.band[i].1)))
            })
            .map(|(i, _)| i)
            .collect();
        if shown.is_empty() {
            continue;
        }
        for &i in &shown {
            let (x, y) = curve.points[i];
            let (low, high) = if banded { curve.band[i] } else { (y, y) };
            least = (least.0.min(x), least.1.min(low));
            greatest = (greatest.0.max(x), greatest.1.max(high));
        }
        if curve.marks {
            let dots = ScatterPlot::new()
                .with_data(shown.iter().map(|&i| curve.points[i]))
                .with_color("#000000")
                .with_size(3.5);
            plots.push(Plot::Scatter(match &curve.label {
                Some(label) => dots.with_legend(label.clone()),
                None => dots,
            }));
            continue;
        }
        let mut line = LinePlot::new()
            .with_data(shown.iter().map(|&i| curve.points[i]))
            .with_color(COLOURS[index % COLOURS.len()])
            .with_line_style(STYLES[index % STYLES.len()].clone())
            .with_stroke_width(2.0);
        if curve.steps {
            line = line.with_step();
        }
        if banded {
            line = line.with_band(
                shown.iter().map(|&i| curve.band[i].0),
                shown.iter().map(|&i| curve.band[i].1),
            );
        }
        if let Some(label) = &curve.label {
            line = line.with_legend(label.clone());
        }
        plots.push(Plot::Line(line));
    }
    if plots.is_empty() {
        // Without points the axes are empty.
        plots.push(Plot::Line(LinePlot::new().with_data([(1.0, 1.0)])));
        (least, greatest) = ((1.0, 1.0), (10.0, 1.0));
    }
    if let Some((value, _)) = &panel.mark {
        greatest.1 = greatest.1.max(*value);
    }
    let mut layout = Layout::auto_from_plots(&plots)
        .with_x_label(panel.x_label.clone())
        .with_y_label(panel.y_label.clone())
        .with_x_axis_max(if greatest.0 > least.0 {
            greatest.0
        } else {
            10.0 * greatest.0.max(0.1)
        });
    if panel.log_x {
        layout = layout.with_log_x();
    } else {
        layout = layout.with_x_axis_min(least.0.min(0.0));
    }
    if panel.log_y {
        layout = layout.with_log_y();
    } else {
        layout = layout
            .with_y_axis_min(0.0)
            .with_y_axis_max(1.08 * greatest.1.max(1.0));
    }
    if let Some((value, label)) = &panel.mark {
        layout = layout.with_reference_line(
            ReferenceLine::horizontal(*value)
                .with_label(label.clone())
                .with_color("#555555")
                .with_dasharray("5 4"),
        );
    }
    (plots, layout)
}
