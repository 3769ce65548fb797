//! Signal temporal logic over sampled signals, with quantitative semantics: the fitness of falsification.

use core::ops::RangeInclusive;
use std::collections::VecDeque;

use satisfice::Error;

/// Signals sampled at the same times.
///
/// ```
/// use satisfice_problems::Trace;
/// let trace = Trace::new(vec![vec![0.0, 1.5, 0.8], vec![1.0, 1.0, 2.0]])?; // two signals, three samples
/// assert_eq!(trace.signals()[1][2], 2.0);
/// assert!(Trace::new(vec![vec![0.0], vec![1.0, 2.0]]).is_err());
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Trace {
    signals: Vec<Vec<f64>>,
    length: usize,
}

impl Trace {
    /// A trace of these signals, each a list of samples.
    ///
    /// # Errors
    /// [`Error::Parameter`] if there is no signal or no sample, or if signals differ in length.
    pub fn new(signals: Vec<Vec<f64>>) -> Result<Self, Error> {
        let length = signals.first().map_or(0, Vec::len);
        if length == 0 {
            return Err(Error::parameter(
                "signals",
                "none",
                "at least one signal of at least one sample",
            ));
        }
        if let Some(other) = signals.iter().find(|signal| signal.len() != length) {
            return Err(Error::parameter(
                "samples",
                other.len(),
                format!("{length}, as in the first signal"),
            ));
        }
        Ok(Self { signals, length })
    }

    /// The samples of each signal.
    #[must_use]
    pub fn signals(&self) -> &[Vec<f64>] {
        &self.signals
    }
}

/// A formula of signal temporal logic (Maler, Nickovic 2004, doi 10.1007/978-3-540-30206-3_12), built without a parser.
///
/// [`robustness`](Specification::robustness) is the quantitative semantics (Donzé, Maler 2010, doi 10.1007/978-3-642-15297-9_9):
/// positive where the trace satisfies the formula, negative where it falsifies it. Intervals are in samples, relative to
/// the present one; samples past the end of the trace are left out: `always` over no sample holds (plus infinity),
/// `eventually` over no sample fails (minus infinity).
///
/// ```
/// use satisfice_problems::{Specification, Trace};
/// // Whenever the signal is above 1, it is below 0.5 within two samples.
/// let settles = Specification::below(0, 0.5).eventually(0..=2);
/// let rule = Specification::above(0, 1.0).implies(settles).always(0..=10);
/// let trace = Trace::new(vec![vec![0.0, 1.5, 0.8, 0.2, 0.0]])?;
/// assert!((rule.robustness(&trace) - 0.3).abs() < 1e-12); // at the second sample: 0.5 - 0.2
/// # Ok::<(), satisfice::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Specification(Node);

#[derive(Debug, Clone, PartialEq)]
enum Node {
    /// factor * (signal - level).
    Level {
        signal: usize,
        level: f64,
        factor: f64,
    },
    Not(Box<Node>),
    And(Box<Node>, Box<Node>),
    Or(Box<Node>, Box<Node>),
    Always(Box<Node>, RangeInclusive<usize>),
    Eventually(Box<Node>, RangeInclusive<usize>),
    Until(Box<Node>, Box<Node>, RangeInclusive<usize>),
}

