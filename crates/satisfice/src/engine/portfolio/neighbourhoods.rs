//! The neighbourhoods that the problem itself names.

mod at_once;
mod candidates;
mod late;
#[cfg(test)]
mod rooks;

use self::at_once::NeighboursAtOnce;
use self::late::LateNeighbours;
use super::NeighbourTiming;
use super::visited::Visited;
use crate::batch::{Batch, Outcome};
use crate::context::Context;
use crate::error::Error;
use crate::scalar::Real;
use crate::state::{Reader, Saved, State};

/// Neighbours come late where an evaluation takes less than so many seconds: to predict each of dozens takes about as long.
const CHEAP: f64 = 1e-5;

/// The graph that the problem's neighbours span, explored from the hits: at once, and late as soon as that is known to be better.
#[derive(Debug)]
pub(super) struct Neighbourhoods<S> {
    timing: NeighbourTiming,
    neighbours: ByTiming<S>,
}

#[derive(Debug)]
enum ByTiming<S> {
    AtOnce(Box<NeighboursAtOnce<S>>),
    Late(LateNeighbours<S>),
}

impl<S: Real> Neighbourhoods<S> {
    pub(super) fn new(timing: NeighbourTiming) -> Self {
        Self {
            timing,
            neighbours: ByTiming::AtOnce(Box::default()),
        }
    }

    /// Forgets everything.
    pub(super) fn begin(&mut self) {
        self.neighbours = ByTiming::AtOnce(Box::default());
    }

    /// Whether there is a candidate to try.
    pub(super) fn has_more(&self) -> bool {
        match &self.neighbours {
            ByTiming::AtOnce(neighbours) => neighbours.has_more(),
            ByTiming::Late(neighbours) => neighbours.has_more(),
        }
    }

    /// Takes note of the hits of a batch, and of the misses that are near to a hit, by their place in the batch.
    pub(super) fn expand_all(
        &mut self,
        context: &dyn Context<S>,
        visited: Option<&Visited>,
        (batch, outcomes): (&Batch<S>, &[Outcome<S>]),
        is_near: impl Fn(usize) -> bool,
    ) {
        for (i, (position, outcome)) in batch.points().zip(outcomes).enumerate() {
            let (fitness, is_hit) = match *outcome {
                Outcome::Hit(fitness) => (fitness, true),
                Outcome::Miss(fitness) if is_near(i) => (fitness, false),
                _ => continue,
            };
            self.hand_over(context);
            match &mut self.neighbours {
                ByTiming::AtOnce(neighbours) => {
                    neighbours.expand(context, visited, position, (fitness.f64(), is_hit));
                }
                ByTiming::Late(neighbours) => neighbours.expand(context, position, fitness.f64(), is_hit),
            }
        }
    }

    /// Whether neighbours that have come at once so far are to come late from here on.
    fn are_late(&self, context: &dyn Context<S>, at_once: &NeighboursAtOnce<S>) -> bool {
        if self.timing == NeighbourTiming::Late {
            return true;
        }
        // As many predictions were made as there is time for. Outside lattices nobody knows which points were visited, and late neighbours
        // repeat them.
        if at_once.is_full() && context.space().is_discrete() {
            return true;
        }
        let is_cheap = || context.seconds_an_evaluation().is_some_and(|price| price < CHEAP);
        self.timing == NeighbourTiming::Auto && is_cheap()
    }

    /// Lets neighbours come late from here on, if that is better by now.
    fn hand_over(&mut self, context: &dyn Context<S>) {
        if let ByTiming::AtOnce(at_once) = &self.neighbours
            && self.are_late(context, at_once)
        {
            let mut late = LateNeighbours::default();
            for (position, fitness) in at_once.hits(context.space().dimension()) {
                late.expand(context, position, fitness, true);
            }
            self.neighbours = ByTiming::Late(late);
        }
    }

    /// Writes the best candidate; `false` when there is none.
    pub(super) fn propose(
        &mut self,
        context: &dyn Context<S>,
        visited: Option<&Visited>,
        position: &mut [S],
    ) -> bool {
        match &mut self.neighbours {
            ByTiming::AtOnce(neighbours) => neighbours.propose(context, visited, position),
            ByTiming::Late(neighbours) => neighbours.propose(context, position),
        }
    }

    /// Counts a candidate and its fitness.
    pub(super) fn count(&mut self, fitness: S) {
        if let ByTiming::AtOnce(neighbours) = &mut self.neighbours {
            neighbours.count(fitness);
        }
    }

