//! Answers that reach the engines in the order told: there is always more to ask for.
//!
//! All engines share one archive and one budget. A lane is an engine and its batch; points of it are given out one by one. When
//! more is asked for than the lanes have, the first of these helps that can: a lane whose batch is answered is asked for the
//! next; one whose batch is answered by half is told so far and asked for the next; a new lane is opened. An answer to a batch
//! that was told is told by itself.

use std::collections::{BTreeMap, VecDeque};

use crate::accounting::Reached;
use crate::archive::Archive;
use crate::batch::{Batch, Outcome};
use crate::budget::{Budget, StopReason};
use crate::engine::{Answers, Ask, Origin, WarmStart};
use crate::identity::Identity;
use crate::probes::Probes;
use crate::problem::SatisficingProblem;
use crate::scalar::Real;
use crate::search::lane::{EMPTY_ASKS, Lane, RunningLane};
use crate::search::running::Running;
use crate::search::slice::Slice;
use crate::search::{MOST_LANES, Search};
use crate::seed::SearchRng;
use crate::view::View;

use super::Told;

/// So many candidates in a row that are out already: others have to be answered first.
const FRUITLESS: usize = 100;

/// A slice with its open tickets.
pub(super) struct Eager<S, T> {
    pub(super) slice: Slice<S, T>,
    pub(super) lanes: Vec<EagerLane<S>>,
    pub(super) open: BTreeMap<u64, Open<S, T>>,
    /// Probes that are to be given out, and how many are out.
    pub(super) probes: VecDeque<Vec<S>>,
    pub(super) probes_out: usize,
    /// What every engine is told of, those of later lanes included.
    pub(super) given: Vec<(Vec<S>, Outcome<S>, Origin)>,
    /// Whether a proposal was forgotten: then nothing is proved.
    pub(super) has_gaps: bool,
}

/// An open ticket.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(super) struct Open<S, T> {
    pub(super) solution: T,
    /// Empty where the problem does not encode it.
    pub(super) position: Vec<S>,
    pub(super) of: Of,
}

/// Whose a candidate is.
#[derive(Debug, Clone, Copy, serde::Serialize, serde::Deserialize)]
pub(super) enum Of {
    /// A lane's, at this place of this batch.
    Lane {
        lane: usize,
        batch: u64,
        place: usize,
    },
    Probe,
    /// A hit of the slice before.
    Verified,
    /// A point that the user has given.
    Start,
}

/// An engine and its batch.
pub(super) struct EagerLane<S> {
    pub(super) lane: Lane<S>,
    pub(super) batch: Batch<S>,
    pub(super) books: Books<S>,
}

/// How far a batch is.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(super) struct Books<S> {
    /// Which one it is.
    number: u64,
    outcomes: Vec<Outcome<S>>,
    /// The next point to be given out.
    next: usize,
    /// How many are out.
    out: usize,
    /// Whether the engine was told.
    told: bool,
    /// What the engine said last, and how often it had nothing to propose.
    last: Ask,
    idle: usize,
}

impl<S: Real> EagerLane<S> {
    fn new(lane: Lane<S>, dimension: usize) -> Self {
        Self {
            lane,
            batch: Batch::new(dimension),
            books: Books {
                number: 0,
                outcomes: Vec::new(),
                next: 0,
                out: 0,
                told: true,
                last: Ask::More,
                idle: 0,
            },
        }
    }

    pub(super) fn restored(lane: Lane<S>, batch: Batch<S>, books: Books<S>) -> Option<Self> {
        let fits =
            books.outcomes.len() == batch.len() && books.next <= batch.len() && books.out <= books.next;
        fits.then_some(Self { lane, batch, books })
    }

    fn has_points(&self) -> bool {
        self.books.next < self.batch.len()
    }

    fn has_ended(&self) -> bool {
        !self.has_points() && self.books.last != Ask::More
    }

    /// Whether every point of the space has been given out.
    fn has_covered(&self) -> bool {
        !self.has_points() && self.books.last == Ask::Covered
    }

