//! An engine that is chosen and set, and can be built as often as needed.

use std::sync::Arc;

use super::config::row;
use super::registry::find;
use super::{Engine, EngineConfig, compiled};
use crate::catalogue::Parameter;
use crate::error::Error;
use crate::scalar::Real;

/// An engine with its settings: what a search is made with.
///
/// It comes from the settings of an engine, from a name, or from a closure that builds an engine of your own:
///
/// ```
/// use satisfice::engine::{ConfiguredEngine, LatestHitQpso};
///
/// let typed: ConfiguredEngine<f64> = LatestHitQpso { particles: 60, ..Default::default() }.into();
/// let named = ConfiguredEngine::<f64>::named("latest-hit-qpso")?.set("particles", "60")?;
/// assert_eq!(typed.parameters(), named.parameters());
/// assert!(ConfiguredEngine::<f64>::named("latest-hit-qspo").is_err());
/// # Ok::<(), satisfice::Error>(())
/// ```
///
/// Building is cheap and gives a new engine each time, so that every lane of a search has its own.
pub struct ConfiguredEngine<S> {
    recipe: Box<dyn Recipe<S>>,
    flood_fill: bool,
    pruned: bool,
}

/// Settings of any engine, as an object.
trait Recipe<S>: Send + Sync {
    fn name(&self) -> &str;
    fn set(&mut self, name: &str, text: &str) -> Result<(), Error>;
    fn texts(&self) -> Vec<(String, String)>;
    fn check(&self) -> Result<(), Error>;
    fn is_scheduled(&self) -> bool;
    fn build(&self) -> Box<dyn Engine<S>>;
    fn boxed(&self) -> Box<dyn Recipe<S>>;
}

impl<S: Real, E: EngineConfig> Recipe<S> for E {
    fn name(&self) -> &str {
        E::NAME
    }
    fn set(&mut self, name: &str, text: &str) -> Result<(), Error> {
        EngineConfig::set(self, name, text)
    }
    fn texts(&self) -> Vec<(String, String)> {
        EngineConfig::texts(self)
    }
    fn check(&self) -> Result<(), Error> {
        EngineConfig::check(self)
    }
    fn is_scheduled(&self) -> bool {
        EngineConfig::is_scheduled(self)
    }
    fn build(&self) -> Box<dyn Engine<S>> {
        EngineConfig::build(self)
    }
    fn boxed(&self) -> Box<dyn Recipe<S>> {
        Box::new(self.clone())
    }
}

/// An engine without settings, built by a closure.
struct Custom<S> {
    name: String,
    make: Arc<dyn Fn() -> Box<dyn Engine<S>> + Send + Sync>,
    scheduled: bool,
}

impl<S: Real> Recipe<S> for Custom<S> {
    fn name(&self) -> &str {
        &self.name
    }
    fn set(&mut self, name: &str, _: &str) -> Result<(), Error> {
        row(&[], &self.name, name).map(|_| ())
    }
    fn texts(&self) -> Vec<(String, String)> {
        Vec::new()
    }
    fn check(&self) -> Result<(), Error> {
        Ok(())
    }
    fn is_scheduled(&self) -> bool {
        self.scheduled
    }
    fn build(&self) -> Box<dyn Engine<S>> {
        (self.make)()
    }
    fn boxed(&self) -> Box<dyn Recipe<S>> {
        Box::new(Self {
            name: self.name.clone(),
            make: Arc::clone(&self.make),
            scheduled: self.scheduled,
        })
    }
}

impl<S: Real, E: EngineConfig> From<E> for ConfiguredEngine<S> {
    fn from(settings: E) -> Self {
        Self::of(Box::new(settings))
    }
}

impl<S: Real> Clone for ConfiguredEngine<S> {
    fn clone(&self) -> Self {
        Self {
            recipe: self.recipe.boxed(),
            flood_fill: self.flood_fill,
            pruned: self.pruned,
        }
    }
}

impl<S: Real> core::fmt::Debug for ConfiguredEngine<S> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("ConfiguredEngine")
            .field("name", &self.name())
            .field("parameters", &self.parameters())
            .finish()
    }
}

impl<S: Real> ConfiguredEngine<S> {
    fn of(recipe: Box<dyn Recipe<S>>) -> Self {
        Self {
            recipe,
            flood_fill: false,
            pruned: false,
        }
    }

    /// The engine with this name, with the default of each parameter.
    ///
    /// # Errors
    /// [`Error::Unknown`] with the nearest name.
    pub fn named(name: &str) -> Result<Self, Error> {
        let spec = find(name)?;
        compiled::default_of(spec).ok_or_else(|| Error::unknown("engine", name, [spec.name]))
    }

