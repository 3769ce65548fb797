//! Who decides a query: floating point where it proves the answer, integers where it does not.

use super::advance::{Goal, Reached, advance};
use super::exact;
use super::hull::Hull;
use super::integers::Interval;
use super::motion::PairMotion;
use super::swept::Swept;
use crate::distance::DecidedBy;

/// Pieces of the step, as a power of two, at which the part left to integers begins: a rounded start keeps the integers short.
const SHIFT: u32 = 6;
/// The finest piece of the step that an answer names, as a power of two.
const FINEST: u32 = 50;

/// Impacts are told from the start down to this power of a half.
const LATEST: u32 = 1000;

/// The answer to a query.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solved {
    /// Bounds of the first time of a hit, if there is one; for a decision only its presence counts.
    pub(super) time: Option<[f64; 2]>,
    pub(super) by: DecidedBy,
}

/// Whether and when a hull comes near the origin.
#[inline]
pub(super) fn solve<H: Hull<K>, const K: usize, const M: usize, const N: usize>(
    motion: &PairMotion<M, N>,
    delta: f64,
    goal: Goal,
) -> Solved {
    let reached = match Swept::<K>::new(motion, delta) {
        Some(swept) => advance::<H, K>(&swept, goal),
        None if motion.coordinates().all(f64::is_finite) => Reached::nothing(goal),
        None => {
            return Solved {
                time: None,
                by: DecidedBy::NotFinite,
            };
        }
    };
    if reached.is_decided {
        return Solved {
            time: reached.hit.map(|hit| [reached.free, hit]),
            by: DecidedBy::Filter,
        };
    }
    by_conditions::<H, K, M, N>(motion, delta, goal, reached)
}

#[cold]
fn by_conditions<H: Hull<K>, const K: usize, const M: usize, const N: usize>(
    motion: &PairMotion<M, N>,
    delta: f64,
    goal: Goal,
    reached: Reached,
) -> Solved {
    let end = reached.hit.unwrap_or(goal.until);
    let part = Interval::around(reached.free, end, SHIFT);
    if goal.tolerance.is_infinite() {
        let (is_hit, by) = exact::is_hit(motion, delta, H::PARTS, part);
        let time = is_hit.then(|| [reached.free, part.end()]);
        return Solved { time, by };
    }
    if reached.free == 0.0 {
        let (is_hit, by) = exact::is_hit(&motion.at_rest(), delta, H::PARTS, Interval::WHOLE);
        if is_hit {
            let time = Some([0.0, 0.0]);
            return Solved { time, by };
        }
    }
    let length = part.end() - part.start();
    let levels = (length / goal.tolerance)
        .log2()
        .ceil()
        .clamp(0.0, f64::from(FINEST - SHIFT)) as u32;
    let (piece, by) = exact::earliest(motion, delta, H::PARTS, part, levels);
    let time = piece.map(|piece| {
        // Exact: short binary fractions.
        let unit = length / (1_u64 << levels) as f64;
        let from = part.start() + piece as f64 * unit;
        let low = from.max(reached.free);
        if low == 0.0 {
            soon::<H, K, M, N>(motion, delta, from + unit)
        } else {
            [low, from + unit]
        }
    });
    Solved { time, by }
}

#[cold]
fn soon<H: Hull<K>, const K: usize, const M: usize, const N: usize>(
    motion: &PairMotion<M, N>,
    delta: f64,
    end: f64,
) -> [f64; 2] {
    let is_hit = |shift: u32| {
        let part = Interval {
            from: 0,
            to: 1,
            shift,
        };
        exact::is_hit(motion, delta, H::PARTS, part).0
    };
    let time = |shift: u32| 0.5_f64.powi(shift as i32);
    if is_hit(LATEST) {
        return [0.0, time(LATEST)];
    }
    let (mut hit, mut free) = ((-end.log2()).floor().max(0.0) as u32, LATEST);
    while free - hit > 1 {
        let middle = hit + (free - hit) / 2;
        if is_hit(middle) {
            hit = middle;
        } else {
            free = middle;
        }
    }
    [time(free), time(hit)]
}
