//! Reasons why a folder, a manifest or a signature can't be made or used.

use std::io;
use std::path::PathBuf;

/// Reasons why a run folder could not be made or finished.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// The path holds a finished run.
    #[error("create run folder {path}: it holds a run already")]
    Finished {
        /// The folder.
        path: PathBuf,
    },
    /// The path holds the remains of a killed run.
    #[error("create run folder {path}: a run that did not end left it")]
    Unfinished {
        /// The folder.
        path: PathBuf,
    },
    /// A run is being written there at this moment.
    #[error("create run folder {path}: another run is writing there")]
    Busy {
        /// The folder.
        path: PathBuf,
    },
    /// The path holds something other than a run.
    #[error("replace {path}: it is not a run folder ({expected} is missing in it)")]
    NotARun {
        /// The folder.
        path: PathBuf,
        /// File that every run has.
        expected: &'static str,
    },
    /// A path without a name, as `/` or `..`.
    #[error("create run folder {path}: expected a path that ends in a name")]
    NoName {
        /// The path.
        path: PathBuf,
    },
    /// A run was put aside for another, which couldn't take its place.
    #[error(
        "rename {} to {}: {source}; the run that it was to replace is in {}",
        .new.display(), .path.display(), .old.display()
    )]
    NotReplaced {
        /// Folder of the new run.
        new: PathBuf,
        /// Name that it was to have.
        path: PathBuf,
        /// Present folder of the previous run.
        old: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The operating system refused.
    #[error("{action} {path}: {source}")]
    System {
        /// Action that failed.
        action: &'static str,
        /// Path that the action concerned.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
}

/// Reasons why a manifest could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum ManifestError {
    /// A file can't be read or written.
    #[error("{action} {path}: {source}")]
    System {
        /// Action that failed.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The content of the manifest isn't valid.
    #[error("read {path}: {reason}")]
    Content {
        /// The manifest.
        path: PathBuf,
        /// Found and expected.
        reason: String,
    },
    /// Something in the folder can't be part of the evidence.
    #[error("write the manifest: {path}: {reason}")]
    Form {
        /// File or folder concerned.
        path: PathBuf,
        /// Found and expected.
        reason: String,
    },
    /// The manifest can't be signed.
    #[error(transparent)]
    Signature(#[from] SignatureError),
}

/// Reasons why a key or a signature can't be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SignatureError {
    /// The key can't be used.
    #[error("read the key {path}: {reason}")]
    Key {
        /// File.
        path: PathBuf,
        /// Reason.
        reason: String,
    },
    /// The signature isn't one of this key on this manifest.
    #[error("verify the signature {path}: {reason}")]
    Signature {
        /// File.
        path: PathBuf,
        /// Reason.
        reason: String,
    },
    /// The signature could not be made.
    #[error("sign {path}: {reason}")]
    Sign {
        /// File that was to be signed.
        path: PathBuf,
        /// Reason.
        reason: String,
    },
}