    /// Whether it can be asked for the next batch.
    fn is_ready(&self) -> bool {
        self.books.told && !self.has_points() && self.books.last == Ask::More
    }

    /// Whether the batch can be told without the answers that are awaited.
    fn can_be_closed(&self) -> bool {
        let (out, all) = (self.books.out, self.batch.len());
        let enough = match self.lane.engine.answers() {
            Answers::ByBatch => 2 * out <= all,
            Answers::Alone | Answers::AnyOrder => true,
        };
        !self.books.told && !self.has_points() && self.books.last == Ask::More && enough
    }
}

impl<S: Real, T> Open<S, T> {
    /// Whether it fits these lanes, in a space of so many axes.
    pub(super) fn fits(&self, lanes: &[EagerLane<S>], dimension: usize) -> bool {
        let placed = match self.of {
            Of::Lane { lane, batch, place } => lanes.get(lane).is_some_and(|lane| {
                batch < lane.books.number || (batch == lane.books.number && place < lane.books.next)
            }),
            Of::Probe | Of::Verified | Of::Start => true,
        };
        placed && (self.position.is_empty() || self.position.len() == dimension)
    }
}

/// A batch of one point.
pub(super) fn one<S: Real>(position: &[S]) -> Batch<S> {
    let mut batch = Batch::new(position.len());
    batch.push(position);
    batch
}

impl<S: Real, T: Identity + Clone + Send + Sync> Eager<S, T> {
    /// Begins the slice.
    pub(super) fn begin<P>(
        search: &mut Search<P>,
        problem: &P,
        budget: &Budget,
        probes: Probes,
        rule: WarmStart,
    ) -> Self
    where
        P: SatisficingProblem<Scalar = S, Solution = T> + ?Sized,
    {
        let dimension = problem.space().dimension();
        let hits = search.previous.len();
        let to_verify = match rule {
            WarmStart::Verify => 0..hits,
            WarmStart::Cold | WarmStart::Engine => hits..hits,
        };
        let mut slice = Slice::begin(budget, dimension, probes, to_verify, Reached::default());
        slice.starts = search.take_starts(problem).concat();
        let mut eager = Self {
            slice,
            lanes: Vec::new(),
            open: BTreeMap::new(),
            probes: VecDeque::new(),
            probes_out: 0,
            given: Vec::new(),
            has_gaps: false,
        };
        for lane in core::mem::take(&mut search.lanes) {
            eager.add(lane, problem, &search.previous);
        }
        eager
    }

    fn add<P>(&mut self, mut lane: Lane<S>, problem: &P, previous: &Archive<T>)
    where
        P: SatisficingProblem<Scalar = S, Solution = T> + ?Sized,
    {
        let view = self.slice.view(problem, previous);
        lane.engine.begin(&view);
        for (position, outcome, origin) in &self.given {
            lane.engine.tell(&view, &one(position), &[*outcome], *origin);
        }
        self.lanes.push(EagerLane::new(lane, problem.space().dimension()));
    }

    /// Gives out the next solution under a number; `None` if others have to be answered first or the slice is over.
    pub(super) fn next<P>(&mut self, number: u64, problem: &P, search: &Search<P>) -> Option<T>
    where
        P: SatisficingProblem<Scalar = S, Solution = T> + ?Sized,
    {
        let mut fruitless = 0;
        while fruitless < FRUITLESS && !self.slice.ledger.is_over() {
            if self.slice.ledger.remaining() <= self.open.len() {
                return None;
            }
            let Some((position, solution, of)) = self.candidate(problem, search) else {
                if self.open.is_empty() {
                    self.slice.ledger.stop = self.slice.ledger.stop.or(self.verdict());
                }
                return None;
            };
            let deletes = self.deletes(of);
            if deletes && self.slice.ledger.archive.contains(&solution) {
                self.slice.ledger.settle_deleted();
                self.route(of, &position, Outcome::Deleted, problem, &search.previous);
            } else if self.is_out(problem, &position) {
                fruitless += 1;
                self.route(of, &position, Outcome::NotEvaluated, problem, &search.previous);
            } else {
                if let Of::Lane { lane, .. } = of {
                    self.lanes[lane].books.out += 1;
                }
                self.probes_out += usize::from(matches!(of, Of::Probe));
                let open = Open {
                    solution: solution.clone(),
                    position,
                    of,
                };
                self.open.insert(number, open);
                return Some(solution);
            }
        }
        None
    }

