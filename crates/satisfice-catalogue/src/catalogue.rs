//! Every problem that has a name. One line each in [`all`].

use satisfice::catalogue::{Catalogued, Parameter, Params};
use satisfice_cloth::Cloth;
use satisfice_collision::problem::{Pleats, Teapots};
use satisfice_problems::{
    Arm, Cec2006, Cec2013, Costas, DiscPacking, Falsification, GraphColouring, Himmelblau, Islands, Langford,
    LatinSquare, MagicSquare, Needles, Puma, Queens, Rastrigin, Roots, SallenKey, Sat, SevenJoints, Shell,
    System, Transmission,
};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::Error;
use crate::exact::Geometric;
use crate::instance::{self, Instance};

/// What makes an instance from its parameters.
pub type Build = fn(&Params) -> Result<Box<dyn Instance>, Error>;

/// One problem of the catalogue.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// Its name, in lower case with hyphens.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// Its parameters with defaults and ranges.
    pub parameters: &'static [Parameter],
    build: Build,
}

/// The entry of a problem type, also of one that is not in [`all`].
#[must_use]
pub const fn entry<P>() -> Entry
where
    P: Catalogued + Send + 'static,
    P::Solution: Serialize + DeserializeOwned,
{
    Entry {
        name: P::NAME,
        summary: P::SUMMARY,
        source: P::SOURCE,
        parameters: P::PARAMETERS,
        build: instance::build::<P>,
    }
}

/// The entry of a problem of vertex pairs, on which exact methods run as well.
#[must_use]
pub const fn geometric<P: Geometric + Send + 'static>() -> Entry {
    Entry {
        name: P::NAME,
        summary: P::SUMMARY,
        source: P::SOURCE,
        parameters: P::PARAMETERS,
        build: instance::build_geometric::<P>,
    }
}

impl Entry {
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

static PROBLEMS: &[Entry] = &[
    geometric::<Teapots>(),
    entry::<Pleats>(),
    geometric::<Cloth>(),
    entry::<Rastrigin>(),
    entry::<Shell>(),
    entry::<Islands>(),
    entry::<Needles>(),
    entry::<DiscPacking>(),
    entry::<Cec2006>(),
    entry::<Arm>(),
    entry::<SevenJoints>(),
    entry::<Puma>(),
    entry::<SallenKey>(),
    entry::<Falsification>(),
    entry::<Transmission>(),
    entry::<Queens>(),
    entry::<GraphColouring>(),
    entry::<Costas>(),
    entry::<MagicSquare>(),
    entry::<LatinSquare>(),
    entry::<Langford>(),
    entry::<Sat>(),
    entry::<Roots>(),
    entry::<Himmelblau>(),
    entry::<System>(),
    entry::<Cec2013>(),
];

/// Every problem, in the order of the docs.
#[must_use]
pub fn all() -> &'static [Entry] {
    PROBLEMS
}

/// The problem with this name.
///
/// # Errors
/// [`Error::Search`] with the nearest name.
pub fn find(name: &str) -> Result<&'static Entry, Error> {
    let entry = all().iter().find(|entry| entry.name == name);
    entry.ok_or_else(|| {
        satisfice::Error::unknown("problem", name, all().iter().map(|entry| entry.name)).into()
    })
}
