//! Reasons why there is no plan.

use crate::journal::JournalError;
use octant_base::failing::{Failing, FailureKind};
use octant_scenario::FileProblems;
use octant_verdict::RequirementsError;
use std::path::{Path, PathBuf};

/// Reasons why there is no plan.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// A file of the campaign isn't valid.
    #[error(transparent)]
    File(#[from] FileProblems),
    /// The file of requirements isn't valid.
    #[error(transparent)]
    Requirements(#[from] RequirementsError),
    /// A file can't be read or written.
    #[error("{action} {path}: {source}")]
    System {
        /// Action that failed.
        action: &'static str,
        /// Path that the action concerned.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The journal of the campaign can't be used.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The campaign contradicts itself.
    #[error("plan {campaign}: {reason}")]
    Contradiction {
        /// The campaign.
        campaign: PathBuf,
        /// Reason.
        reason: String,
    },
    /// The file isn't a plan.
    #[error("read {path}: {reason}")]
    Form {
        /// The file.
        path: PathBuf,
        /// Problem found.
        reason: String,
    },
}

impl Failing for PlanError {
    fn kind(&self) -> FailureKind {
        match self {
            // Reading is of what was given, writing of the place.
            Self::System { action: "create" | "create a file in" | "write", .. } => {
                FailureKind::Bench
            }
            Self::Journal(error) => error.kind(),
            Self::System { .. }
            | Self::File(_)
            | Self::Requirements(_)
            | Self::Contradiction { .. }
            | Self::Form { .. } => FailureKind::Input,
        }
    }
}

/// Returns the first digits of a hash, for display.
#[must_use]
pub fn short(hash: &str) -> &str {
    hash.get(..12).unwrap_or(hash)
}

pub(crate) fn system<T>(
    action: &'static str,
    path: &Path,
    result: std::io::Result<T>,
) -> Result<T, PlanError> {
    result.map_err(|source| PlanError::System { action, path: path.to_owned(), source })
}
