//! Every problem that has a name: the bundled ones, one line each in [`all`], and those that a program adds.

use core::fmt;

use satisfice::catalogue::{Catalogued, Parameter, Params};
use satisfice_cloth::Cloth;
use satisfice_collision::problem::{Pleats, Teapots};
use satisfice_problems::{
    Arm, Branin, Cec2006, Cec2013, Costas, DiscPacking, Falsification, GraphColouring, Hartmann6, Himmelblau,
    Islands, Langford, LatinSquare, MagicSquare, MixedAxes, Needles, PeriodicPoints, Puma, Queens, Rastrigin,
    Roots, SallenKey, Sat, SevenJoints, Shell, SmallRegions, System, Transmission,
};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::Error;
use crate::exact::Geometric;
use crate::instance::{self, Instance};

/// Makes an instance from its parameters.
type Build = fn(&Params) -> Result<Box<dyn Instance>, Error>;

/// A problem of a catalogue: name, parameters, and how to build it.
#[derive(Clone, Copy)]
pub struct ProblemSpec {
    /// Its name, in lower case with hyphens.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
    /// Its source.
    pub source: &'static str,
    /// Its parameters with defaults and ranges.
    pub parameters: &'static [Parameter],
    build: Build,
}

impl ProblemSpec {
    /// The problem of type `P`.
    #[must_use]
    pub const fn of<P>() -> Self
    where
        P: Catalogued + Send + 'static,
        P::Solution: Serialize + DeserializeOwned,
    {
        Self {
            name: P::NAME,
            summary: P::SUMMARY,
            source: P::SOURCE,
            parameters: P::PARAMETERS,
            build: instance::build::<P>,
        }
    }

    /// The problem of type `P`, whose solutions are pairs of vertices, so that exact methods run on it as well.
    #[must_use]
    pub const fn geometric<P: Geometric + Send + 'static>() -> Self {
        Self {
            build: instance::build_geometric::<P>,
            ..Self::of::<P>()
        }
    }

    /// The problem with parameters `(name, text)`, the others at their defaults.
    ///
    /// # Errors
    /// [`Error::Search`] for a name that is not among the parameters, with the nearest, or a value that is not allowed.
    pub fn build<'a>(
        &self,
        settings: impl IntoIterator<Item = (&'a str, &'a str)>,
    ) -> Result<Box<dyn Instance>, Error> {
        (self.build)(&Params::with(self.parameters, self.name, settings)?)
    }
}

impl fmt::Debug for ProblemSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ProblemSpec")
            .field("name", &self.name)
            .field("summary", &self.summary)
            .finish_non_exhaustive()
    }
}

/// The problems that a program knows by name.
///
/// ```
/// use satisfice_catalogue::Catalogue;
/// assert!(Catalogue::bundled().find("queens").is_ok());
/// assert!(Catalogue::empty().with::<satisfice_problems::Queens>().find("qeens").is_err());
/// ```
#[derive(Debug, Clone)]
pub struct Catalogue {
    problems: Vec<ProblemSpec>,
}

impl Catalogue {
    /// The problems that come with this crate.
    #[must_use]
    pub fn bundled() -> Self {
        Self {
            problems: BUNDLED.to_vec(),
        }
    }

    /// No problem.
    #[must_use]
    pub fn empty() -> Self {
        Self { problems: Vec::new() }
    }

    /// Adds a problem, before the others. It replaces one of the same name.
    #[must_use]
    pub fn with<P>(mut self) -> Self
    where
        P: Catalogued + Send + 'static,
        P::Solution: Serialize + DeserializeOwned,
    {
        self.problems.retain(|problem| problem.name != P::NAME);
        self.problems.insert(0, ProblemSpec::of::<P>());
        self
    }

    /// Its problems.
    #[must_use]
    pub fn problems(&self) -> &[ProblemSpec] {
        &self.problems
    }

    /// The problem with this name.
    ///
    /// # Errors
    /// [`Error::Search`] with the nearest name.
    pub fn find(&self, name: &str) -> Result<&ProblemSpec, Error> {
        search(&self.problems, name)
    }
}

impl Default for Catalogue {
    fn default() -> Self {
        Self::bundled()
    }
}

/// Every bundled problem, in the order of the docs.
#[must_use]
pub fn all() -> &'static [ProblemSpec] {
    BUNDLED
}

/// The bundled problem with this name.
///
/// # Errors
/// [`Error::Search`] with the nearest name.
pub fn find(name: &str) -> Result<&'static ProblemSpec, Error> {
    search(BUNDLED, name)
}

fn search<'a>(problems: &'a [ProblemSpec], name: &str) -> Result<&'a ProblemSpec, Error> {
    let found = problems.iter().find(|problem| problem.name == name);
    found.ok_or_else(|| {
        satisfice::Error::unknown("problem", name, problems.iter().map(|problem| problem.name)).into()
    })
}

static BUNDLED: &[ProblemSpec] = &[
    ProblemSpec::geometric::<Teapots>(),
    ProblemSpec::of::<Pleats>(),
    ProblemSpec::geometric::<Cloth>(),
    ProblemSpec::of::<Rastrigin>(),
    ProblemSpec::of::<Shell>(),
    ProblemSpec::of::<Islands>(),
    ProblemSpec::of::<Needles>(),
    ProblemSpec::of::<DiscPacking>(),
    ProblemSpec::of::<Cec2006>(),
    ProblemSpec::of::<SmallRegions>(),
    ProblemSpec::of::<MixedAxes>(),
    ProblemSpec::of::<Arm>(),
    ProblemSpec::of::<SevenJoints>(),
    ProblemSpec::of::<Puma>(),
    ProblemSpec::of::<SallenKey>(),
    ProblemSpec::of::<Falsification>(),
    ProblemSpec::of::<Transmission>(),
    ProblemSpec::of::<Queens>(),
    ProblemSpec::of::<GraphColouring>(),
    ProblemSpec::of::<Costas>(),
    ProblemSpec::of::<MagicSquare>(),
    ProblemSpec::of::<LatinSquare>(),
    ProblemSpec::of::<Langford>(),
    ProblemSpec::of::<Sat>(),
    ProblemSpec::of::<Roots>(),
    ProblemSpec::of::<Himmelblau>(),
    ProblemSpec::of::<System>(),
    ProblemSpec::of::<PeriodicPoints>(),
    ProblemSpec::of::<Branin>(),
    ProblemSpec::of::<Hartmann6>(),
    ProblemSpec::of::<Cec2013>(),
];
