//! A frame under a budget: the likeliest pairs first, and an exact resume.

use super::link::{Link, Near, couple, keeps};
use super::{Completeness, Contact, Frame, Scene, Skips};
use crate::Error;
use crate::broad::{Couple, Pair, Visit};

/// Pairs verified between two questions to the budget.
const STRIDE: usize = 64;
/// Pairs of groups of eight boxes visited between two questions to the budget.
const VISITS: usize = 16;

/// A descent on several threads goes on in so many parts, however many threads there are.
const PARTS: usize = 16;
/// Visits of each part between two questions to the budget.
const VISITS_OF_PART: usize = 256;

/// A frame that is being enumerated piece by piece. First come the contacts of the last frame that hold whatever moved (see
/// [`Scene::measure_contacts`]), then the others are verified, those of the bodies with most contacts first; then the
/// bodies are searched in the same order.
pub struct Pass {
    frame: u64,
    order: Vec<usize>,
    /// For each link the pairs delivered so far.
    delivered: Vec<Vec<Pair>>,
    contacts: Vec<Contact>,
    phase: Phase,
    skips: Skips,
}

enum Phase {
    /// Taking over the contacts that hold by the bound of motion, from pair `next` of the link at `turn` of the order on.
    Held {
        turn: usize,
        next: usize,
    },
    /// Verifying the others, likewise.
    Verify {
        turn: usize,
        next: usize,
    },
    /// Descending; the stack is empty between links. `verified` counts the pairs of this link from the first phase.
    Search {
        turn: usize,
        stack: Vec<Visit>,
        started: bool,
        verified: usize,
    },
    Done,
}

impl Pass {
    /// The contacts found so far, in the order in which they were found; nothing twice.
    #[must_use]
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
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
        let mut contacts = self.contacts;
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
        let mut order: Vec<usize> = (0..self.links.len()).collect();
        order.sort_by_key(|&at| (std::cmp::Reverse(self.links[at].pairs.len()), at));
        Pass {
            frame: self.frame,
            order,
            delivered: vec![Vec::new(); self.links.len()],
            contacts: Vec::new(),
            phase: Phase::Held { turn: 0, next: 0 },
            skips: self.start_skips(),
        }
    }

    /// Goes on with a pass until it is complete or `stop` says so; `stop` is asked every few microseconds and may look at a
    /// clock, a counter or `found` contacts. Called again, it goes on exactly where it stopped: however often it is interrupted,
    /// a pass delivers the same contacts in the same order. What it delivered is what the next pass tries first.
    ///
    /// # Errors
    /// [`Error::Parameter`] if the scene has moved since the pass began.
    pub fn advance(
        &mut self,
        pass: &mut Pass,
        stop: &mut dyn FnMut(usize) -> bool,
    ) -> Result<Completeness, Error> {
        if pass.frame != self.frame || !self.linked || pass.delivered.len() != self.links.len() {
            return Err(Error::parameter(
                "pass",
                pass.frame,
                "a pass of the present frame",
            ));
        }
        while !matches!(pass.phase, Phase::Done) && !stop(pass.contacts.len()) {
            self.piece(pass)?;
        }
        Ok(pass.completeness())
    }

    /// Ends a pass: its contacts are what the next frame starts from, complete or not.
    pub fn finish(&mut self, pass: Pass) -> Frame {
        let done = matches!(pass.phase, Phase::Done);
        if pass.frame == self.frame && pass.delivered.len() == self.links.len() {
            for (link, pairs) in self.links.iter_mut().zip(&pass.delivered) {
                link.pairs.clone_from(pairs);
                link.pairs.sort_unstable();
                link.forget(done.then_some(self.frame));
            }
        }
        pass.into_frame()
    }

    /// The slack of each contact of the last frame, and how much of it the bodies' motion has used; a contact that was closer
    /// than the bodies have moved is one still.
    fn held<'l>(&self, link: &'l Link) -> Option<(&'l [f32], f64)> {
        Some((link.slack(self.frame.checked_sub(1))?, self.motion(link)))
    }

    fn piece(&mut self, pass: &mut Pass) -> Result<(), Error> {
        match &mut pass.phase {
            Phase::Held { turn, next } => {
                let Some(&at) = pass.order.get(*turn) else {
                    pass.phase = Phase::Verify { turn: 0, next: 0 };
                    return Ok(());
                };
                let link = &self.links[at];
                let held = self.held(link);
                let end = held.map_or(0, |(slack, _)| slack.len().min(*next + 16 * STRIDE));
                if let Some((slack, motion)) = held {
                    for (&pair, &slack) in link.pairs[*next..end].iter().zip(&slack[*next..end]) {
                        if f64::from(slack) > motion {
                            pass.delivered[at].push(pair);
                            pass.contacts.push(link.contact(pair));
                            pass.skips.held_by_motion += 1;
                        }
                    }
                }
                *next = end;
                if held.is_none() || end == link.pairs.len() {
                    (*turn, *next) = (*turn + 1, 0);
                }
            }
            Phase::Verify { turn, next } => {
                let Some(&at) = pass.order.get(*turn) else {
                    pass.phase = Phase::Search {
                        turn: 0,
                        stack: Vec::new(),
                        started: false,
                        verified: 0,
                    };
                    return Ok(());
                };
                let link = &self.links[at];
                let end = link.pairs.len().min(*next + STRIDE);
                let held = self.held(link);
                for (i, &pair) in (*next..).zip(&link.pairs[*next..end]) {
                    let taken = held.is_some_and(|(slack, motion)| f64::from(slack[i]) > motion);
                    if !taken && self.decide(link, pair) {
                        pass.delivered[at].push(pair);
                        pass.contacts.push(link.contact(pair));
                    }
                }
                *next = end;
                if end == link.pairs.len() {
                    (*turn, *next) = (*turn + 1, 0);
                }
            }
            Phase::Search {
                turn,
                stack,
                started,
                verified,
            } => {
                let Some(&at) = pass.order.get(*turn) else {
                    pass.phase = Phase::Done;
                    return Ok(());
                };
                let delivered = &mut pass.delivered[at];
                if !*started {
                    delivered.sort_unstable();
                    *verified = delivered.len();
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
                    for pair in found {
                        if delivered[..*verified].binary_search(&pair).is_err() {
                            delivered.push(pair);
                            pass.contacts.push(link.contact(pair));
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
