//! Reasons why nothing, or not everything, was built.

use octant_base::failing::{Failing, FailureKind};
use std::path::PathBuf;

/// Reasons why nothing, or not everything, was built.
#[derive(Debug, thiserror::Error)]
pub enum BuildError {
    /// The program can't find its own path.
    #[error("failed to find the program's own file: {source}")]
    Program {
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The library isn't where the build puts it.
    #[error(
        "{name} is neither beside the program in {} nor in ../lib/octant from there: build it with `cargo build --release`, or name one with --library",
        folder.display()
    )]
    NoLibrary {
        /// File name of the library.
        name: String,
        /// Folder that was searched.
        folder: PathBuf,
    },
    /// A file can't be read.
    #[error("failed to read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// A file isn't a library that can be put into an FMU.
    #[error("{} can't go into an FMU: {reason}", path.display())]
    Library {
        /// The file.
        path: PathBuf,
        /// Reason.
        reason: String,
    },
    /// Two libraries are for the same platform.
    #[error("{} and {} are both for {platform}", first.display(), second.display())]
    SamePlatform {
        /// One of them.
        first: PathBuf,
        /// The other.
        second: PathBuf,
        /// Name of the platform.
        platform: &'static str,
    },
    /// The source isn't there.
    #[error(
        "a library for a target is built from the source of Octant, which isn't in the current folder: run it there"
    )]
    NoSource,
    /// A library for a target can't be built.
    #[error("failed to build the library for {target}: {reason}")]
    Target {
        /// The target.
        target: String,
        /// Reason.
        reason: String,
    },
    /// A scenario can't be put into FMUs.
    #[error("the parameters of {name} can't be put into FMUs: {reason}")]
    Scenario {
        /// Name.
        name: String,
        /// Reason.
        reason: String,
    },
    /// A model doesn't run with its start values.
    #[error("the models don't run with their start values: {reason}")]
    Model {
        /// Messages of the models.
        reason: String,
    },
    /// A file can't be written.
    #[error("failed to write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
}

impl Failing for BuildError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::NoLibrary { .. }
            | Self::Read { .. }
            | Self::Library { .. }
            | Self::SamePlatform { .. }
            | Self::NoSource
            | Self::Target { .. }
            | Self::Scenario { .. } => FailureKind::Input,
            Self::Program { .. } | Self::Model { .. } | Self::Write { .. } => FailureKind::Bench,
        }
    }
}
