//! Whether a search starts at one point or at the best of several: by what both have yielded.

/// Points of which the best is a start.
const DRAWS: usize = 8;
/// A kind of start that was not tried yet is expected to yield a hit in so many evaluations.
const EXPECTED: f64 = 30.0;

/// Where a search started.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(super) enum StartKind {
    /// At a point of the user.
    #[default]
    Given,
    /// At one point.
    Single,
    /// At the best of several.
    Best,
}

impl StartKind {
    /// Points to draw.
    pub(super) fn draws(self) -> usize {
        match self {
            Self::Given => 0,
            Self::Single => 1,
            Self::Best => DRAWS,
        }
    }
}

/// Hits and evaluations of searches by their start.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Starts {
    single: (f64, f64),
    best: (f64, f64),
}

impl Starts {
    /// The kind that has yielded more.
    pub(super) fn next(&self) -> StartKind {
        let yields = |(hits, evaluations): (f64, f64)| (hits + 1.0) / (evaluations + EXPECTED);
        if yields(self.best) > yields(self.single) {
            StartKind::Best
        } else {
            StartKind::Single
        }
    }

    /// Counts an evaluation of a search.
    pub(super) fn count(&mut self, kind: StartKind, is_hit: bool) {
        let known = match kind {
            StartKind::Given => return,
            StartKind::Single => &mut self.single,
            StartKind::Best => &mut self.best,
        };
        known.0 += f64::from(u8::from(is_hit));
        known.1 += 1.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_kinds_are_tried_and_the_better_one_is_kept() {
        let mut starts = Starts::default();
        assert_eq!(starts.next(), StartKind::Single);
        // A hit in 20 evaluations, and one in 60.
        let mut searches = [0, 0];
        for _ in 0..100 {
            let kind = starts.next();
            let takes = if kind == StartKind::Best { 20 } else { 60 };
            for i in 1..=takes {
                starts.count(kind, i == takes);
            }
            searches[usize::from(kind == StartKind::Best)] += 1;
        }
        assert!(searches[0] >= 1 && searches[1] > 20 * searches[0], "{searches:?}");
        // A start of the user says nothing of either.
        let before = starts.next();
        (0..1000).for_each(|_| starts.count(StartKind::Given, true));
        assert_eq!(starts.next(), before);
    }
}
