//! The settings of an engine as a Rust struct, and what a command line needs to know of it.

use core::fmt::Debug;

use super::{COMMON_PARAMETERS, Engine, compiled};
use crate::catalogue::Parameter;
use crate::error::Error;
use crate::scalar::Real;

mod setting;

pub use setting::Setting;

/// The settings of an engine: a struct with public fields, from which the engine is built.
///
/// [`engine_settings!`](crate::engine_settings) declares the struct with its parameter table; an implementation of this trait
/// adds the name and builds the engine. Every engine of [`all`](super::all) has one:
///
/// ```
/// use satisfice::engine::{EngineConfig, LatestHitQpso};
///
/// let mut settings = LatestHitQpso { particles: 60, ..Default::default() };
/// settings.set("alpha", "0.75")?;
/// assert_eq!((settings.particles, settings.alpha), (60, 0.75));
///
/// let error = settings.set("alhpa", "1").unwrap_err();
/// assert!(error.to_string().contains("did you mean `alpha`?"));
/// # Ok::<(), satisfice::Error>(())
/// ```
pub trait EngineConfig: Settings + Clone + Debug + Default + Send + Sync + 'static {
    /// The name on the command line, in lower case with hyphens.
    const NAME: &'static str;
    /// Other names under which [`find`](super::find) knows the engine.
    const ALIASES: &'static [&'static str] = &[];
    /// One line that says what the engine does.
    const SUMMARY: &'static str;
    /// The publication.
    const CITATION: &'static str;
    /// Whether a proposal costs milliseconds, and more with every evaluation: the engine is for hundreds of evaluations of an
    /// expensive F. Tests and benches with thousands of evaluations leave it out.
    const EXPENSIVE_PROPOSALS: bool = false;

    /// The engine for coordinates of type `f64`. Every setting is within its range.
    fn build_f64(&self) -> Box<dyn Engine<f64>>;

    /// The same for coordinates of type `f32`.
    fn build_f32(&self) -> Box<dyn Engine<f32>>;

    /// The engine. Every setting is within its range.
    fn build<S: Real>(&self) -> Box<dyn Engine<S>> {
        if compiled::is_f64::<S>() {
            compiled::same(self.build_f64())
        } else {
            compiled::same(self.build_f32())
        }
    }

    /// Whether a schedule follows the budget with these settings. A short run is then not a prefix of a long one, unless both
    /// have the same [horizon](crate::Budget::with_horizon).
    fn is_scheduled(&self) -> bool {
        false
    }

    /// The table of parameters, a row for each field.
    #[must_use]
    fn parameters() -> &'static [Parameter] {
        Self::rows()
    }

    /// Sets a parameter by its name on the command line.
    ///
    /// # Errors
    /// [`Error::Unknown`] for a name that is not in the table, with the nearest name; [`Error::Parameter`] for a text that
    /// is not a number or out of range.
    fn set(&mut self, name: &str, text: &str) -> Result<(), Error> {
        let row = row(Self::rows(), Self::NAME, name)?;
        self.read(row, text)
    }

    /// Names and values as text, in the order of the table.
    #[must_use]
    fn texts(&self) -> Vec<(String, String)> {
        let values = self.values();
        let names = Self::rows().iter().map(|row| row.name.to_owned());
        names.zip(values).collect()
    }

    /// Checks that every field is within its range, also those that were set in Rust.
    ///
    /// # Errors
    /// [`Error::Parameter`] for the first field that is not.
    fn check(&self) -> Result<(), Error> {
        let mut copy = self.clone();
        for (row, text) in Self::rows().iter().zip(self.values()) {
            copy.read(row, &text)?;
        }
        Ok(())
    }
}

/// The fields of a settings struct as rows of a table. [`engine_settings!`](crate::engine_settings) implements it.
pub trait Settings {
    /// A row for each field, in the order of declaration.
    #[must_use]
    fn rows() -> &'static [Parameter];

    /// Sets the field of a row.
    ///
    /// # Errors
    /// [`Error::Parameter`] and [`Error::Unknown`] for a text that the row does not allow.
    fn read(&mut self, row: &Parameter, text: &str) -> Result<(), Error>;

    /// The values as text, in the order of the rows.
    #[must_use]
    fn values(&self) -> Vec<String>;
}

/// The row with this name.
pub(super) fn row<'a>(table: &'a [Parameter], owner: &str, name: &str) -> Result<&'a Parameter, Error> {
    table.iter().find(|row| row.name == name).ok_or_else(|| {
        // The common ones are known as well; if one of them comes here, it is not known to the engine itself.
        let is_common = COMMON_PARAMETERS.iter().any(|row| row.name == name);
        let common = if is_common { &[] } else { COMMON_PARAMETERS };
        Error::unknown(
            &format!("parameter of `{owner}`"),
            name,
            table.iter().chain(common).map(|row| row.name),
        )
    })
}

