//! The questions about one pair.

use super::Separation;
use super::advance::Goal;
use super::deadline::CutShort;
use super::motion::Moving;
use super::pairs::Against;
use crate::Error;
use crate::distance::{DecidedBy, Decision, Point, Threshold};

/// Whether a pair hits during a step, and who decided it.
pub type Decided = Decision;

/// The first time at which a pair comes nearer than delta (touches, for a delta of 0), and where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impact {
    /// A lower and an upper bound of the infimum of the times of a hit, both proved, in `[0, 1]`. The lower one is above 0 unless the
    /// infimum is below 2^-1000.
    pub time: [f64; 2],
    /// Whether the pair is a hit at time 0 already; `time` is then `[0, 0]`.
    pub at_start: bool,
    /// The point of the first feature closest to the second at the time `time[1]`, rounded.
    pub point_a: Point,
    /// The closest point of the second feature.
    pub point_b: Point,
    /// A vector of length 1 from the first feature towards the second, at about the time of impact; 0 if the features leave it
    /// open, as where they are at rest on each other.
    pub normal: Point,
    /// Who proved it.
    pub by: DecidedBy,
}

/// Whether the pair hits at some time of the step: whether the distance is below delta, or 0 for a delta of 0. Also
/// says who decided it. A pair with a coordinate that is not finite is never a hit.
///
/// Cost: about 100 ns; where rounding decides nothing, a hundred microseconds for a delta of 0 and milliseconds for one above.
#[inline]
pub fn decide<A: Against<B>, B: Copy>(a: &Moving<A>, b: &Moving<B>, separation: Separation) -> Decided {
    let solved = A::solve(a, b, separation.get(), Goal::DECISION);
    Decision {
        within: solved.time.is_some(),
        by: solved.by,
    }
}

/// The same for a part of the step.
#[inline]
pub(super) fn decide_during<A: Against<B>, B: Copy>(
    a: &Moving<A>,
    b: &Moving<B>,
    separation: Separation,
    goal: Goal<'_>,
) -> Result<Decided, CutShort> {
    let solved = A::solve(a, b, separation.get(), goal);
    if solved.is_cut_short {
        return Err(CutShort);
    }
    Ok(Decision {
        within: solved.time.is_some(),
        by: solved.by,
    })
}

/// Whether the distance is below delta at some time of the step.
///
/// ```
/// use satisfice_collision::continuous::{Moving, is_hit};
/// use satisfice_collision::distance::Threshold;
/// let flying = Moving::new([-5.0, 0.0, 1.0], [5.0, 0.0, 1.0]);
/// let wire = Moving::at_rest([[0.0, -1.0, 0.0], [0.0, 1.0, 0.0]]);
/// assert!(!is_hit(&flying, &wire, Threshold::new(1.0)?));
/// assert!(is_hit(&flying, &wire, Threshold::new(1.0_f64.next_up())?));
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
#[inline]
pub fn is_hit<A: Against<B>, B: Copy>(a: &Moving<A>, b: &Moving<B>, threshold: Threshold) -> bool {
    decide(a, b, threshold.into()).within
}

/// Whether the distance is 0 at some time of the step.
///
/// ```
/// use satisfice_collision::continuous::{Moving, touches};
/// let still = Moving::at_rest([[0.0, -1.0, 0.0], [0.0, 1.0, 0.0]]);
/// let up = Moving::new([[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0]], [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]);
/// assert!(touches(&up, &still));
/// ```
#[inline]
pub fn touches<A: Against<B>, B: Copy>(a: &Moving<A>, b: &Moving<B>) -> bool {
    decide(a, b, Separation::TOUCHING).within
}

/// The first time of a hit within `tolerance` (a part of the step; at least 1e-12), or `None` if there is none.
///
/// ```
/// use satisfice_collision::continuous::{Moving, Separation, impact};
/// let falling = Moving::new([0.0, 0.0, 2.0], [0.0, 0.0, -2.0]);
/// let at_rest = Moving::at_rest([0.0; 3]);
/// let impact = impact(&falling, &at_rest, Separation::new(1.0)?, 1e-9)?.expect("they meet");
/// assert!(impact.time[0] <= 0.25 && 0.25 <= impact.time[1] && impact.time[1] - impact.time[0] <= 1e-9);
/// assert!(impact.normal[2] < -0.999_999, "from the falling point down to the one at rest");
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
///
/// # Errors
/// [`Error::Parameter`] for a tolerance that is not a number of at least 1e-12.
pub fn impact<A: Against<B>, B: Copy>(
    a: &Moving<A>,
    b: &Moving<B>,
    separation: Separation,
    tolerance: f64,
) -> Result<Option<Impact>, Error> {
    let goal = Goal {
        tolerance: Goal::checked(tolerance)?,
        ..Goal::DECISION
    };
    // nothing cuts it short
    Ok(within(a, b, separation, goal).unwrap_or_default())
}

/// A time up to which one step of the advance proves the pair free, if it is free up to `from`; at least that.
#[inline]
pub(super) fn free_until<A: Against<B>, B: Copy>(
    a: &Moving<A>,
    b: &Moving<B>,
    separation: Separation,
    from: f64,
) -> f64 {
    A::free_until(a, b, separation.get(), from)
}

/// The first hit up to a time.
pub(super) fn within<A: Against<B>, B: Copy>(
    a: &Moving<A>,
    b: &Moving<B>,
    separation: Separation,
    goal: Goal<'_>,
) -> Result<Option<Impact>, CutShort> {
    let solved = A::solve(a, b, separation.get(), goal);
    if solved.is_cut_short {
        return Err(CutShort);
    }
    let Some(time) = solved.time else {
        return Ok(None);
    };
    let at = |time: f64| A::between(a, time).proximity(&A::other_between(b, time));
    let near = at(time[1]);
    // Before the impact, when the features are not on the wrong sides of each other; they coincide up to rounding just before.
    let before = [0.0, 1e-6, 1e-4, 1e-2].map(|earlier| (time[0] - earlier).max(0.0));
    let normal = before.into_iter().chain([time[1]]).find_map(|time| {
        let near = at(time);
        // Where they meet, the points differ by their rounding only.
        (near.distance > 0.0)
            .then(|| unit(near.point_a, near.point_b))
            .flatten()
    });
    Ok(Some(Impact {
        time,
        at_start: time[1] == 0.0,
        point_a: near.point_a,
        point_b: near.point_b,
        normal: normal.unwrap_or_default(),
        by: solved.by,
    }))
}

/// The direction from `p` to `q`, or `None` if they are the same up to rounding.
fn unit(p: Point, q: Point) -> Option<Point> {
    let d: Point = std::array::from_fn(|k| q[k] - p[k]);
    let scale = (0..3).fold(0.0_f64, |most, k| most.max(p[k].abs()).max(q[k].abs()));
    let length = (0..3).map(|k| (d[k] / scale).powi(2)).sum::<f64>().sqrt();
    (length > 1e-12).then(|| d.map(|x| x / scale / length))
}
