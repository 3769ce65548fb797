//! Whether F is a step function of continuous axes: whether most of its values were seen before.

use crate::batch::Outcome;
use crate::scalar::Real;

/// Values that are remembered, the first ones.
const LEVELS: usize = 32;
/// So many misses tell, and so many for good.
const ENOUGH: u64 = 16;
const CERTAIN: u64 = 4096;

/// Values of F, and how many came more than once.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Levels {
    seen: Vec<u64>,
    misses: u64,
    repeated: u64,
}

impl Levels {
    pub(super) fn count<S: Real>(&mut self, outcome: Outcome<S>) {
        let Outcome::Miss(fitness) = outcome else {
            return;
        };
        if self.misses >= CERTAIN {
            return;
        }
        let value = fitness.f64().to_bits();
        self.misses += 1;
        if self.seen.contains(&value) {
            self.repeated += 1;
        } else if self.seen.len() < LEVELS {
            self.seen.push(value);
        }
    }

    /// Whether most values repeat others, so that F has no slope to descend.
    pub(super) fn are_few(&self) -> bool {
        self.misses >= ENOUGH && 2 * self.repeated > self.misses
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_function_is_told_from_a_slope() {
        let (mut steps, mut slope) = (Levels::default(), Levels::default());
        for i in 0..100 {
            steps.count(Outcome::Miss(f64::from(i % 4)));
            slope.count(Outcome::Miss(f64::from(i)));
            assert_eq!(steps.are_few(), i >= 15, "{i}");
        }
        assert!(!slope.are_few());
        // Hits and missing values say nothing.
        let mut levels = Levels::default();
        for _ in 0..100 {
            levels.count(Outcome::Hit(0.0));
            levels.count(Outcome::<f64>::NonFinite);
        }
        assert!(!levels.are_few());
    }
}
