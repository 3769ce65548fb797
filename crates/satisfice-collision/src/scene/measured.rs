//! How near the contacts of a frame are expected to be in the next one, measured between the frames.

use super::body::Motion;
use super::link::Link;
use super::{Contact, Scene};
use crate::Placement;
use crate::broad::{Pair, Witnesses};
use crate::distance::{Point, Proximity};

/// How far below the threshold the distances of a link's pairs are expected to be in the frame after `frame`, rounded down.
#[derive(Default)]
pub(super) struct Measured {
    pub(super) frame: Option<u64>,
    /// Where the bodies are expected then; `None` if one deforms, of which what is expected is that it stays.
    places: Option<[Placement; 2]>,
    /// In the order of the pairs.
    slack: Vec<f32>,
    /// The pairs in the order of falling slack, and their slacks.
    likely: Vec<Contact>,
    falling: Vec<f32>,
    /// Of rigid bodies the closest points of the likely pairs, in the bodies' own coordinates: wherever the bodies go, the
    /// distance of these points is one that the features do not exceed.
    witnesses: Witnesses,
}

impl Link {
    /// How many of the likely pairs are closer than their bodies are from where they were expected, and so hold without a look.
    pub(super) fn holding(&self, drift: f64) -> usize {
        self.measured
            .falling
            .partition_point(|&slack| f64::from(slack) > drift)
    }

    /// Closest points of the likely pairs, where bodies move as a whole.
    pub(super) fn witnesses(&self) -> &Witnesses {
        &self.measured.witnesses
    }

    /// Those pairs in the order of the pairs.
    pub(super) fn held(&self, drift: f64) -> impl Iterator<Item = Pair> {
        let slacks = self.pairs.iter().zip(&self.measured.slack);
        slacks
            .filter(move |(_, slack)| f64::from(**slack) > drift)
            .map(|(pair, _)| *pair)
    }
}

impl Scene {
    /// Measures the distance of every known contact, so that the next pass can tell from the bodies' motion alone which of them
    /// still hold: of rigid bodies as it will be if they go on as they do, so that a steady motion costs nothing. For the time
    /// between frames: an answer does not change by it. Cost: one distance a contact.
    pub fn measure_contacts(&mut self) {
        let delta = self.threshold.get();
        self.answers += 1;
        for at in 0..self.links.len() {
            let link = &self.links[at];
            let seen = link.seen;
            if seen != Some(self.frame) {
                continue;
            }
            let mut measured = std::mem::take(&mut self.links[at].measured);
            let link = &self.links[at];
            let slack = &mut measured.slack;
            slack.clear();
            measured.places = self
                .are_whole(link)
                .then(|| [link.a, link.b].map(|body| *self.states[body].forecast.expected()));
            let mut witnesses = Vec::new();
            slack.extend(link.pairs.iter().map(|&pair| {
                let nearest = self.proximity_of(link.contact(pair));
                let (delta, distance) = if let Some(places) = &measured.places {
                    let points = self.witness(link, pair, &nearest);
                    witnesses.push(points);
                    (self.reach(link, places), expected_distance(points, places))
                } else {
                    (delta, nearest.distance)
                };
                // a distance is within one unit in the last place; the cast may round up by half of one of f32
                ((delta - distance * (1.0 + 1e-12)) * (1.0 - 1e-12)).max(0.0) as f32
            }));
            slack
                .iter_mut()
                .for_each(|slack| *slack = slack.next_down().max(0.0));
            // numbers that are not negative are ordered as their bits are
            let mut order: Vec<u64> = (0..)
                .zip(&*slack)
                .map(|(pair, slack)| u64::from(!slack.to_bits()) << 32 | pair)
                .collect();
            order.sort_unstable();
            let place = |key: &u64| *key as u32 as usize;
            measured.likely.clear();
            let contacts = order.iter().map(|key| link.contact(link.pairs[place(key)]));
            measured.likely.extend(contacts);
            measured.witnesses.clear();
            if measured.places.is_some() {
                let falling: Vec<_> = order.iter().map(|key| witnesses[place(key)]).collect();
                measured.witnesses.set(&falling);
            }
            measured.falling.clear();
            measured.falling.extend(order.iter().map(|key| slack[place(key)]));
            measured.frame = seen;
            self.links[at].measured = measured;
        }
        // The next pass begins with the link of most pairs: its contacts are laid out here, so that it need not copy them.
        let first = self.order().first().copied();
        self.laid_out.clear();
        self.laid_out_of = None;
        if let Some(first) = first
            && self.links[first].measured.frame == Some(self.frame)
        {
            let Link { a, b, measured, .. } = &self.links[first];
            self.laid_out.extend_from_slice(&measured.likely);
            self.laid_out_of = Some((*a, *b, self.frame));
        }
    }

    /// The closest points of a pair in the bodies' own coordinates.
    fn witness(&self, link: &Link, pair: Pair, nearest: &Proximity) -> [Point; 2] {
        let (kind_a, kind_b) = self.kind.features();
        [
            (link.a, kind_a, pair.a, nearest.weights_a),
            (link.b, kind_b, pair.b, nearest.weights_b),
        ]
        .map(|(body, kind, feature, weights)| self.states[body].own_point(kind, feature, weights))
    }

    /// Whether both bodies of a link move as wholes, if at all.
    fn are_whole(&self, link: &Link) -> bool {
        [link.a, link.b]
            .iter()
            .all(|&body| self.states[body].body.motion != Motion::Deforming)
    }

    /// The pairs of the last frame in the order of falling slack, if they were measured then and for what was expected of the
    /// present frame.
    pub(super) fn likely<'l>(&self, link: &'l Link) -> Option<&'l [Contact]> {
        let last = self.frame.checked_sub(1);
        let foreseen = [link.a, link.b].map(|body| self.states[body].forecast.foreseen().0);
        let measured = &link.measured;
        let is_known = last.is_some() && measured.frame == last && link.seen == last;
        let as_expected = measured.places.as_ref().is_none_or(|[a, b]| foreseen == [a, b]);
        (is_known && as_expected).then_some(&measured.likely)
    }

    /// How near the closest points of a link's likely pairs, with the bodies in these places, have to be for their features to be
    /// within the threshold for certain: posing and weighing round in proportion to the lengths involved.
    pub(super) fn reach(&self, link: &Link, places: &[Placement; 2]) -> f64 {
        let largest = |place: &Placement| {
            place
                .translation()
                .iter()
                .fold(0.0_f64, |most, c| most.max(c.abs()))
        };
        let sizes = self.states[link.a].extent() + self.states[link.b].extent();
        self.threshold.get() - 1e-12 * (sizes + largest(&places[0]) + largest(&places[1]))
    }

    /// By how much the distance of two features of a link can exceed what was expected of the present frame: that the bodies go on
    /// as they did, or, if one of them deforms, that they stay.
    pub(super) fn drift(&self, link: &Link) -> f64 {
        let (a, b) = (&self.states[link.a], &self.states[link.b]);
        if self.are_whole(link) {
            a.forecast.foreseen().1 + b.forecast.foreseen().1
        } else if link.a == link.b {
            2.0 * a.motion
        } else {
            a.motion + b.motion
        }
    }
}

/// How far two points are from each other with their bodies in these places; infinite where a square overflows or vanishes.
fn expected_distance([p, q]: [Point; 2], [a, b]: &[Placement; 2]) -> f64 {
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
