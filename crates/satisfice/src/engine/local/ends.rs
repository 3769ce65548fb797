//! Where local searches have ended: which of these places is near, and from which to search on.

/// Coordinates that are kept, and the fewest and most places; then the oldest ones are forgotten.
const COORDINATES: usize = 1 << 16;
const FEWEST: usize = 16;
const MOST: usize = 1024;
/// How much slower radii shrink, all together, than one grows.
const SLOWER: f64 = 0.5;
/// The radius of the first hit. A later one begins with the radius below which a tenth of all radii are.
const FIRST: f64 = 1.0;
const TENTH: usize = 10;
/// The smallest and the largest radius: a larger one would refuse nearly all samples of any search.
const RADII: (f64, f64) = (0.01, 100.0);

/// The ends of local searches, hits or not. Coordinates are shares of the axes' widths.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Ends {
    places: Vec<f64>,
    ends: Vec<End>,
    /// How many of them are no hits.
    misses: usize,
    /// Where the next one is written, once there is no room.
    oldest: usize,
    /// The radius of a hit that is new, once it is known since radii last changed.
    new_radius: Option<f64>,
    /// Memory of one choice.
    #[serde(skip)]
    list: Vec<usize>,
    /// Memory of one look at the radii.
    #[serde(skip)]
    radii: Vec<f64>,
}

#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
struct End {
    fitness: f64,
    is_hit: bool,
    /// How far away the nearest better one is.
    apart: f64,
    /// Searches that have started from here.
    tries: u32,
    /// The radius within which samples are refused, of a hit; in a search's own metric.
    radius: f64,
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
        let mut end = End {
            fitness,
            is_hit,
            apart,
            tries: 0,
            radius: 0.0,
        };
        let most = (COORDINATES / dimension).clamp(FEWEST, MOST);
        if self.ends.is_empty() {
            // All at once, so that a long search does not allocate.
            self.places.reserve_exact(most * dimension);
            self.ends.reserve_exact(most);
            self.list.reserve_exact(most);
            self.radii.reserve_exact(most);
        }
        if is_hit {
            end.radius = self.new_radius();
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

    /// How many that are no hits have less fitness than this one. Cost: O(n).
    pub(super) fn better(&self, index: usize) -> usize {
        let limit = self.ends[index].fitness;
        let others = self.ends.iter().filter(|end| !end.is_hit && end.fitness < limit);
        others.count()
    }

    /// The nearest one, and how far away it is.
    pub(super) fn nearest(&self, point: &[f64]) -> Option<(usize, f64)> {
        let distances = self
            .places
            .chunks_exact(point.len())
            .map(|place| distance(place, point));
        distances.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// An end from which to search on: no hit, none better within `apart`, a good one from which few have searched: in proportion to
    /// the inverse square of its rank. That one more has is noted. Cost: O(n log n).
    pub(super) fn promising(&mut self, apart: f64) -> Option<usize> {
        let Self { ends, list, .. } = self;
        list.clear();
        list.extend((0..ends.len()).filter(|&index| !ends[index].is_hit && ends[index].apart >= apart));
        list.sort_unstable_by(|&a, &b| ends[a].fitness.total_cmp(&ends[b].fitness).then(a.cmp(&b)));
        let cost =
            |&(rank, &index): &(usize, &usize)| (rank as u64 + 1).pow(2) * (u64::from(ends[index].tries) + 1);
        let (_, &index) = list.iter().enumerate().min_by_key(cost)?;
        let tries = &mut ends[index].tries;
        *tries = tries.saturating_add(1);
        Some(index)
    }

    /// How many are kept.
    pub(super) fn len(&self) -> usize {
        self.ends.len()
    }

    /// The place, the radius and the fitness of each hit.
    pub(super) fn hits(&self, dimension: usize) -> impl Iterator<Item = (&[f64], f64, f64)> {
        let ends = self.places.chunks_exact(dimension).zip(&self.ends);
        ends.filter(|(_, end)| end.is_hit)
            .map(|(place, end)| (place, end.radius, end.fitness))
    }

    /// How far the nearest hit is, in its radius.
    pub(super) fn room(&self, point: &[f64]) -> f64 {
        let hits = self.hits(point.len());
        let distances = hits.map(|(place, radius, _)| distance(place, point) / radius);
        distances.fold(f64::INFINITY, f64::min)
    }

    /// The radius of a hit that is new: one of the smaller ones. That does not change with another hit of this radius.
    fn new_radius(&mut self) -> f64 {
        let Self { ends, radii, .. } = self;
        *self.new_radius.get_or_insert_with(|| {
            radii.clear();
            radii.extend(ends.iter().filter(|end| end.is_hit).map(|end| end.radius));
            let rank = radii.len() / TENTH;
            if radii.is_empty() {
                FIRST
            } else {
                *radii.select_nth_unstable_by(rank, f64::total_cmp).1
            }
        })
    }

    /// A search has been attracted by a hit that was known, or by none: radii adapt.
    pub(super) fn adapt_radii(&mut self, attracted: Option<usize>, rate: f64) {
        self.new_radius = None;
        let hits = (self.ends.len() - self.misses) as f64;
        let others = attracted.map_or(hits, |_| (hits - 1.0).max(1.0));
        let decay = (-SLOWER * rate / others).exp();
        for (index, end) in self.ends.iter_mut().enumerate() {
            if !end.is_hit {
                continue;
            }
            if Some(index) == attracted {
                end.radius = (end.radius * rate.exp()).min(RADII.1);
            } else {
                end.radius = (end.radius * decay).max(RADII.0);
            }
        }
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
        assert_eq!([0, 1, 2].map(|index| ends.better(index)), [1, 2, 0]);
        let mut tries = [0; 4];
        for _ in 0..12 {
            tries[ends.promising(0.2).unwrap()] += 1;
        }
        assert_eq!(tries, [10, 2, 0, 0]);
        assert_eq!(ends.promising(0.001), Some(2));
        assert_eq!(ends.promising(2.0), None);
    }

    #[test]
    fn a_radius_grows_with_every_search_that_its_hit_attracts() {
        let mut ends = Ends::default();
        for (place, is_hit) in [(0.1, true), (0.5, false), (0.9, true)] {
            ends.add(&[place], 0.0, is_hit);
        }
        ends.adapt_radii(Some(0), 1.0);
        ends.adapt_radii(None, 1.0);
        let radii: Vec<f64> = ends.hits(1).map(|(_, radius, _)| radius).collect();
        approx::assert_relative_eq!(radii[0], 0.75_f64.exp(), max_relative = 1e-12);
        approx::assert_relative_eq!(radii[1], (-0.75_f64).exp(), max_relative = 1e-12);
        ends.add(&[0.6], 0.0, true);
        assert_eq!(ends.hits(1).last().map(|(_, radius, _)| radius), Some(radii[1]));
        assert_eq!(ends.room(&[0.1]), 0.0);
        for _ in 0..1000 {
            ends.adapt_radii(Some(0), 1.0);
        }
        let radii: Vec<f64> = ends.hits(1).map(|(_, radius, _)| radius).collect();
        assert_eq!(radii, [RADII.1, RADII.0, RADII.0]);
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
