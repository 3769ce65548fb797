//! The archive: the distinct hits, in the order found.

mod as_list;
mod known;
mod near;
pub(crate) mod packed;
#[cfg(test)]
mod tests;

use hashbrown::HashTable;

pub(crate) use self::known::KnownHits;
use self::near::NearIndex;
use crate::identity::Identity;

/// Up to this many hits, a filter of bits saves most look-ups in the table; a larger one would not stay in the cache.
const FILTERED: usize = 1 << 16;
/// Bits of the filter per hit it has room for: about one look-up in 16 is not saved.
const BITS: usize = 16;
/// Every so many new hits, those that share the key of the latest are counted. With more than `CROWDED`, hits are filed by their places, too.
const LOOK_EVERY: usize = 64;
const CROWDED: usize = 24;

/// The distinct hits, in the order found, each with its fitness and with the evaluation and the time that found it.
///
/// Memory, at rest and beyond the solutions: 20 bytes per hit and 5 bytes per slot of a table that is between 7/16 and 7/8 full,
/// so between 25.7 and 31.5 bytes. A look-up that finds nothing costs a hash, a bit test and, rarely, a table look-up. Where many points
/// share a key, they are also in a tree of places, with a copy of their coordinates.
#[derive(Debug, Clone)]
pub struct Archive<T> {
    solutions: Vec<T>,
    fitness: Vec<f64>,
    evaluations: Vec<u64>,
    seconds: Vec<f32>,
    table: HashTable<u32>,
    /// Hits of probes that the engine has not found itself: [`Archive::contains`] skips them.
    probe_only: HashTable<u32>,
    filter: Vec<u64>,
    /// Solutions by their places, once many of them share a key. The tables are of the numbers of hits then.
    near: Option<NearIndex>,
}

/// At most so many hits that were entered since a look-up are compared one by one.
const LATEST: usize = 32;

/// What an archive held at some time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Mark {
    hits: usize,
    /// Those that [`Archive::contains`] saw.
    seen: usize,
}

/// The outcome of [`Archive::enter`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Insertion {
    /// It was new.
    New,
    /// It was probe-only, and the engine has found it now.
    Promoted,
    /// It was known.
    Known,
}

impl<T> Default for Archive<T> {
    fn default() -> Self {
        Self {
            solutions: Vec::new(),
            fitness: Vec::new(),
            evaluations: Vec::new(),
            seconds: Vec::new(),
            table: HashTable::new(),
            probe_only: HashTable::new(),
            filter: Vec::new(),
            near: None,
        }
    }
}

/// One hit, as a report shows it.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Hit<'a, T> {
    /// The solution.
    pub solution: &'a T,
    /// Its fitness F; `f32` values are widened exactly.
    pub fitness: f64,
    /// The evaluation that found it, counted from 1.
    pub evaluation: u64,
    /// When, in seconds from the start of the slice.
    pub seconds: f64,
}

impl<T> Archive<T> {
    /// Number of hits.
    #[inline]
    #[must_use]
    pub fn len(&self) -> usize {
        self.solutions.len()
    }

    /// Number of hits that only probes have found.
    #[inline]
    pub(crate) fn probe_only(&self) -> usize {
        self.probe_only.len()
    }

