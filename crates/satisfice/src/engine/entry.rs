//! The registry: what the command line, the docs, the conformance suite and the benches walk.

use super::{Engine, pso_inertia, qpso};
use crate::catalogue::{Parameter, Params};
use crate::error::Error;
use crate::scalar::Real;

/// What makes a boxed engine from its parameters.
pub type Build<S> = fn(&Params) -> Result<Box<dyn Engine<S>>, Error>;

/// One engine of the registry.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Its name, in lower case with hyphens.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
    /// Where it was published.
    pub reference: &'static str,
    /// Its parameters with defaults and ranges.
    pub parameters: &'static [Parameter],
    /// Whether, with these parameters, a schedule follows the budget, so that a short run is no prefix of a long one unless
    /// both have one [horizon](crate::Budget::with_horizon).
    pub scheduled: fn(&Params) -> bool,
    /// Builds it for `f32`.
    pub build_f32: Build<f32>,
    /// Builds it for `f64`.
    pub build_f64: Build<f64>,
}

/// Parameters that every engine takes beside its own.
pub const COMMON_PARAMETERS: &[Parameter] = &[
    Parameter::choice(
        "exhaust",
        "whether the neighbourhood of every hit is exhausted beside the engine, with up to half of the evaluations",
        "no",
        &["no", "yes"],
    ),
    Parameter::choice(
        "prune",
        "whether the engine is kept out of regions that the problem's lower bounds exclude, where it offers any",
        "no",
        &["no", "yes"],
    ),
];

impl Entry {
    /// The engine with parameters `(name, text)`, its own and [common ones](COMMON_PARAMETERS), the others at their
    /// defaults.
    ///
    /// # Errors
    /// [`Error::Unknown`] and [`Error::Parameter`] as in [`Params::with`].
    pub fn build<'a, S: Real>(
        &self,
        settings: impl IntoIterator<Item = (&'a str, &'a str)>,
    ) -> Result<Named<S>, Error> {
        let (common, own): (Vec<_>, Vec<_>) = settings
            .into_iter()
            .partition(|(name, _)| COMMON_PARAMETERS.iter().any(|row| row.name == *name));
        let common = Params::with(COMMON_PARAMETERS, self.name, common)?;
        let values = Params::with(self.parameters, self.name, own)?;
        let mut named = Named {
            name: self.name.to_owned(),
            parameters: values.texts(),
            engine: S::build(self, &values)?,
        };
        if common.text("exhaust") == "yes" {
            named = named.exhausting();
        }
        if common.text("prune") == "yes" {
            named = named.pruned();
        }
        Ok(named)
    }
}

/// An engine with the name and the parameters that a report repeats.
pub struct Named<S> {
    /// Its name.
    pub name: String,
    /// Its parameters as text.
    pub parameters: Vec<(String, String)>,
    /// The engine.
    pub engine: Box<dyn Engine<S>>,
}

impl<S: Real> core::fmt::Debug for Named<S> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Named")
            .field("name", &self.name)
            .field("parameters", &self.parameters)
            .finish_non_exhaustive()
    }
}

impl<S: Real> Named<S> {
    /// An engine of one's own, under the name that reports shall show.
    #[must_use]
    pub fn new(name: &str, engine: impl Engine<S> + 'static) -> Self {
        Self {
            name: name.to_owned(),
            parameters: Vec::new(),
            engine: Box::new(engine),
        }
    }
}

/// Every engine, in the order of the docs.
#[must_use]
pub fn all() -> &'static [Entry] {
    ENGINES
}

/// An entry whose engine is built by `$module::build` for either scalar, with the table `PARAMETERS` beside it.
macro_rules! entry {
    ($module:ident, $name:literal, $summary:literal, $reference:literal) => {
        entry!($module, $name, $summary, $reference, |_| false)
    };
    ($module:ident, $name:literal, $summary:literal, $reference:literal, $scheduled:expr) => {
        Entry {
            name: $name,
            summary: $summary,
            reference: $reference,
            parameters: super::$module::PARAMETERS,
            scheduled: $scheduled,
            build_f32: super::$module::build,
            build_f64: super::$module::build,
        }
    };
}

