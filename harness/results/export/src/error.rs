//! Reasons why a recording can't be exported.

use octant_base::failing::{Failing, FailureKind};
use octant_recorder::reader::ReadError;
use std::path::PathBuf;

/// Reason why a recording can't be exported.
#[derive(Debug, thiserror::Error)]
pub enum ExportFailure {
    /// The recording can't be read.
    #[error("read {}: {source}", path.display())]
    Recording {
        /// The recording.
        path: PathBuf,
        /// Error of the reader.
        source: ReadError,
    },
    /// A file is in the way.
    #[error("write {}: it is there already; --force replaces it", path.display())]
    InTheWay {
        /// The file.
        path: PathBuf,
    },
    /// The operating system refused.
    #[error("write {}: {source}", path.display())]
    System {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The library of a format refused.
    #[error("write {}: {reason}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// Its reason.
        reason: String,
    },
    /// A format can't hold this much.
    #[error(
        "write {}: {what} needs {bytes} bytes, a MAT-file of level 5 holds at most {max} in a \
         variable; a coarser --every or fewer --tables make it smaller, --to parquet has no such limit",
        path.display()
    )]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Variable that is too large.
        what: String,
        /// Its size, bytes.
        bytes: u64,
        /// Largest size, bytes.
        max: u64,
    },
    /// The recording has nothing for this format.
    #[error("export {}: {reason}", path.display())]
    Nothing {
        /// The recording.
        path: PathBuf,
        /// Reason.
        reason: String,
    },
}

impl Failing for ExportFailure {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Recording { .. }
            | Self::InTheWay { .. }
            | Self::TooLarge { .. }
            | Self::Nothing { .. } => FailureKind::Input,
            Self::System { .. } | Self::Format { .. } => FailureKind::Bench,
        }
    }
}
