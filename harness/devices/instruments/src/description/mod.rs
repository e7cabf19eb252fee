//! Reads descriptions of record protocols: TOML files, and those of units whose formats are public.
//!
//! ```toml
//! version = 1
//! name = "a unit"
//! byte_order = "big"
//! checksum = { kind = "sum8", at = -1 }
//!
//! [[frame]]
//! sync = [0xA5, 0x5A]
//! length = 28
//! field = [
//!     { is = "counter", at = 2, type = "u8" },
//!     { is = "gyro x", at = 3, type = "i32", unit = "rad", scale = 1e-9 },
//! ]
//! ```
//!
//! In place of frames a description has the records of one length of a file, `[record]`, or lines of text, `[[line]]`.
//!
//! Places are offsets from the frame's first byte, which is 0; negative ones count from behind its last byte. A key
//! that isn't known, a value that isn't possible, and a description of a newer version are errors with file and line.

mod checksum;
mod fields;
mod form;
mod lines;
mod ranges;
mod read;
mod record;
mod table;

use crate::AnyDecoder;
use crate::described::{Described, DescribedDecoder, LinesDecoder, RecordsDecoder};
use std::string::String;

pub use form::UnitForm;

pub use table::{DescriptionProblem, VERSION};

/// Description of a unit.
#[derive(Clone, Debug)]
pub struct UnitDescription {
    /// Name of the unit and its format.
    pub name: String,
    /// Frames, records or lines that the unit sends.
    pub form: UnitForm,
}

impl UnitDescription {
    /// Reads a description; `file` is its name in messages.
    ///
    /// # Errors
    /// If the text is no description, with file, line and key.
    pub fn parse(file: &str, text: &str) -> Result<Self, DescriptionProblem> {
        let (name, form) = read::read(file, text)?;
        Ok(Self { name, form })
    }

    /// Reads a description that is part of the program, if there is one of the name.
    ///
    /// # Errors
    /// If it isn't valid, which a test excludes.
    pub fn ready(name: &str) -> Result<Option<Self>, DescriptionProblem> {
        let found = READY.iter().find(|(known, _)| *known == name);
        found.map(|(name, text)| Self::parse(name, text)).transpose()
    }

    /// Makes a decoder of a file, from its start.
    #[must_use]
    pub fn decoder(&self) -> AnyDecoder {
        match &self.form {
            UnitForm::Frames(record) => {
                AnyDecoder::Described(DescribedDecoder::new(Described::new(record.clone())))
            }
            UnitForm::Records(records) => AnyDecoder::Records(RecordsDecoder::new(records.clone())),
            UnitForm::Lines(lines) => AnyDecoder::Lines(LinesDecoder::of_file(lines.clone())),
        }
    }

    /// Makes a decoder of a port, which may be opened at any time; `None` for records, whose beginning nothing tells.
    #[must_use]
    pub fn port_decoder(&self) -> Option<AnyDecoder> {
        match &self.form {
            UnitForm::Frames(_) => Some(self.decoder()),
            UnitForm::Records(_) => None,
            UnitForm::Lines(lines) => Some(AnyDecoder::Lines(LinesDecoder::of_port(lines.clone()))),
        }
    }
}

/// Name and text of each.
pub const READY: [(&str, &str); 6] = [
    ("kvh-1775-angle", include_str!("../../descriptions/kvh-1775-angle.toml")),
    ("kvh-1775-rate", include_str!("../../descriptions/kvh-1775-rate.toml")),
    ("ln-100-like", include_str!("../../descriptions/ln-100-like.toml")),
    ("stim300-increment", include_str!("../../descriptions/stim300-increment.toml")),
    ("stim300-rate", include_str!("../../descriptions/stim300-rate.toml")),
    ("vectornav-imu-ascii", include_str!("../../descriptions/vectornav-imu-ascii.toml")),
];
