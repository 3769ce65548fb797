//! One pair of a motion: it is asked about again, and its points are looked at where the features are at that time.

use satisfice_collision::Shape;
use satisfice_collision::continuous::{FeatureOf, Impact, MovingContact};
use satisfice_collision::distance::{self, PairKind, Point, Threshold};

use super::super::super::pairs::Side;
use super::super::super::verify::{Checks, check_ends, is_on, slack};
use super::super::TOLERANCE;
use super::super::frames::Frames;
use super::super::report::ImpactLine;

/// Directions may differ by this much.
const ROUNDING: f64 = 1e-6;

pub(super) fn contact(line: &ImpactLine) -> MovingContact {
    let side = |side: &Side| FeatureOf {
        body: u32::try_from(side.body).unwrap_or(u32::MAX),
        index: side.feature,
    };
    MovingContact {
        a: side(&line.a),
        b: side(&line.b),
    }
}

fn name(line: &ImpactLine) -> String {
    let ImpactLine { kind, a, b, .. } = line;
    format!(
        "{kind}: {} of body {} and {} of body {}",
        a.feature, a.body, b.feature, b.body
    )
}

pub(super) fn check(
    line: &ImpactLine,
    place: &str,
    frames: &Frames,
    checks: &mut Checks,
) -> anyhow::Result<()> {
    let Some(&kind) = frames.kinds.iter().find(|kind| kind.name() == line.kind) else {
        checks.that(false, place, name(line), "a kind of pairs that was asked for");
        return Ok(());
    };
    let contact = contact(line);
    let impact = frames
        .step
        .impact_of(kind, &contact, frames.separation, TOLERANCE)?;
    let Some(impact) = impact else {
        checks.that(false, place, name(line), "a pair that comes near during the step");
        return Ok(());
    };
    check_ends([&line.a, &line.b], kind.features(), &frames.bodies, place, checks);
    let Some(time) = line.time else {
        let has_none = line.at_start.is_none() && line.normal.is_none();
        let has_none = has_none && line.point_a.is_none() && line.point_b.is_none();
        checks.that(
            has_none,
            place,
            name(line),
            "nothing of an impact whose time is null",
        );
        return Ok(());
    };
    let [low, high] = impact.time;
    // Both are bounds of one time.
    let agrees = time[0] <= high && low <= time[1] && (0.0..=TOLERANCE).contains(&(time[1] - time[0]));
    checks.that(
        agrees,
        place,
        name(line),
        format!("an impact between {low} and {high}"),
    );
    if agrees {
        // The points are those of the narrow bounds, also where the bounds listed are wider.
        check_start(line, kind, place, frames, checks);
        let mistake = check_points(line, shapes(kind, &contact, frames, high), &impact);
        if let Some((key, expected)) = mistake {
            checks.that(false, format!("{place}.{key}"), line, expected);
        }
    }
    Ok(())
}

/// The features of a pair at a part of the step.
fn shapes(kind: PairKind, contact: &MovingContact, frames: &Frames, time: f64) -> [Shape; 2] {
    let (kind_a, kind_b) = kind.features();
    [(contact.a, kind_a), (contact.b, kind_b)].map(|(feature, kind)| {
        let body = feature.body as usize;
        let (from, to) = (&frames.bodies[body], &frames.ends[body]);
        from.unplaced().features(kind).shape(feature.index, |v| {
            let (from, to) = (from.vertex(v), to.vertex(v));
            std::array::from_fn(|k| from[k] * (1.0 - time) + to[k] * time)
        })
    })
}

fn check_start(line: &ImpactLine, kind: PairKind, place: &str, frames: &Frames, checks: &mut Checks) {
    let [a, b] = shapes(kind, &contact(line), frames, 0.0);
    let is_near = match Threshold::new(frames.separation.get()) {
        Ok(threshold) => distance::within(&a, &b, threshold),
        // Without a threshold, features have to touch.
        Err(_) => distance::distance(&a, &b) == 0.0,
    };
    let expected = format!("{is_near}, from the bodies at the start");
    checks.that(
        line.at_start == Some(is_near),
        format!("{place}.at_start"),
        line.at_start,
        expected,
    );
}

/// The key that is wrong and what it should be.
fn check_points(
    line: &ImpactLine,
    shapes: [Shape; 2],
    impact: &Impact,
) -> Option<(&'static str, &'static str)> {
    let slack = slack(&shapes);
    let (Some(point_a), Some(point_b)) = (line.point_a, line.point_b) else {
        return Some(("point_a", "two points"));
    };
    if !is_on(point_a, &shapes[0], slack) {
        return Some((
            "point_a",
            "a point of the first feature at the time of the impact",
        ));
    }
    if !is_on(point_b, &shapes[1], slack) {
        return Some((
            "point_b",
            "a point of the second feature at the time of the impact",
        ));
    }
    let apart = distance::measure(&Shape::Vertex(point_a), &Shape::Vertex(point_b));
    if (apart - distance::measure(&shapes[0], &shapes[1])).abs() > slack {
        return Some(("point_b", "points as far apart as the features"));
    }
    let is: Option<Point> = Some(impact.normal).filter(|normal| *normal != [0.0; 3]);
    let is_right = match (line.normal, is) {
        (Some(given), Some(is)) => given
            .iter()
            .zip(is)
            .all(|(given, is)| (given - is).abs() <= ROUNDING),
        (given, is) => given == is,
    };
    (!is_right).then_some((
        "normal",
        "the unit vector from a towards b just before the impact",
    ))
}
