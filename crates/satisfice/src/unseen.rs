//! How many hits are not yet seen: estimates with intervals, from uniform probes.

use crate::binomial::clopper_pearson;

/// The confidence of every interval.
const CONFIDENCE: f64 = 0.9;
/// The standard normal quantile of (1 + confidence) / 2.
const QUANTILE: f64 = 1.644_853_626_951_472_7;

/// The hits that a slice has not found, estimated.
///
/// `docs/completeness.md` says what is assumed and where that fails.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Unseen {
    /// The number of distinct hits that are not in C, estimated. Not rounded.
    pub estimate: f64,
    /// Two-sided interval for that number, whole ends included; no upper end where nothing bounds it.
    pub interval: (f64, Option<f64>),
    /// Two-sided interval for the share of the space (of points, or of volume) whose points are hits that the engine has
    /// not found. It assumes nothing beyond uniform probes; 0 where proved.
    pub mass: (f64, f64),
    /// The chance with which each interval holds the truth, at least: 0.9, or 1 where proved.
    pub confidence: f64,
    /// How it was estimated.
    pub method: Method,
    /// Uniform probes that were evaluated.
    pub probes: u64,
    /// Probes that hit what the engine has found as well.
    pub recaptures: u64,
    /// Probes that hit what the engine has not found.
    pub fresh: u64,
}

/// How unseen hits are estimated.
///
/// n probes; m of them hit one of the c hits that the engine has found, u hit one of the v that it has not. Of the v,
/// the probes found d, which are in C; what is unseen is v - d.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Method {
    /// The space was covered or excluded by bounds: nothing is unseen.
    Proved,
    /// A lattice of N points, one for each solution. Outside the engine's hits, probes hit with probability v / (N - c):
    /// the interval is Clopper and Pearson's for u of n - m, exact at any n (1934, doi 10.1093/biomet/26.4.404). It is
    /// narrower than one for all hits from n probes, since c is known and not estimated.
    Lattice,
    /// Hits that are no points of a lattice, taken as equally easy to hit: probes that hit are recaptures with probability
    /// c / (c + v). The estimate is Chapman's, (c + 1) (m + u + 1) / (m + 1) - 1 - c (1951), the interval Clopper and
    /// Pearson's for m of m + u. Where the engine prefers hits that are easy to hit, it is a lower bound.
    Recapture,
    /// As before, but the engine has found nothing: a lower bound from hits that one probe (f1) or two (f2) found,
    /// f1 (f1 - 1) / (2 (f2 + 1)), with a log-normal interval (Chao 1984, Scand. J. Stat. 11; 1987, doi 10.2307/2531532;
    /// after Good 1953, doi 10.1093/biomet/40.3-4.237).
    Chao,
}

impl Unseen {
    /// Nothing is unseen, for sure.
    pub(crate) fn nothing(probes: u64) -> Self {
        Self {
            estimate: 0.0,
            interval: (0.0, Some(0.0)),
            mass: (0.0, 0.0),
            confidence: 1.0,
            method: Method::Proved,
            probes,
            recaptures: 0,
            fresh: 0,
        }
    }
}

impl core::fmt::Display for Unseen {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let (lower, upper) = self.interval;
        // Without a probe that supports it, an estimate of 0 says less than its interval.
        if self.estimate >= 0.5 || upper.is_some_and(|upper| upper < 1.0) {
            write!(f, "{} ", Whole(self.estimate))?;
        }
        match upper {
            Some(upper) => write!(f, "[{}, {}]", Whole(lower), Whole(upper)),
            None => write!(f, "[{}, ?]", Whole(lower)),
        }
    }
}

/// A whole number, a large one by its exponent.
struct Whole(f64);

impl core::fmt::Display for Whole {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let x = self.0;
        if x < 1e9 {
            write!(f, "{x:.0}")
        } else {
            write!(f, "{x:.1e}")
        }
    }
}

