//! Who decides a query: floating point where it proves the answer, integers where it does not.

use super::advance::{Goal, Reached, advance};
use super::deadline::{CutShort, Deadline};
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
    /// Whether the deadline came first, so that nothing is known.
    pub(super) is_cut_short: bool,
}

impl Solved {
    fn new(time: Option<[f64; 2]>, by: DecidedBy) -> Self {
        Self {
            time,
            by,
            is_cut_short: false,
        }
    }
}

/// Whether and when a hull comes near the origin.
#[inline]
pub(super) fn solve<H: Hull<K>, const K: usize, const M: usize, const N: usize>(
    motion: &PairMotion<M, N>,
    delta: f64,
    goal: Goal<'_>,
) -> Solved {
    let reached = match Swept::<K>::new(motion, delta) {
        Some(swept) => advance::<H, K>(&swept, goal),
        None if motion.coordinates().all(f64::is_finite) => Reached::nothing(goal),
        None => {
            return Solved::new(None, DecidedBy::NotFinite);
        }
    };
    if reached.is_decided {
        return Solved::new(reached.hit.map(|hit| [reached.free, hit]), DecidedBy::Filter);
    }
    by_conditions::<H, K, M, N>(motion, delta, goal, reached).unwrap_or(Solved {
        time: None,
        by: DecidedBy::Exact,
        is_cut_short: true,
    })
}

#[cold]
fn by_conditions<H: Hull<K>, const K: usize, const M: usize, const N: usize>(
    motion: &PairMotion<M, N>,
    delta: f64,
    goal: Goal<'_>,
    reached: Reached,
) -> Result<Solved, CutShort> {
    let deadline = goal.deadline;
    let end = reached.hit.unwrap_or(goal.until);
    let part = Interval::around(reached.free, end, SHIFT);
    if goal.tolerance.is_infinite() {
        let (is_hit, by) = exact::is_hit(motion, delta, H::PARTS, part, deadline)?;
        let time = is_hit.then(|| [reached.free, part.end()]);
        return Ok(Solved::new(time, by));
    }
    if reached.free == 0.0 {
        let (is_hit, by) = exact::is_hit(&motion.at_rest(), delta, H::PARTS, Interval::WHOLE, deadline)?;
        if is_hit {
            return Ok(Solved::new(Some([0.0, 0.0]), by));
        }
    }
    let length = part.end() - part.start();
    let levels = (length / goal.tolerance)
        .log2()
        .ceil()
        .clamp(0.0, f64::from(FINEST - SHIFT)) as u32;
    let (piece, by) = exact::earliest(motion, delta, H::PARTS, part, levels, deadline)?;
    let Some(piece) = piece else {
        return Ok(Solved::new(None, by));
    };
    // Exact: short binary fractions.
    let unit = length / (1_u64 << levels) as f64;
    let from = part.start() + piece as f64 * unit;
    let low = from.max(reached.free);
    let time = if low == 0.0 {
        soon::<H, K, M, N>(motion, delta, from + unit, deadline)?
    } else {
        [low, from + unit]
    };
    Ok(Solved::new(Some(time), by))
}

#[cold]
fn soon<H: Hull<K>, const K: usize, const M: usize, const N: usize>(
    motion: &PairMotion<M, N>,
    delta: f64,
    end: f64,
    deadline: Deadline<'_>,
) -> Result<[f64; 2], CutShort> {
    let is_hit = |shift: u32| {
        let part = Interval {
            from: 0,
            to: 1,
            shift,
        };
        exact::is_hit(motion, delta, H::PARTS, part, deadline).map(|(is_hit, _)| is_hit)
    };
    let time = |shift: u32| 0.5_f64.powi(shift as i32);
    if is_hit(LATEST)? {
        return Ok([0.0, time(LATEST)]);
    }
    let (mut hit, mut free) = ((-end.log2()).floor().max(0.0) as u32, LATEST);
    while free - hit > 1 {
        let middle = hit + (free - hit) / 2;
        if is_hit(middle)? {
            hit = middle;
        } else {
            free = middle;
        }
    }
    Ok([time(free), time(hit)])
}
