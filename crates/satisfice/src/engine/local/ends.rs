//! Where local searches have ended: which of these places is near, and from which to search on.

/// Coordinates that are kept, and the fewest and most places; then the oldest ones are forgotten.
const COORDINATES: usize = 1 << 16;
const FEWEST: usize = 16;
const MOST: usize = 1024;

/// The ends of local searches, hits or not. Coordinates are shares of the axes' widths.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Ends {
    places: Vec<f64>,
    ends: Vec<End>,
    /// How many of them are no hits.
    misses: usize,
    /// Where the next one is written, once there is no room.
    oldest: usize,
    /// Memory of one choice.
    #[serde(skip)]
    list: Vec<usize>,
}

#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
struct End {
    fitness: f64,
    is_hit: bool,
    /// How far away the nearest better one is.
    apart: f64,
    /// Searches that have started from here.
    tries: u32,
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b) * (a - b))
        .sum::<f64>()
        .sqrt()
}

impl Ends {
    pub(super) fn place(&self, index: usize, dimension: usize) -> &[f64] {
        &self.places[index * dimension..(index + 1) * dimension]
    }

    pub(super) fn fitness(&self, index: usize) -> f64 {
        self.ends[index].fitness
    }

    pub(super) fn is_hit(&self, index: usize) -> bool {
        self.ends[index].is_hit
    }

    /// A search has ended here. Cost: O(D) for each end, of a hit for each that is none.
    pub(super) fn add(&mut self, place: &[f64], fitness: f64, is_hit: bool) {
        let dimension = place.len();
        let mut apart = f64::INFINITY;
        // No search goes on from a hit, so that hits do not look at each other.
        if !is_hit || self.misses > 0 {
            let others = self.ends.iter_mut().zip(self.places.chunks_exact(dimension));
            for (end, other) in others.filter(|(end, _)| !(is_hit && end.is_hit)) {
                let distance = distance(other, place);
                if is_hit || (!end.is_hit && fitness < end.fitness) {
                    end.apart = end.apart.min(distance);
                } else {
                    apart = apart.min(distance);
                }
            }
        }
        self.misses += usize::from(!is_hit);
        let end = End {
            fitness,
            is_hit,
            apart,
            tries: 0,
        };
        let most = (COORDINATES / dimension).clamp(FEWEST, MOST);
        if self.ends.is_empty() {
            // All at once, so that a long search does not allocate.
            self.places.reserve_exact(most * dimension);
            self.ends.reserve_exact(most);
            self.list.reserve_exact(most);
        }
        if self.ends.len() < most {
            self.places.extend_from_slice(place);
            self.ends.push(end);
            return;
        }
        let index = self.oldest % most;
        self.oldest = index + 1;
        self.misses -= usize::from(!self.ends[index].is_hit);
        self.places[index * dimension..(index + 1) * dimension].copy_from_slice(place);
        self.ends[index] = end;
    }

    /// The nearest one, and how far away it is.
    pub(super) fn nearest(&self, point: &[f64]) -> Option<(usize, f64)> {
        let distances = self
            .places
            .chunks_exact(point.len())
            .map(|place| distance(place, point));
        distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// An end from which to search on: no hit, none better within `apart`, a good one from which few have searched. That one more
    /// has is noted. Cost: O(n log n).
    pub(super) fn promising(&mut self, apart: f64) -> Option<usize> {
        let Self { ends, list, .. } = self;
        list.clear();
        list.extend((0..ends.len()).filter(|&index| !ends[index].is_hit && ends[index].apart >= apart));
        list.sort_unstable_by(|&a, &b| ends[a].fitness.total_cmp(&ends[b].fitness).then(a.cmp(&b)));
        let cost = |&(rank, &index): &(usize, &usize)| (rank as u64 + 1) * (u64::from(ends[index].tries) + 1);
        let (_, &index) = list.iter().enumerate().min_by_key(cost)?;
        let tries = &mut ends[index].tries;
        *tries = tries.saturating_add(1);
        Some(index)
    }

    /// Whether this is a list in a space of so many axes.
    pub(super) fn fit(&self, dimension: usize) -> bool {
        let misses = self.ends.iter().filter(|end| !end.is_hit).count();
        self.places.len() == dimension * self.ends.len() && self.misses == misses
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn good_ends_are_tried_more_often_and_none_beside_a_hit() {
        let mut ends = Ends::default();
        ends.add(&[0.1], 5.0, false);
        ends.add(&[0.5], 7.0, false);
        ends.add(&[0.9], 3.0, false);
        ends.add(&[0.91], 0.0, true);
        assert_eq!(ends.nearest(&[0.6]).map(|(index, _)| index), Some(1));
        let mut tries = [0; 4];
        for _ in 0..12 {
            tries[ends.promising(0.2).unwrap()] += 1;
        }
        assert_eq!(tries, [8, 4, 0, 0]);
        assert_eq!(ends.promising(0.001), Some(2));
        assert_eq!(ends.promising(2.0), None);
    }

    #[test]
    fn the_oldest_end_is_forgotten() {
        let mut ends = Ends::default();
        for i in 0..=MOST {
            ends.add(&[i as f64], 1.0, true);
        }
        assert!(ends.fit(1));
        assert_eq!((ends.ends.len(), ends.place(0, 1)[0]), (MOST, MOST as f64));
    }
}