/// The name of a field with hyphens in place of underscores.
#[doc(hidden)]
#[must_use]
pub const fn hyphenated<const N: usize>(name: &str) -> [u8; N] {
    let (name, mut bytes) = (name.as_bytes(), [0; N]);
    let mut i = 0;
    while i < N {
        bytes[i] = if name[i] == b'_' { b'-' } else { name[i] };
        i += 1;
    }
    bytes
}

/// Bytes of a name as text.
#[doc(hidden)]
#[must_use]
pub const fn name(bytes: &'static [u8]) -> &'static str {
    match core::str::from_utf8(bytes) {
        Ok(name) => name,
        Err(_) => panic!("a field's name is text"),
    }
}

/// Declares the settings of an engine: a struct with public fields, its `Default`, and its table of parameters, which is an
/// implementation of [`Settings`](crate::engine::Settings).
///
/// Every field has a documentation comment, which is the summary in the table, a type that is a
/// [`Setting`](crate::engine::Setting), a default, and for numbers the range that is allowed. Its name on the command line has
/// hyphens in place of underscores.
///
/// ```
/// use satisfice::engine::{EngineConfig, Settings};
///
/// satisfice::engine_settings! {
///     /// Steps around the hits found.
///     pub struct Gossip {
///         /// Share of uniform points.
///         pub uniform_share: f64 = 0.5, 0.0..=1.0;
///         /// Points proposed at once.
///         pub batch: usize = 8, 1..=1000;
///         /// Share of each axis that a step may span; the engine chooses by default.
///         pub longest: Option<f64> = None, 1e-9..=1.0;
///     }
/// }
///
/// assert_eq!(Gossip::default().batch, 8);
/// assert_eq!(Gossip::rows()[0].name, "uniform-share");
/// assert_eq!(Gossip::rows()[2].allowed(), "auto or a number from 0.000000001 to 1");
/// ```
#[macro_export]
macro_rules! engine_settings {
    (
        $(#[$meta:meta])*
        $visibility:vis struct $settings:ident {
            $($(#[doc = $doc:literal])+ pub $field:ident: $type:ty = $default:expr $(, $range:expr)?;)*
        }
    ) => {
        $(#[$meta])*
        #[derive(Debug, Clone, PartialEq)]
        $visibility struct $settings {
            $(
                $(#[doc = $doc])+
                #[doc = concat!("\n\nDefault `", stringify!($default), "`" $(, ", range `", stringify!($range), "`")?, ".")]
                pub $field: $type,
            )*
        }

        impl Default for $settings {
            fn default() -> Self {
                Self { $($field: $default),* }
            }
        }

        impl $crate::engine::Settings for $settings {
            fn rows() -> &'static [$crate::catalogue::Parameter] {
                static ROWS: std::sync::LazyLock<Vec<$crate::catalogue::Parameter>> = std::sync::LazyLock::new(|| {
                    vec![$({
                        const BYTES: [u8; stringify!($field).len()] =
                            $crate::engine::config::hyphenated(stringify!($field));
                        let default: $type = $default;
                        $crate::catalogue::Parameter {
                            name: $crate::engine::config::name(&BYTES),
                            summary: concat!($($doc),+).trim_ascii_start(),
                            kind: $crate::engine::Setting::kind(&default, ($($range)?)),
                        }
                    }),*]
                });
                &ROWS
            }

            #[allow(unused_variables, unused_assignments, unused_mut, reason = "there may be no field")]
            fn read(&mut self, row: &$crate::catalogue::Parameter, text: &str) -> Result<(), $crate::Error> {
                let mut rows = Self::rows().iter();
                $(if rows.next().is_some_and(|of_field| of_field.name == row.name) {
                    self.$field = $crate::engine::Setting::read(row, text)?;
                })*
                Ok(())
            }

            fn values(&self) -> Vec<String> {
                vec![$($crate::engine::Setting::text(&self.$field)),*]
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::{Pso, Qpso};

    #[test]
    fn fields_set_in_rust_are_checked_too() {
        let bad = Pso {
            phi: 3.9,
            ..Pso::default()
        };
        let error = bad.check().unwrap_err().to_string();
        assert!(
            error.contains("phi = 3.9 is not allowed: a number from 4 to 10"),
            "{error}"
        );
        let nan = Pso {
            v_max: f64::NAN,
            ..Pso::default()
        };
        assert!(nan.check().is_err());
        assert!(Pso::default().check().is_ok());
    }

    #[test]
    fn an_optional_parameter_is_auto_or_a_number() {
        let mut qpso = Qpso::default();
        assert_eq!(qpso.alpha_end, None);
        let shown = |qpso: &Qpso| qpso.texts().into_iter().find(|(name, _)| name == "alpha-end");
        assert_eq!(shown(&qpso).unwrap().1, "auto");
        qpso.set("alpha-end", "0.5").unwrap();
        assert_eq!(qpso.alpha_end, Some(0.5));
        qpso.set("alpha-end", "auto").unwrap();
        assert_eq!(qpso.alpha_end, None);
        let error = qpso.set("alpha-end", "11").unwrap_err().to_string();
        assert!(error.contains("auto or a number from 0 to 10"), "{error}");
    }
}
