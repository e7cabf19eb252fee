//! Reasons why a night can't be run, read or accepted.

use octant_campaign::table::TableError;
use octant_evidence::manifest::shell_path;
use octant_selftest::error::FileError;
use std::path::{Path, PathBuf};

/// Reasons why a night can't be run, read or accepted.
#[derive(Debug, thiserror::Error)]
pub enum NightError {
    /// A file, folder or process that the operating system refuses.
    #[error("failed to {action} {path}: {source}")]
    System {
        /// Action that failed.
        action: &'static str,
        /// Path that the action concerned.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// A file could not be written.
    #[error("failed to {0}")]
    File(#[from] FileError),
    /// The file isn't what is expected of it.
    #[error("failed to read {path}: expected {expected}: {source}")]
    Form {
        /// The file.
        path: PathBuf,
        /// Expected content.
        expected: &'static str,
        /// Problem found.
        source: serde_json::Error,
    },
    /// The file has a version that this program doesn't read.
    #[error("failed to read {path}: found version {found}, this program reads version {expected}")]
    Version {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u32,
        /// Version of this program.
        expected: u32,
    },
    /// A value can't be written as JSON.
    #[error("failed to write {what}: {source}")]
    Json {
        /// The value.
        what: String,
        /// Problem found.
        source: serde_json::Error,
    },
    /// The tables of a campaign can't be read.
    #[error("failed to {0}")]
    Table(#[from] TableError),
    /// The accepted baseline can't be read.
    #[error("{error}; octant nightly accept --history {} accepts another", shell_path(.history))]
    Baseline {
        /// Problem found.
        error: Box<NightError>,
        /// The history.
        history: PathBuf,
    },
    /// The night to be accepted hasn't ended.
    #[error("failed to accept night {id}: it hasn't run to its end")]
    NotEnded {
        /// The night.
        id: String,
    },
    /// The process of a case of the suite was ended from outside in every attempt.
    #[error(
        "failed to run {scenario}: its process was ended from outside {tries} times, the last time by \
         {by}: the case has no result"
    )]
    Outside {
        /// The scenario.
        scenario: PathBuf,
        /// Number of attempts.
        tries: u32,
        /// Signal, or other cause.
        by: String,
    },
}

impl NightError {
    /// Makes the error of an action on a file.
    pub(crate) fn of(action: &'static str, path: &Path) -> impl Fn(std::io::Error) -> Self + use<> {
        let path = path.to_owned();
        move |source| Self::System { action, path: path.clone(), source }
    }
}