    /// Whether there are no hits.
    #[inline]
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.solutions.is_empty()
    }

    /// Hit `index`, in the order found.
    #[must_use]
    pub fn get(&self, index: usize) -> Option<Hit<'_, T>> {
        Some(Hit {
            solution: self.solutions.get(index)?,
            fitness: *self.fitness.get(index)?,
            evaluation: *self.evaluations.get(index)?,
            seconds: f64::from(*self.seconds.get(index)?),
        })
    }

    /// The hit that was found last.
    pub(crate) fn last(&self) -> Option<Hit<'_, T>> {
        self.get(self.len().checked_sub(1)?)
    }

    /// All hits, in the order found.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Hit<'_, T>> {
        self.solutions
            .iter()
            .zip(&self.fitness)
            .zip(&self.evaluations)
            .zip(&self.seconds)
            .map(|(((solution, &fitness), &evaluation), &seconds)| Hit {
                solution,
                fitness,
                evaluation,
                seconds: f64::from(seconds),
            })
    }

    /// The solutions alone, in the order found.
    #[must_use]
    pub fn solutions(&self) -> &[T] {
        &self.solutions
    }

    /// How many hits had been found by an evaluation count. Cost: O(log n).
    #[must_use]
    pub fn found_by(&self, evaluation: u64) -> usize {
        self.evaluations.partition_point(|&e| e <= evaluation)
    }

    /// Bytes beyond the solutions themselves.
    #[must_use]
    pub fn overhead_bytes(&self) -> usize {
        (self.fitness.capacity() + self.evaluations.capacity()) * 8
            + self.seconds.capacity() * 4
            + self.table.allocation_size()
            + self.probe_only.allocation_size()
            + self.filter.capacity() * 8
            + self.near.as_ref().map_or(0, NearIndex::bytes)
            + (self.solutions.capacity() - self.solutions.len()) * size_of::<T>()
    }
}

/// The key under which hit `index` is in a table: of its solution, or of its number.
#[inline]
fn key_of<T: Identity>(solutions: &[T], index: u32, by_number: bool) -> u64 {
    if by_number {
        index.key()
    } else {
        solutions[index as usize].key()
    }
}

impl<T: Identity> Archive<T> {
    /// Whether it holds a solution that is the same.
    #[inline]
    #[must_use]
    pub fn contains(&self, solution: &T) -> bool {
        !self.solutions.is_empty() && self.find(solution).is_some()
    }

    /// Whether a solution is the same as the hit at `recent`: a hit that is found again is often found many times in a row.
    #[inline(always)]
    pub(crate) fn is_again(&self, solution: &T, recent: usize) -> bool {
        self.solutions.get(recent).is_some_and(|hit| hit.same(solution)) && !self.is_probe_only(recent)
    }

    /// What it holds now.
    #[inline]
    pub(crate) fn mark(&self) -> Mark {
        Mark {
            hits: self.solutions.len(),
            seen: self.table.len(),
        }
    }

    /// [`Archive::contains`]; if it does, the index of the hit is written to `recent`. `absent`: when it did not hold the solution, if that
    /// was looked up.
    pub(crate) fn contains_again(&self, solution: &T, absent: Option<Mark>, recent: &mut usize) -> bool {
        if let Some(latest) = absent.and_then(|mark| self.entered_since(mark)) {
            let first = self.solutions.len() - latest.len();
            let found = latest.iter().position(|hit| hit.same(solution));
            if let Some(index) = found {
                *recent = first + index;
            }
            return found.is_some();
        }
        let found = self.find(solution);
        if let Some(index) = found {
            *recent = index as usize;
        }
        found.is_some()
    }

    /// The hits entered since then, if they are few and all that [`Archive::contains`] sees beside those of then.
    fn entered_since(&self, mark: Mark) -> Option<&[T]> {
        let latest = self.solutions.get(mark.hits..)?;
        let are_seen = self.table.len().checked_sub(mark.seen) == Some(latest.len());
        (are_seen && latest.len() <= LATEST).then_some(latest)
    }

    /// A hit that is the same, but for those of probes alone.
    #[inline]
    fn find(&self, solution: &T) -> Option<u32> {
        if self.near.is_some() {
            return self.find_near(solution, |index| !self.is_probe_only(index as usize));
        }
        let mut found = None;
        solution.visit_keys(&mut |key| {
            if self.may_hold(key) {
                let is_same = |&index: &u32| self.solutions[index as usize].same(solution);
                found = self.table.find(key, is_same).copied();
            }
            found.is_some()
        });
        found
    }

    /// A hit that is the same and passes `test`, by its place.
    fn find_near(&self, solution: &T, mut test: impl FnMut(u32) -> bool) -> Option<u32> {
        let mut found = None;
        self.near.as_ref()?.any(solution, |index| {
            let passes = self.solutions[index as usize].same(solution) && test(index);
            found = passes.then_some(index);
            passes
        });
        found
    }

