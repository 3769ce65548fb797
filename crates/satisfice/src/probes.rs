//! Uniform probes: a small share of the evaluations, from which a slice estimates what its engine has not found.
//!
//! The engine never learns of them: their hits are in the archive and in the report, but [probe-only](Archive::enter) until
//! the engine finds them itself, as new ones. So the engine's hits E do not depend on the probes, and the probes are a uniform
//! sample that is independent of E, which the estimates of [`Unseen`] require. If the engine followed up the hits of probes,
//! it would turn the evidence of unseen hits into known ones.

use crate::archive::Archive;
use crate::batch::{Batch, Outcome};
use crate::error::Error;
use crate::identity::Identity;
use crate::problem::AnyProblem;
use crate::scalar::Real;
use crate::seed::SearchRng;
use crate::space::Space;
use crate::unseen::{Sample, Unseen};

/// Streams of the probes' generators, one per slice; far from those of lanes, which count from 0.
const STREAM: u64 = 0x7072_6f62_6573_0000;
/// Probes come in batches that grow with their number, so that a short run has some and a long one keeps threads busy.
const GROWTH: u64 = 16;
const LARGEST_BATCH: u64 = 64;
/// An engine's own share makes as many probes or none: of nine that all miss, the interval for the share of the space that is hit and
/// unknown still reaches to 28 %.
const FEWEST: f64 = 10.0;
/// The largest share.
const MOST: f64 = 0.5;

/// The probes of one slice.
#[derive(Debug, Clone, serde::Serialize, serde::Deserialize)]
pub(crate) struct Probes {
    share: f64,
    rng: SearchRng,
    /// The evaluation count from which the next batch is due.
    due: u64,
    sample: Sample,
    /// Hits that a probe found first, by their index in the archive, ascending.
    first: Vec<First>,
}

/// A hit that a probe found first.
#[derive(Debug, Clone, Copy, serde::Serialize, serde::Deserialize)]
struct First {
    index: usize,
    /// Probes that hit it.
    probes: u64,
    /// Those that hit the one point that stands for it.
    own: u64,
}

impl Probes {
    /// # Errors
    /// [`Error::Parameter`] for a share outside [0, 1/2].
    pub(crate) fn new(share: f64, seed: u64, slice: u64) -> Result<Self, Error> {
        if !(0.0..=MOST).contains(&share) {
            return Err(Error::parameter("probes", share, "a share from 0 to 0.5"));
        }
        let mut probes = Self {
            share,
            rng: SearchRng::stream(seed, STREAM.wrapping_add(slice)),
            due: 0,
            sample: Sample::default(),
            first: Vec::new(),
        };
        probes.schedule();
        Ok(probes)
    }

    /// Whether so many planned evaluations suffice for every point of a lattice, but not for this share of probes beside.
    pub(crate) fn leave_no_room<S: Real>(space: &Space<S>, share: f64, planned: Option<u64>) -> bool {
        space.cardinality().zip(planned).is_some_and(|(points, planned)| {
            let planned = planned as f64;
            points <= planned && points > planned * (1.0 - share) - 1.0
        })
    }

    /// Whether this share of so many planned evaluations is too small a sample to say anything. A probe is due once so many evaluations
    /// have been made that it is its share of them, so that the tenth takes one more than ten shares.
    pub(crate) fn are_too_few(share: f64, planned: Option<u64>) -> bool {
        planned.is_some_and(|planned| share * (planned as f64) <= FEWEST)
    }

    pub(crate) fn share(&self) -> f64 {
        self.share
    }

    pub(crate) fn count(&self) -> u64 {
        self.sample.probes
    }

    /// Whether the next batch is to be made before the engine's next.
    #[inline]
    pub(crate) fn is_due(&self, evaluations: u64) -> bool {
        evaluations >= self.due
    }

