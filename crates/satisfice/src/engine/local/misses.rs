//! The best near misses of recombinations, from which searches start.

use crate::scalar::Real;

/// So many are kept.
const MOST: usize = 16;

/// Near misses, the best one last.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(super) struct MissList<S> {
    list: Vec<PlacedMiss<S>>,
    /// Memory of positions that are forgotten.
    #[serde(skip)]
    spare: Vec<Vec<S>>,
}

#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
struct PlacedMiss<S> {
    position: Vec<S>,
    fitness: S,
}

impl<S> Default for MissList<S> {
    fn default() -> Self {
        Self {
            list: Vec::new(),
            spare: Vec::new(),
        }
    }
}

impl<S: Real> MissList<S> {
    /// Keeps a miss, if it is among the best.
    pub(super) fn keep(&mut self, position: &[S], fitness: S) {
        let mut at = self.list.partition_point(|miss| miss.fitness > fitness);
        if !fitness.is_finite() || (self.list.len() == MOST && at == 0) {
            return;
        }
        if self.list.len() == MOST {
            self.spare.push(self.list.remove(0).position);
            at -= 1;
        }
        let mut kept = self.spare.pop().unwrap_or_default();
        kept.clear();
        kept.extend_from_slice(position);
        let miss = PlacedMiss {
            position: kept,
            fitness,
        };
        self.list.insert(at, miss);
    }

    /// Takes the best one out and hands its position and fitness to `read`.
    pub(super) fn take_best(&mut self, read: impl FnOnce(&[S], S)) -> bool {
        let Some(miss) = self.list.pop() else {
            return false;
        };
        read(&miss.position, miss.fitness);
        self.spare.push(miss.position);
        true
    }

    /// Whether these are positions in a space of so many axes.
    pub(super) fn fit(&self, dimension: usize) -> bool {
        let mut positions = self.list.iter().map(|miss| &miss.position);
        self.list.len() <= MOST && positions.all(|position| position.len() == dimension)
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
            misses.keep(&[fitness], fitness);
        }
        for fitness in [f64::NAN, f64::INFINITY] {
            misses.keep(&[-1.0], fitness);
        }
        assert!(misses.fit(1) && !misses.fit(2));
        let mut taken = Vec::new();
        while misses.take_best(|position, fitness| {
            assert_eq!(position, [fitness]);
            taken.push(fitness);
        }) {}
        let best: Vec<f64> = (0..16).map(f64::from).collect();
        assert_eq!(taken, best);
    }
}
