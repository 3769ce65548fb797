//! The coordinates of a motion as integers in a common power of two.

use dashu_int::IBig;

use super::conditions::Conditions;
use super::form::Form;
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
        self.from as f64 * 0.5_f64.powi(self.shift as i32)
    }

    /// The end as a time.
    pub(super) fn end(&self) -> f64 {
        self.to as f64 * 0.5_f64.powi(self.shift as i32)
    }
}

/// The conditions of a motion over a part of the step.
pub(super) fn exact<const M: usize, const N: usize>(
    motion: &PairMotion<M, N>,
    delta: f64,
    during: Interval,
) -> Conditions<Form> {
    let unit = motion
        .coordinates()
        .chain([delta])
        .filter(|&x| x != 0.0)
        .map(|x| mantissa(x).1)
        .min()
        .unwrap_or(0);
    // Times 2^shift, so that the ends of the part are integers too.
    let all = IBig::ONE << during.shift as usize;
    let at = |from: &IBig, to: &IBig, time: u64| from * (&all - IBig::from(time)) + to * IBig::from(time);
    let difference = |i: usize, j: usize, k: usize| {
        let from = integer(motion.from_a[i][k], unit) - integer(motion.from_b[j][k], unit);
        let to = integer(motion.to_a[i][k], unit) - integer(motion.to_b[j][k], unit);
        Form::linear(at(&from, &to, during.from), at(&from, &to, during.to))
    };
    let delta_squared = (delta != 0.0).then(|| {
        let delta = integer(delta, unit) << during.shift as usize;
        Form::new(vec![&delta * &delta]).raised(2)
    });
    Conditions {
        corners: (0..M)
            .flat_map(|i| (0..N).map(move |j| (i, j)))
            .map(|(i, j)| [0, 1, 2].map(|k| difference(i, j, k)))
            .collect(),
        delta_squared,
    }
}
