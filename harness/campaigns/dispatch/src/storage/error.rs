//! Reasons why objects can't be read or written.

use crate::bundle::error::BundleError;
use octant_campaign::store::error::PartError;
use std::path::{Path, PathBuf};

/// Reasons why a campaign on object storage can't be read or written. The text fits after "failed to".
#[derive(Debug, thiserror::Error)]
pub enum StorageError {
    /// The text is no address of a campaign.
    #[error("read the address {found:?}: {reason}")]
    Address {
        /// The text.
        found: String,
        /// Difference from the expected form.
        reason: String,
    },
    /// A variable of the environment has a value that can't be used.
    #[error("use {variable} of the environment: {reason}")]
    Environment {
        /// The variable.
        variable: &'static str,
        /// Found and expected.
        reason: String,
    },
    /// The campaign isn't there.
    #[error(
        "read {object}: found no such object, expected what octant campaign bundle has put there"
    )]
    Absent {
        /// Address of the object.
        object: String,
    },
    /// Another object has the name.
    #[error("write {object}: {reason}")]
    Taken {
        /// Address of the object.
        object: String,
        /// Found and expected.
        reason: String,
    },
    /// The storage refused, or couldn't be reached in time.
    #[error("{action} {object}: {reason}")]
    Failed {
        /// Action that failed.
        action: &'static str,
        /// Address of the object.
        object: String,
        /// Words of the storage or of its client.
        reason: String,
    },
    /// The storage confirmed an object that it doesn't have.
    #[error("write {object}: the storage confirmed it, and reading it back {reason}")]
    NotKept {
        /// Address of the object.
        object: String,
        /// Found and expected.
        reason: String,
    },
    /// An object can't be what its name says.
    #[error("read {object}: {reason}")]
    Form {
        /// Address of the object.
        object: String,
        /// Found and expected.
        reason: String,
    },
    /// The working folder isn't one of this campaign.
    #[error("work in {path}: {reason}")]
    Work {
        /// The folder.
        path: PathBuf,
        /// Found and expected.
        reason: String,
    },
    /// An interrupt came.
    #[error("{action} {object}: interrupted")]
    Interrupted {
        /// Action that was interrupted.
        action: &'static str,
        /// Address of the object.
        object: String,
    },
    /// The bundle can't be read.
    #[error(transparent)]
    Bundle(#[from] BundleError),
    /// A part file can't be read.
    #[error(transparent)]
    Part(#[from] PartError),
    /// The operating system refused.
    #[error("{action} {path}: {source}")]
    System {
        /// Action that failed.
        action: &'static str,
        /// The file or folder.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
}

impl StorageError {
    /// Makes an error of the operating system.
    pub(crate) fn system(
        action: &'static str,
        path: &Path,
    ) -> impl FnOnce(std::io::Error) -> Self + use<> {
        let path = path.to_owned();
        move |source| Self::System { action, path, source }
    }
}
