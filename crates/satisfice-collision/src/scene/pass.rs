//! A frame under a budget: the likeliest pairs first, and an exact resume.

use super::link::{Near, couple, keeps};
use super::{Completeness, Contact, Frame, Scene, Skips};
use crate::Error;
use crate::broad::{Couple, Pair, Visit};

/// Pairs verified between two questions to the budget.
const STRIDE: usize = 128;
/// Groups of eight closest points looked at between two questions to the budget.
const GROUPS: usize = 32;
/// Pairs of groups of eight boxes visited between two questions to the budget.
const VISITS: usize = 16;

/// A descent on several threads goes on in so many parts, however many threads there are.
const PARTS: usize = 16;
/// Visits of each part between two questions to the budget.
const VISITS_OF_PART: usize = 256;

/// A frame that is being enumerated piece by piece. First come the contacts of the last frame that hold whatever moved (see
/// [`Scene::measure_contacts`]), at no cost: they were laid out between the frames. Then come those whose closest points of then
/// are still near where rigid bodies have gone, and then the others are verified, the closest of the last frame first, those of
/// the bodies with most contacts first of all; then the bodies are searched in the same order.
pub struct Pass {
    frame: u64,
    /// What was known when it began.
    answers: u64,
    order: Vec<usize>,
    links: Vec<Progress>,
    delivered: Delivered,
    phase: Phase,
    skips: Skips,
}

/// What a pass has delivered of one link.
#[derive(Default)]
struct Progress {
    /// Whether nothing moved, so that the pairs that are known are those of this frame; `held` counts them then.
    at_rest: bool,
    /// So many of the likely contacts, from the first on, hold by the bound of motion and are delivered.
    held: usize,
    /// Whether these are all that hold so.
    held_all: bool,
    /// Which of the likely contacts are delivered since their closest points of the last frame are near, eight in a mask, beginning
    /// with the group of the first that is not held.
    near: Vec<u8>,
    /// The other pairs delivered.
    others: Vec<Pair>,
    /// All pairs delivered before the search, sorted.
    verified: Vec<Pair>,
}

/// Contacts in the order of their delivery. The first ones may lie there already before they are delivered.
#[derive(Default)]
struct Delivered {
    contacts: Vec<Contact>,
    count: usize,
    /// So many of the first link's likely contacts lie there.
    laid_out: usize,
}

impl Delivered {
    fn push(&mut self, contact: Contact) {
        match self.contacts.get_mut(self.count) {
            Some(place) => *place = contact,
            None => self.contacts.push(contact),
        }
        self.count += 1;
    }

    /// Those of eight contacts, or fewer, that a mask names.
    fn push_some(&mut self, eight: &[Contact], mask: u8) {
        let end = self.count + eight.len();
        if self.contacts.len() < end {
            self.contacts.resize(end, eight[0]);
        }
        // always written, kept by moving the end
        for (lane, &contact) in eight.iter().enumerate() {
            self.contacts[self.count] = contact;
            self.count += usize::from(mask >> lane & 1);
        }
    }
}

impl Progress {
    /// Whether a likely contact has been delivered already.
    fn is_delivered(&self, likely: usize) -> bool {
        let group = likely / 8 - (self.held / 8).min(likely / 8);
        likely < self.held
            || self
                .near
                .get(group)
                .is_some_and(|mask| mask >> (likely % 8) & 1 == 1)
    }
}

enum Phase {
    /// Taking over the contacts that hold by the bound of motion, of the link at `turn` of the order.
    Held {
        turn: usize,
    },
    /// Taking over those of the others whose closest points are near, from the group `next` on.
    Near {
        turn: usize,
        next: usize,
    },
    /// Verifying the others, from the likely one `next` on.
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
    /// The contacts found so far, in the order in which they were found; nothing twice.
    #[must_use]
    pub fn contacts(&self) -> &[Contact] {
        &self.delivered.contacts[..self.delivered.count]
    }

