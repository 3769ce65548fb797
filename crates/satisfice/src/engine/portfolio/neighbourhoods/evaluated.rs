//! The fitness of points whose neighbours became candidates.

use hashbrown::HashTable;

use crate::error::Error;
use crate::state::{Reader, Saved, State, read_rows, write_rows};

/// Fitness by the key of a position; not a number, where the point was only proposed.
#[derive(Debug, Default)]
pub(super) struct Evaluated(HashTable<(u64, f64)>);

impl Evaluated {
    pub(super) fn insert(&mut self, key: u64, fitness: f64) {
        let entry = self.0.entry(key, |known| known.0 == key, |known| known.0);
        entry.insert((key, fitness));
    }

    pub(super) fn contains(&self, key: u64) -> bool {
        self.0.find(key, |known| known.0 == key).is_some()
    }

    /// The sum of the fitness that is known of points, and of how many of them.
    pub(super) fn sum_and_count(&self, keys: &[u64]) -> (f64, u32) {
        let (mut sum, mut count) = (0.0, 0);
        for &key in keys {
            if let Some(&(_, fitness)) = self.0.find(key, |known| known.0 == key)
                && !fitness.is_nan()
            {
                sum += fitness;
                count += 1;
            }
        }
        (sum, count)
    }

    pub(super) fn save(&self, state: &mut State) {
        let mut points: Vec<(u64, f64)> = self.0.iter().copied().collect();
        points.sort_unstable_by_key(|&(key, _)| key);
        let (keys, fitness): (Vec<u64>, Vec<f64>) = points.into_iter().unzip();
        Saved::save(&keys, state);
        write_rows(state, &fitness, 1);
    }

    pub(super) fn restore(from: &mut Reader<'_>) -> Result<Self, Error> {
        let keys: Vec<u64> = from.read()?;
        let fitness: Vec<f64> = read_rows(from)?;
        let mut restored = Self::default();
        for (key, fitness) in keys.into_iter().zip(fitness) {
            restored.insert(key, fitness);
        }
        Ok(restored)
    }
}
