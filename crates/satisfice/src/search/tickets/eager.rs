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
use crate::error::Error;
use crate::identity::Identity;
use crate::problem::AnyProblem;
use crate::scalar::Real;
use crate::search::kept::{KeptSearch, MOST_LANES};
use crate::search::lane::{EMPTY_ASKS, Lane, RunningLane};
use crate::search::running::Running;
use crate::search::slice::Slice;
use crate::seed::SearchRng;
use crate::view::View;

use super::Told;
use super::agenda::{Agenda, Next};
use super::lane::{EagerLane, Of, Open};
use super::out::PointsOut;

/// So many candidates in a row that are out already: others have to be answered first.
const FRUITLESS: usize = 100;

/// A slice with its open tickets.
pub(super) struct Eager<S, T> {
    pub(super) slice: Slice<S, T>,
    pub(super) lanes: Vec<EagerLane<S>>,
    pub(super) agenda: Agenda,
    pub(super) open: BTreeMap<u64, Open<S, T>>,
    pub(super) points_out: PointsOut,
    /// Probes that are to be given out, and how many are out.
    pub(super) probes: VecDeque<Vec<S>>,
    pub(super) probes_out: usize,
    /// What every engine is told of, those of later lanes included.
    pub(super) given: Vec<(Vec<S>, Outcome<S>, Origin)>,
    /// Whether a proposal was forgotten: then nothing is proved.
    pub(super) has_gaps: bool,
}

impl<S: Real, T: Identity + Clone + Send + Sync> Eager<S, T> {
    /// Begins the slice.
    pub(super) fn begin(
        kept: &mut KeptSearch<S, T>,
        problem: &AnyProblem<'_, S, T>,
        budget: &Budget,
    ) -> Result<Self, Error> {
        let (probes, rule) = kept.prepare(problem, budget)?;
        let dimension = problem.space().dimension();
        let hits = kept.previous.len();
        let to_verify = match rule {
            WarmStart::Verify => 0..hits,
            WarmStart::Cold | WarmStart::Engine => hits..hits,
        };
        let mut slice = Slice::begin(budget, dimension, probes, to_verify, Reached::default());
        slice.set_starts(&kept.take_starts(problem));
        let mut eager = Self {
            slice,
            lanes: Vec::new(),
            agenda: Agenda::default(),
            open: BTreeMap::new(),
            points_out: PointsOut::default(),
            probes: VecDeque::new(),
            probes_out: 0,
            given: Vec::new(),
            has_gaps: false,
        };
        for lane in core::mem::take(&mut kept.lanes) {
            eager.add(lane, problem, &kept.previous);
        }
        Ok(eager)
    }

    fn add(&mut self, mut lane: Lane<S>, problem: &AnyProblem<'_, S, T>, previous: &Archive<T>) {
        self.slice.ledger.in_any_order = lane.engine.answers() == Answers::AnyOrder;
        let view = self.slice.view(problem, previous);
        lane.engine.begin(&view);
        for (position, outcome, origin) in &self.given {
            lane.engine
                .tell(&view, &Batch::of_one(position), &[*outcome], *origin);
        }
        self.lanes.push(EagerLane::new(lane, problem.space().dimension()));
        self.agenda.note(&self.lanes, self.lanes.len() - 1);
    }

    /// Gives out the next solution under a number; `None` if others have to be answered first or the slice is over.
    pub(super) fn next(
        &mut self,
        number: u64,
        problem: &AnyProblem<'_, S, T>,
        kept: &KeptSearch<S, T>,
    ) -> Option<T> {
        let mut fruitless = 0;
        while fruitless < FRUITLESS && !self.slice.ledger.is_over() {
            if self.slice.ledger.remaining() <= self.open.len() {
                return None;
            }
            let Some((position, solution, of)) = self.candidate(problem, kept) else {
                if self.open.is_empty() {
                    self.slice.ledger.stop = self.slice.ledger.stop.or(self.verdict());
                }
                return None;
            };
            let deletes = self.deletes(of);
            if deletes && self.slice.ledger.archive.contains(&solution) {
                self.slice.ledger.settle_deleted();
                self.route(of, &position, Outcome::Deleted, problem, &kept.previous);
            } else if self
                .points_out
                .contains(problem.space().axes(), &position, &self.open)
            {
                fruitless += 1;
                self.route(of, &position, Outcome::NotEvaluated, problem, &kept.previous);
            } else {
                if let Of::Lane { lane, .. } = of {
                    self.lanes[lane].progress.out += 1;
                    self.agenda.note(&self.lanes, lane);
                }
                self.probes_out += usize::from(matches!(of, Of::Probe));
                let open = Open {
                    solution: solution.clone(),
                    position,
                    of,
                };
                self.points_out.add(problem.space().axes(), &open.position);
                self.open.insert(number, open);
                return Some(solution);
            }
        }
        None
    }

