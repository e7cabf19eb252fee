//! The reference of a calibration on real data: known, or measured and recorded beside the samples.

use crate::recorded::{Delimiter, MappedStamp, RecordedColumn, TimeColumn};
use std::path::{Path, PathBuf};

/// Reference of a source that brings none of its own.
#[derive(Clone, Debug, PartialEq)]
pub enum ReferenceSpec {
    /// The instrument stands: this holds at all times.
    Static(octant_sample::Reference),
    /// Measured, at stamps of its own.
    Recorded(Box<RecordedReference>),
}

/// Quantity of a recorded reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordedReferenceKind {
    /// Velocity north, east, down, m/s.
    Velocity,
    /// Geodetic latitude and longitude, rad, and height above the ellipsoid, m.
    Position,
}

/// Reference in a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedReference {
    /// Quantity.
    pub kind: RecordedReferenceKind,
    /// SI value of one unit of each of the three numbers; negative reverses it: up is not down.
    pub scale: [f64; 3],
    /// Keys that name the three numbers, for messages: `north`, `up`, `latitude`.
    pub names: [&'static str; 3],
    /// File and its columns or fields.
    pub place: ReferencePlace,
    /// Time between two references that the filter expects, ns.
    pub period_ns: u64,
    /// Latitude and longitude of the site, rad.
    pub site_rad: [f64; 2],
}

/// File of a recorded reference, with the place of its numbers in it.
#[derive(Clone, Debug, PartialEq)]
pub enum ReferencePlace {
    /// Columns of a text file.
    Text(ReferenceColumns),
    /// Fields of the messages on a topic of the MCAP file that has the samples.
    Mcap(ReferenceFields),
}

/// Columns of a reference in a text file.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceColumns {
    /// The file, as written.
    pub file: PathBuf,
    /// True if it isn't the file of the gyros.
    pub own_file: bool,
    /// Columns of the three numbers.
    pub columns: [RecordedColumn; 3],
    /// Time; without it the rows follow each other at `row_period_ns`.
    pub time: Option<TimeColumn>,
    /// Nominal time between two rows of the gyros' file, ns.
    pub row_period_ns: u64,
    /// Delimiter.
    pub delimiter: Delimiter,
    /// Beginning of lines that are skipped; empty: none.
    pub comment: String,
    /// Number of lines at the start that are skipped.
    pub skip_lines: usize,
    /// True if the first line after those names the columns.
    pub header: bool,
}

/// Fields of a reference in an MCAP file.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceFields {
    /// The file, as written.
    pub file: PathBuf,
    /// Topic of its messages.
    pub topic: String,
    /// Paths of the three numbers.
    pub fields: [String; 3],
    /// Stamps.
    pub stamp: MappedStamp,
}

impl ReferenceSpec {
    /// File of the reference, where it is one beside those of the samples.
    #[must_use]
    pub fn own_file(&self) -> Option<&Path> {
        let Self::Recorded(recorded) = self else { return None };
        match &recorded.place {
            ReferencePlace::Text(text) if text.own_file => Some(&text.file),
            ReferencePlace::Text(_) | ReferencePlace::Mcap(_) => None,
        }
    }
}
