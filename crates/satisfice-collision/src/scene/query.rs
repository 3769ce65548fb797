//! Questions that need not know every contact: which bodies touch, the first contact, the closest ones.

use super::link::{Near, couple, keeps};
use super::{Contact, Scene};
use crate::Error;
use crate::broad::{FeatureKind, Pair, Watch, inflate, intersection};
use crate::distance::{Proximity, Threshold};

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
        self.settle();
        let mut found: Vec<Contact> = Vec::new();
        for at in 0..self.links.len() {
            let (a, b) = (self.links[at].a, self.links[at].b);
            let bodies = (a.min(b), a.max(b));
            if found.iter().all(|contact| contact.bodies() != bodies)
                && let Some(pair) = self.any(at)?
            {
                found.push(self.links[at].contact(pair));
            }
        }
        found.sort_unstable();
        Ok(found)
    }

    /// Some contact, if there is any: the same one for the same scene.
    ///
    /// # Errors
    /// As [`Scene::contacts`].
    pub fn first(&mut self) -> Result<Option<Contact>, Error> {
        self.settle();
        for at in 0..self.links.len() {
            if let Some(pair) = self.any(at)? {
                return Ok(Some(self.links[at].contact(pair)));
            }
        }
        Ok(None)
    }

    /// The `k` closest contacts with their distances, by distance, then by number; fewer if there are fewer. Looks at a small
    /// part of the threshold first and widens it only while too few are found.
    ///
    /// # Errors
    /// As [`Scene::contacts`].
    pub fn closest(&mut self, k: usize) -> Result<Vec<(Contact, Proximity)>, Error> {
        self.settle();
        if k == 0 {
            return Ok(Vec::new());
        }
        let whole = self.threshold;
        let mut found = Vec::new();
        for part in [64.0, 16.0, 4.0, 1.0] {
            let Ok(threshold) = Threshold::new(whole.get() / part) else {
                continue;
            };
            found.clear();
            for at in 0..self.links.len() {
                let pairs = self.within(at, threshold)?;
                found.extend(pairs.into_iter().map(|pair| self.links[at].contact(pair)));
            }
            if found.len() >= k {
                break;
            }
        }
        let mut closest: Vec<_> = found
            .into_iter()
            .map(|contact| (contact, self.proximity_of(contact)))
            .collect();
        closest.sort_by(|(a, p), (b, q)| p.distance.total_cmp(&q.distance).then(a.cmp(b)));
        closest.truncate(k);
        Ok(closest)
    }

    /// Some pair of a link.
    fn any(&mut self, at: usize) -> Result<Option<Pair>, Error> {
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
            couple.step(&mut stack, usize::MAX, 1, &mut found);
        }
        Ok(found.into_iter().min())
    }

    /// All pairs of a link within a threshold of its own, nothing remembered.
    fn within(&mut self, at: usize, threshold: Threshold) -> Result<Vec<Pair>, Error> {
        if self.boxes_apart(at) {
            return Ok(Vec::new());
        }
        let (a, b) = (self.links[at].a, self.links[at].b);
        self.ready(a, b)?;
        let (one, two, near) = (&self.states[a], &self.states[b], Near::default());
        let keep = |i: u32, j: u32| keeps(self.kind, one, two, a == b, Pair { a: i, b: j }, &near);
        Ok(match couple(self.kind, one, two, a == b, threshold, &keep) {
            Some(couple) => self.join.all(&couple, &Watch::none()).to_vec(),
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
        FeatureKind::of_pair(self.kind)
    }
}
