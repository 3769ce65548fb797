//! Lists that grow with the answer: where memory ends, an error says so instead of an abort.
//!
//! Pairs are written after the search, not while they are found: they are listed in the order of bodies and features, so that one call
//! gives the same file by any method and on any number of threads, and `--max-pairs` cuts the same list. The file itself is made pair
//! by pair; until then a pair takes about 40 bytes.

use std::collections::TryReserveError;
use std::sync::{Mutex, MutexGuard, PoisonError};

use anyhow::{Context, anyhow};
use satisfice_collision::distance::Proximity;

use super::scene::Pair;
use crate::allocator::fallibly;

/// Appends an element.
///
/// # Errors
/// If there is no memory for it.
pub(super) fn push<T>(list: &mut Vec<T>, element: T) -> anyhow::Result<()> {
    if list.len() == list.capacity() {
        // Doubles, as `push` does, but does not abort; a smaller step where so much is not free.
        let most = list.len().max(1024);
        fallibly(|| {
            list.try_reserve_exact(most)
                .or_else(|_| list.try_reserve_exact(most / 8))
        })
        .with_context(|| {
            format!(
                "memory ends after {} pairs: ask for fewer by --max-pairs N",
                list.len()
            )
        })?;
    }
    list.push(element);
    Ok(())
}

/// What is said where memory ended after so many pairs were listed.
pub(super) fn ended(listed: u64, are_written: bool) -> anyhow::Error {
    let written = if are_written { ", which are written" } else { "" };
    match listed {
        0 => anyhow!("memory ended before a pair was listed: allow the command more memory"),
        _ => anyhow!("memory ended after {listed} pairs{written}; --max-pairs N asks for fewer"),
    }
}

/// Lists of an answer, still empty, with room for what has been found.
#[derive(Debug, Default)]
pub(super) struct Lists {
    pub(super) pairs: Vec<Pair>,
    pub(super) distances: Vec<f64>,
    /// Where closest points are asked for.
    pub(super) witnesses: Option<Vec<Option<Proximity>>>,
}

impl Lists {
    /// Sees to room for so many pairs in all.
    fn reserve(&mut self, pairs: usize) -> Result<(), TryReserveError> {
        fallibly(|| {
            self.pairs
                .try_reserve_exact(pairs.saturating_sub(self.pairs.len()))?;
            self.distances.try_reserve_exact(pairs)?;
            match &mut self.witnesses {
                Some(witnesses) => witnesses.try_reserve_exact(pairs),
                None => Ok(()),
            }
        })
    }

    /// The pairs that there is room for.
    fn capacity(&self) -> usize {
        let witnesses = self.witnesses.as_ref().map_or(usize::MAX, Vec::capacity);
        self.pairs
            .capacity()
            .min(self.distances.capacity())
            .min(witnesses)
    }
}

/// Room for an answer that grows, asked for ahead of it: where memory ends, the search is told to stop, and what it found still
/// has room to be measured and written.
#[derive(Debug)]
pub(super) struct Room(Mutex<State>);

#[derive(Debug)]
struct State {
    lists: Lists,
    is_full: bool,
}

/// Bytes that must be free beside the lists, for what measures and writes.
const SPARE: usize = 32 << 20;
/// Bytes a pair that the search itself may ask for before it is told to stop: a list of twice its length.
const SEARCH: usize = 24;

impl Room {
    pub(super) fn new(witnesses: bool) -> Self {
        let lists = Lists {
            witnesses: witnesses.then(Vec::new),
            ..Lists::default()
        };
        Self(Mutex::new(State {
            lists,
            is_full: false,
        }))
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sees to room for so many pairs and some more. `false` if there is none any more, from then on.
    pub(super) fn holds(&self, found: usize) -> bool {
        let mut state = self.state();
        let known = state.lists.capacity();
        if !state.is_full && (known == 0 || found > known - known / 4) {
            let wanted = (found + found / 2).max(1 << 16);
            let spare = fallibly(|| Vec::<u8>::new().try_reserve_exact(SPARE + SEARCH * wanted));
            state.is_full = spare.and_then(|()| state.lists.reserve(wanted)).is_err();
        }
        !state.is_full
    }

    /// Lists the pairs that there is room for.
    pub(super) fn take(&self, mut pairs: impl Iterator<Item = Pair>) -> Listed {
        let State { lists, is_full } = &mut *self.state();
        let mut lists = std::mem::take(lists);
        let mut left = 0;
        // More may have been found since room was asked for last.
        while let Some(pair) = pairs.next() {
            if push(&mut lists.pairs, pair).is_err() {
                left = 1 + pairs.by_ref().count();
            }
        }
        let found = lists.pairs.len() + left;
        if lists.reserve(lists.pairs.len()).is_err() {
            lists.pairs.truncate(lists.capacity());
        }
        Listed {
            is_full: *is_full || lists.pairs.len() < found,
            lists,
            found,
        }
    }
}

/// What a search found, as far as there is room for it.
#[derive(Debug)]
pub(super) struct Listed {
    pub(super) lists: Lists,
    /// How many pairs there were.
    pub(super) found: usize,
    /// Whether memory ended.
    pub(super) is_full: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_of_memory_is_told_as_it_was() {
        for (listed, are_written, says) in [
            (0, true, "memory ended before a pair was listed: allow"),
            (
                7,
                true,
                "memory ended after 7 pairs, which are written; --max-pairs N",
            ),
            (7, false, "memory ended after 7 pairs; --max-pairs N"),
        ] {
            assert!(ended(listed, are_written).to_string().starts_with(says), "{says}");
        }
    }
}