    fn batch(&self) -> u64 {
        (self.sample.probes / GROWTH).clamp(1, LARGEST_BATCH)
    }

    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "positive, and a conversion from float saturates: no probes are due at 2^64"
    )]
    fn schedule(&mut self) {
        self.due = ((self.sample.probes + self.batch()) as f64 / self.share).ceil() as u64;
    }

    pub(crate) fn propose<S: Real, T: Identity + Clone + Send + Sync>(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        out: &mut Batch<S>,
    ) {
        out.clear();
        for _ in 0..self.batch() {
            out.push_with(|position| self.rng.position(problem.space(), position));
        }
    }

    /// Counts the outcomes of the probes of `batch`.
    pub(crate) fn take<S: Real, T: Identity + Clone + Send + Sync>(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        batch: &Batch<S>,
        outcomes: &[Outcome<S>],
        archive: &Archive<T>,
    ) {
        let space = problem.space();
        let mut values = vec![S::zero(); space.dimension()];
        for (point, outcome) in batch.points().zip(outcomes) {
            if *outcome == Outcome::NotEvaluated {
                continue;
            }
            self.sample.probes += 1;
            if !matches!(outcome, Outcome::Hit(_) | Outcome::Deleted | Outcome::Known(_)) {
                continue;
            }
            space.values(point, &mut values);
            let solution = problem.decode(&values);
            let canonical = problem.canonical(&solution);
            let canonical = canonical.as_ref().unwrap_or(&solution);
            let index = archive
                .position(&solution)
                .or_else(|| archive.position(canonical));
            // None only if the archive is full or the problem is not pure.
            let Some((index, hit)) = index.and_then(|index| Some((index, archive.solutions().get(index)?)))
            else {
                continue;
            };
            let place = self.place(problem, &values, hit, canonical);
            self.enter(index, archive.is_probe_only(index), place);
        }
        self.schedule();
    }

    /// Whether `values` are the one point that stands for `hit`. On a lattice on which several points decode to one
    /// solution, counting only that point gives every solution the same chance.
    fn place<S: Real, T: Identity + Clone + Send + Sync>(
        &mut self,
        problem: &AnyProblem<'_, S, T>,
        values: &[S],
        hit: &T,
        canonical: &T,
    ) -> bool {
        let mut own = vec![S::zero(); values.len()];
        if self.sample.blurred || problem.space().cardinality().is_none() {
            return true; // no lattice, or no use of it
        }
        let Some(encoding) = problem.encoding() else {
            return true; // without an encoding, every point is taken to be a solution of its own
        };
        if !encoding.encode(hit, &mut own) || own == values {
            return true;
        }
        // Another point stands for this hit. It has to be a point of the lattice that decodes to it...
        let mut other = vec![S::zero(); values.len()];
        let stands = problem.space().check_values(&own).is_ok()
            && represents(problem, &problem.decode(&own)).same(hit)
            // ...and this solution has to have the same one: if it has its own, the two are the same only roughly.
            && encoding.encode(canonical, &mut other)
            && own == other;
        self.sample.blurred |= !stands;
        false
    }

    fn enter(&mut self, index: usize, probe_only: bool, own: bool) {
        let own = u64::from(own);
        if !probe_only {
            self.sample.recaptures += 1;
            self.sample.own_recaptures += own;
            return;
        }
        let at = match self.first.binary_search_by_key(&index, |first| first.index) {
            Ok(at) => at,
            Err(at) => {
                let new = First {
                    index,
                    probes: 0,
                    own: 0,
                };
                self.first.insert(at, new);
                at
            }
        };
        self.first[at].probes += 1;
        self.first[at].own += own;
    }

    /// The estimate of hits that are not in the archive; `None` without a probe.
    pub(crate) fn estimate<S: Real, T: Identity + Clone + Send + Sync>(
        &self,
        problem: &AnyProblem<'_, S, T>,
        archive: &Archive<T>,
    ) -> Option<Unseen> {
        let mut sample = self.sample.clone();
        sample.points = problem.space().cardinality();
        sample.known = (archive.len() - archive.probe_only()) as u64;
        for first in &self.first {
            if archive.is_probe_only(first.index) {
                sample.distinct += 1;
                sample.fresh += first.probes;
                sample.own_fresh += first.own;
                sample.once += u64::from(first.probes == 1);
                sample.twice += u64::from(first.probes == 2);
            } else {
                sample.recaptures += first.probes;
                sample.own_recaptures += first.own;
            }
        }
        sample.estimate()
    }
}

/// The solution that represents a hit.
fn represents<S: Real, T: Identity + Clone + Send + Sync>(problem: &AnyProblem<'_, S, T>, hit: &T) -> T {
    problem.canonical(hit).unwrap_or_else(|| hit.clone())
}

#[cfg(test)]
mod tests {
    use crate::{Axis, Budget, Search, Space, from_fn};

    #[test]
    fn a_default_of_fewer_than_ten_probes_is_none() {
        let space = Space::new([Axis::continuous(0.0, 1.0), Axis::continuous(0.0, 1.0)]).unwrap();
        let problem = from_fn(space, 0.01, |x: &[f64]| (x[0] - 0.3).abs() + x[1]).boxed();
        let probes = |evaluations, share: Option<f64>| {
            let mut search = Search::named("portfolio").unwrap();
            if let Some(share) = share {
                search = search.probes(share);
            }
            let report = search.run(&problem, &Budget::evaluations(evaluations)).unwrap();
            assert_eq!(report.unseen.is_some(), report.counts.probes > 0);
            report.counts.probes
        };
        assert_eq!(probes(500, None), 0);
        assert_eq!(probes(501, None), 10);
        assert_eq!(probes(500, Some(0.02)), 9);
    }
}
