//! The exact methods: every pair is decided, or excluded by a bound.

use std::time::{Duration, Instant};

use satisfice::{Cancel, StopReason};
use satisfice_catalogue::{RunReport, RunSpec};
use satisfice_collision::broad::Method;
use satisfice_collision::scene::{self, Contact, Frame, Skips};
use serde_json::{Value, json};

use super::PROBLEM;
use super::arguments::Find;
use super::scene::World;
use crate::progress::Counting;

/// The exact methods by their names.
pub(super) const METHODS: [(&str, Method); 4] = [
    ("exact", Method::Auto),
    ("tree", Method::Tree),
    ("grid", Method::Grid),
    ("brute-force", Method::BruteForce),
];

/// How to find.
pub(super) struct Exact<'a> {
    pub(super) name: &'static str,
    pub(super) method: Method,
    pub(super) time: Option<Duration>,
    pub(super) hits: Option<u64>,
    pub(super) threads: usize,
    pub(super) cancel: &'a Cancel,
}

/// What was found.
pub(super) struct Found {
    pub(super) report: RunReport,
    pub(super) skips: Skips,
}

/// Contacts, and why there are no more.
struct Answer {
    contacts: Vec<Contact>,
    skips: Skips,
    stop: StopReason,
    complete: bool,
}

impl Exact<'_> {
    /// Finds on as many threads as are wanted.
    pub(super) fn find(&self, world: &World) -> anyhow::Result<Found> {
        if self.threads == 1 {
            return self.find_in(world, world.scene(self.method)?);
        }
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(self.threads)
            .build()?;
        pool.install(|| self.find_in(world, world.scene(self.method)?.parallel()))
    }

    #[expect(
        clippy::disallowed_methods,
        reason = "a scene is told when to stop; it does not ask the time itself"
    )]
    fn find_in(&self, world: &World, mut scene: scene::World) -> anyhow::Result<Found> {
        let start = Instant::now();
        let counting = Counting::new();
        let answer = self.answer(world, &mut scene, start, &counting)?;
        let searched = start.elapsed();
        counting.say(format!("measuring {} pairs", answer.contacts.len()));
        let mut solutions = Vec::with_capacity(answer.contacts.len());
        for (&contact, pair) in answer.contacts.iter().zip(world.pairs(&answer.contacts)) {
            let distance = distance(&scene, contact, world.request.threshold)?;
            solutions.push((json!(pair), distance));
        }
        let elapsed = start.elapsed();
        let late = self
            .time
            .map_or(Duration::ZERO, |time| searched.saturating_sub(time));
        Ok(Found {
            report: self.report(world, &answer, solutions, (searched, elapsed), late),
            skips: answer.skips,
        })
    }

    fn answer(
        &self,
        world: &World,
        scene: &mut scene::World,
        start: Instant,
        counting: &Counting,
    ) -> anyhow::Result<Answer> {
        let out_of_time = || self.time.is_some_and(|time| start.elapsed() >= time);
        let stop = |found: usize| {
            counting.show(found, start);
            self.cancel.is_cancelled() || out_of_time()
        };
        // `left`: why no more were wanted, where the question is answered by some.
        let answer = |contacts: Vec<Contact>, left: Option<StopReason>, state: scene::Completeness| {
            let proved = state == scene::Completeness::Proved;
            Answer {
                contacts,
                skips: Skips::default(),
                stop: match (proved, left) {
                    (true, None) => StopReason::Covered,
                    (true, Some(reason)) => reason,
                    (false, _) if self.cancel.is_cancelled() => StopReason::Cancelled,
                    (false, _) => StopReason::Time,
                },
                complete: proved && left.is_none(),
            }
        };
        Ok(match world.request.find {
            Find::Touching => {
                let (witnesses, state) = scene.witnesses_until(&stop)?;
                let left = (!witnesses.is_empty()).then_some(StopReason::Exhausted);
                answer(witnesses, left, state)
            }
            Find::First => {
                let (first, state) = scene.first_until(&stop)?;
                let left = first.is_some().then_some(StopReason::Hits);
                answer(first.into_iter().collect(), left, state)
            }
            Find::Closest(k) => {
                let wanted = usize::try_from(k).unwrap_or(usize::MAX);
                let (closest, state) = scene.closest_until(wanted, &stop)?;
                let left = (closest.len() >= wanted).then_some(StopReason::Hits);
                let contacts = closest.into_iter().map(|(contact, _)| contact).collect();
                answer(contacts, left, state)
            }
            Find::All if matches!(self.method, Method::Auto | Method::Tree) => {
                self.pass(scene, start, counting)?
            }
            Find::All => {
                let frame = scene.frame_until(&stop)?;
                Answer {
                    skips: frame.skips,
                    ..answer(frame.contacts, None, frame.completeness)
                }
            }
        })
    }

    /// Piece by piece, so that a limit and Ctrl-C keep what was found.
    fn pass(&self, scene: &mut scene::World, start: Instant, counting: &Counting) -> anyhow::Result<Answer> {
        let wanted = self
            .hits
            .map_or(usize::MAX, |hits| usize::try_from(hits).unwrap_or(usize::MAX));
        let mut stop = StopReason::Covered;
        let mut pass = scene.pass();
        scene.advance(&mut pass, &mut |found| {
            counting.show(found, start);
            if self.cancel.is_cancelled() {
                stop = StopReason::Cancelled;
            } else if found >= wanted {
                stop = StopReason::Hits;
            } else if self.time.is_some_and(|time| start.elapsed() >= time) {
                stop = StopReason::Time;
            }
            stop != StopReason::Covered
        })?;
        let Frame {
            mut contacts,
            completeness,
            skips,
        } = scene.frame_of(&pass);
        let complete = completeness == scene::Completeness::Proved && contacts.len() <= wanted;
        contacts.truncate(wanted);
        Ok(Answer {
            contacts,
            skips,
            stop: if complete { StopReason::Covered } else { stop },
            complete,
        })
    }

    fn report(
        &self,
        world: &World,
        answer: &Answer,
        solutions: Vec<(Value, f64)>,
        (searched, elapsed): (Duration, Duration),
        late: Duration,
    ) -> RunReport {
        let hits = solutions.len() as u64;
        // Brute force measures what there is, the others what they find.
        let measured = if self.method == Method::BruteForce && answer.complete {
            world.size() - answer.skips.mesh_neighbours
        } else {
            hits
        };
        let mut spec = RunSpec::new(self.name);
        spec.problem = PROBLEM.to_owned();
        spec.problem_parameters = world.settings();
        spec.budget.time = self.time;
        spec.budget.hits = self.hits;
        let cost = (measured, searched.as_secs_f64());
        let mut report = RunReport::at_once(spec, world.request.threshold, solutions, cost);
        report.elapsed_seconds = elapsed.as_secs_f64();
        if let Some(end) = report.trace.last_mut() {
            end.elapsed_seconds = report.elapsed_seconds;
        }
        report.overshoot_seconds = late.as_secs_f64();
        report.stop_reason = answer.stop;
        if answer.complete {
            report.set_proved();
            report.set_reference(Some(hits));
        }
        report
    }
}

/// The distance of a contact: within one unit in the last place, and below the threshold, which it is decided to be.
pub(super) fn distance(scene: &scene::World, contact: Contact, threshold: f64) -> anyhow::Result<f64> {
    Ok(scene.proximity(contact)?.distance.min(threshold.next_down()))
}
