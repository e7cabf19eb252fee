//! Reasons why a bundle can't be made or used.

use octant_base::failing::{Failing, FailureKind};
use octant_campaign::plan::PlanError;
use octant_scenario::{FileNameError, FileProblems};
use std::path::PathBuf;

/// Reasons why a bundle can't be made or used. The text fits after "failed to".
#[derive(Debug, thiserror::Error)]
pub enum BundleError {
    /// The plan or one of its files isn't valid.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// A scenario isn't valid.
    #[error(transparent)]
    Scenario(#[from] FileProblems),
    /// The name of a file can't be expanded.
    #[error(transparent)]
    Name(#[from] FileNameError),
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
    /// A scenario names something that can't be bundled.
    #[error("bundle {path}: {reason}")]
    Unfit {
        /// The file.
        path: PathBuf,
        /// Kind of file found and kind expected.
        reason: String,
    },
    /// Something is in the way.
    #[error("write {path}: {reason}")]
    Exists {
        /// The path.
        path: PathBuf,
        /// Content found there and content expected.
        reason: String,
    },
    /// The file is no bundle, or a damaged one.
    #[error("read {path}: {reason}")]
    Form {
        /// The bundle.
        path: PathBuf,
        /// Value found and value expected.
        reason: String,
    },
    /// An entry of the bundle is wrong.
    #[error("read {path}: its entry {entry:?} {reason}")]
    Entry {
        /// The bundle.
        path: PathBuf,
        /// Name of the entry.
        entry: String,
        /// Value found and value expected.
        reason: String,
    },
}

impl Failing for BundleError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Plan(error) => error.kind(),
            Self::System { action: "read", .. }
            | Self::Scenario(_)
            | Self::Name(_)
            | Self::Unfit { .. }
            | Self::Exists { .. }
            | Self::Form { .. }
            | Self::Entry { .. } => FailureKind::Input,
            Self::System { .. } => FailureKind::Bench,
        }
    }
}

/// Reasons why an entry may not have its name. The text fits after the name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EntryNameError {
    /// An absolute path, of any system.
    #[error("is an absolute path, expected a name in the bundle's own folder")]
    Absolute,
    /// A path that leaves its folder.
    #[error("leads out of its folder with \"..\", expected a name in it")]
    Outside,
    /// Neither a list nor a file under its hash.
    #[error("is no file of a bundle, expected plan.json or files/BLAKE3/NAME")]
    Unknown,
}

impl BundleError {
    /// Returns a closure that makes an error of the operating system one of these.
    pub(super) fn system(
        action: &'static str,
        path: impl Into<PathBuf>,
    ) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.into();
        move |source| Self::System { action, path, source }
    }
}
