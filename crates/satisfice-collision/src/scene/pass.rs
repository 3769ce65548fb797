//! A frame under a budget: the likeliest pairs first, and an exact resume.

use super::filter::PairFilter;
use super::pairs::Status;
use super::{Completeness, Contact, Frame, Skips, World};
use crate::Error;
use crate::broad::{Pair, PairQuery, Visit};

/// Contacts verified between two calls of `stop`.
const STRIDE: usize = 128;
/// Pairs of groups of eight boxes visited between two calls of `stop`.
const VISITS: usize = 16;

/// A parallel descent has this many parts, for any number of threads.
const PARTS: usize = 16;
/// Visits of each part between two calls of `stop`.
const VISITS_OF_PART: usize = 256;

/// A frame that is enumerated piece by piece.
///
/// Contacts of bodies that did not move are there at once. Then come the contacts of the last frame that hold by the bound of
/// motion (see [`World::measure_contacts`]), at no cost, and the others of the last frame are verified, the closest first; the
/// pairs of bodies with most contacts come first, then those whose boxes overlap most. Then the bodies are searched in the same
/// order.
///
/// ```
/// use satisfice_collision::distance::{PairKind, Threshold};
/// use satisfice_collision::generate;
/// use satisfice_collision::scene::{Body, Completeness, World};
/// let mut world = World::new(PairKind::VertexVertex, Threshold::new(0.2)?);
/// world.add(Body::fixed(generate::icosphere(1.0, 3)?))?;
/// world.add(Body::fixed(generate::icosphere(1.1, 3)?))?;
/// let mut pass = world.pass();
/// // until there are ten contacts
/// let state = world.advance(&mut pass, &mut |found| found >= 10)?;
/// assert!(state == Completeness::Unknown && world.found_by(&pass).count() >= 10);
/// // and on from there to the end
/// let state = world.advance(&mut pass, &mut |_| false)?;
/// assert_eq!(state, Completeness::Proved);
/// # Ok::<(), satisfice_collision::Error>(())
/// ```
pub struct Pass {
    /// The number of its world.
    world: u64,
    frame: u64,
    /// The number of the answer when the pass began.
    answers: u64,
    /// The records to examine, in order.
    links: Vec<Progress>,
    /// Contacts of bodies at rest.
    resting: usize,
    delivered: usize,
    phase: Phase,
    skips: Skips,
}

/// The progress of a pass in one record.
struct Progress {
    record: u32,
    /// So many of the likely contacts, from the first on, hold by the bound of motion.
    held: usize,
    /// The other contacts, in the order in which they were found.
    others: Vec<Pair>,
    /// All contacts delivered before the search, sorted.
    verified: Vec<Pair>,
    /// Whether all likely contacts have been verified, and whether all others have been searched.
    is_verified: bool,
    is_done: bool,
}

enum Phase {
    /// Verifying the likely contacts of the link at `turn`, from number `next` on.
    Verify {
        turn: usize,
        next: usize,
    },
    /// Descending; the stack is empty between links.
    Search {
        turn: usize,
        stack: Vec<Visit>,
        started: bool,
    },
    Done,
}

impl Pass {
    /// The number of contacts found so far, including those of bodies at rest.
    #[must_use]
    pub fn found(&self) -> usize {
        self.resting + self.delivered
    }

    /// `Proved` once every pair has been decided or excluded.
    #[must_use]
    pub fn completeness(&self) -> Completeness {
        match self.phase {
            Phase::Done => Completeness::Proved,
            _ => Completeness::Unknown,
        }
    }

    /// The work skipped so far, by reason.
    #[must_use]
    pub fn skips(&self) -> Skips {
        self.skips
    }
}

impl World {
    /// Starts the frame that `place` and `deform` described. Nothing is searched yet.
    #[must_use]
    pub fn pass(&mut self) -> Pass {
        self.log.begin();
        self.log.clean();
        self.settle();
        self.dirty = self.take_dirty();
        let mut order: Vec<_> = self
            .dirty
            .iter()
            .map(|&record| (self.likelihood(record), record))
            .collect();
        order.sort_by(|((m, p), one), ((n, q), two)| n.cmp(m).then(q.total_cmp(p)).then(one.cmp(two)));
        let resting = self
            .pairs
            .iter()
            .filter(|(_, record)| record.status == Status::Current);
        let resting = resting.map(|(_, record)| record.pairs.len()).sum();
        let mut skips = Skips::default();
        let links: Vec<Progress> = order
            .into_iter()
            .map(|(_, record)| Progress {
                record,
                held: self.holding(&self.pairs[record]),
                others: Vec::new(),
                verified: Vec::new(),
                is_verified: false,
                is_done: false,
            })
            .collect();
        let delivered = links.iter().map(|link| link.held).sum();
        skips.held_by_motion = delivered as u64;
        Pass {
            world: self.number,
            frame: self.frame,
            answers: self.answers,
            phase: match links.is_empty() {
                true => Phase::Done,
                false => Phase::Verify { turn: 0, next: 0 },
            },
            skips: self.with_counts(skips, links.len()),
            links,
            resting,
            delivered,
        }
    }

