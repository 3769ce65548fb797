//! Questions that need not know every contact: which bodies touch, the first contact, the closest ones.

use super::link::{Near, couple, keeps};
use super::{Completeness, Contact, Scene};
use crate::Error;
use crate::FeatureKind;
use crate::broad::{Pair, Watch, inflate, intersection};
use crate::distance::{Proximity, Threshold};

/// Visits of a tree between two looks at the watch: some 0.2 ms.
const VISITS: usize = 4096;

/// Told how many there are by now; says whether to stop.
type Stop<'a> = &'a (dyn Fn(usize) -> bool + Sync);

fn completeness(watch: &Watch<'_>) -> Completeness {
    if watch.stopped() {
        Completeness::Unknown
    } else {
        Completeness::Proved
    }
}

impl Scene {
    /// Which bodies have a feature within the threshold of one of another body, or of their own: pairs of body numbers
    /// `(a, b)`, `a <= b`, sorted. Stops at the first contact of each pair.
    ///
    /// # Errors
    /// As [`Scene::contacts`].
    pub fn touching(&mut self) -> Result<Vec<(usize, usize)>, Error> {
        let witnesses = self.witnesses()?;
        let mut touching: Vec<_> = witnesses.iter().map(Contact::bodies).collect();
        touching.sort_unstable();
        Ok(touching)
    }

    /// The same with a contact that shows it for each pair of bodies: the same one for the same scene.
    ///
    /// # Errors
    /// As [`Scene::contacts`].
    pub fn witnesses(&mut self) -> Result<Vec<Contact>, Error> {
        Ok(self.witnesses_watched(&Watch::none())?.0)
    }

    /// The same until `stop` says so, which is asked every 20 us to 10 ms and told how many there are by now;
    /// [`Completeness::Unknown`] where it did: of bodies that are not named, nothing is known.
    ///
    /// # Errors
    /// As [`Scene::contacts`].
    pub fn witnesses_until(&mut self, stop: Stop<'_>) -> Result<(Vec<Contact>, Completeness), Error> {
        self.witnesses_watched(&Watch::until(stop))
    }

    fn witnesses_watched(&mut self, watch: &Watch<'_>) -> Result<(Vec<Contact>, Completeness), Error> {
        self.settle();
        let mut found: Vec<Contact> = Vec::new();
        for at in 0..self.links.len() {
            let (a, b) = (self.links[at].a, self.links[at].b);
            let bodies = (a.min(b), a.max(b));
            if watch.ask(0) {
                break;
            }
            if found.iter().all(|contact| contact.bodies() != bodies)
                && let Some(pair) = self.any(at, watch)?
            {
                found.push(self.links[at].contact(pair));
                watch.ask(1);
            }
        }
        found.sort_unstable();
        Ok((found, completeness(watch)))
    }

    /// Some contact, if there is any: the same one for the same scene.
    ///
    /// # Errors
    /// As [`Scene::contacts`].
    pub fn first(&mut self) -> Result<Option<Contact>, Error> {
        Ok(self.first_watched(&Watch::none())?.0)
    }

    /// The same until `stop` says so; [`Completeness::Unknown`] where it did before there was one.
    ///
    /// # Errors
    /// As [`Scene::contacts`].
    pub fn first_until(&mut self, stop: Stop<'_>) -> Result<(Option<Contact>, Completeness), Error> {
        self.first_watched(&Watch::until(stop))
    }

    fn first_watched(&mut self, watch: &Watch<'_>) -> Result<(Option<Contact>, Completeness), Error> {
        self.settle();
        for at in 0..self.links.len() {
            if watch.ask(0) {
                break;
            }
            if let Some(pair) = self.any(at, watch)? {
                return Ok((Some(self.links[at].contact(pair)), Completeness::Proved));
            }
        }
        Ok((None, completeness(watch)))
    }

    /// The `k` closest contacts with their distances, by distance, then by number; fewer if there are fewer. Looks at a small
    /// part of the threshold first and widens it only while too few are found.
    ///
    /// # Errors
    /// As [`Scene::contacts`].
    pub fn closest(&mut self, k: usize) -> Result<Vec<(Contact, Proximity)>, Error> {
        Ok(self.closest_watched(k, &Watch::none())?.0)
    }

    /// The same until `stop` says so: then the closest of what was found, and [`Completeness::Unknown`].
    ///
    /// # Errors
    /// As [`Scene::contacts`].
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
        self.settle();
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
            for at in 0..self.links.len() {
                let pairs = self.within(at, threshold, watch)?;
                found.extend(pairs.into_iter().map(|pair| self.links[at].contact(pair)));
            }
            found.sort_unstable();
            found.dedup();
        }
        let mut closest: Vec<_> = found
            .into_iter()
            .map(|contact| (contact, self.proximity_of(contact)))
            .collect();
        closest.sort_by(|(a, p), (b, q)| p.distance.total_cmp(&q.distance).then(a.cmp(b)));
        closest.truncate(k);
        Ok((closest, completeness(watch)))
    }

    /// Some pair of a link, if the watch has time for it.
    fn any(&mut self, at: usize, watch: &Watch<'_>) -> Result<Option<Pair>, Error> {
        let link = &self.links[at];
        if link.seen == Some(self.frame) {
            return Ok(link.pairs.first().copied());
        }
        // a pair that touched last time is the likeliest to touch now
        let likely = link
            .pairs
            .iter()
            .copied()
            .take(64)
            .find(|&pair| self.decide(link, pair));
        if likely.is_some() || self.boxes_apart(at) {
            return Ok(likely);
        }
        let (a, b) = (link.a, link.b);
        self.ready(a, b)?;
        let (one, two, near) = (&self.states[a], &self.states[b], Near::default());
        let keep = |i: u32, j: u32| keeps(self.kind, one, two, a == b, Pair { a: i, b: j }, &near);
        let mut found = Vec::new();
        if let Some(couple) = couple(self.kind, one, two, a == b, self.threshold, &keep) {
            let mut stack = Vec::new();
            couple.start(&mut stack);
            while !stack.is_empty() && found.is_empty() && !watch.ask(0) {
                couple.step(&mut stack, VISITS, 1, &mut found);
            }
        }
        Ok(found.into_iter().min())
    }

    /// All pairs of a link within a threshold of its own, or as many as the watch has time for; nothing remembered.
    fn within(&mut self, at: usize, threshold: Threshold, watch: &Watch<'_>) -> Result<Vec<Pair>, Error> {
        if watch.stopped() || self.boxes_apart(at) {
            return Ok(Vec::new());
        }
        let (a, b) = (self.links[at].a, self.links[at].b);
        self.ready(a, b)?;
        let (one, two, near) = (&self.states[a], &self.states[b], Near::default());
        let keep = |i: u32, j: u32| keeps(self.kind, one, two, a == b, Pair { a: i, b: j }, &near);
        Ok(match couple(self.kind, one, two, a == b, threshold, &keep) {
            Some(couple) => self.join.all(&couple, watch).to_vec(),
            None => Vec::new(),
        })
    }

    /// Whether the inflated boxes of a link's bodies do not meet.
    pub(super) fn boxes_apart(&self, at: usize) -> bool {
        let link = &self.links[at];
        let (a, b) = (&self.states[link.a].bounds, &self.states[link.b].bounds);
        link.a != link.b && intersection(a, &inflate(b, self.threshold.get())).is_none()
    }

    /// The kinds of the two features of a pair.
    #[must_use]
    pub fn feature_kinds(&self) -> (FeatureKind, FeatureKind) {
        self.kind.features()
    }
}
