//! Samples that are refused near known hits, within radii in the search's own metric (Ahrari and others 2022).

use super::ends::Ends;
use super::strategy::Strategy;

/// A hit is near if the mean is no farther outside its radius: a normal variable is beyond this once in a hundred times.
const REACH: f64 = 2.33;
/// What is left of the radii after a refusal, raised to the inverse of D (or of the second value, where D is larger), until the next
/// batch: so that sampling ends, and soon.
const SHRINKAGE: f64 = 0.99;
const SLOWEST: usize = 50;

/// The known hits near a generation, as N(0, I) sees them; found anew for each batch.
#[derive(Debug, Default)]
pub(super) struct Repelled {
    /// From each hit to the mean.
    displacements: Vec<f64>,
    radii: Vec<f64>,
    /// What is left of the radii.
    share: f64,
}

impl Repelled {
    /// Finds the hits that are near. Cost: O(D) for each hit, and O(D^2) for those near enough to matter.
    pub(super) fn find(&mut self, ends: &Ends, strategy: &Strategy, is_better: impl Fn(f64) -> bool) {
        let dimension = strategy.mean.len();
        let spread = strategy.spread();
        self.share = 1.0;
        self.radii.clear();
        self.displacements.clear();
        for (place, radius, fitness) in ends.hits(dimension) {
            if !is_better(fitness) {
                continue;
            }
            let limit = radius + REACH;
            let start = self.displacements.len();
            let mean = strategy.mean.iter().zip(place);
            self.displacements.extend(mean.map(|(m, x)| m - x));
            let displacement = &mut self.displacements[start..];
            // No direction has a larger variance than all together.
            let mut is_near = length(displacement) < limit * spread;
            if is_near {
                strategy.whiten(displacement);
                is_near = length(displacement) < limit;
            }
            if is_near {
                self.radii.push(radius);
            } else {
                self.displacements.truncate(start);
            }
        }
    }

    /// Whether no hit is near.
    pub(super) fn is_empty(&self) -> bool {
        self.radii.is_empty()
    }

    /// Whether a sample is too near a known hit. Cost: O(D) for each hit that is near.
    pub(super) fn refuses(&mut self, draw: &[f64]) -> bool {
        let mut regions = self.displacements.chunks_exact(draw.len()).zip(&self.radii);
        let refused = regions.any(|(displacement, radius)| {
            let square: f64 = displacement
                .iter()
                .zip(draw)
                .map(|(u, z)| (u + z) * (u + z))
                .sum();
            square < (self.share * radius).powi(2)
        });
        if refused {
            self.share *= SHRINKAGE.powf(1.0 / draw.len().min(SLOWEST) as f64);
        }
        refused
    }
}

fn length(vector: &[f64]) -> f64 {
    vector.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::SearchRng;

    #[test]
    fn samples_keep_out_of_a_radius_that_shrinks() {
        let mut ends = Ends::default();
        ends.add(&[0.5, 0.5], 0.0, true);
        let (mut rng, mut strategy) = (SearchRng::new(3), Strategy::default());
        let mut repelled = Repelled::default();
        strategy.reset(&[0.6, 0.5], 0.1, 8);
        repelled.find(&ends, &strategy, |_| true);
        assert!(!repelled.is_empty());
        for _ in 0..8 {
            let x = strategy.sample(&mut rng, &mut repelled, |_, x| x);
            let distance = (x[0] - 0.5).hypot(x[1] - 0.5);
            assert!(distance >= 0.1 * repelled.share && repelled.share > 0.8);
        }
        for _ in 0..1000 {
            ends.adapt_radii(Some(0), 1.0);
        }
        repelled.find(&ends, &strategy, |_| true);
        strategy.sample(&mut rng, &mut repelled, |_, x| x);
        assert!(repelled.share < 0.1);
        repelled.find(&ends, &strategy, |fitness| fitness < 0.0);
        assert!(repelled.is_empty());
    }
}
