//! The search: all pairs that come near during the step, or the earliest impact.

use std::sync::Arc;
use std::time::{Duration, Instant};

use rayon::prelude::*;
use satisfice::{Cancel, StopReason};
use satisfice_collision::continuous::MovingContact;
use satisfice_collision::distance::PairKind;

use super::super::building;
use super::TOLERANCE;
use super::frames::Frames;
use crate::progress::Counting;

/// Times computed between two looks at the clock.
const TIMED_AT_ONCE: usize = 64;

/// How to search.
pub(super) struct Search<'a> {
    /// Bounds the whole answer, times of impact included.
    pub(super) time: Option<Duration>,
    pub(super) hits: Option<u64>,
    /// More pairs are counted, but not listed.
    pub(super) most: usize,
    pub(super) threads: usize,
    pub(super) cancel: &'a Cancel,
}

/// A pair and when it first comes near.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hit {
    /// Its kind by the place in the list of kinds.
    pub(super) kind: u8,
    pub(super) contact: MovingContact,
    /// Bounds of the time of impact; NaN if the time was over before it was computed.
    pub(super) time: [f64; 2],
}

impl Hit {
    pub(super) fn is_timed(&self) -> bool {
        !self.time[0].is_nan()
    }
}

/// The hits.
pub(super) struct Impacts {
    /// The earliest first; pairs whose time is not known come last.
    pub(super) pairs: Vec<Hit>,
    /// How many there are, if that is known.
    pub(super) count: Option<u64>,
    /// Whether all pairs are listed, as was proved.
    pub(super) complete: bool,
    /// Bounds of the first impact of all and whether they are within the tolerance, or no pair hits; where they are known.
    pub(super) first: Option<([f64; 2], bool)>,
    /// Pairs of features that were decided by their motion.
    pub(super) queries: u64,
    pub(super) stop: StopReason,
    pub(super) elapsed: Duration,
}