    /// How many contacts a record had last, and how much the boxes of its bodies overlap.
    fn likelihood(&self, record: u32) -> (usize, f64) {
        let known = &self.pairs[record];
        let [a, b] = known.bodies.map(|slot| self.state(slot).bounds());
        let delta = self.threshold.get();
        let side = |k: usize| (a.max[k].min(b.max[k]) - a.min[k].max(b.min[k]) + delta).max(0.0);
        (known.pairs.len(), side(0) * side(1) * side(2))
    }

    /// Goes on with a pass until it is complete or `stop` says so; `stop` is asked every few microseconds and may look at a
    /// clock, a counter or the number of contacts found. Called again, it goes on exactly where it stopped: however often it is
    /// interrupted, a pass delivers the same contacts in the same order. What it delivered is what the next pass tries first.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the world has moved since the pass began, or was asked for an answer: it knows other contacts then.
    pub fn advance(
        &mut self,
        pass: &mut Pass,
        stop: &mut dyn FnMut(usize) -> bool,
    ) -> Result<Completeness, Error> {
        if !self.is_current(pass) {
            return Err(Error::parameter(
                "pass",
                pass.frame,
                "a pass of this world and its present frame that began after the last other answer",
            ));
        }
        while !matches!(pass.phase, Phase::Done) && !stop(pass.found()) {
            self.piece(pass)?;
        }
        Ok(pass.completeness())
    }

    /// The contacts that a pass has found so far: those of bodies at rest, then those of each pair of bodies in the order in
    /// which they were found. Nothing twice; nothing at all if the world has changed since the pass
    /// began, or for a pass of another world.
    pub fn found_by<'w>(&'w self, pass: &'w Pass) -> impl Iterator<Item = Contact> + 'w {
        let is_current = self.is_current(pass);
        let resting = self
            .pairs
            .iter()
            .filter(|(_, record)| record.status == Status::Current);
        let resting = resting.map(|(_, record)| (record, &record.pairs[..], &[][..]));
        let moving = pass.links.iter().filter(move |_| is_current).map(|link| {
            let record = &self.pairs[link.record];
            let held = record
                .slack
                .as_ref()
                .map_or(&[][..], |slack| &slack.likely[..link.held]);
            (record, held, &link.others[..])
        });
        let all = resting.filter(move |_| is_current).chain(moving);
        all.flat_map(|(record, held, others)| {
            held.iter().chain(others).map(|&pair| self.contact(record, pair))
        })
    }

    /// The contacts that a pass has found so far as an answer, sorted.
    #[must_use]
    pub fn frame_of(&self, pass: &Pass) -> Frame {
        let mut contacts: Vec<Contact> = self.found_by(pass).collect();
        contacts.sort_unstable();
        Frame {
            contacts,
            completeness: pass.completeness(),
            skips: pass.skips,
        }
    }

    /// Ends a pass: its contacts are what the next frame starts from, complete or not. Cost: linear in them.
    pub fn finish(&mut self, mut pass: Pass) -> Frame {
        let frame = self.frame_of(&pass);
        if !self.is_current(&pass) {
            return frame;
        }
        self.answers += 1;
        for link in &mut pass.links {
            let record = link.record;
            if !link.is_verified {
                // contacts that were not verified stay likely
                self.pairs[record].status = Status::Stale;
                self.pairs[record].slack = None;
                continue;
            }
            let bodies = self.pairs[record].bodies.map(|slot| self.id(slot));
            let pairs = self.sorted(link);
            let known = &mut self.pairs[record];
            let before = std::mem::replace(&mut known.pairs, pairs);
            known.slack = None;
            known.is_dirty = !link.is_done;
            self.has_known_dirty |= !link.is_done;
            known.status = if link.is_done {
                Status::Current
            } else {
                Status::Partial
            };
            if !(before.is_empty() && known.pairs.is_empty()) {
                self.log.note(bodies, record, before);
            }
        }
        let pairs = &self.pairs;
        self.dirty.retain(|&record| pairs[record].is_dirty);
        self.log.end();
        frame
    }

