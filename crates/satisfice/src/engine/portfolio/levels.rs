//! Whether F is a step function of continuous axes: whether it has hardly any values.

use crate::batch::Outcome;
use crate::scalar::Real;

/// F is a step function while no more values than this were seen, and at most one of them only once, in so many misses or more. A model can
/// learn a function of more steps, such as a number of violated constraints, and where F is only cut off at a level, the values below it,
/// which hardly ever repeat, lead down.
const MOST: usize = 4;
const ENOUGH: u64 = 16;

/// The values of F at the misses, up to one more than a step function has.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Levels {
    /// Each with whether it was seen more than once.
    seen: Vec<(u64, bool)>,
    misses: u64,
}

impl Levels {
    pub(super) fn count<S: Real>(&mut self, outcome: Outcome<S>) {
        let Outcome::Miss(fitness) = outcome else {
            return;
        };
        self.misses = self.misses.saturating_add(1);
        let value = fitness.f64().to_bits();
        if let Some((_, repeats)) = self.seen.iter_mut().find(|(seen, _)| *seen == value) {
            *repeats = true;
        } else if self.seen.len() <= MOST {
            self.seen.push((value, false));
        }
    }

    /// Whether F has so few values that it has no slope to descend.
    pub(super) fn are_few(&self) -> bool {
        let once = self.seen.iter().filter(|(_, repeats)| !repeats).count();
        self.misses >= ENOUGH && self.seen.len() <= MOST && once <= 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_function_is_told_from_a_slope_and_from_one_that_is_cut_off() {
        let [mut steps, mut slope, mut cut_off] = [const {
            Levels {
                seen: Vec::new(),
                misses: 0,
            }
        }; 3];
        for i in 0..100 {
            steps.count(Outcome::Miss(f64::from(i % 4)));
            slope.count(Outcome::Miss(f64::from(i % 5)));
            cut_off.count(Outcome::Miss(f64::from(100 - i).min(60.0)));
            assert_eq!(steps.are_few(), i >= 15, "{i}");
            assert!(!slope.are_few(), "{i}");
            assert_eq!(cut_off.are_few(), (15..42).contains(&i), "{i}");
        }
        // Hits and missing values say nothing.
        let mut levels = Levels::default();
        for _ in 0..100 {
            levels.count(Outcome::Hit(0.0));
            levels.count(Outcome::<f64>::NonFinite);
        }
        assert!(!levels.are_few());
    }
}
