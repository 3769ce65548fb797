//! The exact methods: every pair is decided, or excluded by a bound.

use std::sync::Arc;
use std::time::Duration;

use rayon::ThreadPool;
use rayon::prelude::*;
use satisfice::{Cancel, StopReason};
use satisfice_collision::broad::Method;
use satisfice_collision::distance::Proximity;
use satisfice_collision::scene::{self, Completeness, Contact, Skips};

use super::arguments::Find;
use super::building;
use super::limit::Limit;
use super::memory::{Listed, Lists, Room};
use super::overlaps::{self, Overlap};
use super::pairs::Pairs;
use super::scene::{Measure, Pair, World};
use crate::progress::Counting;

/// The exact methods by their names.
pub(super) const METHODS: [(&str, Method); 4] = [
    ("exact", Method::Auto),
    ("tree", Method::Tree),
    ("grid", Method::Grid),
    ("brute-force", Method::BruteForce),
];

/// Pairs measured between two looks at the clock; one can take about 100 us.
const MEASURED_AT_ONCE: usize = 16;

/// How to find.
pub(super) struct Exact<'a> {
    pub(super) method: Method,
    /// Bounds the whole answer, measuring included.
    pub(super) time: Option<Duration>,
    pub(super) hits: Option<u64>,
    /// More pairs are counted, but not listed.
    pub(super) most: usize,
    /// Whether closest points are kept.
    pub(super) witnesses: bool,
    pub(super) threads: usize,
    pub(super) cancel: &'a Cancel,
}

/// The hits.
pub(super) struct Found {
    pub(super) pairs: Pairs,
    /// Bodies that overlap as solids, if that was asked for.
    pub(super) overlaps: Option<Vec<Overlap>>,
    /// Whether all pairs are listed, as was proved.
    pub(super) complete: bool,
    /// How many there are, if that is known.
    pub(super) count: Option<u64>,
    /// Why there are no more.
    pub(super) stop: StopReason,
    pub(super) skips: Skips,
    pub(super) elapsed: Duration,
    /// Whether memory ended before the search.
    pub(super) is_full: bool,
}

/// Pairs that are not measured yet.
struct Enumerated {
    lists: Lists,
    /// Distances that are known beforehand, of all or of none.
    known: Vec<Proximity>,
    skips: Skips,
    stop: StopReason,
    complete: bool,
    count: Option<u64>,
    is_full: bool,
}

impl Enumerated {
    /// Nothing was compared.
    fn nothing(stop: StopReason, witnesses: bool) -> Self {
        Self {
            lists: Lists {
                pairs: Vec::new(),
                distances: Vec::new(),
                witnesses: witnesses.then(Vec::new),
            },
            known: Vec::new(),
            skips: Skips::default(),
            stop,
            complete: false,
            count: None,
            is_full: false,
        }
    }
}

