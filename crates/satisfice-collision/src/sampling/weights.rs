//! Weighted draws, with and without replacement.

use rand::Rng;

use super::unit;

/// Weights as a binary tree of sums. A changed weight is summed again on the path to the root and never subtracted, so
/// that rounding cannot draw a weight that was set to zero.
pub(super) struct WeightTree {
    /// `sums[1]` is the root, the leaves start at `leaves`.
    sums: Vec<f64>,
    leaves: usize,
}

impl WeightTree {
    /// The weights must be finite and not negative and have a finite sum.
    pub(super) fn new(weights: &[f64]) -> Self {
        let leaves = weights.len().next_power_of_two();
        let mut sums = vec![0.0; 2 * leaves];
        sums[leaves..leaves + weights.len()].copy_from_slice(weights);
        for k in (1..leaves).rev() {
            sums[k] = sums[2 * k] + sums[2 * k + 1];
        }
        Self { sums, leaves }
    }

    pub(super) fn total(&self) -> f64 {
        self.sums[1]
    }

    /// Draws an item with probability weight / total; the total must be positive. Cost: O(log n).
    pub(super) fn draw(&self, rng: &mut impl Rng) -> usize {
        let mut target = unit(rng) * self.total();
        let mut k = 1;
        while k < self.leaves {
            let (left, right) = (self.sums[2 * k], self.sums[2 * k + 1]);
            // Rounding may move the target to or beyond the sum of an empty side: never descend into one.
            if (target < left && left > 0.0) || right == 0.0 {
                k *= 2;
            } else {
                target -= left;
                k = 2 * k + 1;
            }
        }
        k - self.leaves
    }

    pub(super) fn remove(&mut self, item: usize) {
        let mut k = self.leaves + item;
        self.sums[k] = 0.0;
        while k > 1 {
            k /= 2;
            self.sums[k] = self.sums[2 * k] + self.sums[2 * k + 1];
        }
    }
}
