//! Whether a report of `collide --json` is true: its scene is read again, and its pairs are measured again.

use std::collections::BTreeSet;

use anyhow::Context;
use satisfice::Completeness;
use satisfice_catalogue::Mismatch;
use satisfice_catalogue::report::recall;
use serde::Deserialize;

use super::motion;
use super::overlaps;
use super::pairs::Line;
use super::report::{Head, ReadLists};
use super::scene::{Pair, World};

/// Two measurements of one distance may differ by this part of the threshold.
const ROUNDING: f64 = 1e-9;

/// What is not true of a report, and how many pairs it lists.
pub(crate) fn verify(text: &[u8]) -> anyhow::Result<(Vec<Mismatch>, u64)> {
    let wrong = "the report is not one of `collide --json`";
    let head: Head = serde_json::from_slice(text).context(wrong)?;
    if motion::is_of_motion(&head) {
        return motion::verify(text, &head);
    }
    let lists: ReadLists = serde_json::from_slice(text).context(wrong)?;
    let world =
        World::of_settings(&head.problem_parameters).context("the scene of the report cannot be built")?;
    let mut mismatches = counts(&head, &lists);
    mismatches.extend(pairs(&lists, &world)?);
    mismatches.extend(overlaps(&head, &lists, &world));
    mismatches.extend(best(&head, &world)?);
    mismatches.extend(reference(&head, &world)?);
    Ok((mismatches, head.hits))
}

/// The counts against the lists.
fn counts(head: &Head, lists: &ReadLists) -> Vec<Mismatch> {
    let mut wrong = Vec::new();
    let listed = lists.pairs.len() as u64;
    if head.hits != listed {
        wrong.push(Mismatch::new(
            "hits",
            head.hits,
            format!("{listed}, the number of pairs"),
        ));
    }
    let unmeasured = lists.pairs.iter().filter(|pair| pair.distance.is_none()).count() as u64;
    if head.unmeasured != unmeasured {
        let expected = format!("{unmeasured}, the pairs without a distance");
        wrong.push(Mismatch::new("unmeasured", head.unmeasured, expected));
    }
    for (place, seconds) in [
        ("elapsed_seconds", head.elapsed_seconds),
        ("overshoot_seconds", head.overshoot_seconds),
    ] {
        if seconds < 0.0 {
            wrong.push(Mismatch::new(place, seconds, "no negative time"));
        }
    }
    let is_proved = head.completeness == Completeness::Proved;
    if is_proved && head.unseen_estimate != Some(0.0) {
        let found = format!("{:?}", head.unseen_estimate);
        wrong.push(Mismatch::new(
            "unseen_estimate",
            found,
            "0, since completeness is proved",
        ));
    }
    if is_proved && head.answer != Completeness::Proved {
        let expected = "Proved, since completeness is";
        wrong.push(Mismatch::new("answer", format!("{:?}", head.answer), expected));
    }
    let overlapping = lists.overlaps.iter().map(|overlap| [overlap.a, overlap.b]);
    let near = lists
        .pairs
        .iter()
        .filter(|_| head.threshold.is_finite())
        .map(bodies);
    let touching: BTreeSet<_> = near.chain(overlapping).collect();
    if lists.touching != touching {
        wrong.push(Mismatch::new(
            "touching",
            "other bodies",
            "those of the pairs, if there is a threshold, and of the overlaps",
        ));
    }
    wrong
}

fn bodies(line: &Line) -> [usize; 2] {
    [line.a.body.min(line.b.body), line.a.body.max(line.b.body)]
}

