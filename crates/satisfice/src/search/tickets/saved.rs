//! Tickets as a part of a checkpoint.

use std::collections::VecDeque;
use std::sync::Arc;

use super::agenda::Agenda;
use super::contents::SavedTickets;
use super::lane::{EagerLane, Open};
use super::ordered::{Ordered, Out};
use super::{Eager, Inner, Order, Tickets, ValueBits, position_of};
use crate::batch::Batch;
use crate::engine::{Answers, ConfiguredEngine};
use crate::error::Error;
use crate::identity::Identity;
use crate::problem::SatisficingProblem;
use crate::scalar::Real;
use crate::search::Search;
use crate::search::checkpoint::Checkpoint;
use crate::search::kept::KeptSearch;
use crate::search::lane::Lane;
use crate::search::slice::Slice;
use crate::state::{Reader, Saved, State};

impl<P: SatisficingProblem + ?Sized> Tickets<P> {
    /// The search, the slice and its tickets as they are now. Cost: a copy of the archive and of the engines' state.
    #[must_use]
    pub fn checkpoint(&self) -> Checkpoint<P::Solution> {
        let mut informed = Vec::new();
        let (mut checkpoint, state) = match &self.state {
            Inner::Ordered(ordered) => {
                let mut state = State::default();
                ordered.batches().save(&mut state);
                let waiting = ordered.informed.iter();
                informed
                    .extend(waiting.map(|(solution, value, _)| (solution.clone(), ValueBits::of(*value))));
                (self.search.kept.save(Some(&ordered.running)), state)
            }
            Inner::Eager(eager) => {
                let mut checkpoint = self.search.kept.save(None);
                checkpoint.contents.unfinished = Some(eager.slice.save());
                checkpoint.contents.lanes = eager.lanes.iter().map(|lane| lane.lane.save()).collect();
                (checkpoint, eager.save())
            }
        };
        let pending = self.pending();
        let open = pending.iter().filter_map(|&ticket| {
            let solution = self.solution(ticket)?;
            Some((ticket.number(), solution.clone()))
        });
        checkpoint.contents.tickets = Some(SavedTickets {
            order: self.order(),
            next: self.next,
            open: open.collect(),
            forgotten: self.forgotten.iter().copied().collect(),
            counts: self.ticket_counts(),
            waits: self.waits,
            log: self.log.clone(),
            informed,
            state,
        });
        checkpoint
    }

    /// Continues a slice that was saved. Tickets that were open may be told, and [`ask`](Tickets::ask) gives them out again
    /// before others.
    ///
    /// # Errors
    /// As [`Search::resume`] and [`Search::run_resumed`]; [`Error::State`] for a checkpoint of a slice without tickets.
    pub fn resume(
        checkpoint: Checkpoint<P::Solution>,
        engine: impl Into<ConfiguredEngine<P::Scalar>>,
        problem: impl Into<Arc<P>>,
    ) -> Result<Self, Error> {
        let problem = problem.into();
        let (mut kept, mut saved, lanes) = KeptSearch::resume_parts(checkpoint, engine.into())?;
        let Some(tickets) = saved.tickets.take() else {
            return Err(Error::State(
                "its slice has no tickets: resume the search".to_owned(),
            ));
        };
        kept.check_saved(&&*problem)?;
        kept.resumed = false;
        let dimension = problem.space().dimension();
        if saved.dimension != Some(dimension) {
            return Err(Error::State("a slice without axes".to_owned()));
        }
        let mut reader = Reader::new(&tickets.state);
        let state = match tickets.order {
            Order::Ordered => {
                let mut ordered = Ordered::new(crate::search::resume::restore(saved, lanes)?);
                ordered.has_gaps = !tickets.forgotten.is_empty();
                ordered.unused = tickets.counts.unused;
                let out: Vec<Out<P::Scalar>> = reader.read()?;
                for out in out {
                    if !ordered.propose_again(out, &&*problem, &kept.previous) {
                        return Err(misfit());
                    }
                }
                for (solution, value) in tickets.informed {
                    let position = position_of(&&*problem, &solution)?;
                    ordered.informed.push((solution, value.value(), position));
                }
                Inner::Ordered(ordered)
            }
            Order::Eager => {
                let previous = kept.previous.len();
                let slice = saved.unfinished.ok_or_else(misfit)?;
                let slice = Slice::restore(slice, dimension, previous)?;
                Inner::Eager(Eager::restore(
                    &mut reader,
                    slice,
                    lanes,
                    &tickets.open,
                    dimension,
                )?)
            }
        };
        reader.finish()?;
        let mut resumed = Self::new(Search { kept }, problem, state);
        let numbers: VecDeque<u64> = tickets.open.iter().map(|&(number, _)| number).collect();
        let pending = resumed.pending();
        let fits = pending.len() == numbers.len()
            && pending
                .iter()
                .zip(&numbers)
                .all(|(ticket, &number)| ticket.number() == number)
            && numbers.back().is_none_or(|&last| last < tickets.next);
        if !fits {
            return Err(misfit());
        }
        resumed.next = tickets.next;
        resumed.again = numbers;
        resumed.forgotten = tickets.forgotten.into_iter().collect();
        resumed.counts = tickets.counts;
        resumed.waits = tickets.waits;
        resumed.log = tickets.log;
        Ok(resumed)
    }
}

fn misfit() -> Error {
    Error::State("its tickets do not fit its slice".to_owned())
}

impl<S: Real, T: Identity + Clone + Send + Sync> Eager<S, T> {
    fn save(&self) -> State {
        let mut state = State::default();
        for lane in &self.lanes {
            lane.batch.positions().to_vec().save(&mut state);
            lane.progress.save(&mut state);
        }
        for open in self.open.values() {
            open.position.save(&mut state);
            open.of.save(&mut state);
        }
        self.probes.save(&mut state);
        self.probes_out.save(&mut state);
        self.given.save(&mut state);
        self.has_gaps.save(&mut state);
        state
    }

    fn restore(
        reader: &mut Reader<'_>,
        mut slice: Slice<S, T>,
        lanes: Vec<Lane<S>>,
        open: &[(u64, T)],
        dimension: usize,
    ) -> Result<Self, Error> {
        let mut restored = Vec::with_capacity(lanes.len());
        slice.ledger.in_any_order = lanes
            .iter()
            .any(|lane| lane.engine.answers() == Answers::AnyOrder);
        for lane in lanes {
            let batch = Batch::from_positions(reader.read()?, dimension).ok_or_else(misfit)?;
            let lane = EagerLane::restored(lane, batch, reader.read()?);
            restored.push(lane.ok_or_else(misfit)?);
        }
        let mut tickets = std::collections::BTreeMap::new();
        for (number, solution) in open {
            let (position, of): (Vec<S>, _) = (reader.read()?, reader.read()?);
            let open = Open {
                solution: solution.clone(),
                position,
                of,
            };
            if !open.fits(&restored, dimension) {
                return Err(misfit());
            }
            tickets.insert(*number, open);
        }
        let eager = Self {
            slice,
            agenda: Agenda::of(&restored),
            lanes: restored,
            open: tickets,
            points_out: super::out::PointsOut::default(),
            probes: reader.read()?,
            probes_out: reader.read()?,
            given: reader.read()?,
            has_gaps: reader.read()?,
        };
        eager.fits(dimension).then_some(eager).ok_or_else(misfit)
    }
}