impl Search<'_> {
    /// Searches on as many threads as are wanted.
    pub(super) fn run(&self, frames: &Frames) -> anyhow::Result<Impacts> {
        let pool = super::super::threads(self.threads)?;
        let start = now();
        let (step, kinds, separation) = (Arc::clone(&frames.step), frames.kinds.clone(), frames.separation);
        let build = move || {
            kinds
                .into_iter()
                .try_for_each(|kind| step.build_trees(kind, separation))
        };
        let built = building::within_limit(frames.vertices(), || self.is_over(start), build)?;
        let found = match built.transpose()? {
            None => self.nothing(frames),
            Some(()) if frames.request.first => pool.install(|| self.first(frames, start))?,
            Some(()) => pool.install(|| self.all(frames, start))?,
        };
        Ok(Impacts {
            elapsed: start.elapsed(),
            ..found
        })
    }

    fn is_over(&self, start: Instant) -> bool {
        self.cancel.is_cancelled() || self.time.is_some_and(|time| start.elapsed() >= time)
    }

    fn why_stopped(&self) -> StopReason {
        match self.cancel.is_cancelled() {
            true => StopReason::Cancelled,
            false => StopReason::Time,
        }
    }

    /// What is known before anything is compared.
    fn nothing(&self, frames: &Frames) -> Impacts {
        building::say_nothing_compared("the trees of the meshes were still being built");
        Impacts {
            pairs: Vec::new(),
            count: None,
            complete: false,
            first: frames.request.first.then_some(([0.0, 1.0], false)),
            queries: 0,
            stop: self.why_stopped(),
            elapsed: Duration::ZERO,
        }
    }

    fn first(&self, frames: &Frames, start: Instant) -> anyhow::Result<Impacts> {
        let earliest =
            frames
                .step
                .earliest_among(&frames.kinds, frames.separation, TOLERANCE, &mut || {
                    self.is_over(start)
                })?;
        let kind = |kind: PairKind| frames.kinds.iter().position(|known| *known == kind);
        let pairs = earliest.first.map(|(of, contact, impact)| Hit {
            kind: kind(of).unwrap_or_default() as u8,
            contact,
            time: impact.time,
        });
        let none = earliest.is_proved && pairs.is_none();
        Ok(Impacts {
            count: none.then_some(0),
            complete: none,
            first: Some((earliest.time, earliest.is_proved)),
            queries: earliest.queries,
            stop: match (earliest.is_proved, pairs.is_some()) {
                (false, _) => self.why_stopped(),
                (true, true) => StopReason::Hits,
                (true, false) => StopReason::Covered,
            },
            pairs: pairs.into_iter().collect(),
            elapsed: Duration::ZERO,
        })
    }

    fn all(&self, frames: &Frames, start: Instant) -> anyhow::Result<Impacts> {
        let counting = Counting::new();
        let wanted = self
            .hits
            .map_or(usize::MAX, |hits| usize::try_from(hits).unwrap_or(usize::MAX));
        let mut pairs: Vec<Hit> = Vec::new();
        let (mut count, mut queries, mut undecided) = (0_u64, 0, 0);
        for (number, &kind) in (0..).zip(&frames.kinds) {
            let found = std::cell::Cell::new(count);
            let mut failed = None;
            let part = frames.step.each_hit(
                kind,
                frames.separation,
                &mut || {
                    let found = found.get();
                    counting.show(found as usize, start);
                    found >= wanted as u64 || self.is_over(start)
                },
                &mut |contact| {
                    found.set(found.get() + 1);
                    if pairs.len() < self.most.min(wanted) {
                        let hit = Hit {
                            kind: number,
                            contact,
                            time: [f64::NAN; 2],
                        };
                        failed = failed
                            .take()
                            .or(super::super::memory::push(&mut pairs, hit).err());
                    }
                },
            )?;
            if let Some(error) = failed {
                return Err(error);
            }
            count = found.get();
            queries += part.candidates;
            undecided += part.undecided;
        }
        counting.say(format!("times of impact of {} pairs", pairs.len()));
        pairs
            .par_chunks_mut(TIMED_AT_ONCE)
            .try_for_each(|some| -> anyhow::Result<()> {
                if !self.is_over(start) {
                    for hit in some {
                        let kind = frames.kinds[usize::from(hit.kind)];
                        let (impact, _) = frames.step.impact_of_until(
                            kind,
                            &hit.contact,
                            frames.separation,
                            TOLERANCE,
                            &|| self.is_over(start),
                        )?;
                        hit.time = impact.map_or(hit.time, |impact| impact.time);
                    }
                }
                Ok(())
            })?;
        pairs.sort_unstable_by(|p, q| {
            let key = |hit: &Hit| (hit.kind, hit.contact);
            p.time[0]
                .total_cmp(&q.time[0])
                .then(p.time[1].total_cmp(&q.time[1]))
                .then_with(|| key(p).cmp(&key(q)))
        });
        let is_decided = undecided == 0;
        let all_are_listed = is_decided && count == pairs.len() as u64;
        let all_are_timed = pairs.last().is_none_or(Hit::is_timed);
        let first = (all_are_listed && all_are_timed).then(|| {
            let least = |end: usize| pairs.iter().map(|hit| hit.time[end]).fold(1.0, f64::min);
            ([least(0), least(1)], true)
        });
        Ok(Impacts {
            count: is_decided.then_some(count),
            complete: all_are_listed,
            first,
            queries,
            stop: match is_decided && all_are_timed {
                _ if pairs.len() == wanted && !all_are_listed => StopReason::Hits,
                true => StopReason::Covered,
                false if count >= wanted as u64 => StopReason::Hits,
                false => self.why_stopped(),
            },
            pairs,
            elapsed: Duration::ZERO,
        })
    }
}

#[expect(
    clippy::disallowed_methods,
    reason = "a step is told when to stop; it does not ask the time itself"
)]
fn now() -> Instant {
    Instant::now()
}
