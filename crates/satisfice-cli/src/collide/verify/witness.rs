//! Closest points of a pair against its features: they lie on them, realise the distance, and the normal joins them.

use satisfice_collision::Shape;
use satisfice_collision::distance::{self, Point};

use super::super::pairs::{Witness, direction};

/// Points are rounded to this part of the coordinates, generously.
const ROUNDING: f64 = 1e-9;

/// What rounding can move a point of these features, or one derived from it.
pub(in super::super) fn slack(shapes: &[Shape; 2]) -> f64 {
    let corners = shapes.iter().flat_map(Shape::corners).flatten();
    ROUNDING * corners.fold(0.0_f64, |most, c| most.max(c.abs()))
}

/// Whether a point lies on a feature.
pub(in super::super) fn is_on(point: Point, shape: &Shape, slack: f64) -> bool {
    point.iter().all(|c| c.is_finite()) && distance::measure(&Shape::Vertex(point), shape) <= slack
}

/// What should be instead of a witness of a pair at this distance.
pub(super) fn mistake(witness: &Witness, shapes: &[Shape; 2], distance: f64) -> Option<&'static str> {
    let Witness {
        point_a,
        point_b,
        normal,
        part_a,
        part_b,
    } = witness;
    let slack = slack(shapes);
    let [a, b] = [(part_a, point_a, &shapes[0]), (part_b, point_b, &shapes[1])]
        .map(|(name, point, shape)| part(name, shape).is_some_and(|part| is_on(*point, &part, slack)));
    if !a || !b {
        return Some("points on the parts of the features that it names");
    }
    let apart = distance::measure(&Shape::Vertex(*point_a), &Shape::Vertex(*point_b));
    if (apart - distance).abs() > slack {
        return Some("points as far apart as the features");
    }
    let joins = |normal: &Point| {
        direction(*point_a, *point_b).is_some_and(|is| {
            normal
                .iter()
                .zip(is)
                .all(|(given, is)| (given - is).abs() <= ROUNDING)
        })
    };
    let is_right = match normal {
        Some(normal) => joins(normal),
        None => distance == 0.0 || direction(*point_a, *point_b).is_none(),
    };
    (!is_right).then_some("the unit vector from the first point to the second, or null where they meet")
}

/// The part of a feature with this name.
fn part(name: &str, shape: &Shape) -> Option<Shape> {
    let corners = shape.corners();
    let numbered = |kind: &str| name.strip_prefix(kind)?.parse::<usize>().ok();
    match (numbered("vertex "), numbered("edge ")) {
        (Some(k), _) => corners.get(k).map(|&corner| Shape::Vertex(corner)),
        (_, Some(k)) if corners.len() > 1 => {
            let next = corners[(k + 1) % corners.len()];
            corners.get(k).map(|&corner| Shape::Edge([corner, next]))
        }
        _ => (name == "face" && corners.len() == 3).then_some(*shape),
    }
}
