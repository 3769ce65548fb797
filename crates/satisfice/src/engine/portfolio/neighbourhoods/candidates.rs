//! What is known of each candidate, found by its position.

use hashbrown::HashTable;

use crate::scalar::Real;

/// A neighbour of evaluated points, or an evaluated point some of whose neighbours are not entered yet.
#[derive(Debug, Clone, Copy, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Candidate {
    /// Of its position, from which it follows.
    #[serde(skip)]
    pub(super) key: u64,
    /// The number of its latest entry in the queue.
    pub(super) entry: u64,
    /// Sum of the fitness of its evaluated neighbours, and their number; of an evaluated point its own.
    pub(super) sum: f64,
    pub(super) count: u32,
    /// Of an evaluated point, the part of its neighbours that is entered next; 0 of a candidate.
    pub(super) part: u32,
}

impl Candidate {
    /// A candidate of which nothing is known.
    pub(super) fn new(key: u64) -> Self {
        Self {
            key,
            ..Self::default()
        }
    }

    /// An evaluated point of this fitness, of whose neighbours a part is entered next.
    pub(super) fn rest(fitness: f64, part: u32) -> Self {
        Self {
            sum: fitness,
            part,
            ..Self::default()
        }
    }

    /// Adds the fitness of an evaluated neighbour; returns the mean of all of these and of one more with that of the prior.
    pub(super) fn meet(&mut self, fitness: f64, prior: f64) -> f64 {
        self.sum += fitness;
        self.count = self.count.saturating_add(1);
        (self.sum + prior) / (f64::from(self.count) + 1.0)
    }
}

/// The candidates that wait, each in its row.
#[derive(Debug, Default)]
pub(super) struct CandidateTable<S> {
    rows: Vec<Candidate>,
    positions: Vec<S>,
    /// The rows that are free.
    free: Vec<u32>,
    /// The rows of candidates, by their keys.
    by_key: HashTable<u32>,
}

impl<S: Real> CandidateTable<S> {
    /// How many wait.
    pub(super) fn len(&self) -> usize {
        self.rows.len() - self.free.len()
    }

    /// The row of the candidate with a key.
    pub(super) fn find(&self, key: u64) -> Option<u32> {
        let found = self.by_key.find(key, |&row| self.rows[row as usize].key == key);
        found.copied()
    }

    pub(super) fn get(&self, row: u32) -> &Candidate {
        &self.rows[row as usize]
    }

    pub(super) fn get_mut(&mut self, row: u32) -> &mut Candidate {
        &mut self.rows[row as usize]
    }

    pub(super) fn position(&self, row: u32, dimension: usize) -> &[S] {
        &self.positions[row as usize * dimension..(row as usize + 1) * dimension]
    }

    /// Adds one that is not known, and returns its row.
    pub(super) fn add(&mut self, candidate: Candidate, position: &[S]) -> u32 {
        let row = if let Some(row) = self.free.pop() {
            let place = row as usize * position.len();
            self.rows[row as usize] = candidate;
            self.positions[place..place + position.len()].copy_from_slice(position);
            row
        } else {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "2^32 candidates do not fit in memory"
            )]
            let row = self.rows.len() as u32;
            self.rows.push(candidate);
            self.positions.extend_from_slice(position);
            row
        };
        if candidate.part == 0 {
            let rows = &self.rows;
            self.by_key
                .insert_unique(candidate.key, row, |&row| rows[row as usize].key);
        }
        row
    }

    /// Whether the rows are of a space of so many axes.
    pub(super) fn fit(&self, dimension: usize) -> bool {
        Some(self.positions.len()) == self.rows.len().checked_mul(dimension)
    }

    pub(super) fn remove(&mut self, row: u32) {
        let Candidate { key, part, .. } = core::mem::take(&mut self.rows[row as usize]);
        if part == 0
            && let Ok(found) = self.by_key.find_entry(key, |&other| other == row)
        {
            found.remove();
        }
        self.free.push(row);
    }
}

/// A hash of a position; two that share one are taken for the same, at odds of 2^-64. In four lanes, so that many axes do not wait for
/// each other.
pub(super) fn key<S: Real>(position: &[S]) -> u64 {
    let mix = |hash: u64, word: u64| {
        let hash = (hash.rotate_left(23) ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        hash ^ (hash >> 32)
    };
    let mut lanes = [0, 1, 2, 3];
    let groups = position.chunks_exact(lanes.len());
    let rest = groups.remainder();
    for group in groups {
        for (lane, x) in lanes.iter_mut().zip(group) {
            *lane = mix(*lane, x.to_word());
        }
    }
    let words = rest.iter().map(|x| x.to_word());
    lanes.into_iter().chain(words).fold(0, mix)
}
