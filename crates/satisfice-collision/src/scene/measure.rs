//! Measures between frames how far below the threshold contacts are expected to be in the next frame.
//!
//! Rigid bodies are expected to go on as they do, deforming ones to stay.

use std::collections::BTreeMap;

use super::pairs::{Record, Status};
use super::slack::Slack;
use super::{State, World};
use crate::broad::Pair;
use crate::distance::{Point, Proximity};
use crate::{FeatureKind, Placement};

impl World {
    /// Measures the distance of every contact whose bodies moved in the last frame. The next pass then knows from the motion of
    /// the bodies alone which of them still hold. Call it between frames; it changes no answer. Cost: one distance per contact.
    pub fn measure_contacts(&mut self) {
        self.predicts = true;
        self.mark_moved();
        let expected: BTreeMap<u32, Placement> = self
            .came_from
            .iter()
            .filter(|(body, _)| self.contains(*body))
            .map(|&(body, from)| (body.slot, self.next_place(body.slot, &from.into())))
            .collect();
        let wanted = |record: &Record| {
            record.status == Status::Current && record.slack.is_none() && !record.pairs.is_empty()
        };
        let records: Vec<u32> = self
            .pairs
            .iter()
            .filter(|(_, record)| wanted(record))
            .map(|(id, _)| id)
            .collect();
        for id in records {
            let slack = self.measure(&self.pairs[id], &expected);
            self.pairs[id].slack = Some(Box::new(slack));
        }
    }

    /// Where a rigid body is in the next frame if it moves as it did from `from` on.
    fn next_place(&self, slot: u32, from: &Placement) -> Placement {
        let now = self.state(slot).placement();
        let step = from.inverse().and_then(|back| back.then(&now));
        step.and_then(|step| now.then(&step)).unwrap_or(now)
    }

    fn measure(&self, record: &Record, expected: &BTreeMap<u32, Placement>) -> Slack {
        let [a, b] = record.bodies;
        let delta = self.threshold.get();
        let place = |slot: u32| {
            let next = expected.get(&slot).copied();
            next.unwrap_or_else(|| self.state(slot).placement())
        };
        let places = self.are_rigid(record).then(|| [place(a), place(b)]);
        let slack = |pair: &Pair| {
            let nearest = self.proximity_of(record.bodies, *pair);
            let (delta, distance) = match &places {
                Some(places) => {
                    let points = self.closest_points(record, *pair, &nearest);
                    (delta - self.rounding(record, places), distance_at(points, places))
                }
                None => (delta, nearest.distance),
            };
            // a distance is within one unit in the last place; the cast may round up by half of one of f32
            let slack = ((delta - distance * (1.0 + 1e-12)) * (1.0 - 1e-12)).max(0.0) as f32;
            slack.next_down().max(0.0)
        };
        Slack::new(places, &record.pairs, slack)
    }

    /// The number of likely contacts of a record that certainly hold, by the bound of motion.
    pub(super) fn holding(&self, record: &Record) -> usize {
        match &record.slack {
            Some(slack) if record.status == Status::Behind => slack.holding(self.drift(record, slack)),
            _ => 0,
        }
    }

    /// A bound on how far the distance of two features can exceed the expected one.
    fn drift(&self, record: &Record, slack: &Slack) -> f64 {
        let [a, b] = record.bodies;
        match &slack.places {
            Some(places) => self.state(a).away_from(&places[0]) + self.state(b).away_from(&places[1]),
            None => self.motion_of(a) + self.motion_of(b),
        }
    }

    /// The closest points of a pair in the bodies' own coordinates.
    fn closest_points(&self, record: &Record, pair: Pair, nearest: &Proximity) -> [Point; 2] {
        let (kind_a, kind_b) = self.kind.features();
        [
            self.state(record.bodies[0])
                .own_point(kind_a, pair.a, nearest.weights_a),
            self.state(record.bodies[1])
                .own_point(kind_b, pair.b, nearest.weights_b),
        ]
    }

    /// Whether neither body of a record deforms.
    fn are_rigid(&self, record: &Record) -> bool {
        record
            .bodies
            .iter()
            .all(|&slot| self.state(slot).deforming.is_none())
    }

    /// A bound on the rounding of placing and weighing the closest points, in proportion to the lengths involved.
    fn rounding(&self, record: &Record, places: &[Placement; 2]) -> f64 {
        let largest = |place: &Placement| {
            place
                .translation()
                .iter()
                .fold(0.0_f64, |most, c| most.max(c.abs()))
        };
        let sizes: f64 = record.bodies.iter().map(|&slot| self.state(slot).extent()).sum();
        1e-12 * (sizes + largest(&places[0]) + largest(&places[1]))
    }
}

impl State {
    /// The point of a feature with these weights, before the placement.
    fn own_point(&self, kind: FeatureKind, feature: u32, weights: [f64; 3]) -> Point {
        let corners = self
            .corners_of(kind, feature)
            .map(|v| self.vertices()[v as usize]);
        if kind == FeatureKind::Vertex {
            return corners[0];
        }
        std::array::from_fn(|k| (0..3).map(|c| weights[c] * corners[c][k]).sum())
    }
}

/// How far two points are from each other with their bodies in these places; infinite where a square overflows or vanishes.
fn distance_at([p, q]: [Point; 2], [a, b]: &[Placement; 2]) -> f64 {
    let (p, q) = (a.apply(p), b.apply(q));
    let [x, y, z] = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    let square = x * x + y * y + z * z;
    let vanishes = square < 1e-290 && [x, y, z] != [0.0; 3];
    if vanishes || !square.is_finite() {
        f64::INFINITY
    } else {
        square.sqrt()
    }
}