    /// Whether a hit that is the same as `solution` passes `test`.
    pub(crate) fn any_same(&self, solution: &T, mut test: impl FnMut(&T) -> bool) -> bool {
        if self.near.is_some() {
            let found = self.find_near(solution, |index| {
                !self.is_probe_only(index as usize) && test(&self.solutions[index as usize])
            });
            return found.is_some();
        }
        solution.visit_keys(&mut |key| {
            self.table
                .iter_hash(key)
                .map(|&i| &self.solutions[i as usize])
                .any(|hit| hit.same(solution) && test(hit))
        })
    }

    /// Whether it holds a hit that stands for `solution`.
    pub(crate) fn holds(&self, solution: &T) -> bool {
        self.any_same(solution, |hit| hit.stands_for(solution))
    }

    /// Adds a solution with its fitness F, its evaluation and its time in seconds, unless the archive holds one that is the
    /// same; returns whether it was new. Amortised cost: O(1).
    ///
    /// ```
    /// let mut archive = satisfice::Archive::default();
    /// assert!(archive.insert([3, 4], -0.5, 1, 0.0));
    /// assert!(!archive.insert([3, 4], -0.5, 2, 0.1), "the same pair");
    /// assert_eq!(archive.get(0).map(|hit| (hit.fitness, hit.evaluation)), Some((-0.5, 1)));
    /// ```
    ///
    /// At 2^32 - 1 hits, the archive is full and takes no more.
    pub fn insert(&mut self, solution: T, fitness: f64, evaluation: u64, seconds: f64) -> bool {
        !self.contains(&solution)
            && self.enter(solution, fitness, evaluation, seconds, false) == Insertion::New
    }

    /// Adds a hit of the engine or of a probe that [`Archive::contains`] has just denied: looking again among many close hits would take as
    /// long as all the rest. That of a probe is listed, but not seen by [`contains`](Archive::contains) until the engine finds it, too, or
    /// the archive comes to rest.
    pub(crate) fn enter(
        &mut self,
        solution: T,
        fitness: f64,
        evaluation: u64,
        seconds: f64,
        probe: bool,
    ) -> Insertion {
        if let Some(index) = self.position_probe_only(&solution) {
            if probe {
                return Insertion::Known;
            }
            self.promote(index);
            return Insertion::Promoted;
        }
        let Ok(index) = u32::try_from(self.solutions.len()) else {
            return Insertion::Known;
        };
        self.solutions.push(solution);
        let key = self.key_of(index);
        if let Some(near) = &mut self.near {
            near.insert(&self.solutions[index as usize], index);
        }
        self.fitness.push(fitness);
        self.evaluations.push(evaluation);
        #[expect(clippy::cast_possible_truncation, reason = "7 digits of a time are plenty")]
        self.seconds.push(seconds as f32);
        let (solutions, by_number) = (&self.solutions, self.near.is_some());
        let rehash = |&i: &u32| key_of(solutions, i, by_number);
        if probe {
            self.probe_only.insert_unique(key, index, rehash);
        } else {
            self.table.insert_unique(key, index, rehash);
            self.note(key);
        }
        if self.is_crowded(key, index as usize) {
            self.file_by_places();
        }
        Insertion::New
    }

    /// The index of a solution that is the same, probe-only or not.
    pub(crate) fn position(&self, solution: &T) -> Option<usize> {
        let found = self.find(solution);
        found
            .or_else(|| self.position_probe_only(solution))
            .map(|index| index as usize)
    }

    fn position_probe_only(&self, solution: &T) -> Option<u32> {
        if self.probe_only.is_empty() {
            return None;
        }
        if self.near.is_some() {
            return self.find_near(solution, |index| self.is_probe_only(index as usize));
        }
        let mut found = None;
        solution.visit_keys(&mut |key| {
            found = self
                .probe_only
                .find(key, |&i| self.solutions[i as usize].same(solution))
                .copied();
            found.is_some()
        });
        found
    }

    /// Whether hit `index` is probe-only.
    pub(crate) fn is_probe_only(&self, index: usize) -> bool {
        let number = u32::try_from(index);
        number.is_ok_and(|number| {
            !self.probe_only.is_empty()
                && index < self.solutions.len()
                && self
                    .probe_only
                    .find(self.key_of(number), |&i| i == number)
                    .is_some()
        })
    }

