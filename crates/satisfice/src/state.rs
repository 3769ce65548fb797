//! The state of an engine, saved and restored bit by bit: a part of every checkpoint.

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::Error;

mod rows;
pub(crate) use self::rows::{read_rows, write_rows};

/// A saved state: bytes in the [postcard](https://docs.rs/postcard) format. Floats keep their bits, so that nothing is
/// rounded and infinities survive.
///
/// ```
/// use satisfice::state::{Reader, State};
///
/// let mut state = State::default();
/// state.write(&vec![0.1, f64::INFINITY]);
/// state.write(&7_u64);
///
/// let mut reader = Reader::new(&state);
/// let list: Vec<f64> = reader.read()?;
/// let number: u64 = reader.read()?;
/// reader.finish()?;
/// assert_eq!((list, number), (vec![0.1, f64::INFINITY], 7));
/// # Ok::<(), satisfice::Error>(())
/// ```
///
/// Written as text, as in JSON, it is compressed: most numbers of an engine are coordinates, of which many are alike.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct State(pub Vec<u8>);

mod text {
    //! Bytes are written as they are; in a text, as base64 of a zlib stream.

    use std::borrow::Cow;
    use std::io::{Read, Write};

    use base64::Engine;
    use base64::engine::general_purpose::STANDARD;
    use flate2::Compression;
    use flate2::read::ZlibDecoder;
    use flate2::write::ZlibEncoder;
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de, ser};

    use super::State;

    impl Serialize for State {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            if !serializer.is_human_readable() {
                return self.0.serialize(serializer);
            }
            let mut packed = ZlibEncoder::new(Vec::new(), Compression::fast());
            packed.write_all(&self.0).map_err(ser::Error::custom)?;
            let packed = packed.finish().map_err(ser::Error::custom)?;
            (self.0.len(), STANDARD.encode(packed)).serialize(serializer)
        }
    }

    impl<'de> Deserialize<'de> for State {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            if !deserializer.is_human_readable() {
                return Vec::deserialize(deserializer).map(Self);
            }
            let (length, text): (u64, Cow<'_, str>) = Deserialize::deserialize(deserializer)?;
            let packed = STANDARD.decode(text.as_bytes()).map_err(de::Error::custom)?;
            let mut bytes = Vec::new();
            // No more than was written, whatever a damaged stream would give.
            let mut limited = ZlibDecoder::new(&*packed).take(length);
            limited.read_to_end(&mut bytes).map_err(de::Error::custom)?;
            if bytes.len() as u64 == length {
                Ok(Self(bytes))
            } else {
                Err(de::Error::custom("the state of an engine ends too early"))
            }
        }
    }
}

impl State {
    /// Appends a value.
    ///
    /// # Panics
    /// If the value's `Serialize` fails, or describes a sequence without its length. Derived implementations do neither.
    pub fn write<T: Serialize + ?Sized>(&mut self, value: &T) {
        let bytes = core::mem::take(&mut self.0);
        self.0 = postcard::to_extend(value, bytes).expect("derived implementations of Serialize do not fail");
    }
}

/// Reads a [`State`] from its beginning.
#[derive(Debug)]
pub struct Reader<'a> {
    bytes: &'a [u8],
}

impl<'a> Reader<'a> {
    /// At the beginning of `state`.
    #[must_use]
    pub fn new(state: &'a State) -> Self {
        Self { bytes: &state.0 }
    }

    /// The next value.
    ///
    /// # Errors
    /// [`Error::State`] if the state ends early or the next bytes are not such a value.
    pub fn read<T: Saved>(&mut self) -> Result<T, Error> {
        T::restore(self)
    }

    /// Checks that everything has been read.
    ///
    /// # Errors
    /// [`Error::State`] if bytes are left.
    pub fn finish(self) -> Result<(), Error> {
        if self.bytes.is_empty() {
            Ok(())
        } else {
            Err(Error::State(format!("{} bytes are left over", self.bytes.len())))
        }
    }