static ENGINES: &[Entry] = &[
    entry!(
        portfolio,
        "portfolio",
        "swarms, local searches, recombined hits, learned steps and uniform points that compete for evaluations by their yield",
        "this project; parts after Chen et al. 2012, Igel et al. 2006, Beyer, Sendhoff 2017, Luby et al. 1993, Agrawal, Goyal 2012"
    ),
    entry!(
        random,
        "random",
        "uniform random sampling, the baseline",
        "none needed"
    ),
    entry!(
        walk,
        "walk",
        "random walk from the latest hit, steps of log-uniform length, a tenth uniform",
        "none"
    ),
    entry!(
        descent,
        "descent",
        "greedy descent over neighbours, restarted at uniform points",
        "after Guy, Debunne 2004, INRIA RR-5136, and Kimmerle, Nesme, Faure 2004, VMV"
    ),
    entry!(
        descent_flood,
        "descent-flood",
        "restarted descent, then breadth-first exhaustion of every hit's neighbourhood",
        "after Guy, Debunne 2004, INRIA RR-5136, and Kimmerle, Nesme, Faure 2004, VMV"
    ),
    entry!(
        restarted_cma_es,
        "restarted-cma-es",
        "restarted (1+1)-CMA-ES for continuous axes, and recombination of hits",
        "this project; parts after Igel, Suttorp, Hansen 2006, doi 10.1145/1143997.1144082, and Luby, Sinclair, Zuckerman 1993, doi 10.1016/0020-0190(93)90029-9"
    ),
    entry!(
        pso_1995,
        "pso-1995",
        "the first particle swarm, without inertia weight",
        "Kennedy, Eberhart 1995, doi 10.1109/ICNN.1995.488968"
    ),
    entry!(
        pso_inertia,
        "pso-inertia",
        "particle swarm with an inertia weight that falls",
        "Shi, Eberhart 1998, doi 10.1109/ICEC.1998.699146",
        pso_inertia::is_scheduled
    ),
    entry!(
        pso,
        "pso",
        "particle swarm with constriction, attracted by the best",
        "Clerc, Kennedy 2002, doi 10.1109/4235.985692"
    ),
    entry!(
        pso_latest_hit,
        "pso-latest-hit",
        "particle swarm with constriction, attracted by the latest hit, hits deleted",
        "Clerc, Kennedy 2002, doi 10.1109/4235.985692; Chen et al. 2012, doi 10.3923/itj.2012.536.539"
    ),
    entry!(
        spso_2011,
        "spso-2011",
        "Standard PSO 2011: rotation-invariant, random topology",
        "Zambrano-Bigiarini, Clerc, Rojas 2013, doi 10.1109/CEC.2013.6557848"
    ),
    entry!(
        qpso,
        "qpso",
        "quantum-behaved swarm, attracted by the best, nothing deleted",
        "Sun, Feng, Xu 2004, doi 10.1109/CEC.2004.1330875",
        qpso::is_scheduled
    ),
    entry!(
        qpso_deletion,
        "qpso-deletion",
        "quantum-behaved swarm, attracted by the best, hits deleted",
        "Sun, Feng, Xu 2004, doi 10.1109/CEC.2004.1330875"
    ),
    entry!(
        latest_hit_qpso,
        "latest-hit-qpso",
        "the paper's swarm: quantum-behaved, attracted by the latest hit, hits deleted",
        "Chen, Ye, An, Wang 2012, doi 10.3923/itj.2012.536.539"
    ),
    entry!(
        wang,
        "wang",
        "the paper's rival, reconstructed: a particle swarm with niches found by clustering, hits deleted",
        "after Wang et al. 2006, the rival of Chen et al. 2012, doi 10.3923/itj.2012.536.539; DBSCAN: Ester et al. 1996, KDD-96"
    ),
    entry!(
        li,
        "li",
        "reconstructed: bounding volumes exclude regions, then small swarms in the leaves that are left",
        "after Li et al. 2010, as mentioned by Chen et al. 2012, doi 10.3923/itj.2012.536.539"
    ),
    entry!(
        branch_and_bound,
        "branch-and-bound",
        "exact: best-first over regions by the problem's lower bounds; enumeration where there are none",
        "Land, Doig 1960, doi 10.2307/1910129"
    ),
];

/// The entry with this name.
///
/// # Errors
/// [`Error::Unknown`] with the nearest name.
pub fn find(name: &str) -> Result<&'static Entry, Error> {
    all()
        .iter()
        .find(|entry| entry.name == name)
        .ok_or_else(|| Error::unknown("engine", name, all().iter().map(|entry| entry.name)))
}

/// The engine with this name and its default parameters.
///
/// # Errors
/// [`Error::Unknown`] with the nearest name.
pub fn build<S: Real>(name: &str) -> Result<Named<S>, Error> {
    find(name)?.build([])
}

/// The engine of a search that names none: the first of the registry, the winner of `cargo run --release --example ablation`.
///
/// # Panics
/// If a default of its own table were out of range, which a test excludes.
#[must_use]
pub fn default<S: Real>() -> Named<S> {
    all()[0]
        .build([])
        .expect("the defaults of the table are in their ranges")
}