    /// An engine of your own. `make` builds it, once for each lane of a search; reports show `name`.
    ///
    /// ```
    /// use satisfice::engine::{Ask, ConfiguredEngine, Origin};
    /// use satisfice::{Batch, Budget, Context, Engine, Outcome, Search, SearchRng, Space, from_fn, saved_fields};
    ///
    /// struct Uniform;
    /// impl Engine<f64> for Uniform {
    ///     fn begin(&mut self, _: &dyn Context<f64>) {}
    ///     fn ask(&mut self, context: &dyn Context<f64>, rng: &mut SearchRng, out: &mut Batch<f64>) -> Ask {
    ///         out.push_with(|position| rng.position(context.space(), position));
    ///         Ask::More
    ///     }
    ///     fn tell(&mut self, _: &dyn Context<f64>, _: &Batch<f64>, _: &[Outcome<f64>], _: Origin) {}
    ///     saved_fields!();
    /// }
    ///
    /// let problem = from_fn(Space::lattice(2, 50)?, 3.0, |x: &[f64]| x[0] + x[1]);
    /// let engine = ConfiguredEngine::custom("uniform", || Uniform);
    /// let report = Search::with(engine).run(&problem, &Budget::evaluations(20_000))?;
    /// assert_eq!(report.hit_count(), 6);
    /// # Ok::<(), satisfice::Error>(())
    /// ```
    #[must_use]
    pub fn custom<E>(name: &str, make: impl Fn() -> E + Send + Sync + 'static) -> Self
    where
        E: Engine<S> + 'static,
    {
        Self::of(Box::new(Custom {
            name: name.to_owned(),
            make: Arc::new(move || Box::new(make())),
            scheduled: false,
        }))
    }

    /// The same for an engine of your own whose schedule follows the budget: the conformance suite then compares runs of
    /// different lengths under one [horizon](crate::Budget::with_horizon).
    #[must_use]
    pub fn custom_scheduled<E>(name: &str, make: impl Fn() -> E + Send + Sync + 'static) -> Self
    where
        E: Engine<S> + 'static,
    {
        Self::of(Box::new(Custom {
            name: name.to_owned(),
            make: Arc::new(move || Box::new(make())),
            scheduled: true,
        }))
    }

    /// Sets a parameter by its name on the command line: one of the engine's own or of the
    /// [common ones](COMMON_PARAMETERS).
    ///
    /// # Errors
    /// [`Error::Unknown`] for a name that is not in the table, with the nearest name; [`Error::Parameter`] for a text that
    /// is not a number or out of range.
    pub fn set(mut self, name: &str, text: &str) -> Result<Self, Error> {
        let common = COMMON_PARAMETERS.iter().find(|row| row.name == name);
        let Some(row) = common else {
            self.recipe.set(name, text)?;
            return Ok(self);
        };
        row.check(text)?;
        let chosen = text == "yes";
        match row.name {
            "exhaust" => self.flood_fill = chosen,
            _ => self.pruned = chosen,
        }
        Ok(self)
    }

    /// Sets several parameters, each `(name, text)`; of several for one name, the last counts.
    ///
    /// # Errors
    /// As [`ConfiguredEngine::set`].
    pub fn set_all<'a>(self, settings: impl IntoIterator<Item = (&'a str, &'a str)>) -> Result<Self, Error> {
        settings
            .into_iter()
            .try_fold(self, |engine, (name, text)| engine.set(name, text))
    }

    /// The engine, and beside it a flood fill: from every hit its neighbours, their neighbours where they are hits, and so
    /// on, breadth first. Reports show the parameter `exhaust`.
    ///
    /// Neighbours are the [problem's own](crate::Neighbourhood), or else the next lattice points; on
    /// continuous axes, the nearest points in both directions of each axis that are not known hits. They get at most every
    /// other evaluation, so that the engine continues discovering, and all of them once the engine has nothing more to propose.
    /// The engine is told of the hits among them.
    ///
    /// For hits that lie together. `portfolio` and `descent-flood` already contain a flood fill.
    #[must_use]
    pub fn flood_fill(mut self) -> Self {
        self.flood_fill = true;
        self
    }

    /// The engine, kept out of regions without hits where the problem
    /// [offers bounds](crate::Bounds). Reports show the parameter `prune`.
    ///
    /// The space is split where the engine looks and finds nothing; a half whose bound is at least delta is excluded. A
    /// proposal there is not evaluated, and the engine is told that its F is not finite. If all proposals of an engine are
    /// excluded for long, uniform points of the rest take their place. Calls of bounds use up at most an eighth of the
    /// evaluations. Without bounds nothing changes.
    #[must_use]
    pub fn pruned(mut self) -> Self {
        self.pruned = true;
        self
    }

    /// The engine's name.
    #[must_use]
    pub fn name(&self) -> &str {
        self.recipe.name()
    }

    /// Names and values of the parameters as text: the engine's own, and the common ones that are on.
    #[must_use]
    pub fn parameters(&self) -> Vec<(String, String)> {
        let mut all = self.recipe.texts();
        for (name, chosen) in [("exhaust", self.flood_fill), ("prune", self.pruned)] {
            if chosen {
                all.push((name.to_owned(), "yes".to_owned()));
            }
        }
        all
    }

    /// Whether a schedule follows the budget: see [`EngineConfig::is_scheduled`].
    #[must_use]
    pub fn is_scheduled(&self) -> bool {
        self.recipe.is_scheduled()
    }

    /// Checks that every parameter is within its range.
    ///
    /// # Errors
    /// [`Error::Parameter`] for the first one that is not.
    pub fn check(&self) -> Result<(), Error> {
        self.recipe.check()
    }

    /// A new engine. May be called many times.
    ///
    /// # Errors
    /// As [`ConfiguredEngine::check`].
    pub fn build(&self) -> Result<Box<dyn Engine<S>>, Error> {
        self.check()?;
        Ok(self.build_unchecked())
    }

    /// A new engine, of parameters that have been checked.
    pub(crate) fn build_unchecked(&self) -> Box<dyn Engine<S>> {
        let mut engine = self.recipe.build();
        if self.flood_fill {
            engine = compiled::flood_fill(engine);
        }
        if self.pruned {
            engine = compiled::pruned(engine);
        }
        engine
    }
}

/// Parameters that every engine takes beside its own.
pub const COMMON_PARAMETERS: &[Parameter] = &[
    Parameter::choice(
        "exhaust",
        "Flood fill around every hit beside the engine, with at most half of the evaluations.",
        "no",
        &["no", "yes"],
    ),
    Parameter::choice(
        "prune",
        "Keep the engine out of regions that the problem's lower bounds exclude.",
        "no",
        &["no", "yes"],
    ),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::{Pso, all};

    #[test]
    fn an_unknown_parameter_gets_the_common_ones_as_well() {
        for (name, wanted) in [
            ("exhuast", "did you mean `exhaust`?"),
            ("zzzzzzzz", "exhaust, prune"),
        ] {
            let error = ConfiguredEngine::<f64>::named("random").unwrap().set(name, "yes");
            let error = error.unwrap_err().to_string();
            assert!(
                error.contains(wanted) && error.ends_with("exhaust, prune"),
                "{error}"
            );
        }
        // The settings of an engine alone do not have them.
        let error = EngineConfig::set(&mut Pso::default(), "prune", "yes").unwrap_err();
        assert!(!error.to_string().ends_with("prune"), "{error}");
    }

    #[test]
    fn every_engine_is_built_by_its_name_and_its_aliases() {
        for spec in all() {
            let engine = ConfiguredEngine::<f32>::named(spec.name).unwrap();
            assert_eq!(engine.name(), spec.name);
            assert!(engine.build().is_ok() && engine.build().is_ok());
            for alias in spec.aliases {
                assert_eq!(ConfiguredEngine::<f64>::named(alias).unwrap().name(), spec.name);
            }
        }
    }

    #[test]
    fn a_setting_out_of_range_is_refused_when_the_engine_is_built() {
        let engine = ConfiguredEngine::<f64>::from(Pso {
            particles: 0,
            ..Pso::default()
        });
        let error = engine.build().err().unwrap().to_string();
        assert!(error.contains("particles = 0 is not allowed"), "{error}");
    }

    #[test]
    fn common_parameters_are_shown_where_they_are_on() {
        let engine = ConfiguredEngine::<f64>::named("random").unwrap();
        assert_eq!(engine.parameters(), [("batch".to_owned(), "64".to_owned())]);
        let engine = engine.set("prune", "yes").unwrap().set("exhaust", "yes").unwrap();
        let names: Vec<_> = engine.parameters().into_iter().map(|(name, _)| name).collect();
        assert_eq!(names, ["batch", "exhaust", "prune"]);
        assert!(engine.clone().set("prune", "maybe").is_err());
        assert_eq!(engine.set("prune", "no").unwrap().parameters().len(), 2);
    }
}