    /// `Proved` once every pair has been decided or excluded.
    #[must_use]
    pub fn completeness(&self) -> Completeness {
        match self.phase {
            Phase::Done => Completeness::Proved,
            _ => Completeness::Unknown,
        }
    }

    /// What was skipped so far, and why.
    #[must_use]
    pub fn skips(&self) -> Skips {
        self.skips
    }

    /// The contacts so far as an answer, sorted.
    #[must_use]
    pub fn into_frame(self) -> Frame {
        let completeness = self.completeness();
        let mut contacts = self.delivered.contacts;
        contacts.truncate(self.delivered.count);
        contacts.sort_unstable();
        Frame {
            contacts,
            completeness,
            skips: self.skips,
        }
    }
}

impl Scene {
    /// Starts the frame that `place` and `deform` described. Nothing is searched yet.
    #[must_use]
    pub fn pass(&mut self) -> Pass {
        self.settle();
        let order = self.order();
        let first = order.first().map(|&at| &self.links[at]);
        let likely = first.and_then(|link| self.likely(link));
        let laid_out = likely.map_or(0, <[Contact]>::len);
        let of = first.zip(self.frame.checked_sub(1));
        let of = of.map(|(link, frame)| (link.a, link.b, frame));
        let usable = laid_out > 0 && self.laid_out.len() == laid_out && self.laid_out_of == of;
        Pass {
            frame: self.frame,
            answers: self.answers,
            order,
            links: self.links.iter().map(|_| Progress::default()).collect(),
            delivered: if usable {
                Delivered {
                    contacts: std::mem::take(&mut self.laid_out),
                    count: 0,
                    laid_out,
                }
            } else {
                Delivered::default()
            },
            phase: Phase::Held { turn: 0 },
            skips: self.start_skips(),
        }
    }

    /// Goes on with a pass until it is complete or `stop` says so; `stop` is asked every few microseconds and may look at a
    /// clock, a counter or `found` contacts. Called again, it goes on exactly where it stopped: however often it is interrupted,
    /// a pass delivers the same contacts in the same order. What it delivered is what the next pass tries first.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the scene has moved since the pass began, or was asked for an answer: it knows other contacts then.
    pub fn advance(
        &mut self,
        pass: &mut Pass,
        stop: &mut dyn FnMut(usize) -> bool,
    ) -> Result<Completeness, Error> {
        if !self.is_current(pass) {
            return Err(Error::parameter(
                "pass",
                pass.frame,
                "a pass of the present frame that began after the last other answer",
            ));
        }
        while !matches!(pass.phase, Phase::Done) && !stop(pass.delivered.count) {
            self.piece(pass)?;
        }
        Ok(pass.completeness())
    }

    /// Ends a pass: its contacts are what the next frame starts from, complete or not. Cost: linear in them.
    pub fn finish(&mut self, mut pass: Pass) -> Frame {
        if !self.is_current(&pass) {
            return pass.into_frame();
        }
        self.answers += 1;
        let (completeness, skips) = (pass.completeness(), pass.skips);
        let mut contacts = pass.delivered.contacts;
        contacts.clear();
        let done = completeness == Completeness::Proved;
        for at in 0..self.links.len() {
            let pairs = self.sorted(at, &mut pass.links[at]);
            let link = &mut self.links[at];
            contacts.extend(pairs.iter().map(|&pair| link.contact(pair)));
            if pass.links[at].at_rest {
                link.rested(self.frame);
                continue;
            }
            link.pairs = pairs;
            link.forget(done.then_some(self.frame));
        }
        Frame {
            contacts,
            completeness,
            skips,
        }
    }

    /// Whether nothing has changed since a pass began.
    fn is_current(&self, pass: &Pass) -> bool {
        pass.frame == self.frame && pass.answers == self.answers && self.linked
    }

