//! Whether a report of `collide --json` is true: its scene is read again, and its pairs are measured and looked for again.

mod checks;
mod head;
mod lines;
mod missing;
mod referee;
mod solids;
mod sweep;
mod witness;

use std::collections::BTreeSet;

use anyhow::Context;
use satisfice::{Completeness, SatisficingProblem};
use satisfice_collision::broad::Method;
use satisfice_collision::scene::Skips;
use serde::Deserialize;

use super::couples::PairProblem;
use super::exact::METHODS;
use super::motion;
use super::report::{Head, ReadLists};
use super::scene::{Pair, World};
use crate::progress::Counting;
use crate::verify::Checked;
pub(super) use checks::Checks;
pub(super) use head::{Beside, check as check_head};
pub(super) use lines::check_ends;
use lines::{Measured, agree, couple};
use referee::Referee;
pub(super) use witness::{is_on, slack};

/// Two measurements of one distance may differ by this part of it, or of the threshold.
const ROUNDING: f64 = 1e-9;

/// What was done about pairs that are not listed.
#[derive(Debug, Clone, Copy)]
pub(super) enum Looked {
    /// The report says that none that was asked for is missing.
    ForMissing,
    /// The report says how many there are.
    Counted,
    /// The report says neither.
    NoClaim,
    TooLong,
}

pub(super) fn checked(checks: Checks, hits: u64, looked: Looked) -> Checked {
    Checked {
        wrong: checks.wrong(),
        hits,
        others: match looked {
            Looked::ForMissing => "others were looked for, and none is missing",
            Looked::Counted => "all that there are were counted again",
            Looked::NoClaim => "it does not say that there are no others",
            Looked::TooLong => "whether others are missing was not checked, which would take too long",
        },
        unchecked: "times, the end by them, what was skipped, and estimates of pairs not seen",
    }
}

pub(crate) fn verify(text: &[u8], counting: &Counting) -> anyhow::Result<Checked> {
    let wrong = "the report is not one of `collide --json`";
    let head: Head = serde_json::from_slice(text).context(wrong)?;
    if motion::is_of_motion(&head) {
        return motion::verify(text, &head, counting);
    }
    let lists: ReadLists = serde_json::from_slice(text).context(wrong)?;
    let world = World::of_settings(&head.problem_parameters)
        .context("the scene of the report cannot be built; its files are looked for from this folder")?;
    let referee = Referee::new(&world);
    let mut checks = Checks::default();
    check_lists(&head, &lists, &world, &mut checks);
    let measured = lines::check(&head, &lists.pairs, &world, &referee, counting, &mut checks);
    best(&head, &world, &referee, &measured, &mut checks)?;
    counting.say("looking into the bodies".to_owned());
    solids::check(&head, &lists.overlaps, &world, &mut checks)?;
    counting.say("looking for pairs that are not listed".to_owned());
    let looked = missing::check(&head, &world, &measured, &referee, &mut checks);
    Ok(checked(checks, head.hits, looked))
}

/// The head, and what follows from the lists alone.
fn check_lists(head: &Head, lists: &ReadLists, world: &World, checks: &mut Checks) {
    let method = METHODS
        .iter()
        .find(|(name, _)| *name == head.engine)
        .map(|(_, method)| *method);
    let is_proved = head.completeness == Completeness::Proved;
    let listed = lists.pairs.len() as u64;
    let measured = lists.pairs.iter().filter(|pair| pair.distance.is_some()).count() as u64;
    let is_answered = match method {
        Some(_) => world
            .request
            .find
            .is_answered(listed, is_proved, head.stop_reason),
        None => is_proved,
    };
    let beside = Beside {
        methods: &METHODS.map(|(name, _)| name),
        find: world.request.find,
        settings: world.settings(),
        bodies: world.body_lines(),
        listed_bodies: &lists.bodies,
        listed,
        measured,
        answer: if is_answered {
            Completeness::Proved
        } else {
            Completeness::Unknown
        },
    };
    check_head(head, &beside, checks);
    let reasons = Skips::default().by_reason().map(|(reason, _)| reason);
    let unknown = lists
        .skipped
        .iter()
        .find(|(reason, _)| !reasons.contains(&reason.as_str()));
    checks.that(unknown.is_none(), "skipped", unknown, "a known reason");
    // Brute force measures every pair, the other exact methods those that they find.
    let computed = match method {
        Some(Method::BruteForce) if is_proved => {
            let neighbours = lists
                .skipped
                .get("pairs of mesh neighbours")
                .copied()
                .unwrap_or_default();
            Some(world.size().saturating_sub(neighbours))
        }
        method => method.map(|_| measured),
    };
    let computed = computed.unwrap_or(head.evaluations);
    checks.equal(
        "evaluations",
        &head.evaluations,
        &computed,
        "the distances that were computed",
    );
    let overlapping = lists.overlaps.iter().map(|overlap| [overlap.a, overlap.b]);
    let near = lists.pairs.iter().filter(|_| head.threshold.is_finite());
    let near = near.map(|line| couple(&line.pair()));
    let touching: BTreeSet<_> = near.chain(overlapping).collect();
    let expected = "those of the pairs, if there is a threshold, and of the overlaps";
    checks.that(lists.touching == touching, "touching", &lists.touching, expected);
}

/// The closest pair that an engine saw must be as far apart as the report says, and no pair closer. It may be one that counts as none.
fn best(
    head: &Head,
    world: &World,
    referee: &Referee<'_>,
    measured: &Measured,
    checks: &mut Checks,
) -> anyhow::Result<()> {
    let Some(best) = &head.best else {
        return Ok(());
    };
    let pair = Pair::deserialize(&best.solution).ok();
    let Some(pair) = pair.filter(|pair| referee.has(pair)) else {
        let expected = "a pair of features of this scene, the lesser first";
        checks.that(false, "best.solution", &best.solution, expected);
        return Ok(());
    };
    let job = PairProblem::new(world, pair.bodies())?;
    let distance = job.problem.fitness(&(pair.a.feature, pair.b.feature));
    let is_right = agree(best.fitness, distance, head.threshold);
    checks.that(is_right, "best.fitness", best.fitness, distance);
    let least = measured.pairs.values().copied().fold(f64::INFINITY, f64::min);
    let is_least = best.fitness <= least || agree(best.fitness, least, head.threshold);
    let expected = format!("at most {least}, the distance of a listed pair");
    checks.that(is_least, "best.fitness", best.fitness, expected);
    let is_one = (1..=head.evaluations).contains(&best.evaluation);
    let expected = format!("from 1 to {}", head.evaluations);
    checks.that(is_one, "best.evaluation", best.evaluation, expected);
    Ok(())
}
