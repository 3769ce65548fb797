//! Conservative advancement: from one proved time to the next.
//!
//! At the time reached, a direction from the origin towards the hull proves the hull apart up to the time at which its first
//! corner meets the plane at distance delta (the corners move along lines, so that time is a quotient). For a motion that comes to
//! contact this is Newton's method on the distance from the safe side. Short steps announce a contact, and then a
//! proof of it is tried just beyond. What neither side proves within [`STEPS`] is left to integers.

use super::hull::Hull;
use super::swept::Swept;

/// The most steps of one query.
const STEPS: u32 = 40;
/// Steps shorter than this (of the step of time) make no progress worth having.
const STALL: f64 = 1e-14;
/// A contact is looked for after steps shorter than this.
const SHORT: f64 = 0.05;
/// How far beyond a stalled advance a contact is looked for.
const BEYOND: [f64; 3] = [1e-12, 1e-9, 1e-6];

/// What is known at the end. Times are in `[0, 1]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Reached {
    /// No hit at or before this time (before it, if it is 0).
    pub(super) free: f64,
    /// A hit at or before this time, if there is one proved.
    pub(super) hit: Option<f64>,
    /// Whether everything asked for is proved.
    pub(super) is_decided: bool,
}

/// How far the question goes.
#[derive(Debug, Clone, Copy)]
pub struct Goal {
    /// Only the times up to this one.
    pub(super) until: f64,
    /// How close the two times have to be; infinite if only the decision counts.
    pub(super) tolerance: f64,
}

impl Goal {
    pub(super) const DECISION: Self = Self {
        until: 1.0,
        tolerance: f64::INFINITY,
    };
}

pub(super) fn advance<H: Hull<K>, const K: usize>(swept: &Swept<K>, goal: Goal) -> Reached {
    let mut reached = Reached::NOTHING;
    let mut nearest = H::nearest(&swept.at(0.0));
    if swept.is_near(&nearest) {
        return Reached {
            hit: Some(0.0),
            is_decided: true,
            ..reached
        };
    }
    let mut before = 0.0;
    for _ in 0..STEPS {
        let direction = swept
            .apart_around(nearest.direction, reached.free)
            .or_else(|| swept.apart_around(nearest.point, reached.free));
        let Some((_, next)) = direction else { break };
        let end = reached.hit.unwrap_or(goal.until);
        if next >= end {
            // A hit is never before its proof, so this is the end of a step that is free.
            reached.free = end;
            reached.is_decided = true;
            return reached;
        }
        let step = next - reached.free;
        if step < STALL {
            break;
        }
        (before, reached.free) = (reached.free, next);
        if reached.is_close_enough(goal) {
            return reached.decided();
        }
        if step < SHORT {
            if swept.is_never_flat::<H>(next, end) && reached.hit.is_none() && swept.is_for_touching() {
                reached.free = goal.until;
                return reached.decided();
            }
            reached.look(swept_hit::<H, K>(swept, before, (next + step).min(end)));
            if reached.is_close_enough(goal) {
                return reached.decided();
            }
        }
        nearest = H::nearest(&swept.at(reached.free));
    }
    let end = reached.hit.unwrap_or(goal.until);
    for beyond in BEYOND {
        let time = (reached.free + beyond).min(end);
        let from = (reached.free - beyond).max(0.0);
        reached.look(swept_hit::<H, K>(swept, from, time).or_else(|| swept_hit::<H, K>(swept, before, time)));
        if reached.is_close_enough(goal) {
            return reached.decided();
        }
    }
    reached
}

/// A time by which a hit is proved, if `time` or the way there proves one.
fn swept_hit<H: Hull<K>, const K: usize>(swept: &Swept<K>, from: f64, time: f64) -> Option<f64> {
    let proved = if swept.is_for_touching() {
        swept.crosses::<H>(from, time)
    } else {
        swept.is_near(&H::nearest(&swept.at(time)))
    };
    proved.then_some(time)
}

impl Reached {
    /// Nothing is known.
    pub(super) const NOTHING: Self = Self {
        free: 0.0,
        hit: None,
        is_decided: false,
    };

    fn look(&mut self, hit: Option<f64>) {
        if let Some(time) = hit
            && self.hit.is_none_or(|known| time < known)
        {
            self.hit = Some(time);
        }
    }

    fn is_close_enough(&self, goal: Goal) -> bool {
        self.hit.is_some_and(|hit| hit - self.free <= goal.tolerance)
    }

    fn decided(self) -> Self {
        Self {
            is_decided: true,
            ..self
        }
    }
}