    /// Whether a pass is one of this world, in which nothing has changed since it began.
    fn is_current(&self, pass: &Pass) -> bool {
        pass.world == self.number
            && pass.frame == self.frame
            && pass.answers == self.answers
            && self.movers.is_empty()
            && self.unpaired.is_empty()
    }

    /// All contacts that a pass has delivered of a record, sorted.
    fn sorted(&self, link: &mut Progress) -> Vec<Pair> {
        let mut all = std::mem::take(&mut link.others);
        if let Some(slack) = &self.pairs[link.record].slack {
            all.extend_from_slice(&slack.likely[..link.held]);
        }
        all.sort_unstable();
        all
    }

    fn piece(&mut self, pass: &mut Pass) -> Result<(), Error> {
        match &mut pass.phase {
            Phase::Verify { turn, next } => {
                let Some(link) = pass.links.get_mut(*turn) else {
                    pass.phase = Phase::Search {
                        turn: 0,
                        stack: Vec::new(),
                        started: false,
                    };
                    return Ok(());
                };
                let record = &self.pairs[link.record];
                let likely = match &record.slack {
                    Some(slack) if record.status == Status::Behind => &slack.likely,
                    _ => &record.pairs,
                };
                let first = link.held.max(*next);
                let end = likely.len().min(first + STRIDE);
                let within = likely[first..end].iter().copied();
                let known = link.others.len();
                link.others
                    .extend(within.filter(|&pair| self.decide(record.bodies, pair)));
                pass.delivered += link.others.len() - known;
                *next = end;
                if end == likely.len() {
                    link.is_verified = true;
                    (*turn, *next) = (*turn + 1, 0);
                }
            }
            Phase::Search { turn, stack, started } => {
                let Some(link) = pass.links.get_mut(*turn) else {
                    pass.phase = Phase::Done;
                    return Ok(());
                };
                let bodies = self.pairs[link.record].bodies;
                if !*started {
                    if self.boxes_apart(bodies) {
                        self.pairs.set_apart(link.record, true);
                        link.is_done = true;
                        *turn += 1;
                        return Ok(());
                    }
                    self.pairs.set_apart(link.record, false);
                    self.ensure_trees(bodies)?;
                    let mut verified = link.others.clone();
                    if let Some(slack) = &self.pairs[link.record].slack {
                        verified.extend_from_slice(&slack.likely[..link.held]);
                    }
                    verified.sort_unstable();
                    link.verified = verified;
                }
                let (one, two) = (self.state(bodies[0]), self.state(bodies[1]));
                let filter = PairFilter::new(self.kind, one.state(), two.state(), bodies[0] == bodies[1]);
                let keep = |i: u32, j: u32| filter.keeps(Pair { a: i, b: j });
                let places = self.places(bodies);
                if let Some(query) = self.pair_query(bodies, &places, self.threshold, &filter, &keep) {
                    if !*started {
                        query.start(stack);
                    }
                    let mut found = Vec::new();
                    pass.skips.mesh_neighbours += if self.parallel && stack.len() >= PARTS {
                        step_in_parts(&query, stack, &mut found)
                    } else {
                        query.step(stack, VISITS, usize::MAX, &mut found).neighbours
                    };
                    found.retain(|pair| link.verified.binary_search(pair).is_err());
                    pass.delivered += found.len();
                    link.others.append(&mut found);
                }
                filter.count(&mut pass.skips);
                *started = !stack.is_empty();
                if stack.is_empty() {
                    link.is_done = true;
                    link.verified = Vec::new();
                    *turn += 1;
                }
            }
            Phase::Done => {}
        }
        Ok(())
    }
}

/// Continues a descent on the current rayon pool. The results and their order do not depend on the number of threads. Returns how many
/// pairs of neighbours were left out.
fn step_in_parts(query: &PairQuery<'_>, stack: &mut Vec<Visit>, found: &mut Vec<Pair>) -> u64 {
    use rayon::prelude::*;
    let mut parts: Vec<(Vec<Visit>, Vec<Pair>)> = (0..PARTS).map(|_| Default::default()).collect();
    let first = stack.len().saturating_sub(PARTS * VISITS);
    for (at, visit) in stack.drain(first..).enumerate() {
        parts[at % PARTS].0.push(visit);
    }
    let go_on = |(stack, found): &mut (Vec<Visit>, Vec<Pair>)| {
        query.step(stack, VISITS_OF_PART, usize::MAX, found).neighbours
    };
    let neighbours = parts.par_iter_mut().map(go_on).sum();
    for (rest, pairs) in &mut parts {
        stack.append(rest);
        found.append(pairs);
    }
    neighbours
}
