//! Draws maps.

use kuva::plot::scatter::MarkerShape;
use kuva::plot::{ColorMap, ContourPlot, LinePlot, LineStyle, ScatterPlot};
use kuva::render::annotations::TextAnnotation;
use kuva::render::figure::Figure;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use kuva::render::render::{Primitive, Scene};

use super::outline::outline_areas;
use super::{encode, title_size};
use crate::error::Error;
use crate::plot::{Format, Layer, Map, Maps, Marker, Shape};

/// Draws maps. The same maps give the same bytes.
///
/// # Errors
/// [`Error::Chart`] if the picture cannot be encoded.
pub fn draw_maps(maps: &Maps, format: Format) -> Result<Vec<u8>, Error> {
    let (plots, layouts): (Vec<_>, Vec<_>) = maps.panels.iter().map(panel).unzip();
    let columns = maps.panels.len().max(1);
    let figure = Figure::new(1, columns)
        .with_title(maps.title.clone())
        .with_title_size(title_size(&maps.title, maps.size.0 * columns as f64))
        .with_plots(plots)
        .with_layouts(layouts)
        .with_cell_size(maps.size.0, maps.size.1);
    let labels =
        |map: &Map| -> Vec<Option<String>> { map.layers.iter().map(|layer| layer.label.clone()).collect() };
    let one_legend = columns > 1
        && maps
            .panels
            .iter()
            .all(|map| labels(map) == labels(&maps.panels[0]));
    let has_scale = |layer: &Layer| matches!(layer.shape, Shape::Contours { .. });
    let mut scene = if one_legend && !maps.panels[0].layers.iter().any(has_scale) {
        figure.with_shared_legend_bottom().render()
    } else {
        figure.render()
    };
    // The library's own pixels fill holes, and cells cost nothing there.
    if format == Format::Svg {
        outline_areas(&mut scene);
    }
    show_whole_discs(&mut scene);
    encode(&scene, format)
}

/// Lets discs at the border of a map be seen whole: what the library draws over a map is cut there.
fn show_whole_discs(scene: &mut Scene) {
    let mut cut = None;
    for element in std::mem::take(&mut scene.elements) {
        match (&element, &cut) {
            (Primitive::ClipStart { .. }, _) => cut = Some(element.clone()),
            (Primitive::ClipEnd, _) => cut = None,
            (Primitive::CircleBatch { .. }, Some(start)) => {
                scene
                    .elements
                    .extend([Primitive::ClipEnd, element, start.clone()]);
                continue;
            }
            _ => {}
        }
        scene.elements.push(element);
    }
}

fn panel(map: &Map) -> (Vec<Plot>, Layout) {
    let mut plots: Vec<Plot> = map.layers.iter().flat_map(|layer| draw(map, layer)).collect();
    if plots.is_empty() {
        // Without points the axes are empty.
        plots.push(Plot::Line(
            LinePlot::new().with_data([(map.x_range.0, map.y_range.0)]),
        ));
    }
    let mut layout = Layout::auto_from_plots(&plots)
        .with_title(map.title.clone())
        .with_title_size(14)
        .with_x_label(map.x_label.clone())
        .with_y_label(map.y_label.clone())
        .with_x_axis_min(map.x_range.0)
        .with_x_axis_max(map.x_range.1)
        .with_y_axis_min(map.y_range.0)
        .with_y_axis_max(map.y_range.1);
    if map.logarithmic {
        layout = layout.with_log_scale();
    } else if map.to_scale {
        layout = layout.with_equal_aspect();
    }
    for (x, y, words) in &map.notes {
        layout = layout.with_annotation(TextAnnotation::new(words.clone(), *x, *y));
    }
    (plots, layout)
}

