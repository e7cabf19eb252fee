//! Reasons why the result of a case can't be read.

use crate::journal::JournalError;
use crate::store::error::{PartError, ResultPlace};
use std::io;
use std::path::PathBuf;

/// Reasons why the result of a case can't be read. The text fits after "failed to".
#[derive(Debug, thiserror::Error)]
pub enum ResultError {
    /// A part file can't be read.
    #[error(transparent)]
    Part(#[from] PartError),
    /// The journal of the campaign can't be read.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// A file can't be read.
    #[error("read {path}: {source}")]
    System {
        /// The file or folder.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// It isn't the result of a case.
    #[error("read {place}: expected the result of a case: {source}")]
    Form {
        /// The result.
        place: ResultPlace,
        /// Problem found.
        source: serde_json::Error,
    },
    /// The result has a version that this program doesn't read.
    #[error(
        "read {place}: found version {found}, this program reads versions 1 to {newest}{}",
        if .found > .newest { ": a newer Octant wrote it" } else { "" }
    )]
    Version {
        /// The result.
        place: ResultPlace,
        /// Its version.
        found: u32,
        /// Newest version that is read.
        newest: u32,
    },
    /// It is stored for another case.
    #[error(
        "read {place}: it is the result of case {case}, expected that of the case it is named for"
    )]
    Name {
        /// The result.
        place: ResultPlace,
        /// Case that it names.
        case: String,
    },
    /// The result contradicts itself.
    #[error("read {place}: it contradicts itself: {}", .contradictions.join("; "))]
    Contradiction {
        /// The result.
        place: ResultPlace,
        /// Contradictions.
        contradictions: Vec<String>,
    },
    /// The result isn't that of the planned case.
    #[error("read {place}: its {what} is {found}, the plan has {expected}")]
    Foreign {
        /// The result.
        place: ResultPlace,
        /// Part that differs.
        what: String,
        /// Value in the result.
        found: String,
        /// Value in the plan.
        expected: String,
    },
    /// Another twin than that of a case that shares it.
    #[error("read {place}: {reason}")]
    Twins {
        /// The result.
        place: ResultPlace,
        /// Both twins.
        reason: String,
    },
}
