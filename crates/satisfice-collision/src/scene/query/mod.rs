//! Questions that need not know every contact: which bodies touch, and the first contact; in files of their own, the closest pairs
//! and distances, what is in a box, and what a ray meets first.

mod closest;
mod ray;
mod region;

pub use closest::NearestFeature;
pub use ray::RayHit;

use std::collections::BTreeSet;

use super::filter::PairFilter;
use super::pairs::Status;
use super::{BodyId, Completeness, Contact, World};
use crate::Error;
pub(super) use crate::broad::Stop;
use crate::broad::{Pair, Watch};

/// Visits of a tree between two looks at the watch.
pub(super) const VISITS: usize = 4096;
/// Contacts of an earlier frame that are tried before a search.
const LIKELY: usize = 64;

pub(super) fn completeness(watch: &Watch<'_>) -> Completeness {
    if watch.stopped() {
        Completeness::Unknown
    } else {
        Completeness::Proved
    }
}

impl World {
    /// Which bodies have a feature within the threshold of one of another body, or of their own: pairs of bodies `(a, b)`,
    /// `a <= b`, sorted. Stops at the first contact of each pair.
    ///
    /// # Errors
    /// As [`World::update`].
    pub fn touching(&mut self) -> Result<Vec<(BodyId, BodyId)>, Error> {
        let witnesses = self.witnesses()?;
        let mut touching: Vec<_> = witnesses.iter().map(Contact::bodies).collect();
        touching.sort_unstable();
        Ok(touching)
    }

    /// The same with a contact that shows it for each pair of bodies: the same one for the same world.
    ///
    /// # Errors
    /// As [`World::update`].
    pub fn witnesses(&mut self) -> Result<Vec<Contact>, Error> {
        Ok(self.witnesses_watched(&Watch::none())?.0)
    }

    /// The same until `stop` says so, which is asked every 20 us to 10 ms and told how many there are by now;
    /// [`Completeness::Unknown`] where it did: of bodies that are not named, nothing is known.
    ///
    /// # Errors
    /// As [`World::update`].
    pub fn witnesses_until(&mut self, stop: Stop<'_>) -> Result<(Vec<Contact>, Completeness), Error> {
        self.witnesses_watched(&Watch::until(stop))
    }

    fn witnesses_watched(&mut self, watch: &Watch<'_>) -> Result<(Vec<Contact>, Completeness), Error> {
        let mut named = BTreeSet::new();
        let mut found: Vec<Contact> = Vec::new();
        for record in self.by_bodies() {
            let [a, b] = self.pairs[record].bodies;
            let bodies = (a.min(b), a.max(b));
            if watch.ask(0) {
                break;
            }
            if !named.contains(&bodies)
                && let Some(pair) = self.any(record, watch)?
            {
                named.insert(bodies);
                found.push(self.contact(&self.pairs[record], pair));
                watch.ask(1);
            }
        }
        found.sort_unstable();
        Ok((found, completeness(watch)))
    }

    /// Some contact, if there is any: the same one for the same world.
    ///
    /// # Errors
    /// As [`World::update`].
    pub fn first(&mut self) -> Result<Option<Contact>, Error> {
        Ok(self.first_watched(&Watch::none())?.0)
    }

    /// The same until `stop` says so; [`Completeness::Unknown`] where it did before there was one.
    ///
    /// # Errors
    /// As [`World::update`].
    pub fn first_until(&mut self, stop: Stop<'_>) -> Result<(Option<Contact>, Completeness), Error> {
        self.first_watched(&Watch::until(stop))
    }

    fn first_watched(&mut self, watch: &Watch<'_>) -> Result<(Option<Contact>, Completeness), Error> {
        for record in self.by_bodies() {
            if watch.ask(0) {
                break;
            }
            if let Some(pair) = self.any(record, watch)? {
                return Ok((
                    Some(self.contact(&self.pairs[record], pair)),
                    Completeness::Proved,
                ));
            }
        }
        Ok((None, completeness(watch)))
    }

    /// The records of the present frame in the order of their bodies.
    pub(super) fn by_bodies(&mut self) -> Vec<u32> {
        self.settle();
        self.mark_moved();
        let mut records: Vec<_> = self
            .pairs
            .iter()
            .map(|(id, record)| (record.bodies, id))
            .collect();
        records.sort_unstable();
        records.into_iter().map(|(_, id)| id).collect()
    }

    /// Some pair of a record, if the watch has time for it.
    fn any(&mut self, record: u32, watch: &Watch<'_>) -> Result<Option<Pair>, Error> {
        let known = &self.pairs[record];
        let bodies = known.bodies;
        if known.status == Status::Current {
            return Ok(known.pairs.first().copied());
        }
        // a pair that touched last time is the likeliest to touch now
        let likely = known
            .pairs
            .iter()
            .copied()
            .take(LIKELY)
            .find(|&pair| self.decide(bodies, pair));
        if likely.is_some() || self.boxes_apart(bodies) {
            return Ok(likely);
        }
        self.ensure_trees(bodies)?;
        let (one, two) = (self.state(bodies[0]), self.state(bodies[1]));
        let filter = PairFilter::new(self.kind, one.state(), two.state(), bodies[0] == bodies[1]);
        let keep = |i: u32, j: u32| filter.keeps(Pair { a: i, b: j });
        let mut found = Vec::new();
        let places = self.places(bodies);
        if let Some(query) = self.pair_query(bodies, &places, self.threshold, &filter, &keep) {
            let mut stack = Vec::new();
            query.start(&mut stack);
            while !stack.is_empty() && found.is_empty() && !watch.ask(0) {
                query.step(&mut stack, VISITS, 1, &mut found);
            }
        }
        Ok(found.into_iter().min())
    }
}
