//! Values of a state: what a part of a model writes, one after another, and reads again in the same order. The trait
//! speaks of writer and reader, and both of the trait, whose parts they pass on to.

use crate::error::StateError;
#[cfg(feature = "outline")]
use crate::outline::Outline;
use alloc::vec::Vec;
use postcard::ser_flavors::Flavor;
use serde::{Deserialize, Serialize};

/// Part of a model that changes while it runs.
pub trait State {
    /// Writes the values.
    fn save(&self, to: &mut Writer);

    /// Reads the values into a model that was made from the same configuration.
    ///
    /// # Errors
    /// If the bytes are not those of such a model. The model is then in no useful state.
    fn load(&mut self, from: &mut StateReader<'_>) -> Result<(), StateError>;
}

/// Takes the values of a state, one after another.
#[derive(Debug, Default)]
pub struct Writer {
    bytes: Vec<u8>,
    failed: bool,
    #[cfg(feature = "outline")]
    outline: Option<Outline>,
}

/// Appends to bytes.
struct Append<'a>(&'a mut Vec<u8>);

impl Flavor for Append<'_> {
    type Output = ();

    #[inline]
    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        self.0.push(byte);
        Ok(())
    }

    #[inline]
    fn try_extend(&mut self, bytes: &[u8]) -> postcard::Result<()> {
        self.0.extend_from_slice(bytes);
        Ok(())
    }

    fn finalize(self) -> postcard::Result<()> {
        Ok(())
    }
}

impl Writer {
    /// Makes a writer that appends to `bytes`.
    pub(crate) fn onto(bytes: Vec<u8>) -> Self {
        Self { bytes, ..Self::default() }
    }

    /// Writes a value.
    #[inline]
    pub fn value<T: Serialize + ?Sized>(&mut self, name: &'static str, value: &T) {
        #[cfg(feature = "outline")]
        if let Some(outline) = &mut self.outline {
            outline.value(name, value);
        }
        #[cfg(not(feature = "outline"))]
        let _ = name;
        let mut serializer = postcard::Serializer { output: Append(&mut self.bytes) };
        self.failed |= value.serialize(&mut serializer).is_err();
    }

    /// Writes a part that has values of its own.
    #[inline]
    pub fn part<T: State + ?Sized>(&mut self, name: &'static str, part: &T) {
        #[cfg(feature = "outline")]
        if let Some(outline) = &mut self.outline {
            outline.enter(name);
        }
        #[cfg(not(feature = "outline"))]
        let _ = name;
        part.save(self);
        #[cfg(feature = "outline")]
        if let Some(outline) = &mut self.outline {
            outline.leave();
        }
    }

    /// Lists names and kinds of the values of a state, one a line.
    #[cfg(feature = "outline")]
    #[must_use]
    pub fn outline<T: State + ?Sized>(state: &T) -> alloc::string::String {
        let mut writer = Self { outline: Some(Outline::default()), ..Self::default() };
        state.save(&mut writer);
        writer.outline.map(Outline::into_text).unwrap_or_default()
    }

    /// Returns whether every value could be written.
    pub(crate) fn is_sound(&self) -> bool {
        !self.failed
    }

    pub(crate) fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }
}

/// Returns the values of a state, in the order in which they were written.
#[derive(Debug)]
pub struct StateReader<'a> {
    rest: &'a [u8],
}

impl<'a> StateReader<'a> {
    pub(crate) fn new(rest: &'a [u8]) -> Self {
        Self { rest }
    }

    /// Reads a value.
    ///
    /// # Errors
    /// If the bytes end before it, or are not a value of its type.
    pub fn value<T: Deserialize<'a>>(&mut self, name: &'static str) -> Result<T, StateError> {
        match postcard::take_from_bytes(self.rest) {
            Ok((value, rest)) => {
                self.rest = rest;
                Ok(value)
            }
            Err(_) => Err(StateError::value(name, "the bytes end before it, or it is none")),
        }
    }

    /// Reads a part that has values of its own.
    ///
    /// # Errors
    /// The errors of the part.
    pub fn part<T: State + ?Sized>(
        &mut self,
        _name: &'static str,
        part: &mut T,
    ) -> Result<(), StateError> {
        part.load(self)
    }

    /// Checks that no bytes are left.
    ///
    /// # Errors
    /// If bytes are left.
    pub fn end(&self) -> Result<(), StateError> {
        match self.rest.len() {
            0 => Ok(()),
            1 => Err(StateError::value("end", "1 byte is left over")),
            more => Err(StateError::value("end", alloc::format!("{more} bytes are left over"))),
        }
    }
}