    /// All pairs that a pass has delivered of a link, sorted.
    fn sorted(&self, at: usize, progress: &mut Progress) -> Vec<Pair> {
        let link = &self.links[at];
        if progress.at_rest {
            return link.pairs[..progress.held].to_vec();
        }
        let mut others = std::mem::take(&mut progress.others);
        if progress.verified.is_empty() {
            let likely = self.likely(link).unwrap_or_default();
            let near = (progress.held..likely.len()).filter(|&at| progress.is_delivered(at));
            others.extend(near.map(|at| Pair {
                a: likely[at].a,
                b: likely[at].b,
            }));
        }
        others.sort_unstable();
        let others = merged(progress.verified.iter().copied(), others);
        if !progress.verified.is_empty() {
            return others;
        }
        if progress.held_all {
            merged(link.held(self.drift(link)), others)
        } else {
            let likely = self.likely(link).unwrap_or_default();
            let held = likely[..progress.held].iter().map(|contact| Pair {
                a: contact.a,
                b: contact.b,
            });
            let mut held: Vec<Pair> = held.collect();
            held.sort_unstable();
            merged(held.into_iter(), others)
        }
    }

    fn piece(&mut self, pass: &mut Pass) -> Result<(), Error> {
        match &mut pass.phase {
            Phase::Held { turn } => {
                let Some(&at) = pass.order.get(*turn) else {
                    pass.phase = Phase::Near { turn: 0, next: 0 };
                    return Ok(());
                };
                let link = &self.links[at];
                let progress = &mut pass.links[at];
                progress.at_rest = self.is_at_rest(link);
                if progress.at_rest {
                    let end = link.pairs.len().min(progress.held + 16 * STRIDE);
                    for &pair in &link.pairs[progress.held..end] {
                        pass.delivered.push(link.contact(pair));
                    }
                    progress.held = end;
                    if end == link.pairs.len() {
                        pass.skips.unmoved_bodies += 1;
                        *turn += 1;
                    }
                    return Ok(());
                }
                let likely = self.likely(link).unwrap_or_default();
                let holding = if likely.is_empty() {
                    0
                } else {
                    link.holding(self.drift(link))
                };
                let end = holding.min(progress.held + 16 * STRIDE);
                let lie_there = *turn == 0 && end <= pass.delivered.laid_out;
                if lie_there {
                    pass.delivered.count = end;
                } else {
                    for &contact in &likely[progress.held..end] {
                        pass.delivered.push(contact);
                    }
                }
                pass.skips.held_by_motion += (end - progress.held) as u64;
                progress.held = end;
                if end == holding {
                    progress.held_all = !likely.is_empty();
                    *turn += 1;
                }
            }
            Phase::Near { turn, next } => {
                let Some(&at) = pass.order.get(*turn) else {
                    pass.phase = Phase::Verify { turn: 0, next: 0 };
                    return Ok(());
                };
                let link = &self.links[at];
                let progress = &mut pass.links[at];
                let likely = self.likely(link).unwrap_or_default();
                let groups = link.witnesses().groups();
                let first = (*next).max(progress.held / 8);
                let end = groups.min(first + GROUPS);
                if progress.at_rest || likely.is_empty() || first >= end {
                    (*turn, *next) = (*turn + 1, 0);
                    return Ok(());
                }
                let places = [link.a, link.b].map(|body| self.states[body].placement);
                let known = progress.near.len();
                link.witnesses().near(
                    first..end,
                    [&places[0], &places[1]],
                    self.reach(link, &places),
                    &mut progress.near,
                );
                let count = pass.delivered.count;
                for (group, mask) in (first..end).zip(&mut progress.near[known..]) {
                    let held = progress.held.saturating_sub(group * 8).min(8);
                    *mask &= !((1_u16 << held) - 1) as u8;
                    let eight = &likely[group * 8..likely.len().min(group * 8 + 8)];
                    pass.delivered.push_some(eight, *mask);
                }
                pass.skips.held_by_motion += (pass.delivered.count - count) as u64;
                *next = end;
            }
            Phase::Verify { turn, next } => {
                let Some(&at) = pass.order.get(*turn) else {
                    pass.phase = Phase::Search {
                        turn: 0,
                        stack: Vec::new(),
                        started: false,
                    };
                    return Ok(());
                };
                let link = &self.links[at];
                let progress = &mut pass.links[at];
                if progress.at_rest {
                    (*turn, *next) = (*turn + 1, 0);
                    return Ok(());
                }
                let likely = self.likely(link);
                *next = (*next).max(progress.held);
                let end = link.pairs.len().min(*next + STRIDE);
                for i in *next..end {
                    let pair = match likely {
                        Some(_) if progress.is_delivered(i) => continue,
                        Some(likely) => Pair {
                            a: likely[i].a,
                            b: likely[i].b,
                        },
                        None => link.pairs[i],
                    };
                    if self.decide(link, pair) {
                        progress.others.push(pair);
                        pass.delivered.push(link.contact(pair));
                    }
                }
                *next = end;
                if end == link.pairs.len() {
                    (*turn, *next) = (*turn + 1, 0);
                }
            }
            Phase::Search { turn, stack, started } => {
                let Some(&at) = pass.order.get(*turn) else {
                    pass.phase = Phase::Done;
                    return Ok(());
                };
                if pass.links[at].at_rest {
                    *turn += 1;
                    return Ok(());
                }
                if !*started {
                    let verified = self.sorted(at, &mut pass.links[at]);
                    pass.links[at].verified = verified;
                    if self.boxes_apart(at) {
                        pass.skips.boxes_apart += 1;
                        *turn += 1;
                        return Ok(());
                    }
                    let (a, b) = (self.links[at].a, self.links[at].b);
                    self.ready(a, b)?;
                }
                let link = &self.links[at];
                let (one, two, one_body) = (&self.states[link.a], &self.states[link.b], link.a == link.b);
                let near = Near::default();
                let keep = |i: u32, j: u32| keeps(self.kind, one, two, one_body, Pair { a: i, b: j }, &near);
                if let Some(couple) = couple(self.kind, one, two, one_body, self.threshold, &keep) {
                    if !*started {
                        couple.start(stack);
                    }
                    let mut found = Vec::new();
                    if self.parallel && stack.len() >= PARTS {
                        step_in_parts(&couple, stack, &mut found);
                    } else {
                        couple.step(stack, VISITS, usize::MAX, &mut found);
                    }
                    let Progress { verified, others, .. } = &mut pass.links[at];
                    for pair in found {
                        if verified.binary_search(&pair).is_err() {
                            others.push(pair);
                            pass.delivered.push(link.contact(pair));
                        }
                    }
                }
                near.count(&mut pass.skips);
                *started = !stack.is_empty();
                *turn += usize::from(stack.is_empty());
            }
            Phase::Done => {}
        }
        Ok(())
    }
}

