//! Layout of tables in their files, and reasons why one could not be written or read.

use octant_base::failing::{Failing, FailureKind};
use std::path::PathBuf;

/// Version of the tables' layout.
pub const SCHEMA: &str = "1";
/// Version of tables in which columns have units.
pub const SCHEMA_WITH_UNITS: &str = "2";
/// Metadata key of the version.
pub(super) const VERSION_KEY: &str = "octant.schema";
/// Metadata key of the plan's id.
pub(super) const PLAN_KEY: &str = "octant.plan";
/// Metadata key of the units: a JSON object from names of columns to units.
pub(super) const UNITS_KEY: &str = "octant.units";

/// Number of rows passed to the library, or taken from it, at a time: it needs values in types of
/// its own.
pub(super) const ROWS_AT_A_TIME: usize = 16 * 1024;

/// Reasons why a table could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The operating system refused.
    #[error("{action} {path}: {source}")]
    System {
        /// Action that failed.
        action: &'static str,
        /// Path that the action concerned.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file isn't an octant table, or isn't complete.
    #[error("read {path}: {reason}")]
    Form {
        /// The file.
        path: PathBuf,
        /// Problem found.
        reason: String,
    },
    /// The table could not be written.
    #[error("write {path}: {reason}")]
    Write {
        /// The file.
        path: PathBuf,
        /// Reason.
        reason: String,
    },
}

impl Failing for TableError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::System { action: "write", .. } | Self::Write { .. } => FailureKind::Bench,
            Self::System { .. } | Self::Form { .. } => FailureKind::Input,
        }
    }
}