/// A layer as plots of the library; the first of them has the line in the legend.
fn draw(map: &Map, layer: &Layer) -> Vec<Plot> {
    let shown = |points: &[(f64, f64)]| -> Vec<(f64, f64)> {
        let visible =
            |x: f64, y: f64| x.is_finite() && y.is_finite() && (!map.logarithmic || (x > 0.0 && y > 0.0));
        points.iter().copied().filter(|&(x, y)| visible(x, y)).collect()
    };
    let lines = |lines: &[Vec<(f64, f64)>], style: &LineStyle| -> Vec<Plot> {
        let mut label = layer.label.clone();
        let drawn = lines.iter().map(|line| {
            let plot = LinePlot::new()
                .with_data(shown(line))
                .with_color(layer.colour.hexadecimal())
                .with_line_style(style.clone())
                .with_stroke_width(layer.size);
            Plot::Line(match label.take() {
                Some(label) => plot.with_legend(label),
                None => plot,
            })
        });
        drawn.collect()
    };
    match &layer.shape {
        Shape::Points(marker, points) => {
            let within = |range: (f64, f64), at: f64| (range.0..=range.1).contains(&at);
            let points = shown(points).into_iter();
            let plot = ScatterPlot::new()
                .with_data(points.filter(|&(x, y)| within(map.x_range, x) && within(map.y_range, y)))
                .with_color(layer.colour.hexadecimal())
                .with_size(layer.size)
                .with_marker(match marker {
                    Marker::Disc => MarkerShape::Circle,
                    Marker::Square => MarkerShape::Square,
                    Marker::Triangle => MarkerShape::Triangle,
                    Marker::Cross => MarkerShape::Cross,
                });
            vec![Plot::Scatter(match &layer.label {
                Some(label) => plot.with_legend(label.clone()),
                None => plot,
            })]
        }
        Shape::Lines(all) => lines(all, &LineStyle::Solid),
        Shape::Dashes(all) => lines(all, &LineStyle::Dashed),
        Shape::Contours { x, y, z, levels } => {
            let plot = ContourPlot::new()
                .with_grid(z.clone(), x.clone(), y.clone())
                .with_levels(levels)
                .with_filled()
                .with_colormap(ColorMap::Cividis)
                .with_line_color("none");
            vec![Plot::Contour(match &layer.label {
                Some(label) => plot.with_legend(label.clone()),
                None => plot,
            })]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::Colour;

    fn svg(maps: &Maps) -> String {
        String::from_utf8(draw_maps(maps, Format::Svg).unwrap()).unwrap()
    }

    fn maps(points: Vec<(f64, f64)>) -> Maps {
        Maps {
            title: "a title".to_owned(),
            size: (300.0, 200.0),
            panels: vec![Map {
                x_label: "x (m)".to_owned(),
                x_range: (1.0, 10.0),
                y_range: (1.0, 10.0),
                logarithmic: true,
                layers: vec![Layer::points(Colour::Blue, 2.0, points).named("a & b")],
                notes: vec![(2.0, 2.0, "a note".to_owned())],
                ..Map::default()
            }],
        }
    }

    #[test]
    fn a_map_shows_its_points_and_its_words() {
        let some = svg(&maps(vec![(2.0, 3.0), (4.0, 5.0)]));
        for words in ["a title", "x (m)", "a &amp; b", "a note", "#0072b2"] {
            assert!(some.contains(words), "{words} is not in the picture");
        }
        // Points that logarithmic axes cannot show are left out; the others stay.
        let odd = [
            (f64::NAN, 1.0),
            (2.0, 3.0),
            (-1.0, 2.0),
            (4.0, 5.0),
            (3.0, f64::INFINITY),
        ];
        assert_eq!(some, svg(&maps(odd.to_vec())));
        assert_ne!(some, svg(&maps(vec![(2.0, 3.0)])));
    }

    #[test]
    fn contours_and_nothing_are_drawn() {
        let axis = vec![0.0, 1.0, 2.0];
        let slope = Shape::Contours {
            x: axis.clone(),
            y: axis,
            z: vec![vec![0.0, 1.0, 2.0]; 3],
            levels: vec![0.5, 1.5],
        };
        let mut maps = Maps {
            size: (300.0, 200.0),
            panels: vec![Map {
                x_range: (0.0, 2.0),
                y_range: (0.0, 2.0),
                to_scale: true,
                ..Map::default()
            }],
            ..Maps::default()
        };
        let empty = draw_maps(&maps, Format::Png).unwrap();
        maps.panels[0].layers.push(Layer {
            label: Some("height".to_owned()),
            colour: Colour::Black,
            size: 1.0,
            shape: slope,
        });
        assert_ne!(draw_maps(&maps, Format::Png).unwrap(), empty);
        assert!(svg(&maps).contains("height"));
        // A band is one path, whatever number of cells it covers.
        let picture = svg(&maps);
        let bands: Vec<&str> = picture.split("<path d=\"").skip(1).collect();
        assert!(
            bands
                .iter()
                .any(|path| path.split('"').next().unwrap().matches('M').count() == 1)
        );
        assert!(
            bands
                .iter()
                .all(|path| path.split('"').next().unwrap().len() < 100),
            "{picture}"
        );
        assert!(!svg(&Maps::default()).is_empty());
    }
}
