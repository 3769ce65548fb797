//! How well a model has predicted what it was told.

/// Predictions after which a past one counts for 1/e.
const MEMORY: f64 = 64.0;
/// So many predictions tell.
const ENOUGH: u64 = 48;
/// Share of the variance of F that a model predicts which is of use.
const USEFUL: f64 = 0.25;

/// What a model has to predict better than.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::engine) enum Yardstick {
    /// The mean of the latest points. They gather where F is low, so the model must tell them apart.
    Latest,
    /// The mean of the first points, which is what chance finds: enough where nothing else leads down.
    First,
}

/// The share of the variance of F that was predicted before F was known (prequential analysis: Dawid 1984, doi 10.2307/2981683).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Skill {
    predictions: u64,
    /// Sums that fade: of squared errors of the predictions, of the running mean and of the first points' mean, of values, and of ones.
    errors: f64,
    spread: f64,
    from_first: f64,
    values: f64,
    weight: f64,
}

impl Skill {
    /// Counts a value and the error with which it was predicted. `first`: the mean of the first points.
    pub(super) fn count(&mut self, value: f64, error: f64, first: f64) {
        let keep = 1.0 - 1.0 / MEMORY;
        if self.weight > 0.0 {
            let from_mean = value - self.values / self.weight;
            self.errors = keep * self.errors + error * error;
            self.spread = keep * self.spread + from_mean * from_mean;
            self.from_first = keep * self.from_first + (value - first) * (value - first);
            self.predictions += 1;
        }
        self.values = keep * self.values + value;
        self.weight = keep * self.weight + 1.0;
    }

    /// Counts a point whose components were predicted with this share of their variance as error. Their values where hits are sought are
    /// near 0, and their mean there says nothing.
    pub(super) fn count_share(&mut self, error: f64) {
        let keep = 1.0 - 1.0 / MEMORY;
        self.errors = keep * self.errors + error.min(1.0);
        self.spread = keep * self.spread + 1.0;
        self.from_first = keep * self.from_first + 1.0;
        self.predictions += 1;
    }

    /// Whether the model predicts better than the mean does; `None` before enough predictions tell.
    pub(super) fn is_useful(&self, yardstick: Yardstick) -> Option<bool> {
        let variance = match yardstick {
            Yardstick::Latest => self.spread,
            Yardstick::First => self.from_first,
        };
        (self.predictions >= ENOUGH).then_some(self.errors < (1.0 - USEFUL) * variance)
    }

    pub(super) fn saved(&self) -> (u64, [f64; 5]) {
        (
            self.predictions,
            [
                self.errors,
                self.spread,
                self.from_first,
                self.values,
                self.weight,
            ],
        )
    }

    pub(super) fn restored(
        (predictions, [errors, spread, from_first, values, weight]): (u64, [f64; 5]),
    ) -> Self {
        Self {
            predictions,
            errors,
            spread,
            from_first,
            values,
            weight,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Yardstick::{First, Latest};
    use super::*;

    #[test]
    fn what_predicts_is_told_from_what_does_not() {
        let value = |i: u64| (i as f64 * 0.618).fract();
        let (mut good, mut none, mut worse) = (Skill::default(), Skill::default(), Skill::default());
        for i in 0..200 {
            assert_eq!(good.is_useful(Latest), (i > ENOUGH).then_some(true), "{i}");
            good.count(value(i), 0.1, 0.5);
            none.count(value(i), value(i) - 0.5, 0.5);
            worse.count(value(i), 0.6, 0.5);
        }
        assert_eq!(
            [none.is_useful(Latest), worse.is_useful(Latest)],
            [Some(false); 2]
        );
        // What was learned later counts.
        for i in 0..300 {
            worse.count(value(i), 0.05, 0.5);
        }
        assert_eq!(worse.is_useful(Latest), Some(true));
    }

    /// Points near 0.2 of which it cannot say which is better, where chance finds 1.
    #[test]
    fn to_know_where_f_is_low_is_of_use_where_nothing_else_leads_there() {
        let (mut low, mut none) = (Skill::default(), Skill::default());
        for i in 0..100 {
            assert_eq!(low.is_useful(First), (i > ENOUGH).then_some(true), "{i}");
            let error = 0.1 * (i as f64 * 0.618).fract() - 0.05;
            low.count(0.2 + error, error, 1.0);
            none.count(1.0 + error, error, 1.0);
        }
        assert_eq!(low.is_useful(Latest), Some(false));
        assert_eq!([First, Latest].map(|of| none.is_useful(of)), [Some(false); 2]);
        assert_eq!(Skill::restored(low.saved()), low);
    }

    #[test]
    fn components_are_predicted_if_errors_are_small_beside_their_variance() {
        let (mut good, mut bad) = (Skill::default(), Skill::default());
        for i in 0..100 {
            assert_eq!(good.is_useful(Latest), (i >= ENOUGH).then_some(true), "{i}");
            good.count_share(0.5);
            bad.count_share(if i % 2 == 0 { 0.7 } else { 50.0 });
        }
        assert_eq!(bad.is_useful(Latest), Some(false));
    }

    #[test]
    fn to_predict_a_constant_is_of_no_use() {
        let mut skill = Skill::default();
        for _ in 0..=ENOUGH {
            skill.count(1.0, 0.0, 1.0);
        }
        assert_eq!(skill.is_useful(Latest), Some(false));
    }
}
