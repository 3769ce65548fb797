//! State saved and restored, bit by bit: what a checkpoint keeps of an engine.

use crate::error::Error;
use crate::scalar::Real;

/// A saved state: words of 64 bits. Floats are kept by their bits, so that nothing is rounded and infinities survive.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct State(pub Vec<u64>);

/// Reads a [`State`] from its beginning.
#[derive(Debug)]
pub struct Reader<'a> {
    words: &'a [u64],
}

impl<'a> Reader<'a> {
    /// At the beginning of `state`.
    #[must_use]
    pub fn new(state: &'a State) -> Self {
        Self { words: &state.0 }
    }

    /// The next value.
    ///
    /// # Errors
    /// [`Error::State`] where the state is too short or a word is no such value.
    pub fn read<T: Saved>(&mut self) -> Result<T, Error> {
        T::restore(self)
    }

    /// Says that all has been read.
    ///
    /// # Errors
    /// [`Error::State`] where words are left.
    pub fn finish(self) -> Result<(), Error> {
        if self.words.is_empty() {
            Ok(())
        } else {
            Err(Error::State(format!("{} words are left over", self.words.len())))
        }
    }

    fn word(&mut self) -> Result<u64, Error> {
        let (&first, rest) = self
            .words
            .split_first()
            .ok_or_else(|| Error::State("it ends too early".to_owned()))?;
        self.words = rest;
        Ok(first)
    }
}

/// What can be kept in a [`State`].
pub trait Saved: Sized {
    /// Appends the value.
    fn save(&self, state: &mut State);
    /// Reads it back.
    ///
    /// # Errors
    /// [`Error::State`] where the next words are no such value.
    fn restore(from: &mut Reader<'_>) -> Result<Self, Error>;
}

impl Saved for u64 {
    fn save(&self, state: &mut State) {
        state.0.push(*self);
    }
    fn restore(from: &mut Reader<'_>) -> Result<Self, Error> {
        from.word()
    }
}

macro_rules! saved_as_word {
    ($($type:ty),*) => {$(
        impl Saved for $type {
            fn save(&self, state: &mut State) {
                state.0.push(*self as u64);
            }
            fn restore(from: &mut Reader<'_>) -> Result<Self, Error> {
                let word = from.word()?;
                Self::try_from(word).map_err(|_| Error::State(format!("{word} is no {}", stringify!($type))))
            }
        }
    )*};
}
saved_as_word!(usize, u32, u16, u8);

impl Saved for bool {
    fn save(&self, state: &mut State) {
        state.0.push(u64::from(*self));
    }
    fn restore(from: &mut Reader<'_>) -> Result<Self, Error> {
        match from.word()? {
            0 => Ok(false),
            1 => Ok(true),
            word => Err(Error::State(format!("{word} is no bool"))),
        }
    }
}

macro_rules! saved_real {
    ($($type:ty),*) => {$(
        impl Saved for $type {
            fn save(&self, state: &mut State) {
                state.0.push(self.to_word());
            }
            fn restore(from: &mut Reader<'_>) -> Result<Self, Error> {
                from.word().map(Real::from_word)
            }
        }
    )*};
}
saved_real!(f32, f64);

impl<T: Saved> Saved for Vec<T> {
    fn save(&self, state: &mut State) {
        Saved::save(&self.len(), state);
        for item in self {
            item.save(state);
        }
    }
    fn restore(from: &mut Reader<'_>) -> Result<Self, Error> {
        let length: usize = from.read()?;
        if length > from.words.len() && length > 0 {
            return Err(Error::State(format!(
                "a list of {length} is longer than the rest"
            )));
        }
        (0..length).map(|_| from.read()).collect()
    }
}

impl<T: Saved> Saved for std::collections::VecDeque<T> {
    fn save(&self, state: &mut State) {
        Saved::save(&self.len(), state);
        for item in self {
            item.save(state);
        }
    }
    fn restore(from: &mut Reader<'_>) -> Result<Self, Error> {
        from.read::<Vec<T>>().map(Self::from)
    }
}

impl<T: Saved> Saved for Option<T> {
    fn save(&self, state: &mut State) {
        Saved::save(&self.is_some(), state);
        if let Some(item) = self {
            item.save(state);
        }
    }
    fn restore(from: &mut Reader<'_>) -> Result<Self, Error> {
        if from.read()? {
            from.read().map(Some)
        } else {
            Ok(None)
        }
    }
}

impl<T: Saved, U: Saved> Saved for (T, U) {
    fn save(&self, state: &mut State) {
        self.0.save(state);
        self.1.save(state);
    }
    fn restore(from: &mut Reader<'_>) -> Result<Self, Error> {
        Ok((from.read()?, from.read()?))
    }
}

impl<T: Saved, const N: usize> Saved for [T; N] {
    fn save(&self, state: &mut State) {
        for item in self {
            item.save(state);
        }
    }
    fn restore(from: &mut Reader<'_>) -> Result<Self, Error> {
        let items: Vec<T> = (0..N).map(|_| from.read()).collect::<Result<_, _>>()?;
        items
            .try_into()
            .map_err(|_| Error::State("an array of another length".to_owned()))
    }
}

/// What is saved and restored in place, into a value that has the same settings: everything that is [`Saved`], and parts of
/// engines by [`saved_fields!`](crate::saved_fields).
pub trait Part {
    /// Appends all that changes.
    fn save(&self, state: &mut State);
    /// Reads it back.
    ///
    /// # Errors
    /// [`Error::State`] where the next words do not fit.
    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error>;
}

impl<T: Saved> Part for T {
    fn save(&self, state: &mut State) {
        Saved::save(self, state);
    }
    fn restore(&mut self, from: &mut Reader<'_>) -> Result<(), Error> {
        *self = from.read()?;
        Ok(())
    }
}

/// Writes `save` and `restore` of [`Engine`](crate::Engine) or of [`Part`] for the named fields: the ones that change while
/// it runs. Every field of that kind has to be named; the conformance suite finds a forgotten one.
///
/// With `; check` behind the fields, `self.check()?` says whether restored fields fit each other.
#[macro_export]
macro_rules! saved_fields {
    ($($field:ident),* $(,)? $(; $check:ident)?) => {
        fn save(&self, state: &mut $crate::state::State) {
            let _ = &state;
            $($crate::state::Part::save(&self.$field, state);)*
        }
        fn restore(&mut self, from: &mut $crate::state::Reader<'_>) -> Result<(), $crate::Error> {
            let _ = &from;
            $($crate::state::Part::restore(&mut self.$field, from)?;)*
            $(self.$check()?;)?
            Ok(())
        }
    };
}

/// Implements [`Saved`] for a struct by its fields, all of them.
#[macro_export]
macro_rules! saved_struct {
    ($name:ident $(<$generic:ident: $bound:path>)? { $($field:ident),* $(,)? }) => {
        impl $(<$generic: $bound + $crate::state::Saved>)? $crate::state::Saved for $name $(<$generic>)? {
            fn save(&self, state: &mut $crate::state::State) {
                $($crate::state::Saved::save(&self.$field, state);)*
            }
            fn restore(from: &mut $crate::state::Reader<'_>) -> Result<Self, $crate::Error> {
                Ok(Self { $($field: from.read()?),* })
            }
        }
    };
}