/// Goes on with a descent on the threads of the current pool. What is found, and in which order, does not depend on their number.
fn step_in_parts(couple: &Couple<'_>, stack: &mut Vec<Visit>, found: &mut Vec<Pair>) {
    use rayon::prelude::*;
    let mut parts: Vec<(Vec<Visit>, Vec<Pair>)> = (0..PARTS).map(|_| Default::default()).collect();
    let first = stack.len().saturating_sub(PARTS * VISITS);
    for (at, visit) in stack.drain(first..).enumerate() {
        parts[at % PARTS].0.push(visit);
    }
    parts.par_iter_mut().for_each(|(stack, found)| {
        couple.step(stack, VISITS_OF_PART, usize::MAX, found);
    });
    for (rest, pairs) in &mut parts {
        stack.append(rest);
        found.append(pairs);
    }
}

/// Two sorted sequences as one.
fn merged(one: impl Iterator<Item = Pair>, other: Vec<Pair>) -> Vec<Pair> {
    let mut all = Vec::with_capacity(one.size_hint().0 + other.len());
    let mut other = other.into_iter().peekable();
    for pair in one {
        while let Some(before) = other.next_if(|before| *before < pair) {
            all.push(before);
        }
        all.push(pair);
    }
    all.extend(other);
    all
}
