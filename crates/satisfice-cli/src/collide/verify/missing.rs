//! Whether the pairs of a report are those that it says they are: all, the closest, or one of any two bodies that touch. The
//! [referee](super::referee) finds the pairs again.

use std::collections::BTreeSet;

use satisfice::Completeness;
use satisfice_collision::distance::Threshold;

use super::checks::Checks;
use super::lines::{Measured, couple};
use super::referee::Referee;
use super::{Looked, ROUNDING};
use crate::collide::arguments::Find;
use crate::collide::report::Head;
use crate::collide::scene::{Pair, World};

pub(super) fn check(
    head: &Head,
    world: &World,
    measured: &Measured,
    referee: &Referee<'_>,
    checks: &mut Checks,
) -> Looked {
    let is_answered = head.answer == Completeness::Proved;
    let is_proved = head.completeness == Completeness::Proved;
    let (is_done, looked) = match world.request.find {
        Find::Closest(wanted) if is_answered => (
            closest(wanted, world, measured, referee, checks),
            Looked::ForMissing,
        ),
        Find::Touching if is_answered => (touching(world, measured, referee, checks), Looked::ForMissing),
        _ if is_proved => (all(head, world, referee, checks), Looked::ForMissing),
        _ if head.reference_hits.is_some() => (all(head, world, referee, checks), Looked::Counted),
        _ => return Looked::NoClaim,
    };
    if is_done { looked } else { Looked::TooLong }
}

fn all(head: &Head, world: &World, referee: &Referee<'_>, checks: &mut Checks) -> bool {
    let mut there_are = 0;
    let is_done = referee.each_pair(world.threshold, &mut |_| {
        there_are += 1;
        true
    });
    if is_done {
        let given = head.reference_hits.unwrap_or(there_are);
        checks.equal("reference_hits", &given, &there_are, "the pairs that there are");
        let is_right = head.completeness != Completeness::Proved || head.hits == there_are;
        let hits = head.hits;
        let expected = format!("Unknown: there are {there_are} pairs and {hits} are listed");
        checks.that(is_right, "completeness", head.completeness, expected);
    }
    is_done
}

fn touching(world: &World, measured: &Measured, referee: &Referee<'_>, checks: &mut Checks) -> bool {
    let listed: BTreeSet<_> = measured.pairs.keys().map(couple).collect();
    let mut missing = None;
    let is_done = referee.each_pair(world.threshold, &mut |pair| {
        if !listed.contains(&couple(&pair)) {
            missing = Some(pair);
        }
        false
    });
    is_missing(missing, "a pair of these bodies", checks);
    is_done
}

fn closest(
    wanted: u64,
    world: &World,
    measured: &Measured,
    referee: &Referee<'_>,
    checks: &mut Checks,
) -> bool {
    let listed = measured.pairs.len() as u64;
    checks.that(
        listed <= wanted,
        "pairs",
        listed,
        format!("at most the {wanted} asked for"),
    );
    // Where there are fewer than wanted, they are all.
    let below = match measured.farthest() {
        Some(farthest) if listed >= wanted => Threshold::new(farthest * (1.0 - ROUNDING)),
        _ => Ok(world.threshold),
    };
    // Nothing is closer than 0.
    let Ok(below) = below else { return true };
    let mut missing: Option<Pair> = None;
    let is_done = referee.each_pair(below, &mut |pair| {
        if !measured.pairs.contains_key(&pair) {
            missing = Some(pair);
        }
        true
    });
    is_missing(
        missing,
        "a pair that is closer than one listed, or than the threshold",
        checks,
    );
    is_done
}

fn is_missing(missing: Option<Pair>, what: &str, checks: &mut Checks) {
    if let Some(pair) = missing {
        checks.that(
            false,
            "answer",
            Completeness::Proved,
            format!("Unknown: {pair}, {what}, is not listed"),
        );
    }
}