impl Exact<'_> {
    /// Finds on as many threads as are wanted.
    pub(super) fn find(&self, world: &Arc<World>) -> anyhow::Result<Found> {
        let limit = Limit::new(self.time, self.cancel);
        let pool = match self.threads {
            1 => None,
            threads => Some(Arc::new(super::threads(threads)?)),
        };
        let scene = self.built(world, pool.as_ref(), &limit)?;
        match pool {
            Some(pool) => pool.install(|| self.find_in(world, scene, &limit)),
            None => self.find_in(world, scene, &limit),
        }
    }

    /// The scene with its trees, and the solids; `None` if the limit is reached before.
    fn built(
        &self,
        world: &Arc<World>,
        pool: Option<&Arc<ThreadPool>>,
        limit: &Limit<'_>,
    ) -> anyhow::Result<Option<scene::World>> {
        let (world, pool, method) = (Arc::clone(world), pool.cloned(), self.method);
        let built = building::within_limit(
            world.features(),
            || limit.is_reached(),
            move || -> anyhow::Result<scene::World> {
                world.solids()?;
                let mut scene = world.scene(method)?;
                match &pool {
                    Some(pool) => {
                        scene = scene.parallel();
                        pool.install(|| scene.build_trees())?;
                    }
                    None => scene.build_trees()?,
                }
                Ok(scene)
            },
        )?;
        if built.is_none() {
            building::say_nothing_compared("the meshes were still being prepared");
        }
        built.transpose()
    }

    fn find_in(
        &self,
        world: &World,
        scene: Option<scene::World>,
        limit: &Limit<'_>,
    ) -> anyhow::Result<Found> {
        let counting = Counting::new();
        let mut answer = match scene {
            Some(mut scene) => self.answer(world, &mut scene, limit, &counting)?,
            None => Enumerated::nothing(limit.reason(), self.witnesses),
        };
        counting.say(format!("measuring {} pairs", answer.lists.pairs.len()));
        let pairs = self.measured(world, &mut answer, limit)?;
        if pairs.unmeasured() > 0 {
            answer.stop = limit.reason();
        }
        let (overlaps, are_all) = match world.request.solid {
            false => (None, true),
            // the solids may not be prepared
            true if limit.is_reached() => (Some(Vec::new()), false),
            true => {
                counting.say("looking into the bodies".to_owned());
                let (overlaps, are_all) = overlaps::find(world.solids()?, &|| limit.is_reached());
                (Some(overlaps), are_all)
            }
        };
        if !are_all {
            answer.stop = limit.reason();
            answer.complete = false;
        }
        Ok(Found {
            overlaps,
            complete: answer.complete,
            count: answer.count.or(answer.complete.then_some(pairs.len() as u64)),
            pairs,
            stop: answer.stop,
            skips: answer.skips,
            elapsed: limit.elapsed(),
            is_full: answer.is_full,
        })
    }

    fn answer(
        &self,
        world: &World,
        scene: &mut scene::World,
        limit: &Limit<'_>,
        counting: &Counting,
    ) -> anyhow::Result<Enumerated> {
        let stop = |found: usize| {
            counting.show(found, limit.start());
            limit.is_reached()
        };
        // `enough`: why no more were wanted, if some pairs answer the question.
        let answer = |contacts: Vec<Contact>, enough: Option<StopReason>, state: Completeness| {
            let proved = state == Completeness::Proved;
            let stop = match (proved, enough) {
                (true, None) => StopReason::Covered,
                (true, Some(reason)) => reason,
                (false, _) => limit.reason(),
            };
            let mut found = Enumerated::nothing(stop, self.witnesses);
            found.lists.pairs.extend(world.pairs(contacts.into_iter()));
            found.complete = proved && enough.is_none();
            found
        };
        Ok(match world.request.find {
            Find::Touching => {
                let (witnesses, state) = scene.witnesses_until(&stop)?;
                let enough = (!witnesses.is_empty()).then_some(StopReason::Exhausted);
                answer(witnesses, enough, state)
            }
            Find::First => {
                let (first, state) = scene.first_until(&stop)?;
                let enough = first.is_some().then_some(StopReason::Hits);
                answer(first.into_iter().collect(), enough, state)
            }
            Find::Closest(k) => {
                let wanted = usize::try_from(k).unwrap_or(usize::MAX);
                let (closest, state) = match world.request.threshold.is_finite() {
                    true => scene.closest_until(wanted, &stop)?,
                    false => scene.nearest_until(wanted, &stop)?,
                };
                let enough = (closest.len() >= wanted).then_some(StopReason::Hits);
                let (contacts, known) = closest.into_iter().unzip();
                Enumerated {
                    known,
                    ..answer(contacts, enough, state)
                }
            }
            Find::All => self.all(world, scene, limit, counting)?,
        })
    }

    /// All pairs, or those found until a limit. Those beyond `most` are counted only.
    fn all(
        &self,
        world: &World,
        scene: &mut scene::World,
        limit: &Limit<'_>,
        counting: &Counting,
    ) -> anyhow::Result<Enumerated> {
        let wanted = self
            .hits
            .map_or(usize::MAX, |hits| usize::try_from(hits).unwrap_or(usize::MAX));
        let room = Room::new(self.witnesses);
        let has_enough = |found: usize| {
            counting.show(found, limit.start());
            // One more than the list takes shows that there are more.
            found >= wanted || found > self.most || limit.is_reached_after(found) || !room.holds(found)
        };
        let (listed, completeness, skips) = if matches!(self.method, Method::Auto | Method::Tree) {
            let mut pass = scene.pass();
            scene.advance(&mut pass, &mut |found| has_enough(found))?;
            let listed = room.take(world.pairs(scene.found_by(&pass)));
            (listed, pass.completeness(), pass.skips())
        } else {
            let update = scene.update_until(&has_enough)?;
            let listed = room.take(world.pairs(scene.contacts()));
            (listed, update.completeness, update.skips)
        };
        let Listed {
            lists,
            found,
            is_full,
        } = listed;
        let mut answer = Enumerated {
            lists,
            known: Vec::new(),
            skips,
            stop: limit.reason(),
            complete: false,
            count: None,
            is_full,
        };
        let pairs = &mut answer.lists.pairs;
        match self.threads {
            1 => pairs.sort_unstable_by_key(Pair::order),
            _ => pairs.par_sort_unstable_by_key(Pair::order),
        }
        pairs.truncate(wanted.min(self.most));
        let is_cut = pairs.len() < found;
        if completeness == Completeness::Proved && (!is_cut || found > self.most || is_full) {
            answer.stop = StopReason::Covered;
            answer.complete = !is_cut;
            answer.count = is_cut.then_some(found as u64);
        } else if found >= wanted {
            answer.stop = StopReason::Hits;
        } else if found > self.most || is_full {
            pairs.shrink_to_fit();
            let (count, state) = scene.count_until(&|found| {
                counting.show(found, limit.start());
                limit.is_reached()
            })?;
            if state == Completeness::Proved {
                answer.stop = StopReason::Covered;
                answer.count = Some(count);
                // Those left out were counted only until the list was full.
                answer.skips = Skips::default();
            }
        }
        // Where it ended just behind the last pair, nothing is lost.
        answer.is_full = is_full && !answer.complete;
        if answer.is_full && answer.stop == StopReason::Covered {
            answer.stop = StopReason::Memory;
        }
        Ok(answer)
    }

    /// The pairs with their distances, measured until the limit is reached.
    fn measured(&self, world: &World, answer: &mut Enumerated, limit: &Limit<'_>) -> anyhow::Result<Pairs> {
        let Lists {
            pairs: found,
            distances,
            witnesses,
        } = std::mem::take(&mut answer.lists);
        let mut pairs = Pairs {
            distances,
            witnesses,
            ..Pairs::default()
        };
        let below = world.request.threshold;
        let mut keep = |near: Option<Proximity>| {
            let distance = near.map_or(f64::NAN, |near| capped(near.distance, below));
            pairs.distances.push(distance);
            if let Some(witnesses) = &mut pairs.witnesses {
                witnesses.push(near);
            }
        };
        if !answer.known.is_empty() {
            answer.known.drain(..).map(Some).for_each(&mut keep);
        } else if !found.is_empty() && !limit.is_reached() {
            // By another scene: the first one keeps the pairs for a next frame, which takes memory.
            let measure = &world.measure()?;
            // In blocks, so that no more than the distance is kept of each pair.
            let blocks = found.chunks(4096 * MEASURED_AT_ONCE);
            for block in blocks.take_while(|_| !limit.is_reached()) {
                self.block(measure, block, limit)?
                    .into_iter()
                    .flatten()
                    .for_each(&mut keep);
            }
        }
        // the time was over before the others
        pairs.distances.resize(found.len(), f64::NAN);
        if let Some(witnesses) = &mut pairs.witnesses {
            witnesses.resize(found.len(), None);
        }
        pairs.pairs = found;
        Ok(pairs)
    }

    /// Closest points of some pairs; `None` for those that the limit came before.
    fn block(
        &self,
        measure: &Measure,
        pairs: &[Pair],
        limit: &Limit<'_>,
    ) -> anyhow::Result<Vec<Vec<Option<Proximity>>>> {
        let some = |pairs: &[Pair]| -> anyhow::Result<Vec<_>> {
            if limit.is_reached() {
                return Ok(vec![None; pairs.len()]);
            }
            pairs
                .iter()
                .map(|pair| measure.proximity(pair).map(Some))
                .collect()
        };
        match self.threads {
            1 => pairs.chunks(MEASURED_AT_ONCE).map(some).collect(),
            _ => pairs.par_chunks(MEASURED_AT_ONCE).map(some).collect(),
        }
    }
}

/// A distance, within one unit in the last place, kept below the threshold: the pair is decided to be.
pub(super) fn capped(distance: f64, threshold: f64) -> f64 {
    distance.min(threshold.next_down())
}
