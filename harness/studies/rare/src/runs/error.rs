//! Reasons why an estimate gave no result.

use octant_base::chained_lines::ChainedLinesError;
use octant_base::failing::{Failing, FailureKind};
use std::path::PathBuf;

/// Reasons why an estimate gave no result.
#[derive(Debug, thiserror::Error)]
pub enum RareError {
    /// The scenario has no requirement of this id.
    #[error("found requirement {found:?}, {expected}")]
    NoRequirement {
        /// Id that was asked for.
        found: String,
        /// Known ones.
        expected: String,
    },
    /// The scenario requires nothing.
    #[error("found a scenario without [[requirements]], expected one with a measure and a limit")]
    NothingRequired,
    /// Several requirements, and none was chosen.
    #[error("found {0} requirements, expected --requirement with the id of one of them: {1}")]
    Several(usize, String),
    /// The runs don't come from a simulation.
    #[error(
        "found a source or a unit that isn't simulated in this program, expected the plant and the core in process"
    )]
    NotSimulated,
    /// Runs by the clock can't be repeated by the thousand.
    #[error("found a run by the clock, expected realtime.pace = \"free\"")]
    ByClock,
    /// Nobody answers by the thousand.
    #[error("found step {0:?} of [[operator]], expected a scenario that asks nobody")]
    Attended(String),
    /// Without calibration nothing is published.
    #[error("found a scenario without calibration, expected [procedure.calibration]")]
    NoCalibration,
    /// No parameter of this name is published.
    #[error("found parameter {found:?}, {expected}")]
    NoParameter {
        /// Name that was asked for.
        found: String,
        /// Known ones.
        expected: String,
    },
    /// The journal can't be read or written.
    #[error("{action} {path}: {source}")]
    Journal {
        /// Action that failed.
        action: &'static str,
        /// The journal.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The journal is of another estimate, or was changed.
    #[error("{path}: line {line}: {problem}")]
    OtherEstimate {
        /// The journal.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Found and expected content.
        problem: String,
    },
    /// The failing run had another result when it was run again from its file.
    #[error("run {0} again from its file: found another result, which is a bug of this program")]
    Differs(String),
    /// Interrupted on request.
    #[error("interrupted: the same command resumes")]
    Cancelled,
}

impl Failing for RareError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::NoRequirement { .. }
            | Self::NothingRequired
            | Self::Several(..)
            | Self::NotSimulated
            | Self::ByClock
            | Self::Attended(_)
            | Self::NoCalibration
            | Self::NoParameter { .. }
            | Self::OtherEstimate { .. } => FailureKind::Input,
            Self::Journal { .. } | Self::Differs(_) => FailureKind::Bench,
            Self::Cancelled => FailureKind::Inconclusive,
        }
    }
}

impl From<ChainedLinesError> for RareError {
    fn from(error: ChainedLinesError) -> Self {
        match error {
            ChainedLinesError::System { action, path, source } => {
                Self::Journal { action, path, source }
            }
            ChainedLinesError::Line { path, line, problem } => {
                Self::OtherEstimate { path, line, problem }
            }
        }
    }
}
