//! Estimates of the number of unseen hits, with intervals, from uniform probes.

use crate::binomial::clopper_pearson;

/// The confidence of every interval.
const CONFIDENCE: f64 = 0.9;
/// The standard normal quantile of (1 + confidence) / 2.
const QUANTILE: f64 = 1.644_853_626_951_472_7;

/// An estimate of the hits that a slice has not found.
///
/// `docs/completeness.md` describes the assumptions and where they fail.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Unseen {
    /// The estimated number of distinct hits that are not in C. Not rounded.
    pub estimate: f64,
    /// Two-sided interval for that number, ends included, both whole; no upper end if it is unbounded.
    pub interval: (f64, Option<f64>),
    /// Two-sided interval for the share of the space (of its points or volume) that is hits which the engine has not
    /// found. It assumes uniform probes only; 0 if completeness is proved.
    pub mass: (f64, f64),
    /// The probability, at least, that each interval contains the true value: 0.9, or 1 if proved.
    pub confidence: f64,
    /// The method of estimation.
    pub method: Method,
    /// Uniform probes that were evaluated.
    pub probes: u64,
    /// Probes whose hit the engine has found too.
    pub recaptures: u64,
    /// Probes whose hit the engine has not found.
    pub fresh: u64,
}

/// The method by which unseen hits are estimated.
///
/// Of n probes, m hit one of the c hits that the engine has found, and u one of the v that it has not. Probes found d of
/// these v, which are in C: v - d hits are unseen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Method {
    /// The space was covered or excluded by bounds: nothing is unseen.
    Proved,
    /// A lattice of N points, one for each solution. Outside the engine's hits, probes hit with probability v / (N - c):
    /// the interval is Clopper and Pearson's for u of n - m, exact at any n (1934, doi 10.1093/biomet/26.4.404). It is
    /// narrower than an interval for all hits from n probes, because c is known.
    Lattice,
    /// Hits that are not points of a lattice, assumed equally easy to hit: a probe that hits is a recapture with probability
    /// c / (c + v). The estimate is Chapman's, (c + 1) (m + u + 1) / (m + 1) - 1 - c (1951), the interval Clopper and
    /// Pearson's for m of m + u. If the engine prefers hits that are easy to hit, it is a lower bound.
    Recapture,
    /// For an engine that has found nothing: a lower bound from the hits found by one probe (f1) or by two (f2),
    /// f1 (f1 - 1) / (2 (f2 + 1)), with a log-normal interval (Chao 1984, Scand. J. Stat. 11; 1987, doi 10.2307/2531532;
    /// after Good 1953, doi 10.1093/biomet/40.3-4.237).
    Chao,
}

impl Unseen {
    /// Nothing is unseen: proved.
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

/// How many, in words that "hits not seen" follows: `12 (3 to 40)`, `0 to 40`.
impl core::fmt::Display for Unseen {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let (lower, upper) = self.interval;
        let (estimate, lower) = (Whole(self.estimate), Whole(lower));
        // Without a probe that supports it, an estimate of 0 says less than its interval.
        let is_supported = self.estimate >= 0.5 || upper.is_some_and(|upper| upper < 1.0);
        match (is_supported, upper.map(Whole)) {
            (true, Some(upper)) => write!(f, "{estimate} ({lower} to {upper})"),
            (true, None) => write!(f, "{estimate} (at least {lower})"),
            (false, Some(upper)) => write!(f, "{lower} to {upper}"),
            (false, None) => write!(f, "an unknown number of"),
        }
    }
}

/// An integer; a large one with an exponent.
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

/// Counts of what the probes of a slice found.
#[derive(Debug, Clone, Default, serde::Serialize, serde::Deserialize)]
pub(crate) struct Sample {
    /// N, if the space is a lattice.
    pub(crate) points: Option<f64>,
    /// c.
    pub(crate) known: u64,
    /// n.
    pub(crate) probes: u64,
    /// m.
    pub(crate) recaptures: u64,
    /// u.
    pub(crate) fresh: u64,
    /// m and u of the probes at the encoding of their solution.
    pub(crate) own_recaptures: u64,
    pub(crate) own_fresh: u64,
    /// d.
    pub(crate) distinct: u64,
    /// f1.
    pub(crate) once: u64,
    /// f2.
    pub(crate) twice: u64,
    /// Whether several points of the lattice decode to one solution.
    pub(crate) blurred: bool,
}

impl Sample {
    pub(crate) fn estimate(&self) -> Option<Unseen> {
        if self.probes == 0 {
            return None;
        }
        let (d, c) = (self.distinct as f64, self.known as f64);
        // There are no more solutions than points.
        let most = self.points.map(|points| (points - c - d).max(0.0));
        let (method, estimate, lower, upper) = match self.points {
            Some(points) if !self.blurred => self.by_lattice(points - c),
            _ if self.known > 0 => self.by_recapture(c),
            _ => self.by_chao(),
        };
        // Ends are rounded inwards to integers, with a tolerance for rounding errors; an interval without an integer becomes
        // the integer nearest to the estimate.
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

    /// v and its interval, if `others` points are not hits of the engine.
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

    /// v and its interval, if all hits are equally easy to hit and the engine has `c` of them.
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

    /// v and its interval, if the engine has found nothing.
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
