//! Places of results, and reasons why a part file can't be read.

use super::frame::SCHEMA;
use std::fmt;
use std::path::{Path, PathBuf};

/// Place where a result is stored.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ResultPlace {
    /// A file of its own, named for the case.
    File(PathBuf),
    /// A record of a part file.
    Record {
        /// The file.
        part: PathBuf,
        /// Byte at which the record begins.
        offset: u64,
        /// The case.
        case: String,
    },
}

impl ResultPlace {
    /// Returns the file.
    #[must_use]
    pub fn path(&self) -> &Path {
        match self {
            Self::File(path) | Self::Record { part: path, .. } => path,
        }
    }

    /// Returns what is the same however the cases were distributed: the file of the case, or the folder of
    /// all parts.
    #[must_use]
    pub fn folder(&self) -> &Path {
        match self {
            Self::File(path) => path,
            Self::Record { part, .. } => part.parent().unwrap_or(part),
        }
    }

    /// Returns the case for which it is named.
    #[must_use]
    pub fn case(&self) -> &str {
        match self {
            Self::File(path) => {
                let name = path.file_name().and_then(|name| name.to_str()).unwrap_or("");
                name.split('.').next().unwrap_or("")
            }
            Self::Record { case, .. } => case,
        }
    }
}

impl fmt::Display for ResultPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => write!(f, "{}", path.display()),
            Self::Record { part, offset, case } => {
                write!(f, "{}, case {case} at byte {offset}", part.display())
            }
        }
    }
}

/// Reasons why a part file can't be read or written. The text fits after "failed to".
#[derive(Debug, thiserror::Error)]
pub enum PartError {
    /// The operating system refused.
    #[error("{action} {path}: {source}")]
    System {
        /// Action that failed.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file isn't a part.
    #[error("read {path}: found no head of a part file, expected results of cases")]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// The file has a version that this program doesn't read.
    #[error(
        "read {path}: found version {found}, this program reads version {SCHEMA}{}",
        if *.found > SCHEMA { ": a newer Octant wrote it" } else { "" }
    )]
    Version {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u32,
    },
    /// A record is damaged, and is not the end of a file whose writer was ended.
    #[error(
        "read {path}: the record at byte {offset} is damaged: found {found}, expected {expected}"
    )]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Byte at which the record begins.
        offset: u64,
        /// Content that was found.
        found: String,
        /// Content that was expected.
        expected: String,
    },
    /// The result is too large for a record.
    #[error("write {path}: the result of case {case} is too large: found {bytes} bytes")]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The case.
        case: String,
        /// Bytes of the result.
        bytes: usize,
    },
}

impl PartError {
    /// Makes an error of the operating system.
    pub(super) fn system(
        action: &'static str,
        path: &Path,
    ) -> impl FnOnce(std::io::Error) -> Self + use<> {
        let path = path.to_owned();
        move |source| Self::System { action, path, source }
    }
}
