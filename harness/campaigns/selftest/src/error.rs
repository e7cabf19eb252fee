//! Reasons why a case, or the self-test itself, could not be run. Their texts fit after "failed to".

use std::path::{Path, PathBuf};

/// File that can't be read or written.
#[derive(Debug, thiserror::Error)]
#[error("{action} {path}: {source}")]
pub struct FileError {
    /// Action that failed.
    pub action: &'static str,
    /// The file.
    pub path: PathBuf,
    /// Error of the operating system.
    pub source: std::io::Error,
}

impl FileError {
    /// Makes the error of an action on a file.
    pub(crate) fn of(action: &'static str, path: &Path) -> impl Fn(std::io::Error) -> Self + use<> {
        let path = path.to_owned();
        move |source| Self { action, path: path.clone(), source }
    }
}

/// Reasons why the program could not be run for a case.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// A file of the case can't be read or written, or the program can't be started.
    #[error(transparent)]
    File(#[from] FileError),
    /// The program was ended from outside.
    #[error("run {program}: it was ended from outside, by {by}")]
    Outside {
        /// The program.
        program: PathBuf,
        /// Signal, or other cause.
        by: String,
    },
    /// A run wrote no summary.
    #[error("run a scenario: no summary, status {status:?}: {said}")]
    NoSummary {
        /// Exit status; `None` if there is none.
        status: Option<i32>,
        /// Standard error of the program.
        said: String,
    },
}

/// Reasons why a case could not be prepared.
#[derive(Debug, thiserror::Error)]
pub enum CaseSetupError {
    /// The program could not be run.
    #[error(transparent)]
    Bench(#[from] BenchError),
    /// A step of the preparation failed.
    #[error("{0}")]
    Step(String),
}

impl From<String> for CaseSetupError {
    fn from(step: String) -> Self {
        Self::Step(step)
    }
}

impl From<&str> for CaseSetupError {
    fn from(step: &str) -> Self {
        Self::Step(step.to_owned())
    }
}

/// Error of a self-test without a folder for its cases.
#[derive(Debug, thiserror::Error)]
#[error("make a folder: {0}")]
pub struct CaseFolderError(#[from] pub std::io::Error);
