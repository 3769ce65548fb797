//! The hits that a slice knows: those that all lanes share, and those found since.

use std::sync::Arc;

use super::{Archive, Hit, Insertion, Mark};
use crate::identity::Identity;

/// The hits that a slice knows. Lanes share what they have listed at their last exchange, so that memory does not grow by the number of
/// lanes times that of their hits.
#[derive(Debug, Clone)]
pub(crate) struct KnownHits<T> {
    listed: Option<Arc<Archive<T>>>,
    found: Archive<T>,
}

impl<T> From<Archive<T>> for KnownHits<T> {
    fn from(found: Archive<T>) -> Self {
        Self { listed: None, found }
    }
}

impl<T> Default for KnownHits<T> {
    fn default() -> Self {
        Archive::default().into()
    }
}

impl<T> KnownHits<T> {
    /// All hits, where none are shared or where nothing was found since.
    #[inline]
    pub(crate) fn all(&self) -> &Archive<T> {
        match &self.listed {
            Some(listed) if self.found.is_empty() => listed,
            _ => &self.found,
        }
    }

    /// The hits, those that all lanes share first.
    pub(crate) fn iter(&self) -> impl Iterator<Item = Hit<'_, T>> {
        let listed = self.listed.iter().flat_map(|listed| listed.iter());
        listed.chain(self.found.iter())
    }

    /// What was found since the last exchange.
    pub(crate) fn found(&self) -> &Archive<T> {
        &self.found
    }

    /// What all lanes share.
    pub(crate) fn listed(&self) -> Option<&Arc<Archive<T>>> {
        self.listed.as_ref()
    }

    /// Number of hits that all lanes share.
    #[inline]
    pub(crate) fn listed_count(&self) -> usize {
        self.listed.as_ref().map_or(0, |listed| listed.len())
    }

    /// Number of hits.
    #[inline]
    pub(crate) fn len(&self) -> usize {
        self.listed_count() + self.found.len()
    }

    /// Whether there are no hits.
    #[inline]
    pub(crate) fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of hits that the engine sees.
    #[inline]
    pub(crate) fn seen(&self) -> usize {
        self.len() - self.found.probe_only()
    }

    /// Hit `index`, those that all lanes share first.
    pub(crate) fn solution(&self, index: usize) -> Option<&T> {
        match index.checked_sub(self.listed_count()) {
            Some(since) => self.found.solutions().get(since),
            None => self.listed.as_ref()?.solutions().get(index),
        }
    }

    /// Sets what all lanes share.
    pub(crate) fn set_listed(&mut self, listed: Option<Arc<Archive<T>>>) {
        self.listed = listed;
    }

    /// Forgets what was found since the last exchange.
    pub(crate) fn clear_found(&mut self) {
        self.found = Archive::default();
    }
}

impl<T: Identity + Clone> KnownHits<T> {
    /// Makes all hits shared, for the lanes.
    pub(crate) fn share(&mut self) -> Arc<Archive<T>> {
        if !self.found.is_empty() {
            self.take_back();
            self.listed = Some(Arc::new(core::mem::take(&mut self.found)));
        }
        Arc::clone(self.listed.get_or_insert_default())
    }

    /// Takes back what was [shared](Self::share), to be added to.
    pub(crate) fn take_back(&mut self) {
        let Some(listed) = self.listed.take() else { return };
        let since = core::mem::replace(&mut self.found, Arc::unwrap_or_clone(listed));
        for hit in since.iter() {
            self.found
                .insert(hit.solution.clone(), hit.fitness, hit.evaluation, hit.seconds);
        }
    }

    /// All hits, shared or not.
    pub(crate) fn into_all(mut self) -> Archive<T> {
        self.take_back();
        self.found
    }
}

impl<T: Identity> KnownHits<T> {
    /// What was found since the last exchange, as of now.
    #[inline]
    pub(crate) fn mark(&self) -> Mark {
        self.found.mark()
    }

