//! The registry: every engine by its name. The command line, the docs, the conformance suite and the benches walk it.

use super::{ConfiguredEngine, EngineConfig};
use crate::catalogue::Parameter;
use crate::error::Error;
use crate::scalar::Real;

/// What is known of a registered engine without building it.
#[derive(Debug, Clone, Copy)]
pub struct EngineSpec {
    /// Its name, in lower case with hyphens.
    pub name: &'static str,
    /// Other names under which [`find`] knows it.
    pub aliases: &'static [&'static str],
    /// One line that says what it does.
    pub summary: &'static str,
    /// The publication.
    pub citation: &'static str,
    /// Whether a proposal costs milliseconds, and more with every evaluation: the engine is for hundreds of evaluations of an
    /// expensive F.
    pub expensive_proposals: bool,
    parameters: fn() -> &'static [Parameter],
}

impl EngineSpec {
    const fn of<E: EngineConfig>() -> Self {
        Self {
            name: E::NAME,
            aliases: E::ALIASES,
            summary: E::SUMMARY,
            citation: E::CITATION,
            expensive_proposals: E::EXPENSIVE_PROPOSALS,
            parameters: E::parameters,
        }
    }

    /// Its parameters with defaults and ranges.
    #[must_use]
    pub fn parameters(&self) -> &'static [Parameter] {
        (self.parameters)()
    }

    /// The engine with parameters `(name, text)`, its own and [common ones](super::COMMON_PARAMETERS), the others at their
    /// defaults.
    ///
    /// # Errors
    /// As [`ConfiguredEngine::set`].
    pub fn configure<'a, S: Real>(
        &self,
        settings: impl IntoIterator<Item = (&'a str, &'a str)>,
    ) -> Result<ConfiguredEngine<S>, Error> {
        ConfiguredEngine::named(self.name)?.set_all(settings)
    }
}

/// Lists the engines once, by their settings.
macro_rules! engines {
    (($d:tt) $($engine:ident,)+) => {
        $(use super::$engine;)+

        static ENGINES: &[EngineSpec] = &[$(EngineSpec::of::<$engine>()),+];

        /// Calls a macro with the settings types of all engines: tests that have one function per engine need no list.
        #[doc(hidden)]
        #[macro_export]
        macro_rules! for_each_engine {
            ($d name:ident) => {
                $d name! { $($engine)+ }
            };
        }

        /// The engine of a spec with the default of each parameter.
        pub(super) fn default_of<S: Real>(spec: &EngineSpec) -> Option<ConfiguredEngine<S>> {
            $(if spec.name == <$engine>::NAME {
                return Some(<$engine>::default().into());
            })+
            None
        }
    };
}

engines! {
    ($)
    Portfolio,
    Random,
    Walk,
    Descent,
    DescentFlood,
    RestartedCmaEs,
    Niching,
    Pso1995,
    PsoInertia,
    Pso,
    PsoLatestHit,
    Spso2011,
    Qpso,
    QpsoDeletion,
    LatestHitQpso,
    NichingPsoDbscan,
    BoundedSwarms,
    BranchAndBound,
    Surrogate,
    QuadraticDescent,
}

/// Every engine, in the order of the docs.
#[must_use]
pub fn all() -> &'static [EngineSpec] {
    ENGINES
}

/// The engine with this name or alias.
///
/// # Errors
/// [`Error::Unknown`] with the nearest name.
pub fn find(name: &str) -> Result<&'static EngineSpec, Error> {
    all()
        .iter()
        .find(|spec| spec.name == name || spec.aliases.contains(&name))
        .ok_or_else(|| Error::unknown("engine", name, all().iter().map(|spec| spec.name)))
}

/// The engine of a search that names none: the one that finds most on the problems of
/// `cargo run --release --example ablation`.
#[must_use]
pub fn default<S: Real>() -> ConfiguredEngine<S> {
    Portfolio::default().into()
}
