//! Reasons why a search gave no result.

use octant_base::chained_lines::ChainedLinesError;
use octant_base::failing::{Failing, FailureKind};
use octant_run::MethodError;
use octant_scenario::Problem;
use std::path::PathBuf;

/// Reasons why a search gave no result.
#[derive(Debug, thiserror::Error)]
pub enum SearchError {
    /// The scenario has faults of its own.
    #[error("found a scenario with {0} of its own [[faults]], expected none: the search sets them")]
    HasFaults(usize),
    /// The scenario can't be written with its defaults.
    #[error("write the scenario: {}", .0.message)]
    Unwritable(Problem),
    /// A scenario that the search wrote can't be read.
    #[error("read the scenario that was found: {0}")]
    Unreadable(String),
    /// Without calibration no parameter can be moved.
    #[error("found a scenario without calibration, expected [procedure.calibration]")]
    NoCalibration,
    /// The run without faults refused its calibration, so there is no reference.
    #[error("the run without faults is refused itself: {0}")]
    TwinRefused(String),
    /// A run gave no result.
    #[error(transparent)]
    Method(#[from] MethodError),
    /// No form of the space can be in the scenario.
    #[error("found no fault that the scenario can have; the first reason: {0}")]
    EmptySpace(String),
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
    /// The journal is of another search.
    #[error("{path}: line {line}: {problem}")]
    OtherSearch {
        /// The journal.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// What was found and what was expected.
        problem: String,
    },
    /// The worst fault had another effect in an undivided run.
    #[error("{0}, which is a bug of this program")]
    Differs(String),
    /// Interrupted on request.
    #[error("interrupted: the same command resumes")]
    Cancelled,
}

impl Failing for SearchError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Method(error) => error.kind(),
            Self::HasFaults(_)
            | Self::Unwritable(_)
            | Self::Unreadable(_)
            | Self::NoCalibration
            | Self::EmptySpace(_)
            | Self::OtherSearch { .. } => FailureKind::Input,
            Self::Journal { .. } | Self::Differs(_) => FailureKind::Bench,
            Self::Cancelled => FailureKind::Inconclusive,
            Self::TwinRefused(_) => FailureKind::Fail,
        }
    }
}

impl From<ChainedLinesError> for SearchError {
    fn from(error: ChainedLinesError) -> Self {
        match error {
            ChainedLinesError::System { action, path, source } => {
                Self::Journal { action, path, source }
            }
            ChainedLinesError::Line { path, line, problem } => {
                Self::OtherSearch { path, line, problem }
            }
        }
    }
}
