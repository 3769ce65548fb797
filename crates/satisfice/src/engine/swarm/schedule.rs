//! Coefficients that change while the budget is used up.

use crate::scalar::Real;

/// A coefficient that goes in a straight line from one value to another as the budget is used.
///
/// It follows the elapsed share of the budget, never a count of sweeps: how many sweeps fit into a deadline is not known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Schedule<S> {
    from: S,
    to: S,
}

impl<S: Real> Schedule<S> {
    /// From `from` at the start to `to` at the end of the budget.
    pub(super) fn linear(from: f64, to: f64) -> Self {
        Self {
            from: S::of(from),
            to: S::of(to),
        }
    }

    /// Always `value`.
    pub(super) fn fixed(value: f64) -> Self {
        Self::linear(value, value)
    }

    /// The value when `share()` of the budget is used; a fixed coefficient does not ask.
    #[inline]
    pub(super) fn at(&self, share: impl FnOnce() -> f64) -> S {
        if self.from == self.to {
            return self.from;
        }
        self.from + (self.to - self.from) * S::of(share())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_goes_from_one_end_to_the_other() {
        let inertia = Schedule::<f64>::linear(0.9, 0.4);
        for (share, value) in [(0.0, 0.9), (0.5, 0.65), (1.0, 0.4)] {
            approx::assert_relative_eq!(inertia.at(|| share), value, max_relative = 1e-15);
        }
        approx::assert_relative_eq!(
            Schedule::<f64>::fixed(0.7).at(|| unreachable!("asked for nothing")),
            0.7
        );
    }
}