    pub(super) fn save(&self, state: &mut State, dimension: usize) {
        match &self.neighbours {
            ByTiming::AtOnce(neighbours) => {
                Saved::save(&0_u8, state);
                neighbours.save(state, dimension);
            }
            ByTiming::Late(neighbours) => {
                Saved::save(&1_u8, state);
                neighbours.save(state, dimension);
            }
        }
    }

    pub(super) fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        self.neighbours = match from.read::<u8>()? {
            0 => ByTiming::AtOnce(Box::new(NeighboursAtOnce::restore(from)?)),
            1 => ByTiming::Late(LateNeighbours::restore(from)?),
            _ => {
                return Err(Error::State(
                    "its neighbourhoods are of an unknown kind".to_owned(),
                ));
            }
        };
        Ok(())
    }

    /// Whether restored parts fit each other and the space.
    pub(super) fn fit(&self, dimension: usize) -> bool {
        match &self.neighbours {
            ByTiming::AtOnce(neighbours) => neighbours.fit(dimension),
            ByTiming::Late(neighbours) => neighbours.fit(dimension),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_come_late_once_evaluations_are_known_to_be_cheap() {
        let are_late = |timing, prices: &[Option<f64>]| {
            let mut all = Neighbourhoods::new(timing);
            for (x, &seconds_an_evaluation) in (1..).zip(prices) {
                let context = rooks::Rooks {
                    seconds_an_evaluation,
                    ..rooks::rooks()
                };
                let mut batch = Batch::new(2);
                batch.push(&[f64::from(x), 5.0]);
                all.expand_all(&context, None, (&batch, &[Outcome::Miss(2.0)]), |_| false);
                all.expand_all(&context, None, (&batch, &[Outcome::Hit(0.5)]), |_| false);
            }
            assert!(all.has_more() && all.fit(2));
            let mut state = State::default();
            all.save(&mut state, 2);
            all.begin();
            assert!(!all.has_more());
            all.restore(&mut Reader::new(&state)).unwrap();
            // The first hit has four hundred neighbours but itself, and none is lost.
            let (mut column, mut position) = (0, [0.0; 2]);
            while all.propose(&rooks::rooks(), None, &mut position) {
                column += usize::from(position[0] == 1.0);
            }
            assert!(column >= rooks::SIDE - 1, "{timing:?} {prices:?}: {column}");
            matches!(all.neighbours, ByTiming::Late(_))
        };
        let auto = |prices: &[_]| are_late(NeighbourTiming::Auto, prices);
        assert!(auto(&[Some(1e-6)]) && auto(&[None, Some(1e-6)]) && auto(&[Some(2e-5), Some(1e-6)]));
        assert!(!auto(&[None]) && !auto(&[Some(2e-5)]));
        assert!(are_late(NeighbourTiming::Late, &[None]));
        assert!(!are_late(NeighbourTiming::AtOnce, &[Some(1e-6)]));
    }

    #[test]
    fn neighbours_at_once_are_late_ones_from_some_number_on_and_no_hit_is_lost() {
        let enter = |context: &rooks::Rooks| {
            let mut all = Neighbourhoods::new(NeighbourTiming::AtOnce);
            for i in 0..rooks::SIDE * rooks::SIDE {
                let mut batch = Batch::new(2);
                #[expect(clippy::cast_precision_loss, reason = "small")]
                batch.push(&[(i % rooks::SIDE) as f64, (i / rooks::SIDE) as f64]);
                let outcome = if i == 4321 {
                    Outcome::Hit(-0.5)
                } else {
                    Outcome::Miss(2.0)
                };
                all.expand_all(context, None, (&batch, &[outcome]), |_| true);
            }
            all
        };
        let mut context = rooks::rooks();
        let mut all = enter(&context);
        assert!(matches!(all.neighbours, ByTiming::Late(_)));
        let mut position = [0.0; 2];
        for _ in 0..398 {
            assert!(all.propose(&context, None, &mut position));
            assert!((position[0] == 121.0) != (position[1] == 21.0), "{position:?}");
        }
        // Late ones would be evaluated again where no visited points are known.
        context.space = crate::Space::new([crate::Axis::continuous(0.0, 200.0); 2]).unwrap();
        assert!(matches!(enter(&context).neighbours, ByTiming::AtOnce(_)));
    }
}
