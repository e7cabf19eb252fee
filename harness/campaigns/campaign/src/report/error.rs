//! Reasons why there is no report of a campaign.

use crate::execute::ExecuteError;
use crate::execute::case::ResultError;
use crate::plan::PlanError;
use octant_base::failing::{Failing, FailureKind};
use octant_evidence::ManifestError;
use octant_evidence::disposition::DispositionError;
use std::path::PathBuf;

/// Reasons why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The plan isn't valid.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The folder has results of another plan.
    #[error(transparent)]
    Foreign(#[from] ExecuteError),
    /// A result can't be read.
    #[error(transparent)]
    Result(#[from] ResultError),
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
    /// The content of a file isn't valid.
    #[error("read {path}: {reason}")]
    Form {
        /// The file.
        path: PathBuf,
        /// Problem found.
        reason: String,
    },
    /// The results can't be written in a format.
    #[error("write {what}: {reason}")]
    Format {
        /// Format to be written.
        what: &'static str,
        /// Reason.
        reason: String,
    },
    /// Positions can't be shown as distances.
    #[error(
        "show latitude and longitude errors in {unit}: the length of a minute of longitude is that of each \
         case's latitude, which isn't known: {reason}; expected the scenarios of the plan in their places, or \
         arcmin as the unit of position"
    )]
    Units {
        /// Unit that was chosen.
        unit: &'static str,
        /// Reason why the sites aren't known.
        reason: String,
    },
    /// The dispositions can't be read.
    #[error(transparent)]
    Dispositions(#[from] DispositionError),
    /// The manifest can't be written.
    #[error(transparent)]
    Manifest(#[from] ManifestError),
}

impl Failing for ReportError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Plan(error) => error.kind(),
            Self::Foreign(error) => error.kind(),
            Self::Dispositions(error) => error.kind(),
            Self::Form { .. } | Self::Units { .. } => FailureKind::Input,
            Self::Result(_) | Self::System { .. } | Self::Format { .. } | Self::Manifest(_) => {
                FailureKind::Bench
            }
        }
    }
}
