//! Moves of a local search on integer axes, chosen by how often each has brought an improvement.

use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::Space;

/// The kinds of moves.
const KINDS: usize = 6;
/// Every kind keeps at least this much weight beside its rate of improvement.
const FLOOR: f64 = 0.02;
/// Past trials of a kind are halved at this number.
const MEMORY: f64 = 500.0;

/// Adaptive choice among moves: probability matching on the rate of strict improvements (Fialho 2010, chapter 3).
#[derive(Debug, Clone)]
pub(super) struct Moves {
    trials: [f64; KINDS],
    improvements: [f64; KINDS],
}

crate::saved_struct!(Moves { trials, improvements });

impl Default for Moves {
    fn default() -> Self {
        Self {
            trials: [2.0; KINDS],
            improvements: [1.0; KINDS],
        }
    }
}

impl Moves {
    /// Moves a position along some of `axes`, all integer, and returns the kind of move. The result may lie outside.
    pub(super) fn apply<S: Real>(
        &self,
        space: &Space<S>,
        axes: &[usize],
        rng: &mut SearchRng,
        position: &mut [S],
    ) -> usize {
        let kind = self.choose(rng);
        let j = axes[rng.below(axes.len())];
        match kind {
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
        kind
    }

    fn choose(&self, rng: &mut SearchRng) -> usize {
        let weight = |kind: usize| self.improvements[kind] / self.trials[kind] + FLOOR;
        let mut left = rng.uniform() * (0..KINDS).map(weight).sum::<f64>();
        for kind in 0..KINDS - 1 {
            left -= weight(kind);
            if left < 0.0 {
                return kind;
            }
        }
        KINDS - 1
    }

    /// Books a move of this kind.
    pub(super) fn book(&mut self, kind: usize, improved: bool) {
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
