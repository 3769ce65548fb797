//! Where a rigid body is expected in the next frame: carried on as it moved last, if that proved true of late, or where it is.
//! An expectation decides nothing; it only says which contacts hold as long as the body is not far from it.

use crate::Placement;

/// What is expected of a body, and how far the present frame is from what was expected of it.
pub(super) struct Forecast {
    /// Carried on from the last two frames.
    carried: Placement,
    /// The body's place in the next frame.
    expected: Placement,
    /// What was expected to be its place in the present frame.
    foreseen: Placement,
    /// No vertex is further than this from where it was expected.
    deviation: f64,
}

impl Forecast {
    /// Of a body that has not moved yet.
    pub(super) fn new(placement: Placement) -> Self {
        Self {
            carried: placement,
            expected: placement,
            foreseen: placement,
            deviation: f64::INFINITY,
        }
    }

    /// The body goes from one place to another. `apart` bounds how far any vertex is from itself in two placements.
    pub(super) fn settle(
        &mut self,
        old: &Placement,
        new: &Placement,
        apart: impl Fn(&Placement, &Placement) -> f64,
    ) {
        let apart = |one: &Placement, two: &Placement| if one == two { 0.0 } else { apart(one, two) };
        let goes_on = apart(&self.carried, new) < apart(old, new);
        self.foreseen = self.expected;
        self.deviation = apart(&self.foreseen, new);
        self.carried = match old.inverse().and_then(|back| back.then(new)) {
            Ok(step) if old != new => new.then(&step).unwrap_or(*new),
            _ => *new,
        };
        self.expected = if goes_on { self.carried } else { *new };
    }

    /// The place in the next frame.
    pub(super) fn expected(&self) -> &Placement {
        &self.expected
    }

    /// What was expected to be the place in the present frame, and how far no vertex is from there.
    pub(super) fn foreseen(&self) -> (&Placement, f64) {
        (&self.foreseen, self.deviation)
    }
}

#[cfg(test)]
mod tests {
    use super::Forecast;
    use crate::Placement;

    fn apart(one: &Placement, two: &Placement) -> f64 {
        let corner = [1.0, 2.0, 3.0];
        let (p, q) = (one.apply(corner), two.apply(corner));
        (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt()
    }

    #[test]
    fn steady_motion_is_foreseen_and_a_turn_back_is_not() {
        let step = Placement::from_axis_angle([1.0, 1.0, 0.0], 0.1)
            .and_then(|turn| turn.moved([0.3, 0.0, -0.1]))
            .unwrap();
        let mut at = Placement::IDENTITY;
        let mut forecast = Forecast::new(at);
        let mut seen = Vec::new();
        for frame in 0..8 {
            let step = if frame < 5 { step } else { step.inverse().unwrap() };
            let next = at.then(&step).unwrap();
            forecast.settle(&at, &next, apart);
            seen.push(forecast.foreseen().1 / apart(&at, &next));
            at = next;
        }
        // nothing is known of the first two frames; the third proves that the body goes on
        assert!(seen[0] == 1.0 && seen[1] == 1.0, "{seen:?}");
        assert!(seen[2] == 1.0 || seen[2] < 1e-12, "{seen:?}");
        assert!(seen[3..5].iter().all(|&off| off < 1e-12), "{seen:?}");
        // it turns back, is not trusted for a frame, and goes on again
        assert!(seen[5] > 1.5 && seen[6] == 1.0 && seen[7] < 1e-12, "{seen:?}");
    }
}
