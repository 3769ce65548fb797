//! The best near misses of recombinations, from which searches start.

/// So many are kept.
const MOST: usize = 16;

/// Near misses, the best one last. Coordinates are shares of the axes' widths.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct MissList {
    list: Vec<PlacedMiss>,
    /// Memory of places that are forgotten.
    #[serde(skip)]
    spare: Vec<Vec<f64>>,
}

#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
struct PlacedMiss {
    place: Vec<f64>,
    fitness: f64,
}

impl MissList {
    /// Keeps a miss, if it is among the best; `write` writes its place.
    pub(super) fn keep(&mut self, dimension: usize, fitness: f64, write: impl FnOnce(&mut [f64])) {
        let mut at = self.list.partition_point(|miss| miss.fitness > fitness);
        if !fitness.is_finite() || (self.list.len() == MOST && at == 0) {
            return;
        }
        if self.list.len() == MOST {
            self.spare.push(self.list.remove(0).place);
            at -= 1;
        }
        let mut place = self.spare.pop().unwrap_or_default();
        place.resize(dimension, 0.0);
        write(&mut place);
        self.list.insert(at, PlacedMiss { place, fitness });
    }

    /// Takes the best one out and hands its place to `read`.
    pub(super) fn take_best(&mut self, read: impl FnOnce(&[f64])) -> bool {
        let Some(miss) = self.list.pop() else {
            return false;
        };
        read(&miss.place);
        self.spare.push(miss.place);
        true
    }

    /// Whether these are places in a space of so many axes.
    pub(super) fn fit(&self, dimension: usize) -> bool {
        self.list.len() <= MOST && self.list.iter().all(|miss| miss.place.len() == dimension)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_are_kept_and_the_best_of_them_taken_first() {
        let mut misses = MissList::default();
        for i in 0..40 {
            let fitness = f64::from((i * 7) % 40);
            misses.keep(1, fitness, |place| place[0] = fitness);
        }
        misses.keep(1, f64::NAN, |_| unreachable!());
        assert!(misses.fit(1) && !misses.fit(2));
        let mut taken = Vec::new();
        while misses.take_best(|place| taken.push(place[0])) {}
        let best: Vec<f64> = (0..16).map(f64::from).collect();
        assert_eq!(taken, best);
    }
}
