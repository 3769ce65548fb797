//! Questions that need not know every contact: which bodies touch, the first contact, the closest ones.

use std::collections::BTreeSet;

use super::filter::Filter;
use super::pairs::Status;
use super::{BodyId, Completeness, Contact, World};
use crate::Error;
use crate::broad::{Pair, Watch, inflate, intersection};
use crate::distance::{Proximity, Threshold};

/// Visits of a tree between two looks at the watch.
pub(super) const VISITS: usize = 4096;
/// Contacts of an earlier frame that are tried before a search.
const LIKELY: usize = 64;

/// Told how many there are by now; says whether to stop.
pub(super) type Stop<'a> = &'a (dyn Fn(usize) -> bool + Sync);

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

    /// The `k` closest contacts with their distances, by distance, then by number; fewer if there are fewer. Looks at a small
    /// part of the threshold first and widens it only while too few are found.
    ///
    /// # Errors
    /// As [`World::update`].
    pub fn closest(&mut self, k: usize) -> Result<Vec<(Contact, Proximity)>, Error> {
        Ok(self.closest_watched(k, &Watch::none())?.0)
    }

    /// The same until `stop` says so: then the closest of what was found, and [`Completeness::Unknown`].
    ///
    /// # Errors
    /// As [`World::update`].
    pub fn closest_until(
        &mut self,
        k: usize,
        stop: Stop<'_>,
    ) -> Result<(Vec<(Contact, Proximity)>, Completeness), Error> {
        self.closest_watched(k, &Watch::until(stop))
    }

    fn closest_watched(
        &mut self,
        k: usize,
        watch: &Watch<'_>,
    ) -> Result<(Vec<(Contact, Proximity)>, Completeness), Error> {
        let records = self.by_bodies();
        let whole = self.threshold;
        let mut found = Vec::new();
        for part in [64.0, 16.0, 4.0, 1.0] {
            let Ok(threshold) = Threshold::new(whole.get() / part) else {
                continue;
            };
            if found.len() >= k || watch.stopped() {
                break;
            }
            // Closer ones are found again, unless there is no time for it.
            for &record in &records {
                let pairs = self.within(record, threshold, watch)?;
                found.extend(
                    pairs
                        .into_iter()
                        .map(|pair| self.contact(&self.pairs[record], pair)),
                );
            }
            found.sort_unstable();
            found.dedup();
        }
        let mut closest = Vec::with_capacity(found.len());
        for contact in found {
            closest.push((contact, self.proximity(contact)?));
        }
        closest.sort_by(|(a, p), (b, q)| p.distance.total_cmp(&q.distance).then(a.cmp(b)));
        closest.truncate(k);
        Ok((closest, completeness(watch)))
    }

    /// The records of the present frame in the order of their bodies.
    pub(super) fn by_bodies(&mut self) -> Vec<u32> {
        self.settle();
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
        let filter = Filter::new(self.kind, one, two, bodies[0] == bodies[1]);
        let keep = |i: u32, j: u32| filter.keeps(Pair { a: i, b: j });
        let mut found = Vec::new();
        if let Some(query) = self.pair_query(bodies, self.threshold, &filter, &keep) {
            let mut stack = Vec::new();
            query.start(&mut stack);
            while !stack.is_empty() && found.is_empty() && !watch.ask(0) {
                query.step(&mut stack, VISITS, 1, &mut found);
            }
        }
        Ok(found.into_iter().min())
    }

    /// All pairs of a record within a threshold of its own, or as many as the watch has time for; nothing remembered.
    fn within(&mut self, record: u32, threshold: Threshold, watch: &Watch<'_>) -> Result<Vec<Pair>, Error> {
        let bodies = self.pairs[record].bodies;
        let [a, b] = bodies;
        let boxes = [a, b].map(|slot| self.state(slot).bounds);
        let apart = a != b && intersection(&boxes[0], &inflate(&boxes[1], threshold.get())).is_none();
        if watch.stopped() || apart {
            return Ok(Vec::new());
        }
        self.ensure_trees(bodies)?;
        let mut spaces = std::mem::take(&mut self.workspaces);
        let (one, two) = (self.state(a), self.state(b));
        let filter = Filter::new(self.kind, one, two, a == b);
        let keep = |i: u32, j: u32| filter.keeps(Pair { a: i, b: j });
        let pairs = match self.pair_query(bodies, threshold, &filter, &keep) {
            Some(query) => spaces[0].join.all(&query, watch).to_vec(),
            None => Vec::new(),
        };
        self.workspaces = spaces;
        Ok(pairs)
    }
}