impl Specification {
    /// Signal `signal` is above `level`: robustness x - level.
    #[must_use]
    pub fn above(signal: usize, level: f64) -> Self {
        Self(Node::Level {
            signal,
            level,
            factor: 1.0,
        })
    }
    /// Signal `signal` is below `level`: robustness level - x.
    #[must_use]
    pub fn below(signal: usize, level: f64) -> Self {
        Self(Node::Level {
            signal,
            level,
            factor: -1.0,
        })
    }
    /// The negation: minus the robustness.
    #[must_use]
    #[expect(clippy::should_implement_trait, reason = "reads like the other connectives")]
    pub fn not(self) -> Self {
        Self(Node::Not(Box::new(self.0)))
    }
    /// The conjunction: the minimum.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self(Node::And(Box::new(self.0), Box::new(other.0)))
    }
    /// The disjunction: the maximum.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self(Node::Or(Box::new(self.0), Box::new(other.0)))
    }
    /// If this, then `other`.
    #[must_use]
    pub fn implies(self, other: Self) -> Self {
        self.not().or(other)
    }
    /// At all samples from `steps.start()` to `steps.end()` from now: the minimum.
    #[must_use]
    pub fn always(self, steps: RangeInclusive<usize>) -> Self {
        Self(Node::Always(Box::new(self.0), steps))
    }
    /// At one of these samples: the maximum.
    #[must_use]
    pub fn eventually(self, steps: RangeInclusive<usize>) -> Self {
        Self(Node::Eventually(Box::new(self.0), steps))
    }
    /// `other` at one of these samples, and this at every sample before it from now on.
    #[must_use]
    pub fn until(self, other: Self, steps: RangeInclusive<usize>) -> Self {
        Self(Node::Until(Box::new(self.0), Box::new(other.0), steps))
    }

    /// The robustness at the first sample; NaN if the formula names a signal that the trace lacks.
    ///
    /// Cost: O(n) per connective for n samples; O(n w) for `until` over w samples.
    #[must_use]
    pub fn robustness(&self, trace: &Trace) -> f64 {
        self.0.robustness(trace).map_or(f64::NAN, |all| all[0])
    }
}

impl Node {
    /// The robustness at each sample.
    fn robustness(&self, trace: &Trace) -> Option<Vec<f64>> {
        let pointwise = |a: &Self, b: &Self, choose: fn(f64, f64) -> f64| {
            let (a, b) = (a.robustness(trace)?, b.robustness(trace)?);
            Some(a.into_iter().zip(b).map(|(a, b)| choose(a, b)).collect())
        };
        match self {
            Self::Level {
                signal,
                level,
                factor,
            } => {
                let signal = trace.signals.get(*signal)?;
                Some(signal.iter().map(|x| factor * (x - level)).collect())
            }
            Self::Not(inner) => Some(negative(inner.robustness(trace)?)),
            Self::And(a, b) => pointwise(a, b, f64::min),
            Self::Or(a, b) => pointwise(a, b, f64::max),
            Self::Always(inner, steps) => Some(window_minima(&inner.robustness(trace)?, steps)),
            Self::Eventually(inner, steps) => Some(negative(window_minima(
                &negative(inner.robustness(trace)?),
                steps,
            ))),
            Self::Until(a, b, steps) => {
                let (a, b) = (a.robustness(trace)?, b.robustness(trace)?);
                Some(
                    (0..trace.length)
                        .map(|now| until(&a[now..], &b[now..], steps))
                        .collect(),
                )
            }
        }
    }
}

fn negative(mut values: Vec<f64>) -> Vec<f64> {
    values.iter_mut().for_each(|value| *value = -*value);
    values
}

/// max over k in `steps` of min(b[k], min over l < k of a[l]).
fn until(a: &[f64], b: &[f64], steps: &RangeInclusive<usize>) -> f64 {
    let (mut held, mut best) = (f64::INFINITY, f64::NEG_INFINITY);
    for (k, (a, b)) in a.iter().zip(b).enumerate() {
        if k > *steps.end() {
            break;
        }
        if steps.contains(&k) {
            best = best.max(held.min(*b));
        }
        held = held.min(*a);
    }
    best
}

/// The minimum of `values[t + from ..= t + to]` for each t, by a queue of candidates (Lemire 2006, arXiv cs/0610046).
fn window_minima(values: &[f64], steps: &RangeInclusive<usize>) -> Vec<f64> {
    let n = values.len();
    let mut minima = vec![f64::INFINITY; n];
    let mut queue: VecDeque<usize> = VecDeque::new();
    let mut entered = 0;
    for (t, minimum) in minima.iter_mut().enumerate() {
        let first = t.saturating_add(*steps.start()).max(entered);
        let end = t.saturating_add(*steps.end()).saturating_add(1).min(n);
        for k in first..end {
            while queue.back().is_some_and(|&last| values[last] >= values[k]) {
                queue.pop_back();
            }
            queue.push_back(k);
        }
        entered = entered.max(end);
        while queue
            .front()
            .is_some_and(|&k| k < t.saturating_add(*steps.start()))
        {
            queue.pop_front();
        }
        if let Some(&k) = queue.front().filter(|_| !steps.is_empty()) {
            *minimum = values[k];
        }
    }
    minima
}