    /// Indices of the hits that only probes have found, ascending.
    pub(crate) fn probe_only_indices(&self) -> Vec<u32> {
        let mut indices: Vec<u32> = self.probe_only.iter().copied().collect();
        indices.sort_unstable();
        indices
    }

    /// Marks hit `index` as probe-only; `false` if there is no such hit.
    pub(crate) fn set_probe_only(&mut self, index: u32) -> bool {
        if index as usize >= self.solutions.len() {
            return false;
        }
        let key = self.key_of(index);
        if let Ok(entry) = self.table.find_entry(key, |&i| i == index) {
            entry.remove();
            let (solutions, by_number) = (&self.solutions, self.near.is_some());
            self.probe_only
                .insert_unique(key, index, |&i| key_of(solutions, i, by_number));
        }
        true
    }

    fn promote(&mut self, index: u32) {
        let key = self.key_of(index);
        if let Ok(entry) = self.probe_only.find_entry(key, |&i| i == index) {
            entry.remove();
        }
        let (solutions, by_number) = (&self.solutions, self.near.is_some());
        self.table
            .insert_unique(key, index, |&i| key_of(solutions, i, by_number));
        self.note(key);
    }

    /// Frees memory that was kept for growth and for speed, and promotes all probe-only hits.
    pub fn rest(&mut self) {
        let probe_only = core::mem::take(&mut self.probe_only);
        probe_only.into_iter().for_each(|index| self.promote(index));
        self.solutions.shrink_to_fit();
        self.fitness.shrink_to_fit();
        self.evaluations.shrink_to_fit();
        self.seconds.shrink_to_fit();
        let (solutions, by_number) = (&self.solutions, self.near.is_some());
        self.table.shrink_to_fit(|&i| key_of(solutions, i, by_number));
        self.filter = Vec::new();
    }

    #[inline]
    fn key_of(&self, index: u32) -> u64 {
        key_of(&self.solutions, index, self.near.is_some())
    }

    /// Whether the solution at `index`, the last one, shares its key with so many that a look-up by its place costs less; looked at
    /// seldom.
    #[inline]
    fn is_crowded(&self, key: u64, index: usize) -> bool {
        index.is_multiple_of(LOOK_EVERY)
            && self.near.is_none()
            && self.table.iter_hash(key).count() > CROWDED
            && self.solutions[index].visit_place(&mut |_, _| ())
    }

    /// Files all solutions by their places from now on.
    fn file_by_places(&mut self) {
        let mut near = NearIndex::default();
        for (solution, index) in self.solutions.iter().zip(0..) {
            near.insert(solution, index);
        }
        self.near = Some(near);
        let rehash = |&i: &u32| i.key();
        for table in [&mut self.table, &mut self.probe_only] {
            for index in core::mem::take(table) {
                table.insert_unique(index.key(), index, rehash);
            }
        }
        self.filter = Vec::new();
    }

    #[inline]
    fn may_hold(&self, key: u64) -> bool {
        // The table takes the key's lowest bits and its seven highest, the filter the ones between.
        let bits = self.filter.len() * 64;
        if bits == 0 {
            return true;
        }
        let bit = (key >> 24) as usize & (bits - 1);
        self.filter[bit / 64] >> (bit % 64) & 1 == 1
    }

    fn note(&mut self, key: u64) {
        let hits = self.solutions.len();
        if hits > FILTERED || self.near.is_some() {
            self.filter = Vec::new();
            return;
        }
        if hits * BITS > self.filter.len() * 64 {
            // Twice the room, filled again.
            self.filter.clear();
            self.filter
                .resize((2 * hits * BITS).next_power_of_two().max(1024) / 64, 0);
            for i in 0..hits {
                let key = self.solutions[i].key();
                self.set(key);
            }
        } else {
            self.set(key);
        }
    }

    fn set(&mut self, key: u64) {
        let bit = (key >> 24) as usize & (self.filter.len() * 64 - 1);
        self.filter[bit / 64] |= 1 << (bit % 64);
    }
}
