//! What a call of the fitness costs in time, as far as samples tell.

/// Evaluations between two samples: to look at the clock costs as much as a cheap fitness.
const APART: u64 = 64;

/// The price of a call: the less of the last two samples, because a first call or a pause of the machine may take a thousand times
/// as long as the others.
#[derive(Debug, Default)]
pub(super) struct Price {
    latest: Option<f64>,
    seconds: Option<f64>,
    /// The evaluations after which the next sample is due.
    next: u64,
}

impl Price {
    /// Whether a sample is due after so many evaluations.
    #[inline]
    pub(super) fn is_due(&self, evaluations: u64) -> bool {
        evaluations >= self.next
    }

    /// Enters a sample: what so many calls took, after so many evaluations.
    pub(super) fn note(&mut self, nanoseconds: u64, calls: usize, evaluations: u64) {
        let seconds = nanoseconds as f64 * 1e-9 / calls.max(1) as f64;
        self.seconds = self.latest.map(|latest| latest.min(seconds));
        self.latest = Some(seconds);
        self.next = evaluations + APART.min(evaluations);
    }

    /// Seconds a call; `None` before two samples.
    pub(super) fn seconds(&self) -> Option<f64> {
        self.seconds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_slow_call_is_not_the_price() {
        let mut price = Price::default();
        price.note(5_000_000, 1, 1);
        assert_eq!(price.seconds(), None);
        price.note(3_000, 3, 10);
        assert_eq!(price.seconds(), Some(1e-6));
        price.note(9_000_000, 1, 1000);
        assert_eq!(price.seconds(), Some(1e-6));
        // What stays slow is believed.
        price.note(8_000_000, 1, 2000);
        assert_eq!(price.seconds(), Some(8e-3));
    }

    #[test]
    fn samples_are_some_evaluations_apart() {
        let mut price = Price::default();
        assert!(price.is_due(0));
        price.note(1, 1, 0);
        assert!(price.is_due(1));
        price.note(1, 1, 500);
        assert!(!price.is_due(500 + APART - 1) && price.is_due(500 + APART));
    }
}