    /// Whether a point with the same values is out.
    fn is_out<P>(&self, problem: &P, position: &[S]) -> bool
    where
        P: SatisficingProblem<Scalar = S, Solution = T> + ?Sized,
    {
        let axes = problem.space().axes();
        self.open.values().any(|open| {
            let pairs = open.position.iter().zip(position).zip(axes);
            open.position.len() == position.len()
                && !position.is_empty()
                && pairs
                    .into_iter()
                    .all(|((&a, &b), axis)| axis.value(a) == axis.value(b))
        })
    }

    fn deletes(&self, of: Of) -> bool {
        match of {
            Of::Lane { lane, .. } => self.lanes[lane].lane.engine.deletes(),
            Of::Probe | Of::Verified | Of::Start => true,
        }
    }

    /// Why the slice ends when no lane has more to propose and nothing is out.
    fn verdict(&self) -> Option<StopReason> {
        if self.lanes.iter().any(EagerLane::has_covered) {
            let proved = !self.has_gaps;
            return Some(if proved {
                StopReason::Covered
            } else {
                StopReason::Exhausted
            });
        }
        let ended = self.lanes.iter().all(EagerLane::has_ended);
        ended.then_some(StopReason::Exhausted)
    }

    /// The next candidate.
    fn candidate<P>(&mut self, problem: &P, search: &Search<P>) -> Option<(Vec<S>, T, Of)>
    where
        P: SatisficingProblem<Scalar = S, Solution = T> + ?Sized,
    {
        if let Some(index) = self.slice.to_verify.next() {
            let solution = search.previous.solutions().get(index)?.clone();
            let position = super::position_of(problem, &solution).unwrap_or_default();
            return Some((position, solution, Of::Verified));
        }
        if self.probes_out == 0
            && self.probes.is_empty()
            && self.slice.probes.is_due(self.slice.ledger.counts.evaluations)
        {
            self.slice.probes.propose(problem, &mut self.slice.batch);
            let points = self.slice.batch.points().map(<[S]>::to_vec);
            self.probes.extend(points);
        }
        let dimension = problem.space().dimension();
        let (mut position, of) = if self.slice.starts.is_empty() {
            match self.probes.pop_front() {
                Some(position) => (position, Of::Probe),
                None => self.point(problem, search)?,
            }
        } else {
            (self.slice.starts.drain(..dimension).collect(), Of::Start)
        };
        let mut values = vec![S::zero(); position.len()];
        problem
            .space()
            .keep_inside_with_values(&mut position, &mut values);
        if let Of::Lane { lane, place, .. } = of {
            self.lanes[lane].batch.point_mut(place).copy_from_slice(&position);
        }
        Some((position, problem.decode(&values), of))
    }

    /// The next point of a lane.
    fn point<P>(&mut self, problem: &P, search: &Search<P>) -> Option<(Vec<S>, Of)>
    where
        P: SatisficingProblem<Scalar = S, Solution = T> + ?Sized,
    {
        let previous = &*search.previous;
        loop {
            if self.lanes.iter().any(EagerLane::has_covered) {
                return None;
            }
            if let Some(lane) = self.lanes.iter().position(EagerLane::has_points) {
                let EagerLane { batch, books, .. } = &mut self.lanes[lane];
                let place = books.next;
                books.next += 1;
                let of = Of::Lane {
                    lane,
                    batch: books.number,
                    place,
                };
                return Some((batch.point(place).to_vec(), of));
            }
            if self.slice.ledger.is_over() {
                return None; // by calls of bounds
            }
            if let Some(lane) = self.lanes.iter().position(EagerLane::is_ready) {
                self.ask(lane, problem, previous);
            } else if let Some(lane) = self.lanes.iter().position(EagerLane::can_be_closed) {
                self.tell_batch(lane, problem, previous);
            } else if self.lanes.len() < MOST_LANES
                && self.lanes.iter().all(|lane| {
                    lane.books.last == Ask::More && lane.lane.engine.answers() == Answers::ByBatch
                })
                && let Ok(engine) = search.engine.build()
            {
                let rng = SearchRng::stream(search.seed, self.lanes.len() as u64);
                self.add(Lane { engine, rng }, problem, previous);
            } else {
                return None;
            }
        }
    }

