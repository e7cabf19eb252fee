//! Writing of values to bytes.

use crate::State;
use alloc::vec::Vec;
use postcard::ser_flavors::Flavor;
use serde::Serialize;

/// Takes the values of a state, one after another.
#[derive(Debug, Default)]
pub struct Writer {
    bytes: Vec<u8>,
    failed: bool,
    #[cfg(feature = "outline")]
    pub(crate) outline: Option<crate::outline::Outline>,
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

    /// Returns whether every value could be written.
    pub(crate) fn is_sound(&self) -> bool {
        !self.failed
    }

    pub(crate) fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }
}
