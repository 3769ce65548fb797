//! Outlines of areas: the library draws a band of a map cell by cell, in megabytes.

use std::collections::BTreeMap;
use std::fmt::Write;

use kuva::render::render::{Primitive, Scene};

/// A corner in hundredths of a unit, as the library writes it.
type Corner = (i64, i64);

/// Replaces each area that is drawn as polygons side by side by its outline. It covers the same points.
pub(super) fn outline_areas(scene: &mut Scene) {
    for element in &mut scene.elements {
        if let Primitive::Path(path) = element
            && path.fill.is_some()
            && path.stroke_width == 0.0
            && let Some(polygons) = polygons(&path.d)
            && polygons.len() > 1
        {
            path.d = text(&loops(&polygons));
        }
    }
}

/// The polygons of a path that has nothing but closed polygons, with two decimals at most.
fn polygons(path: &str) -> Option<Vec<Vec<Corner>>> {
    let closed = path.trim().strip_suffix('Z')?;
    closed.split('Z').map(polygon).collect()
}

fn polygon(path: &str) -> Option<Vec<Corner>> {
    let corners = path.trim().strip_prefix('M')?.split('L');
    let corner = |text: &str| {
        let (x, y) = text.trim().split_once(' ')?;
        Some((hundredths(x)?, hundredths(y)?))
    };
    corners.map(corner).collect()
}

#[expect(clippy::cast_possible_truncation, reason = "checked to be small")]
fn hundredths(text: &str) -> Option<i64> {
    let number: f64 = text.parse().ok()?;
    (number.abs() < 1e9).then_some((100.0 * number).round() as i64)
}

/// The loops around polygons that do not overlap: an edge that two of them share is inside.
fn loops(polygons: &[Vec<Corner>]) -> Vec<Vec<Corner>> {
    // How often each edge is passed forwards, less backwards, with all polygons in one sense.
    let mut passed = BTreeMap::<(Corner, Corner), i32>::new();
    for polygon in polygons {
        let sense = sense(polygon);
        for (index, &from) in polygon.iter().enumerate() {
            let to = polygon[(index + 1) % polygon.len()];
            let forwards = if from < to { 1 } else { -1 };
            *passed.entry((from.min(to), from.max(to))).or_default() += forwards * sense;
        }
    }
    let mut ways = BTreeMap::<Corner, Vec<Corner>>::new();
    for ((a, b), times) in passed {
        let (from, to) = if times > 0 { (a, b) } else { (b, a) };
        for _ in 0..times.abs() {
            ways.entry(from).or_default().push(to);
        }
    }
    let mut loops = Vec::new();
    while let Some((&start, _)) = ways.first_key_value() {
        let (mut walked, mut at) = (vec![start], start);
        while let Some(ends) = ways.get_mut(&at) {
            let next = ends.pop();
            if ends.is_empty() {
                ways.remove(&at);
            }
            let Some(next) = next else { break };
            at = next;
            if at == start {
                break;
            }
            walked.push(at);
        }
        loops.push(straightened(&walked));
    }
    loops
}

/// The sense in which a polygon turns: 1 or -1, 0 without an area.
fn sense(polygon: &[Corner]) -> i32 {
    let pairs = polygon.iter().zip(polygon.iter().cycle().skip(1));
    let twice: i64 = pairs.map(|(a, b)| a.0 * b.1 - a.1 * b.0).sum();
    i32::from(twice > 0) - i32::from(twice < 0)
}

/// A loop without the corners that lie between their neighbours.
fn straightened(corners: &[Corner]) -> Vec<Corner> {
    let count = corners.len();
    let turns = |index: usize| {
        let (a, b, c) = (
            corners[(index + count - 1) % count],
            corners[index],
            corners[(index + 1) % count],
        );
        (b.0 - a.0) * (c.1 - b.1) != (b.1 - a.1) * (c.0 - b.0)
    };
    (0..count)
        .filter(|&index| turns(index))
        .map(|index| corners[index])
        .collect()
}

fn text(loops: &[Vec<Corner>]) -> String {
    let mut path = String::new();
    for corners in loops.iter().filter(|corners| corners.len() > 2) {
        for (index, &(x, y)) in corners.iter().enumerate() {
            let word = if index == 0 { "M" } else { "L" };
            // Writing to a string cannot fail.
            let _ = write!(path, "{word}{} {}", x as f64 / 100.0, y as f64 / 100.0);
        }
        path.push('Z');
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outline(path: &str) -> String {
        text(&loops(&polygons(path).unwrap()))
    }

    #[test]
    fn squares_side_by_side_are_one_rectangle() {
        // The second one turns the other way.
        let row =
            "M0.00 0.00 L1.50 0.00 L1.50 1.00 L0.00 1.00 Z M1.50 0.00 L1.50 1.00 L3.00 1.00 L3.00 0.00 Z ";
        assert_eq!(outline(row), "M0 0L3 0L3 1L0 1Z");
        let apart = "M0 0 L1 0 L1 1 Z M5 5 L6 5 L6 6 Z";
        assert_eq!(outline(apart), "M0 0L1 0L1 1ZM5 5L6 5L6 6Z");
    }

    #[test]
    fn a_hole_turns_the_other_way() {
        let mut path = String::new();
        for (x, y) in (0..9)
            .map(|cell| (cell % 3, cell / 3))
            .filter(|&cell| cell != (1, 1))
        {
            let _ = write!(
                path,
                "M{x} {y} L{} {y} L{} {} L{x} {} Z ",
                x + 1,
                x + 1,
                y + 1,
                y + 1
            );
        }
        assert_eq!(outline(&path), "M0 0L3 0L3 3L0 3ZM1 1L1 2L2 2L2 1Z");
    }

    #[test]
    fn other_paths_are_left_alone() {
        for path in [
            "",
            "M0 0 L1 1",
            "M0 0 C1 1 2 2 3 3 Z",
            "M0 0 L1 Z",
            "M1e12 0 L0 0 L1 1 Z",
        ] {
            assert!(polygons(path).is_none(), "{path}");
        }
    }
}