/// What the probes of a slice found, counted.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(crate) struct Sample {
    /// N, where the space is a lattice.
    pub(crate) points: Option<f64>,
    /// c.
    pub(crate) known: u64,
    /// n.
    pub(crate) probes: u64,
    /// m.
    pub(crate) recaptures: u64,
    /// u.
    pub(crate) fresh: u64,
    /// m and u of probes at the one point that stands for its solution.
    pub(crate) own_recaptures: u64,
    pub(crate) own_fresh: u64,
    /// d.
    pub(crate) distinct: u64,
    /// f1.
    pub(crate) once: u64,
    /// f2.
    pub(crate) twice: u64,
    /// Points of the lattice do not stand for solutions one to one.
    pub(crate) blurred: bool,
}

impl Sample {
    pub(crate) fn estimate(&self) -> Option<Unseen> {
        if self.probes == 0 {
            return None;
        }
        let (d, c) = (self.distinct as f64, self.known as f64);
        // No more solutions than points.
        let most = self.points.map(|points| (points - c - d).max(0.0));
        let (method, estimate, lower, upper) = match self.points {
            Some(points) if !self.blurred => self.by_lattice(points - c),
            _ if self.known > 0 => self.by_recapture(c),
            _ => self.by_chao(),
        };
        // Ends are whole, with room for the rounding of what was whole; an interval between two whole numbers becomes the
        // one nearest to the estimate.
        let room = 1e-9;
        let upper = upper.map(|upper| (upper * (1.0 + room)).floor());
        let mut lower = (lower * (1.0 - room)).ceil();
        let mut upper = upper;
        if upper.is_some_and(|upper| lower > upper) {
            lower = estimate.round();
            upper = Some(lower);
        }
        let within = |x: f64| {
            let x = (x - d).max(0.0);
            most.map_or(x, |most| x.min(most))
        };
        let (lower, upper) = (within(lower), upper.map_or(most, |upper| Some(within(upper))));
        Some(Unseen {
            estimate: within(estimate).max(lower).min(upper.unwrap_or(f64::INFINITY)),
            interval: (lower, upper),
            mass: clopper_pearson(self.fresh, self.probes, CONFIDENCE),
            confidence: CONFIDENCE,
            method,
            probes: self.probes,
            recaptures: self.recaptures,
            fresh: self.fresh,
        })
    }

    /// v and its interval, where `others` points are not the engine's hits.
    fn by_lattice(&self, others: f64) -> (Method, f64, f64, Option<f64>) {
        let trials = self.probes - self.own_recaptures;
        let (lower, upper) = clopper_pearson(self.own_fresh, trials, CONFIDENCE);
        let share = self.own_fresh as f64 / (trials as f64).max(1.0);
        (
            Method::Lattice,
            share * others,
            lower * others,
            Some(upper * others),
        )
    }

    /// v and its interval, where all hits are equally easy to hit and the engine has `c` of them.
    fn by_recapture(&self, c: f64) -> (Method, f64, f64, Option<f64>) {
        let (m, hits) = (self.recaptures as f64, self.recaptures + self.fresh);
        let (lower, upper) = clopper_pearson(self.recaptures, hits, CONFIDENCE);
        let chapman = (c + 1.0) * (hits as f64 + 1.0) / (m + 1.0) - 1.0 - c;
        (
            Method::Recapture,
            chapman,
            c * (1.0 / upper - 1.0),
            (lower > 0.0).then(|| c * (1.0 / lower - 1.0)),
        )
    }

    /// v and its interval, where the engine has found nothing.
    fn by_chao(&self) -> (Method, f64, f64, Option<f64>) {
        let (f1, f2, d) = (self.once as f64, self.twice as f64, self.distinct as f64);
        let n = self.probes as f64;
        let a = (n - 1.0) / n;
        let next = f2 + 1.0;
        let more = a * f1 * (f1 - 1.0) / (2.0 * next);
        if more <= 0.0 {
            return (Method::Chao, d, d, None); // no repetition tells how many there are
        }
        let variance = more
            + (a * f1 * (2.0 * f1 - 1.0) / (2.0 * next)).powi(2) / f1
            + f2 * (a * f1 * (f1 - 1.0) / (2.0 * next * next)).powi(2);
        let factor = (QUANTILE * (variance / (more * more)).ln_1p().sqrt()).exp();
        (Method::Chao, d + more, d + more / factor, Some(d + more * factor))
    }
}

#[cfg(test)]
#[path = "unseen_tests.rs"]
mod tests;