    /// Asks a lane for its next batch.
    fn ask<P>(&mut self, lane: usize, problem: &P, previous: &Archive<T>)
    where
        P: SatisficingProblem<Scalar = S, Solution = T> + ?Sized,
    {
        let EagerLane { lane, batch, books } = &mut self.lanes[lane];
        let slice = &mut self.slice;
        batch.clear();
        let view = View {
            problem,
            previous,
            ledger: &slice.ledger,
            calls: &slice.calls,
            scratches: &slice.scratches,
        };
        books.last = lane.engine.ask(&view, &mut lane.rng, batch);
        let bounds = slice.calls.bounds.get();
        let works = bounds > slice.ledger.counts.bound_calls;
        slice.ledger.count_bounds(bounds);
        books.number += 1;
        books.next = 0;
        books.out = 0;
        books.outcomes.clear();
        books.outcomes.resize(batch.len(), Outcome::NotEvaluated);
        books.told = batch.is_empty();
        // An engine that works on bounds has not come to its end.
        books.idle = if batch.is_empty() && !works {
            books.idle + 1
        } else {
            0
        };
        if books.idle >= EMPTY_ASKS && books.last == Ask::More {
            books.last = Ask::Exhausted;
        }
    }

    /// Tells a lane's engine what is known of its batch.
    fn tell_batch<P>(&mut self, lane: usize, problem: &P, previous: &Archive<T>)
    where
        P: SatisficingProblem<Scalar = S, Solution = T> + ?Sized,
    {
        let EagerLane { lane, batch, books } = &mut self.lanes[lane];
        books.told = true;
        if lane.engine.answers() != Answers::AnyOrder {
            let view = self.slice.view(problem, previous);
            lane.engine.tell(&view, batch, &books.outcomes, Origin::Engine);
        }
    }

    /// Lets a lane, the probes, or all engines know what became of a candidate that is not out any more.
    fn route<P>(&mut self, of: Of, position: &[S], outcome: Outcome<S>, problem: &P, previous: &Archive<T>)
    where
        P: SatisficingProblem<Scalar = S, Solution = T> + ?Sized,
    {
        match of {
            Of::Lane { lane, batch, place } => {
                let view = self.slice.view(problem, previous);
                let EagerLane {
                    lane: Lane { engine, .. },
                    books,
                    batch: points,
                } = &mut self.lanes[lane];
                let any_order = engine.answers() == Answers::AnyOrder;
                if any_order {
                    engine.tell(&view, &one(position), &[outcome], Origin::Engine);
                }
                if batch == books.number && !books.told {
                    books.outcomes[place] = outcome;
                    if books.next == points.len() && books.out == 0 {
                        self.tell_batch(lane, problem, previous);
                    }
                } else if !any_order && outcome != Outcome::NotEvaluated {
                    engine.tell(&view, &one(position), &[outcome], Origin::WarmStart);
                }
            }
            Of::Probe => {
                let (batch, archive) = (one(position), &self.slice.ledger.archive);
                self.slice.probes.take(problem, &batch, &[outcome], archive);
                self.slice.ledger.counts.probes = self.slice.probes.count();
            }
            Of::Verified => {
                self.slice.ledger.counts.verified += u64::from(outcome != Outcome::NotEvaluated);
                self.tell_all(position, outcome, Origin::WarmStart, problem, previous);
            }
            Of::Start => self.tell_all(position, outcome, Origin::Start, problem, previous),
        }
    }

