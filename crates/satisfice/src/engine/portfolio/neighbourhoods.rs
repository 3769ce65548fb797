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

/// The graph that the problem's neighbours span, explored from the hits.
#[derive(Debug)]
pub(super) struct Neighbourhoods<S> {
    timing: NeighbourTiming,
    neighbours: ByTiming<S>,
}

#[derive(Debug)]
enum ByTiming<S> {
    /// Before the first hit.
    Undecided,
    AtOnce(Box<NeighboursAtOnce<S>>),
    Late(LateNeighbours<S>),
}

impl<S: Real> Neighbourhoods<S> {
    pub(super) fn new(timing: NeighbourTiming) -> Self {
        Self {
            timing,
            neighbours: ByTiming::Undecided,
        }
    }

    /// Forgets everything.
    pub(super) fn begin(&mut self) {
        self.neighbours = ByTiming::Undecided;
    }

    /// Whether there is a candidate to try.
    pub(super) fn has_more(&self) -> bool {
        match &self.neighbours {
            ByTiming::Undecided => false,
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
            match self.decided(context) {
                ByTiming::Undecided => {}
                ByTiming::AtOnce(neighbours) => {
                    neighbours.expand(context, visited, position, (fitness.f64(), is_hit));
                }
                ByTiming::Late(neighbours) => neighbours.expand(context, position, fitness.f64(), is_hit),
            }
        }
    }

    /// When neighbours come, by now decided.
    fn decided(&mut self, context: &dyn Context<S>) -> &mut ByTiming<S> {
        if matches!(self.neighbours, ByTiming::Undecided) {
            let is_late = match self.timing {
                NeighbourTiming::Auto => {
                    let is_cheap = || context.seconds_an_evaluation().is_none_or(|price| price < CHEAP);
                    context.evaluations_planned().is_none() && is_cheap()
                }
                timing => timing == NeighbourTiming::Late,
            };
            self.neighbours = if is_late {
                ByTiming::Late(LateNeighbours::default())
            } else {
                ByTiming::AtOnce(Box::default())
            };
        }
        &mut self.neighbours
    }

    /// Lets neighbours come late from here on once as many predictions were made as there is time for. Only of a lattice, where it is known
    /// which points were visited: elsewhere late neighbours repeat them.
    fn hand_over(&mut self, context: &dyn Context<S>) {
        if let ByTiming::AtOnce(at_once) = &self.neighbours
            && at_once.is_full()
            && context.space().is_lattice()
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
            ByTiming::Undecided => false,
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
            ByTiming::Undecided => Saved::save(&0_u8, state),
            ByTiming::AtOnce(neighbours) => {
                Saved::save(&1_u8, state);
                neighbours.save(state, dimension);
            }
            ByTiming::Late(neighbours) => {
                Saved::save(&2_u8, state);
                neighbours.save(state, dimension);
            }
        }
    }

    pub(super) fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        self.neighbours = match from.read::<u8>()? {
            0 => ByTiming::Undecided,
            1 => ByTiming::AtOnce(Box::new(NeighboursAtOnce::restore(from)?)),
            2 => ByTiming::Late(LateNeighbours::restore(from)?),
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
            ByTiming::Undecided => true,
            ByTiming::AtOnce(neighbours) => neighbours.fit(dimension),
            ByTiming::Late(neighbours) => neighbours.fit(dimension),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_come_late_where_evaluations_are_cheap_and_not_limited() {
        let is_late = |timing, planned, seconds_an_evaluation| {
            let context = rooks::Rooks {
                planned,
                seconds_an_evaluation,
                ..rooks::rooks()
            };
            let mut batch = Batch::new(2);
            batch.push(&[3.0, 5.0]);
            let mut all = Neighbourhoods::new(timing);
            all.expand_all(&context, None, (&batch, &[Outcome::Miss(2.0)]), |_| false);
            assert!(matches!(all.neighbours, ByTiming::Undecided));
            all.expand_all(&context, None, (&batch, &[Outcome::Hit(0.5)]), |_| false);
            assert!(all.has_more() && all.fit(2));
            let mut state = State::default();
            all.save(&mut state, 2);
            all.begin();
            assert!(!all.has_more());
            all.restore(&mut Reader::new(&state)).unwrap();
            matches!(all.neighbours, ByTiming::Late(_))
        };
        let auto = |planned, price| is_late(NeighbourTiming::Auto, planned, price);
        assert!(auto(None, None) && auto(None, Some(1e-6)));
        assert!(!auto(None, Some(2e-5)) && !auto(Some(100), None));
        assert!(is_late(NeighbourTiming::Late, Some(100), Some(1.0)));
        assert!(!is_late(NeighbourTiming::AtOnce, None, Some(1e-6)));
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
