//! Whether the report of a motion is true: the frames are read again, and every pair is asked about again.

use std::collections::BTreeSet;

use anyhow::Context;
use satisfice::Completeness;
use satisfice_catalogue::Mismatch;
use satisfice_collision::continuous::{FeatureOf, MovingContact};

use super::super::pairs::Side;
use super::super::report::Head;
use super::TOLERANCE;
use super::frames::Frames;
use super::report::{ImpactLine, ImpactLists};

/// Candidates are decided in a fraction of a microsecond, so that counting all pairs of so many takes seconds.
const MOST_TO_COUNT: u64 = 20_000_000;

/// Whether the report is one of a motion.
pub(in super::super) fn is_of_motion(head: &Head) -> bool {
    head.problem_parameters.get("from").is_some()
}

/// What is not true of a report, and how many pairs it lists.
pub(in super::super) fn verify(text: &[u8], head: &Head) -> anyhow::Result<(Vec<Mismatch>, u64)> {
    let lists: ImpactLists =
        serde_json::from_slice(text).context("the report is not one of `collide --from --to --json`")?;
    let frames =
        Frames::of_settings(&head.problem_parameters).context("the motion of the report cannot be built")?;
    let mut wrong = Vec::new();
    let listed = lists.pairs.len() as u64;
    if head.hits != listed {
        wrong.push(Mismatch::new(
            "hits",
            head.hits,
            format!("{listed}, the number of pairs"),
        ));
    }
    let mut seen = BTreeSet::new();
    for (index, line) in lists.pairs.iter().enumerate() {
        let place = format!("pairs[{index}]");
        if let Some(expected) = mistake(line, &frames)? {
            wrong.push(Mismatch::new(place, name(line), expected));
        } else if !seen.insert((line.kind.clone(), contact(line))) {
            wrong.push(Mismatch::new(
                place,
                name(line),
                "a pair that is not listed before",
            ));
        }
    }
    let touching: BTreeSet<_> = lists
        .pairs
        .iter()
        .map(|line| [line.a.body.min(line.b.body), line.a.body.max(line.b.body)])
        .collect();
    if lists.touching != touching {
        wrong.push(Mismatch::new("touching", "other bodies", "those of the pairs"));
    }
    wrong.extend(count(head, &frames)?);
    wrong.extend(first(head, &lists, &frames)?);
    Ok((wrong, head.hits))
}

fn name(line: &ImpactLine) -> String {
    let ImpactLine { kind, a, b, .. } = line;
    format!(
        "{kind}: {} of body {} and {} of body {}",
        a.feature, a.body, b.feature, b.body
    )
}

fn contact(line: &ImpactLine) -> MovingContact {
    let side = |side: &Side| FeatureOf {
        body: u32::try_from(side.body).unwrap_or(u32::MAX),
        index: side.feature,
    };
    MovingContact {
        a: side(&line.a),
        b: side(&line.b),
    }
}

/// What a line should be instead.
fn mistake(line: &ImpactLine, frames: &Frames) -> anyhow::Result<Option<String>> {
    let Some(kind) = frames.kinds.iter().find(|kind| kind.name() == line.kind) else {
        return Ok(Some("a kind of pairs that was asked for".to_owned()));
    };
    let impact = frames
        .step
        .impact_of(*kind, &contact(line), frames.separation, TOLERANCE)?;
    let Some(impact) = impact else {
        return Ok(Some("a pair that comes near during the step".to_owned()));
    };
    let [low, high] = impact.time;
    // Both are bounds of one time.
    let agrees = |given: [f64; 2]| given[0] <= high && low <= given[1] && given[1] - given[0] <= TOLERANCE;
    Ok(line
        .time
        .filter(|given| !agrees(*given))
        .map(|_| format!("an impact between {low} and {high}")))
}

fn count(head: &Head, frames: &Frames) -> anyhow::Result<Option<Mismatch>> {
    if head.reference_hits.is_none() || frames.request.first || head.evaluations > MOST_TO_COUNT {
        return Ok(None);
    }
    let mut there_are = 0;
    for &kind in &frames.kinds {
        frames
            .step
            .each_hit(kind, frames.separation, &mut || false, &mut |_| there_are += 1)?;
    }
    if head.reference_hits != Some(there_are) {
        let given = format!("{:?}", head.reference_hits);
        return Ok(Some(Mismatch::new("reference_hits", given, there_are)));
    }
    if head.completeness == Completeness::Proved && head.hits != there_are {
        let expected = format!("Unknown: there are {there_are} pairs");
        return Ok(Some(Mismatch::new("completeness", "Proved", expected)));
    }
    Ok(None)
}

fn first(head: &Head, lists: &ImpactLists, frames: &Frames) -> anyhow::Result<Option<Mismatch>> {
    let Some(given) = lists.first_impact else {
        return Ok(None);
    };
    if head.evaluations > MOST_TO_COUNT {
        return Ok(None);
    }
    let earliest = frames
        .step
        .earliest_among(&frames.kinds, frames.separation, TOLERANCE, &mut || false)?;
    let [low, high] = earliest.time;
    let is_bounded = given.time[0] <= high && low <= given.time[1];
    let is_final = !given.proved || given.time[1] - given.time[0] <= TOLERANCE;
    Ok((!is_bounded || !is_final).then(|| {
        Mismatch::new(
            "first_impact",
            format!("{:?}", given.time),
            format!("between {low} and {high}"),
        )
    }))
}