    /// As [`Archive::contains`].
    #[inline]
    pub(crate) fn contains(&self, solution: &T) -> bool {
        self.found.contains(solution) || self.is_listed(solution)
    }

    #[inline]
    fn is_listed(&self, solution: &T) -> bool {
        self.listed
            .as_ref()
            .is_some_and(|listed| listed.contains(solution))
    }

    /// As [`Archive::is_again`].
    #[inline(always)]
    pub(crate) fn is_again(&self, solution: &T, recent: usize) -> bool {
        match &self.listed {
            None => self.found.is_again(solution, recent),
            Some(_) => self.solution(recent).is_some_and(|hit| hit.same(solution)),
        }
    }

    /// As [`Archive::contains_again`]: what is listed does not change while a batch is out.
    pub(crate) fn contains_again(&self, solution: &T, absent: Option<Mark>, recent: &mut usize) -> bool {
        let mut index = 0;
        if self.found.contains_again(solution, absent, &mut index) {
            *recent = self.listed_count() + index;
            return true;
        }
        let Some(listed) = self.listed.as_ref().filter(|_| absent.is_none()) else {
            return false;
        };
        listed.contains_again(solution, None, recent)
    }

    /// As [`Archive::any_same`].
    pub(crate) fn any_same(&self, solution: &T, mut test: impl FnMut(&T) -> bool) -> bool {
        let listed = self.listed.as_ref();
        self.found.any_same(solution, &mut test)
            || listed.is_some_and(|listed| listed.any_same(solution, &mut test))
    }

    /// As [`Archive::insert`].
    pub(crate) fn insert(&mut self, solution: T, fitness: f64, evaluation: u64, seconds: f64) -> bool {
        !self.is_listed(&solution) && self.found.insert(solution, fitness, evaluation, seconds)
    }

    /// As [`Archive::enter`].
    pub(crate) fn enter(
        &mut self,
        solution: T,
        fitness: f64,
        evaluation: u64,
        seconds: f64,
        probe: bool,
    ) -> Insertion {
        self.found.enter(solution, fitness, evaluation, seconds, probe)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Located;

    /// Half of the hits are shared, or all, or none: all answers are those of one archive.
    #[test]
    fn what_is_shared_changes_no_answer() {
        let mut rng = crate::SearchRng::new(3);
        let mut point = || Located::new(&[rng.uniform(), rng.uniform()], 0.05);
        for shared in [0, 60, 120] {
            let (mut one, mut known, mut shared_hits) = (Archive::default(), KnownHits::default(), 0);
            for n in 0..120 {
                if n == shared {
                    shared_hits = known.share().len();
                }
                let hit = point();
                let is_new = one.insert(hit.clone(), 0.5, n, 0.0);
                assert_eq!(known.insert(hit, 0.5, n, 0.0), is_new);
            }
            if shared == 120 {
                shared_hits = known.share().len();
            }
            assert_eq!(
                (known.len(), known.seen(), known.is_empty()),
                (one.len(), one.len(), false)
            );
            let mark = known.mark();
            for _ in 0..300 {
                let other = point();
                let (mut expected, mut recent) = (0, 0);
                let is_known = one.contains_again(&other, None, &mut expected);
                assert_eq!(known.contains(&other), is_known);
                assert_eq!(known.contains_again(&other, None, &mut recent), is_known);
                assert!(
                    !known.contains_again(&other, Some(mark), &mut 0),
                    "nothing was found since"
                );
                assert_eq!(
                    known.is_again(&other, recent),
                    is_known && other.same(&one.solutions()[recent])
                );
                assert!(!is_known || known.solution(recent).is_some_and(|hit| hit.same(&other)));
                assert_eq!(known.any_same(&other, |_| true), is_known);
            }
            assert_eq!(
                (known.listed_count(), known.found().len()),
                (shared_hits, one.len() - shared_hits)
            );
            assert!(known.iter().eq(one.iter()));
            assert_eq!(known.into_all().solutions(), one.solutions());
        }
    }
}