    fn tell_all<P>(
        &mut self,
        position: &[S],
        outcome: Outcome<S>,
        origin: Origin,
        problem: &P,
        previous: &Archive<T>,
    ) where
        P: SatisficingProblem<Scalar = S, Solution = T> + ?Sized,
    {
        if position.is_empty() || outcome == Outcome::NotEvaluated {
            return;
        }
        let (batch, view) = (one(position), self.slice.view(problem, previous));
        for lane in &mut self.lanes {
            lane.lane.engine.tell(&view, &batch, &[outcome], origin);
        }
        self.given.push((position.to_vec(), outcome, origin));
    }

    /// Takes a value, or forgets a ticket; `None` if it is not open.
    pub(super) fn tell<P>(
        &mut self,
        number: u64,
        value: Option<S>,
        problem: &P,
        previous: &Archive<T>,
    ) -> Option<Told>
    where
        P: SatisficingProblem<Scalar = S, Solution = T> + ?Sized,
    {
        let Open {
            solution,
            position,
            of,
        } = self.open.remove(&number)?;
        match of {
            Of::Probe => self.probes_out -= 1,
            Of::Lane { lane, batch, .. } => {
                let books = &mut self.lanes[lane].books;
                books.out -= usize::from(batch == books.number);
            }
            Of::Verified | Of::Start => {}
        }
        let over = self.slice.ledger.stops_before_more();
        let outcome = match value {
            Some(value) if !over => {
                let (deletes, probing) = (self.deletes(of), matches!(of, Of::Probe));
                let ledger = &mut self.slice.ledger;
                ledger.settle_one(problem, &solution, value, deletes, probing)
            }
            _ => {
                self.has_gaps = true;
                Outcome::NotEvaluated
            }
        };
        self.route(of, &position, outcome, problem, previous);
        Some(if over { Told::Over } else { Told::Taken })
    }

    /// Enters a value from elsewhere, and tells every engine.
    pub(super) fn inform<P>(
        &mut self,
        problem: &P,
        previous: &Archive<T>,
        solution: &T,
        value: S,
        position: &[S],
    ) where
        P: SatisficingProblem<Scalar = S, Solution = T> + ?Sized,
    {
        let outcome = self.slice.ledger.inform(problem, solution, value);
        self.tell_all(position, outcome, Origin::Start, problem, previous);
    }

    /// Whether restored parts fit each other.
    pub(super) fn fits(&self, dimension: usize) -> bool {
        let of_lane = |number: usize, lane: &EagerLane<S>| {
            let out = self.open.values().filter(|open| {
                matches!(open.of, Of::Lane { lane: of, batch, .. } if of == number && batch == lane.books.number)
            });
            out.count() == lane.books.out
        };
        let probes = self.open.values().filter(|open| matches!(open.of, Of::Probe));
        !self.lanes.is_empty()
            && self
                .lanes
                .iter()
                .enumerate()
                .all(|(number, lane)| of_lane(number, lane))
            && probes.count() == self.probes_out
            && self
                .probes
                .iter()
                .chain(self.given.iter().map(|(position, ..)| position))
                .all(|position| position.len() == dimension)
    }

    pub(super) fn open(&self) -> usize {
        self.open.len()
    }

    pub(super) fn pending(&self) -> Vec<u64> {
        self.open.keys().copied().collect()
    }

    pub(super) fn solution(&self, number: u64) -> Option<&T> {
        self.open.get(&number).map(|open| &open.solution)
    }

    /// Ends the slice. Its first engine goes on in the next one, if that has one lane.
    pub(super) fn finish(mut self) -> Running<S, T> {
        let _ = self.slice.ledger.is_over();
        let mut slice = Some(self.slice);
        let running = |lane: EagerLane<S>| {
            let slice = slice.take()?;
            Some(RunningLane {
                lane: lane.lane,
                slice,
            })
        };
        Running {
            lanes: self.lanes.into_iter().map_while(running).collect(),
            exchange: None,
        }
    }
}