    fn next<T: DeserializeOwned>(&mut self) -> Result<T, Error> {
        let (value, rest) = postcard::take_from_bytes(self.bytes).map_err(|error| match error {
            postcard::Error::DeserializeUnexpectedEnd => Error::State("it ends too early".to_owned()),
            other => Error::State(format!("it is damaged, or of another build: {other}")),
        })?;
        self.bytes = rest;
        Ok(value)
    }
}

/// A value that can be kept in a [`State`]: everything that serde writes and reads.
pub trait Saved: Sized {
    /// Appends the value.
    fn save(&self, state: &mut State);
    /// Reads it back.
    ///
    /// # Errors
    /// [`Error::State`] if the next bytes are not such a value.
    fn restore(from: &mut Reader<'_>) -> Result<Self, Error>;
}

impl<T: Serialize + DeserializeOwned> Saved for T {
    fn save(&self, state: &mut State) {
        state.write(self);
    }
    fn restore(from: &mut Reader<'_>) -> Result<Self, Error> {
        from.next()
    }
}

/// A part of an engine that is saved and restored in place, into a part with the same settings: everything that is
/// [`Saved`], and parts with [`saved_fields!`](crate::saved_fields).
pub trait Part {
    /// Appends everything that changes.
    fn save(&self, state: &mut State);
    /// Reads it back.
    ///
    /// # Errors
    /// [`Error::State`] if the next bytes do not fit.
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

/// Writes `save` and `restore` of [`Engine`](crate::Engine) or of [`Part`] for the named fields: those that change while
/// the engine runs. Settings are not saved. The conformance suite finds a forgotten field.
///
/// With `; check` after the fields, `self.check()?` decides whether the restored fields fit each other.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_keep_their_bits() {
        let values = [
            -0.0,
            f64::from_bits(0x7ff8_0000_0000_1234),
            5e-324,
            f64::NEG_INFINITY,
            0.1,
        ];
        let mut state = State::default();
        state.write(&values);
        let mut reader = Reader::new(&state);
        let back: [f64; 5] = reader.read().unwrap();
        assert_eq!(back.map(f64::to_bits), values.map(f64::to_bits));
        assert!(reader.finish().is_ok());
    }

    #[test]
    fn as_text_it_is_compressed() {
        let mut state = State::default();
        state.write(&(0..20_000).map(|i| f64::from(i % 50)).collect::<Vec<f64>>());
        let text = serde_json::to_string(&state).unwrap();
        assert!(
            text.len() * 8 < state.0.len(),
            "{} of {}",
            text.len(),
            state.0.len()
        );
        assert_eq!(serde_json::from_str::<State>(&text).unwrap(), state);
        let bytes = postcard::to_extend(&state, Vec::new()).unwrap();
        assert_eq!(postcard::from_bytes::<State>(&bytes).unwrap(), state);
        let middle = text.len() / 2;
        let other = if text.as_bytes()[middle] == b'A' { "B" } else { "A" };
        let mut flipped = text.clone();
        flipped.replace_range(middle..=middle, other);
        for damaged in [text.replacen("160", "161", 1), flipped, "[4,\"\"]".to_owned()] {
            let read = serde_json::from_str::<State>(&damaged);
            assert!(read.map_or(true, |other| other != state), "{damaged}");
        }
    }

    #[test]
    fn a_state_that_is_cut_short_or_too_long_is_refused() {
        let mut state = State::default();
        state.write(&vec![1.5_f32; 3]);
        for length in 0..state.0.len() {
            let cut = State(state.0[..length].to_vec());
            assert!(Reader::new(&cut).read::<Vec<f32>>().is_err(), "{length}");
        }
        state.write(&true);
        let mut reader = Reader::new(&state);
        assert!(reader.read::<Vec<f32>>().is_ok());
        assert!(
            reader
                .finish()
                .unwrap_err()
                .to_string()
                .contains("1 bytes are left over")
        );
    }

    #[test]
    fn a_list_said_to_be_longer_than_the_state_takes_no_memory() {
        let mut state = State::default();
        state.write(&u64::MAX);
        assert!(Reader::new(&state).read::<Vec<u64>>().is_err());
    }
}
