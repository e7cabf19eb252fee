//! Reasons why an archive can't be used.

use super::names::NameProblem;
use std::io;
use std::path::PathBuf;

/// Reason why an archive can't be used.
#[derive(Debug, thiserror::Error)]
pub enum ArchiveError {
    /// The file can't be read.
    #[error("failed to open {file}: {error}")]
    Open {
        /// File name.
        file: String,
        /// Error of the system.
        error: io::Error,
    },
    /// The file is no zip archive.
    #[error(
        "{file} is no zip archive: it {found}, expected an FMU or SSP file, or an unpacked folder"
    )]
    NotZip {
        /// File name.
        file: String,
        /// Content found instead.
        found: String,
    },
    /// The file is a zip archive, but truncated or damaged.
    #[error("{file} is damaged: {reason}")]
    Damaged {
        /// File name.
        file: String,
        /// Damage found.
        reason: String,
    },
    /// An entry must not be unpacked.
    #[error("{file}: entry {:?} {}, expected {}", .problem.name, .problem.found, .problem.expected)]
    Entry {
        /// File name.
        file: String,
        /// The entry and its problem.
        problem: NameProblem,
    },
    /// An entry can't be read.
    #[error("{file}: entry {entry:?} is damaged: {reason}")]
    Unreadable {
        /// File name.
        file: String,
        /// Name of the entry.
        entry: String,
        /// Damage found.
        reason: String,
    },
    /// The archive exceeds a limit.
    #[error("{file}: {what}, expected at most {limit}")]
    TooMuch {
        /// File name.
        file: String,
        /// Quantity above the limit.
        what: String,
        /// Limit.
        limit: String,
    },
    /// An entry is missing.
    #[error("{file} has no {entry}")]
    Missing {
        /// File name.
        file: String,
        /// Name of the entry.
        entry: String,
    },
    /// The temporary folder can't be written.
    #[error("failed to unpack {file} to {}: {error}", .path.display())]
    Write {
        /// File name.
        file: String,
        /// Path that can't be written.
        path: PathBuf,
        /// Error of the system.
        error: io::Error,
    },
    /// The file can't be copied.
    #[error("failed to copy {file} to {}: {error}", .path.display())]
    Copy {
        /// File name.
        file: String,
        /// Folder of the copy.
        path: PathBuf,
        /// Error of the system.
        error: io::Error,
    },
}
