//! Reading of values from bytes.

use crate::{State, StateError};
use serde::Deserialize;

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