    fn deletes(&self, of: Of) -> bool {
        match of {
            Of::Lane { lane, .. } => self.lanes[lane].lane.engine.deletes(),
            Of::Probe | Of::Verified | Of::Start => true,
        }
    }

    /// Why the slice ends when no lane has more to propose and nothing is out.
    fn verdict(&self) -> Option<StopReason> {
        if self.agenda.first(Next::Covered).is_some() {
            let proved = !self.has_gaps;
            return Some(if proved {
                StopReason::Covered
            } else {
                StopReason::Exhausted
            });
        }
        self.agenda.has_ended().then_some(StopReason::Exhausted)
    }

    /// The next candidate.
    fn candidate(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        kept: &KeptSearch<S, T>,
    ) -> Option<(Vec<S>, T, Of)> {
        if let Some(index) = self.slice.to_verify.next() {
            let solution = kept.previous.solutions().get(index)?.clone();
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
                None => self.point(problem, kept)?,
            }
        } else {
            (self.slice.next_starts(1, dimension), Of::Start)
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
    fn point(&mut self, problem: &AnyProblem<'_, S, T>, kept: &KeptSearch<S, T>) -> Option<(Vec<S>, Of)> {
        let previous = &*kept.previous;
        loop {
            if self.agenda.first(Next::Covered).is_some() {
                return None;
            }
            if let Some(lane) = self.agenda.first(Next::Point) {
                let EagerLane { batch, progress, .. } = &mut self.lanes[lane];
                let place = progress.next;
                progress.next += 1;
                let of = Of::Lane {
                    lane,
                    batch: progress.number,
                    place,
                };
                let position = batch.point(place).to_vec();
                self.agenda.note(&self.lanes, lane);
                return Some((position, of));
            }
            if self.slice.ledger.is_over() {
                return None; // by calls of bounds
            }
            if let Some(lane) = self.agenda.first(Next::Ask) {
                self.ask(lane, problem, previous);
            } else if let Some(lane) = self.agenda.first(Next::Tell) {
                self.tell_batch(lane, problem, previous);
            } else if self.lanes.len() < MOST_LANES
                && self.agenda.first(Next::End).is_none()
                && self.lanes[0].lane.engine.answers() == Answers::ByBatch
                && let Ok(engine) = kept.engine.build()
            {
                let rng = SearchRng::stream(kept.seed, self.lanes.len() as u64);
                self.add(Lane { engine, rng }, problem, previous);
            } else {
                return None;
            }
        }
    }

    /// Asks a lane for its next batch.
    fn ask(&mut self, number: usize, problem: &AnyProblem<'_, S, T>, previous: &Archive<T>) {
        let EagerLane {
            lane,
            batch,
            progress,
        } = &mut self.lanes[number];
        let slice = &mut self.slice;
        batch.clear();
        let view = View {
            problem,
            previous,
            ledger: &slice.ledger,
            calls: &slice.calls,
            scratches: &slice.scratches,
        };
        progress.last = lane.engine.ask(&view, &mut lane.rng, batch);
        let bounds = slice.calls.bounds.get();
        let works = bounds > slice.ledger.counts.bound_calls;
        slice.ledger.count_bounds(bounds);
        progress.number += 1;
        progress.next = 0;
        progress.out = 0;
        progress.outcomes.clear();
        progress.outcomes.resize(batch.len(), Outcome::NotEvaluated);
        progress.told = batch.is_empty();
        // An engine that works on bounds has not come to its end.
        progress.idle = if batch.is_empty() && !works {
            progress.idle + 1
        } else {
            0
        };
        if progress.idle >= EMPTY_ASKS && progress.last == Ask::More {
            progress.last = Ask::Exhausted;
        }
        self.agenda.note(&self.lanes, number);
    }

    /// Tells a lane's engine what is known of its batch.
    fn tell_batch(&mut self, number: usize, problem: &AnyProblem<'_, S, T>, previous: &Archive<T>) {
        let EagerLane {
            lane,
            batch,
            progress,
        } = &mut self.lanes[number];
        progress.told = true;
        if lane.engine.answers() != Answers::AnyOrder {
            let view = self.slice.view(problem, previous);
            lane.engine.tell(&view, batch, &progress.outcomes, Origin::Engine);
        }
        self.agenda.note(&self.lanes, number);
        let engines = self.lanes.iter().map(|lane| lane.lane.engine.sources());
        self.slice.record_sources(engines);
    }

    /// Lets a lane, the probes, or all engines know what became of a candidate that is not out any more.
    fn route(
        &mut self,
        of: Of,
        position: &[S],
        outcome: Outcome<S>,
        problem: &AnyProblem<'_, S, T>,
        previous: &Archive<T>,
    ) {
        match of {
            Of::Lane { lane, batch, place } => {
                let view = self.slice.view(problem, previous);
                let EagerLane {
                    lane: Lane { engine, .. },
                    progress,
                    batch: points,
                } = &mut self.lanes[lane];
                let any_order = engine.answers() == Answers::AnyOrder;
                if any_order {
                    let origin = Origin::Single { ask: batch, place };
                    engine.tell(&view, &Batch::of_one(position), &[outcome], origin);
                }
                if batch == progress.number && !progress.told {
                    progress.outcomes[place] = outcome;
                    if progress.next == points.len() && progress.out == 0 {
                        self.tell_batch(lane, problem, previous);
                    }
                } else if !any_order && outcome != Outcome::NotEvaluated {
                    engine.tell(&view, &Batch::of_one(position), &[outcome], Origin::WarmStart);
                }
            }
            Of::Probe => {
                let (batch, archive) = (Batch::of_one(position), self.slice.ledger.archive.all());
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

    fn tell_all(
        &mut self,
        position: &[S],
        outcome: Outcome<S>,
        origin: Origin,
        problem: &AnyProblem<'_, S, T>,
        previous: &Archive<T>,
    ) {
        if position.is_empty() || outcome == Outcome::NotEvaluated {
            return;
        }
        let (batch, view) = (Batch::of_one(position), self.slice.view(problem, previous));
        for lane in &mut self.lanes {
            lane.lane.engine.tell(&view, &batch, &[outcome], origin);
        }
        self.given.push((position.to_vec(), outcome, origin));
    }

    /// Takes a value, or forgets a ticket; `None` if it is not open.
    pub(super) fn tell(
        &mut self,
        number: u64,
        value: Option<S>,
        problem: &AnyProblem<'_, S, T>,
        previous: &Archive<T>,
    ) -> Option<Told> {
        let Open {
            solution,
            position,
            of,
        } = self.open.remove(&number)?;
        self.points_out.remove(problem.space().axes(), &position);
        match of {
            Of::Probe => self.probes_out -= 1,
            Of::Lane { lane, batch, .. } => {
                let progress = &mut self.lanes[lane].progress;
                progress.out -= usize::from(batch == progress.number);
                self.agenda.note(&self.lanes, lane);
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
    pub(super) fn inform(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        previous: &Archive<T>,
        solution: &T,
        value: S,
        position: &[S],
    ) {
        let outcome = self.slice.ledger.inform(problem, solution, value);
        self.tell_all(position, outcome, Origin::Start, problem, previous);
    }

    /// Whether restored parts fit each other.
    pub(super) fn fits(&self, dimension: usize) -> bool {
        let mut out = vec![0; self.lanes.len()];
        for open in self.open.values() {
            if let Of::Lane { lane, batch, .. } = open.of
                && batch == self.lanes[lane].progress.number
            {
                out[lane] += 1;
            }
        }
        let probes = self.open.values().filter(|open| matches!(open.of, Of::Probe));
        !self.lanes.is_empty()
            && self
                .lanes
                .iter()
                .zip(out)
                .all(|(lane, out)| lane.progress.out == out)
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

    /// Ends the slice. Its first engine continues in the next one, if that has one lane.
    pub(super) fn finish(mut self) -> Running<S, T> {
        if !self.slice.ledger.is_over() {
            self.slice.ledger.give_up();
        }
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
