//! Reasons why two runs can't be compared.

use octant_campaign::table::TableError;
use octant_recorder::reader::ReadError;
use std::path::PathBuf;

/// Reason why two runs or campaigns can't be compared.
#[derive(Debug, thiserror::Error)]
pub enum DiffError {
    /// A file can't be read.
    #[error("read {}: {reason}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Reason.
        reason: String,
    },
    /// A recording can't be read.
    #[error("read {}: {source}", path.display())]
    Recording {
        /// The recording.
        path: PathBuf,
        /// Error of the reader.
        source: ReadError,
    },
    /// The tables of a campaign can't be read.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The folder has no run.
    #[error(
        "compare {}: expected the folder of a run with recording.mcap, a recording, or the folder of \
         a campaign with cases.parquet", path.display()
    )]
    NoRun {
        /// The folder.
        path: PathBuf,
    },
}
