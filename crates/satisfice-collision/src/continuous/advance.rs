//! Conservative advancement: from one proved time to the next.
//!
//! At the time reached, a direction from the origin towards the hull proves the hull apart up to the time at which its first
//! corner meets the plane at distance delta (the corners move along lines, so that time is a quotient). For a motion that comes to
//! contact this is Newton's method on the distance from the safe side. Short steps announce a contact, and then a
//! proof of it is tried just beyond; touching is also proved by the root of a volume. What neither side proves
//! within [`STEPS`] is left to integers.

use super::deadline::Deadline;
use super::hull::Hull;
use super::swept::Swept;
use crate::Error;

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
    /// No hit from the start of the question to this time, which included if it is later.
    pub(super) free: f64,
    /// A hit at or before this time, if there is one proved.
    pub(super) hit: Option<f64>,
    /// Whether everything asked for is proved.
    pub(super) is_decided: bool,
}

/// What is asked.
#[derive(Clone, Copy)]
pub struct Goal<'s> {
    /// Only times from this one on, before which there is no hit.
    pub(super) from: f64,
    /// Only times up to this one.
    pub(super) until: f64,
    /// How close the two bounds of the time have to be; infinite if only the decision counts.
    pub(super) tolerance: f64,
    /// How long a decision may take.
    pub(super) deadline: Deadline<'s>,
}

impl Goal<'_> {
    /// Only whether there is a hit.
    pub(super) const DECISION: Self = Self {
        from: 0.0,
        until: 1.0,
        tolerance: f64::INFINITY,
        deadline: Deadline::NONE,
    };

    /// A tolerance that a user asks for.
    pub(super) fn checked(tolerance: f64) -> Result<f64, Error> {
        if tolerance.is_nan() || tolerance < 1e-12 {
            return Err(Error::parameter(
                "tolerance",
                tolerance,
                "a part of the step, at least 1e-12",
            ));
        }
        Ok(tolerance.min(1.0))
    }
}

pub(super) fn advance<H: Hull<K>, const K: usize>(swept: &Swept<K>, goal: Goal<'_>) -> Reached {
    let mut reached = Reached::nothing(goal);
    let mut nearest = H::nearest(&swept.at(goal.from));
    if swept.is_near(&nearest) {
        reached.hit = Some(goal.from);
        return reached.decided();
    }
    let touching = swept.is_for_touching();
    for number in 0..STEPS {
        let direction = swept
            .apart_around(nearest.direction, reached.free)
            .or_else(|| swept.apart_around(nearest.point, reached.free));
        let Some((_, next)) = direction else { break };
        let end = reached.hit.unwrap_or(goal.until);
        if next >= end {
            reached.free = end;
            return reached.decided();
        }
        let step = next - reached.free;
        reached.free = next;
        if reached.is_close_enough(goal) {
            return reached.decided();
        }
        if step < STALL {
            break;
        }
        if touching && (number == 0 || step < SHORT) && swept.is_never_flat::<H>(next, end) {
            reached.free = end;
            return reached.decided();
        }
        if touching && number == 0 {
            reached.look(swept.crossing::<H>(next, end));
        } else if !touching && step < SHORT {
            let time = (next + step).min(end);
            reached.look(swept.is_near(&H::nearest(&swept.at(time))).then_some(time));
        }
        if reached.is_close_enough(goal) {
            return reached.decided();
        }
        nearest = H::nearest(&swept.at(reached.free));
    }
    let end = reached.hit.unwrap_or(goal.until);
    if touching {
        let from = (reached.free - 1e-3).max(goal.from);
        reached.look(swept.crossing::<H>(from, end));
    } else {
        for beyond in BEYOND {
            let time = (reached.free + beyond).min(end);
            reached.look(swept.is_near(&H::nearest(&swept.at(time))).then_some(time));
        }
    }
    if reached.is_close_enough(goal) {
        return reached.decided();
    }
    reached
}

/// A time up to which one step proves the hull free, if it is free up to `from`; at least that.
#[inline(always)]
pub(super) fn free_until<H: Hull<K>, const K: usize>(swept: &Swept<K>, from: f64) -> f64 {
    let nearest = H::nearest(&swept.at(from));
    swept
        .apart_around(nearest.direction, from)
        .or_else(|| swept.apart_around(nearest.point, from))
        .map_or(from, |(_, next)| next)
}

impl Reached {
    /// Nothing is known.
    pub(super) fn nothing(goal: Goal<'_>) -> Self {
        Self {
            free: goal.from,
            hit: None,
            is_decided: false,
        }
    }

    fn look(&mut self, hit: Option<f64>) {
        if let Some(time) = hit
            && self.hit.is_none_or(|known| time < known)
        {
            self.hit = Some(time);
        }
    }

    fn is_close_enough(&self, goal: Goal<'_>) -> bool {
        let is_after_start = self.free > 0.0 || goal.tolerance.is_infinite();
        self.hit
            .is_some_and(|hit| hit - self.free <= goal.tolerance && is_after_start)
    }

    fn decided(self) -> Self {
        Self {
            is_decided: true,
            ..self
        }
    }
}
