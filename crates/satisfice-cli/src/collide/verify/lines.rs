//! The pairs of a report one by one: each must be one of the scene, listed once, within the threshold, and as far apart as it says.

use std::collections::BTreeMap;

use satisfice_collision::{FeatureKind, Mesh, distance};

use super::checks::Checks;
use super::referee::Referee;
use super::{ROUNDING, witness};
use crate::collide::arguments::Find;
use crate::collide::body::NamedBody;
use crate::collide::pairs::{Line, Side};
use crate::collide::report::Head;
use crate::collide::scene::{Pair, World};
use crate::progress::Counting;

/// Pairs measured between two looks at the progress.
const SHOW_EVERY: usize = 4096;

/// The pairs of a report that are pairs of the scene, with their distances.
#[derive(Debug, Default)]
pub(super) struct Measured {
    pub(super) pairs: BTreeMap<Pair, f64>,
}

impl Measured {
    pub(super) fn farthest(&self) -> Option<f64> {
        self.pairs.values().copied().reduce(f64::max)
    }
}

/// The bodies of a pair, the lesser first.
pub(super) fn couple(pair: &Pair) -> [usize; 2] {
    let [a, b] = pair.bodies();
    [a.min(b), a.max(b)]
}

/// The corners that a report gives of a feature: files do not number edges.
fn has_its_ends(side: &Side, kind: FeatureKind, mesh: Option<&Mesh>) -> bool {
    let ends = mesh.and_then(|mesh| mesh.edges().get(side.feature as usize).copied());
    side.vertices == ends.filter(|_| kind == FeatureKind::Edge)
}

/// Whether two measurements of one distance are the same but for rounding.
pub(super) fn agree(given: f64, distance: f64, threshold: f64) -> bool {
    let scale = if threshold.is_finite() { threshold } else { 0.0 };
    (given - distance).abs() <= ROUNDING * scale.max(distance.abs())
}

pub(super) fn check(
    head: &Head,
    lines: &[Line],
    world: &World,
    referee: &Referee<'_>,
    counting: &Counting,
    checks: &mut Checks,
) -> Measured {
    let threshold = world.request.threshold;
    let mut measured = Measured::default();
    let mut last = 0.0;
    for (index, line) in lines.iter().enumerate() {
        if index % SHOW_EVERY == 0 {
            counting.say(format!("measuring pair {index} of {}", lines.len()));
        }
        let place = format!("pairs[{index}]");
        let pair = line.pair();
        let name = pair.to_string();
        if !referee.is_pair(&pair) {
            checks.that(
                false,
                place,
                name,
                "a pair of features of this scene, the lesser first",
            );
            continue;
        }
        let shapes = referee.shapes(&pair);
        let distance = distance::measure(&shapes[0], &shapes[1]);
        if measured.pairs.insert(pair, distance).is_some() {
            checks.that(false, place, name, "a pair that is not listed before");
            continue;
        }
        let is_hit = distance::within(&shapes[0], &shapes[1], world.threshold);
        let found = format!("{name}, {distance} apart");
        checks.that(is_hit, &place, found, format!("less than {threshold}"));
        let agrees = line
            .distance
            .is_none_or(|given| agree(given, distance, threshold));
        let given = format!("the distance {}", line.distance.unwrap_or_default());
        checks.that(agrees, &place, given, distance);
        check_ends([&line.a, &line.b], world.kinds(), &world.bodies, &place, checks);
        let mistake = line
            .witness
            .as_ref()
            .and_then(|given| witness::mistake(given, &shapes, distance));
        if let Some(expected) = mistake {
            checks.that(false, format!("{place}.witness"), &line.witness, expected);
        }
        found_when(head, line, &place, checks);
        if let (Find::Closest(_), Some(given)) = (world.request.find, line.distance) {
            checks.that(
                given >= last,
                format!("{place}.distance"),
                given,
                "the nearest pair first",
            );
            last = given;
        }
    }
    measured
}

/// Whether the two sides of a pair, of these kinds, name the ends of the edges that they are.
pub(in super::super) fn check_ends(
    sides: [&Side; 2],
    kinds: (FeatureKind, FeatureKind),
    bodies: &[NamedBody],
    place: &str,
    checks: &mut Checks,
) {
    for (side, kind, part) in [(sides[0], kinds.0, "a"), (sides[1], kinds.1, "b")] {
        let mesh = bodies.get(side.body).map(NamedBody::unplaced);
        let place = format!("{place}.{part}.vertices");
        checks.that(
            has_its_ends(side, kind, mesh),
            place,
            side.vertices,
            "the ends of an edge",
        );
    }
}

/// When an engine found a pair.
fn found_when(head: &Head, line: &Line, place: &str, checks: &mut Checks) {
    if let Some(evaluation) = line.evaluation {
        let is_one = (1..=head.evaluations).contains(&evaluation);
        let expected = format!("from 1 to {}", head.evaluations);
        checks.that(is_one, format!("{place}.evaluation"), evaluation, expected);
    }
    if let Some(seconds) = line.seconds {
        // Times of hits have 7 digits.
        let is_one = (0.0..=head.elapsed_seconds * (1.0 + 1e-6)).contains(&seconds);
        let expected = format!("from 0 to {}", head.elapsed_seconds);
        checks.that(is_one, format!("{place}.seconds"), seconds, expected);
    }
}
