//! The types of the fields of an engine's settings.

use core::ops::RangeInclusive;

use crate::catalogue::{ParamKind, ParamValue, Parameter};
use crate::error::Error;

/// A type that a field of an engine's settings may have: `usize`, `u64`, `f64`, `Option<usize>`, `Option<f64>`, `bool`, or an enum declared by
/// [`engine_choice!`](crate::engine_choice).
pub trait Setting: Sized {
    /// What limits the values: a range for numbers, `()` for others.
    type Range;

    /// The kind of the row in the table.
    fn kind(default: &Self, range: Self::Range) -> ParamKind;

    /// The value of a text.
    ///
    /// # Errors
    /// [`Error::Parameter`] or [`Error::Unknown`] if the row does not allow the text.
    fn read(row: &Parameter, text: &str) -> Result<Self, Error>;

    /// The value as text, which [`read`](Setting::read) turns back into the same value.
    fn text(&self) -> String;
}

macro_rules! counts {
    ($($type:ty),*) => {$(
        impl Setting for $type {
            type Range = RangeInclusive<i64>;

            fn kind(default: &Self, range: Self::Range) -> ParamKind {
                let (min, max) = range.into_inner();
                ParamKind::Integer {
                    min,
                    max,
                    default: i64::try_from(*default).unwrap_or(i64::MAX),
                }
            }

            fn read(row: &Parameter, text: &str) -> Result<Self, Error> {
                let not_allowed = || Error::parameter(row.name, text, row.allowed());
                match row.parse(text)? {
                    ParamValue::Integer(value) => value.try_into().map_err(|_| not_allowed()),
                    _ => Err(not_allowed()),
                }
            }

            fn text(&self) -> String {
                self.to_string()
            }
        }
    )*};
}
counts!(usize, u64);

impl Setting for f64 {
    type Range = RangeInclusive<f64>;

    fn kind(default: &Self, range: Self::Range) -> ParamKind {
        let (min, max) = range.into_inner();
        ParamKind::Real {
            min,
            max,
            default: *default,
        }
    }

    fn read(row: &Parameter, text: &str) -> Result<Self, Error> {
        match row.parse(text)? {
            ParamValue::Real(value) => Ok(value),
            _ => Err(Error::parameter(row.name, text, row.allowed())),
        }
    }

    fn text(&self) -> String {
        self.to_string()
    }
}

/// `None` is `auto` on the command line.
impl Setting for Option<usize> {
    type Range = RangeInclusive<i64>;

    fn kind(_: &Self, range: Self::Range) -> ParamKind {
        let (min, max) = range.into_inner();
        ParamKind::OptionalInteger { min, max }
    }

    fn read(row: &Parameter, text: &str) -> Result<Self, Error> {
        match row.parse(text)? {
            ParamValue::Integer(value) => {
                let value = usize::try_from(value);
                value
                    .map(Some)
                    .map_err(|_| Error::parameter(row.name, text, row.allowed()))
            }
            _ => Ok(None),
        }
    }

    fn text(&self) -> String {
        self.map_or_else(|| Parameter::AUTO.to_owned(), |value| value.to_string())
    }
}

/// `None` is `auto` on the command line.
impl Setting for Option<f64> {
    type Range = RangeInclusive<f64>;

    fn kind(_: &Self, range: Self::Range) -> ParamKind {
        let (min, max) = range.into_inner();
        ParamKind::OptionalReal { min, max }
    }

    fn read(row: &Parameter, text: &str) -> Result<Self, Error> {
        Ok(match row.parse(text)? {
            ParamValue::Real(value) => Some(value),
            _ => None,
        })
    }

    fn text(&self) -> String {
        self.map_or_else(|| Parameter::AUTO.to_owned(), |value| value.to_string())
    }
}

/// `yes` or `no` on the command line.
impl Setting for bool {
    type Range = ();

    fn kind(default: &Self, (): ()) -> ParamKind {
        ParamKind::Choice {
            of: &["no", "yes"],
            default: if *default { "yes" } else { "no" },
        }
    }

    fn read(row: &Parameter, text: &str) -> Result<Self, Error> {
        row.parse(text)?;
        Ok(text == "yes")
    }

    fn text(&self) -> String {
        if *self { "yes" } else { "no" }.to_owned()
    }
}

/// Declares an enum that a field of an engine's settings may have, with the word for each variant on the command line.
///
/// ```
/// use satisfice::engine::Setting;
///
/// satisfice::engine_choice! {
///     /// Who attracts the particles.
///     pub enum Attractor {
///         /// The best point so far.
///         Best = "best",
///         /// The latest hit.
///         LatestHit = "latest-hit",
///     }
/// }
/// assert_eq!(Attractor::LatestHit.text(), "latest-hit");
/// ```
#[macro_export]
macro_rules! engine_choice {
    (
        $(#[$meta:meta])*
        $visibility:vis enum $choice:ident {
            $($(#[$variant_meta:meta])* $variant:ident = $word:literal,)+
        }
    ) => {
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        $visibility enum $choice {
            $(
                $(#[$variant_meta])*
                #[doc = concat!("\n\n`", $word, "` on the command line.")]
                $variant,
            )+
        }

        impl $choice {
            /// The word on the command line.
            #[must_use]
            pub const fn word(self) -> &'static str {
                match self {
                    $(Self::$variant => $word,)+
                }
            }
        }

        impl $crate::engine::Setting for $choice {
            type Range = ();

            fn kind(default: &Self, (): ()) -> $crate::catalogue::ParamKind {
                $crate::catalogue::ParamKind::Choice {
                    of: &[$($word),+],
                    default: default.word(),
                }
            }

            fn read(row: &$crate::catalogue::Parameter, text: &str) -> Result<Self, $crate::Error> {
                row.check(text)?;
                match text {
                    $($word => Ok(Self::$variant),)+
                    _ => Err($crate::Error::parameter(row.name, text, row.allowed())),
                }
            }

            fn text(&self) -> String {
                self.word().to_owned()
            }
        }
    };
}