/// Every pair must be one of the scene, listed once, within the threshold, and at the distance that it has.
fn pairs(lists: &ReadLists, world: &World) -> anyhow::Result<Vec<Mismatch>> {
    let threshold = world.request.threshold;
    let mut wrong = Vec::new();
    let mut seen = BTreeSet::new();
    for (index, line) in lists.pairs.iter().enumerate() {
        let place = format!("pairs[{index}]");
        let pair = line.pair();
        if !world.has(&pair)? {
            wrong.push(Mismatch::new(
                place,
                format!("{pair}"),
                "a pair of features of this scene, the lesser first",
            ));
            continue;
        }
        if !seen.insert(pair) {
            wrong.push(Mismatch::new(
                place,
                format!("{pair}"),
                "a pair that is not listed before",
            ));
            continue;
        }
        let distance = world.fitness(&pair)?;
        let is_pair = distance < threshold; // never true of NaN
        let scale = if threshold.is_finite() {
            threshold
        } else {
            distance
        };
        let agrees = |given: f64| (given - distance).abs() <= ROUNDING * scale;
        if !is_pair {
            wrong.push(Mismatch::new(
                place,
                format!("{pair}, {distance} apart"),
                format!("less than {threshold}"),
            ));
        } else if line.distance.is_some_and(|given| !agrees(given)) {
            let given = line.distance.unwrap_or_default();
            wrong.push(Mismatch::new(place, format!("the distance {given}"), distance));
        }
    }
    Ok(wrong)
}

/// Bodies that overlap must be those that do, as far as they were looked at.
fn overlaps(head: &Head, lists: &ReadLists, world: &World) -> Option<Mismatch> {
    let is = overlaps::find(&world.solids, &|| false);
    let wrong = lists
        .overlaps
        .iter()
        .find(|given| !is.iter().any(|is| is.agrees(given)));
    let is_short = head.completeness == Completeness::Proved && is.len() != lists.overlaps.len();
    (wrong.is_some() || is_short).then(|| {
        let given = wrong.map_or_else(
            || format!("{} of them", lists.overlaps.len()),
            |wrong| format!("{wrong:?}"),
        );
        let all: Vec<String> = is.iter().map(|overlap| overlap.text(&world.bodies)).collect();
        Mismatch::new(
            "overlaps",
            given,
            format!("{} of them: {}", all.len(), all.join("; ")),
        )
    })
}

/// The closest pair that an engine saw must be as far apart as the report says.
fn best(head: &Head, world: &World) -> anyhow::Result<Option<Mismatch>> {
    let Some(best) = &head.best else {
        return Ok(None);
    };
    let pair = Pair::deserialize(&best.solution).ok();
    let Some(pair) = pair.filter(|pair| world.has(pair).is_ok_and(|has| has)) else {
        let expected = "a pair of features of this scene, the lesser first";
        return Ok(Some(Mismatch::new("best.solution", &best.solution, expected)));
    };
    let distance = world.fitness(&pair)?;
    let agrees = (best.fitness - distance).abs() <= ROUNDING * head.threshold.max(distance.abs());
    Ok((!agrees).then(|| Mismatch::new("best.fitness", best.fitness, distance)))
}

/// The number of pairs that there are, where counting them takes a few seconds.
fn reference(head: &Head, world: &World) -> anyhow::Result<Vec<Mismatch>> {
    let mut wrong = Vec::new();
    let there_are = match world.is_small() {
        true => Some(world.reference_hits()?),
        false => head.reference_hits,
    };
    if let (Some(given), Some(there_are)) = (head.reference_hits, there_are)
        && given != there_are
    {
        wrong.push(Mismatch::new("reference_hits", given, there_are));
    }
    let expected = head.reference_hits.and_then(|all| recall(head.hits, all));
    if head.recall != expected {
        wrong.push(Mismatch::new(
            "recall",
            format!("{:?}", head.recall),
            format!("{expected:?}"),
        ));
    }
    if let Some(there_are) = there_are
        && (head.hits > there_are || (head.completeness == Completeness::Proved && head.hits < there_are))
    {
        let expected = format!(
            "Unknown: there are {there_are} pairs and {} are listed",
            head.hits
        );
        wrong.push(Mismatch::new(
            "completeness",
            format!("{:?}", head.completeness),
            expected,
        ));
    }
    Ok(wrong)
}
