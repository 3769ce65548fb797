//! Moves of a local search, chosen by how often each has brought an improvement.

use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::Space;

/// The number of kinds of moves on integer axes, and of all kinds.
const LATTICE: usize = 6;
const KINDS: usize = LATTICE + 2;
/// Every kind keeps at least this much weight beside its rate of improvement.
const FLOOR: f64 = 0.02;
/// Past trials of a kind are halved at this number.
const MEMORY: f64 = 500.0;

/// A kind of move.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(into = "usize", from = "usize")]
pub(super) enum Move {
    /// Along integer axes, in one of several ways.
    Lattice(usize),
    /// To a neighbour that the problem names.
    Neighbour,
    /// A draw of the covariance-adapting mutation along continuous axes.
    Mutation,
}

impl Move {
    fn index(self) -> usize {
        match self {
            Self::Lattice(way) => way,
            Self::Neighbour => LATTICE,
            Self::Mutation => LATTICE + 1,
        }
    }

    fn of(index: usize) -> Self {
        match index {
            LATTICE => Self::Neighbour,
            index if index > LATTICE => Self::Mutation,
            way => Self::Lattice(way),
        }
    }
}

impl From<Move> for usize {
    fn from(kind: Move) -> Self {
        kind.index()
    }
}

/// Every number is a move, so that a damaged state leads to no other.
impl From<usize> for Move {
    fn from(index: usize) -> Self {
        Self::of(index)
    }
}

/// Adaptive choice among moves: probability matching on the rate of strict improvements (Fialho 2010, chapter 3).
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(super) struct Moves {
    trials: [f64; KINDS],
    improvements: [f64; KINDS],
}

impl Default for Moves {
    fn default() -> Self {
        Self {
            trials: [2.0; KINDS],
            improvements: [1.0; KINDS],
        }
    }
}

impl Moves {
    /// Draws a kind of move among those that are usable: lattice moves, neighbours, mutations.
    pub(super) fn choose(&self, usable: [bool; 3], rng: &mut SearchRng) -> Move {
        let [lattice, neighbours, mutations] = usable;
        let weight = |kind: usize| match Move::of(kind) {
            Move::Lattice(_) if !lattice => 0.0,
            Move::Neighbour if !neighbours => 0.0,
            Move::Mutation if !mutations => 0.0,
            _ => self.improvements[kind] / self.trials[kind] + FLOOR,
        };
        let mut left = rng.uniform() * (0..KINDS).map(weight).sum::<f64>();
        let mut last = Move::Mutation;
        for kind in (0..KINDS).filter(|&kind| weight(kind) > 0.0) {
            last = Move::of(kind);
            left -= weight(kind);
            if left < 0.0 {
                break;
            }
        }
        last
    }

    /// Moves a position along some of `axes`, all integer, in one of the ways. The result may lie outside.
    pub(super) fn along<S: Real>(
        way: usize,
        space: &Space<S>,
        axes: &[usize],
        rng: &mut SearchRng,
        position: &mut [S],
    ) {
        let j = axes[rng.below(axes.len())];
        match way {
            0 => {
                let (_, sign) = rng.uniform_and_sign();
                position[j] = position[j] + if sign { S::one() } else { -S::one() };
            }
            1 => position[j] = position[j] + log_uniform_step(space, j, rng),
            2 => position[j] = space.axes()[j].at(rng.uniform()),
            3 => {
                position[j] = position[j] + log_uniform_step(space, j, rng);
                let other = axes[rng.below(axes.len())];
                position[other] = position[other] + log_uniform_step(space, other, rng);
            }
            4 => position.swap(j, axes[rng.below(axes.len())]),
            _ => {
                for &axis in axes {
                    position[axis] = position[axis] + S::of((2.0 * rng.normal()).round());
                }
            }
        }
    }

    /// Counts a move of this kind.
    pub(super) fn count(&mut self, of: Move, improved: bool) {
        let kind = of.index();
        self.trials[kind] += 1.0;
        self.improvements[kind] += f64::from(u8::from(improved));
        if self.trials[kind] > MEMORY {
            self.trials[kind] *= 0.5;
            self.improvements[kind] *= 0.5;
        }
    }
}

/// A whole step of log-uniform length between 1 and the axis, fair sign.
fn log_uniform_step<S: Real>(space: &Space<S>, axis: usize, rng: &mut SearchRng) -> S {
    let (share, sign) = rng.uniform_and_sign();
    let length = space.axes()[axis].width().f64().powf(share).floor().max(1.0);
    S::of(if sign { length } else { -length })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Probability matching: a kind is drawn with its rate of improvement plus the floor, over the sum of all.
    #[test]
    fn moves_are_drawn_by_their_rates_of_improvement() {
        let mut moves = Moves::default();
        for i in 0..98 {
            moves.count(Move::Neighbour, i < 39);
            moves.count(Move::Mutation, false);
        }
        // (1 + 39) / (2 + 98) + 0.02 = 0.42 against 1 / 100 + 0.02 = 0.03.
        let mut rng = SearchRng::new(4);
        let draws = 20_000;
        let neighbours = (0..draws)
            .filter(|_| moves.choose([false, true, true], &mut rng) == Move::Neighbour)
            .count();
        approx::assert_relative_eq!(
            neighbours as f64 / f64::from(draws),
            0.42 / 0.45,
            max_relative = 0.01
        );
    }
}
