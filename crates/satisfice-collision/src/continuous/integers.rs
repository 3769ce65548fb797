//! The coordinates of a motion as integers in a common power of two.

use dashu_int::IBig;

use super::form::{Form, FormVector};
use super::motion::PairMotion;
use crate::distance::exact::{integer, mantissa};

/// A part of the step, `numerators / 2^shift`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Interval {
    pub(super) from: u64,
    pub(super) to: u64,
    pub(super) shift: u32,
}

impl Interval {
    /// The whole step.
    pub(super) const WHOLE: Self = Self {
        from: 0,
        to: 1,
        shift: 0,
    };

    /// The least part in steps of `2^-shift` that contains `from..=to`, both in `[0, 1]`.
    pub(super) fn around(from: f64, to: f64, shift: u32) -> Self {
        let unit = (1_u64 << shift) as f64;
        let from = ((from * unit).floor() as u64).min((1 << shift) - 1);
        Self {
            from,
            to: ((to * unit).ceil() as u64).max(from + 1),
            shift,
        }
    }

    /// The start as a time.
    pub(super) fn start(&self) -> f64 {
        self.from as f64 / (1_u64 << self.shift) as f64
    }

    /// The end as a time.
    pub(super) fn end(&self) -> f64 {
        self.to as f64 / (1_u64 << self.shift) as f64
    }
}

/// The differences `a_i - b_j` over a part of the step as linear forms, and delta in the same unit.
pub(super) struct Differences {
    pub(super) corners: Vec<FormVector>,
    pub(super) delta: IBig,
}

impl Differences {
    pub(super) fn new<const M: usize, const N: usize>(
        motion: &PairMotion<M, N>,
        delta: f64,
        part: Interval,
    ) -> Self {
        let unit = motion
            .coordinates()
            .chain([delta])
            .filter(|&x| x != 0.0)
            .map(|x| mantissa(x).1)
            .min()
            .unwrap_or(0);
        // Times 2^shift, so that the ends of the part are integers too.
        let all = IBig::ONE << part.shift as usize;
        let at = |from: &IBig, to: &IBig, time: u64| from * (&all - IBig::from(time)) + to * IBig::from(time);
        let difference = |i: usize, j: usize, k: usize| {
            let from = integer(motion.from_a[i][k], unit) - integer(motion.from_b[j][k], unit);
            let to = integer(motion.to_a[i][k], unit) - integer(motion.to_b[j][k], unit);
            Form::linear(at(&from, &to, part.from), at(&from, &to, part.to))
        };
        Self {
            corners: (0..M)
                .flat_map(|i| (0..N).map(move |j| (i, j)))
                .map(|(i, j)| [0, 1, 2].map(|k| difference(i, j, k)))
                .collect(),
            delta: integer(delta, unit) << part.shift as usize,
        }
    }
}
