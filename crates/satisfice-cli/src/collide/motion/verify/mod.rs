//! Whether the report of a motion is true: the frames are read again, and every pair is asked about again.

mod line;

use std::collections::BTreeSet;

use anyhow::Context;
use satisfice::Completeness;

use super::super::arguments::Find;
use super::super::report::{BodyLine, Head};
use super::super::verify::{Beside, Checks, Looked, check_head, checked};
use super::TOLERANCE;
use super::frames::Frames;
use super::report::ImpactLists;
use crate::progress::Counting;
use crate::verify::Checked;

/// Candidates are decided in a fraction of a microsecond, so that counting all pairs of so many takes seconds.
const MOST_TO_COUNT: u64 = 20_000_000;
/// Pairs asked about between two looks at the progress.
const SHOW_EVERY: usize = 1024;

/// Whether the report is one of a motion.
pub(in super::super) fn is_of_motion(head: &Head) -> bool {
    head.problem_parameters.get("from").is_some()
}

pub(in super::super) fn verify(text: &[u8], head: &Head, counting: &Counting) -> anyhow::Result<Checked> {
    let lists: ImpactLists =
        serde_json::from_slice(text).context("the report is not one of `collide --from --to --json`")?;
    let frames = Frames::of_settings(&head.problem_parameters)
        .context("the motion of the report cannot be built; its files are looked for from this folder")?;
    let mut checks = Checks::default();
    check_lists(head, &lists, &frames, &mut checks);
    let mut seen = BTreeSet::new();
    let mut last = 0.0;
    for (index, line) in lists.pairs.iter().enumerate() {
        if index % SHOW_EVERY == 0 {
            counting.say(format!("looking at pair {index} of {}", lists.pairs.len()));
        }
        let place = format!("pairs[{index}]");
        line::check(line, &place, &frames, &mut checks)?;
        let is_new = seen.insert((&line.kind, line::contact(line)));
        checks.that(is_new, &place, line, "a pair that is not listed before");
        let start = line.time.map_or(f64::INFINITY, |time| time[0]);
        checks.that(
            start >= last,
            format!("{place}.time"),
            line.time,
            "the earliest pair first",
        );
        last = start;
    }
    counting.say("looking for pairs that are not listed".to_owned());
    let looked = count(head, &frames, &mut checks)?;
    let looked_for_first = first(head, &lists, &frames, &mut checks)?;
    let looked = if frames.request.first {
        looked_for_first
    } else {
        looked
    };
    Ok(checked(checks, head.hits, looked))
}

/// The head, and what follows from the lists alone.
fn check_lists(head: &Head, lists: &ImpactLists, frames: &Frames, checks: &mut Checks) {
    let is_proved = head.completeness == Completeness::Proved;
    let is_answered = lists.first_impact.map_or(is_proved, |first| first.proved);
    let listed = lists.pairs.len() as u64;
    let beside = Beside {
        methods: &["exact"],
        find: if frames.request.first {
            Find::First
        } else {
            Find::All
        },
        settings: frames.settings(),
        bodies: frames.bodies.iter().map(BodyLine::new).collect(),
        listed_bodies: &lists.bodies,
        listed,
        measured: lists.pairs.iter().filter(|line| line.time.is_some()).count() as u64,
        answer: if is_answered {
            Completeness::Proved
        } else {
            Completeness::Unknown
        },
    };
    check_head(head, &beside, checks);
    let least = head.reference_hits.unwrap_or(listed).max(listed);
    let expected = format!("at least the {least} pairs that were decided");
    checks.that(
        head.evaluations >= least,
        "evaluations",
        head.evaluations,
        expected,
    );
    let bodies = lists
        .pairs
        .iter()
        .map(|line| [line.a.body.min(line.b.body), line.a.body.max(line.b.body)]);
    let touching: BTreeSet<_> = bodies.collect();
    checks.that(
        lists.touching == touching,
        "touching",
        &lists.touching,
        "those of the pairs",
    );
}

fn count(head: &Head, frames: &Frames, checks: &mut Checks) -> anyhow::Result<Looked> {
    let is_proved = head.completeness == Completeness::Proved;
    if frames.request.first || !(is_proved || head.reference_hits.is_some()) {
        return Ok(Looked::NoClaim);
    }
    if head.evaluations > MOST_TO_COUNT {
        return Ok(Looked::TooLong);
    }
    let mut there_are = 0;
    for &kind in &frames.kinds {
        frames
            .step
            .each_hit(kind, frames.separation, &mut || false, &mut |_| there_are += 1)?;
    }
    let given = head.reference_hits.unwrap_or(there_are);
    checks.equal("reference_hits", &given, &there_are, "the pairs that there are");
    let expected = format!("Unknown: there are {there_are} pairs");
    let is_right = !is_proved || head.hits == there_are;
    checks.that(is_right, "completeness", head.completeness, expected);
    Ok(if is_proved {
        Looked::ForMissing
    } else {
        Looked::Counted
    })
}

fn first(head: &Head, lists: &ImpactLists, frames: &Frames, checks: &mut Checks) -> anyhow::Result<Looked> {
    let is_known =
        frames.request.first || (head.completeness == Completeness::Proved && head.unmeasured == 0);
    let Some(given) = lists.first_impact else {
        checks.that(
            !is_known,
            "first_impact",
            lists.first_impact,
            "the first impact, which is known",
        );
        return Ok(Looked::NoClaim);
    };
    let times = frames.request.ends.times();
    let seconds = times.map(|times| given.time.map(|part| times.at(part)));
    let agrees = match (given.seconds, seconds) {
        (Some(given), Some(is)) => (0..2).all(|end| (given[end] - is[end]).abs() <= 1e-9 * is[end].abs()),
        (given, is) => given.is_none() && is.is_none(),
    };
    checks.that(
        agrees,
        "first_impact.seconds",
        given.seconds,
        "its time in the animations",
    );
    if head.evaluations > MOST_TO_COUNT {
        return Ok(Looked::TooLong);
    }
    let there_is = first_of_all(frames)?;
    let [low, high] = there_is.unwrap_or([1.0, 1.0]);
    let is_bounded = given.time[0] <= high && low <= given.time[1];
    let is_final = !given.proved || (0.0..=TOLERANCE).contains(&(given.time[1] - given.time[0]));
    let is_found = !given.proved || lists.pairs.is_empty() == there_is.is_none();
    let expected = there_is.map_or("none".to_owned(), |_| format!("between {low} and {high}"));
    checks.that(
        is_bounded && is_final && is_found,
        "first_impact",
        given.time,
        expected,
    );
    Ok(if given.proved {
        Looked::ForMissing
    } else {
        Looked::NoClaim
    })
}

/// Bounds of the first impact, by asking about every pair of the step instead of looking for the first one; `None` if there is none.
fn first_of_all(frames: &Frames) -> anyhow::Result<Option<[f64; 2]>> {
    let mut first: Option<[f64; 2]> = None;
    for &kind in &frames.kinds {
        let mut hits = Vec::new();
        frames
            .step
            .each_hit(kind, frames.separation, &mut || false, &mut |hit| hits.push(hit))?;
        for hit in &hits {
            if let Some(impact) = frames.step.impact_of(kind, hit, frames.separation, TOLERANCE)? {
                let known = first.unwrap_or(impact.time);
                first = Some([known[0].min(impact.time[0]), known[1].min(impact.time[1])]);
            }
        }
    }
    Ok(first)
}
