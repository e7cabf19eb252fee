//! Reasons why a solution can't be taken from its port.

use crate::bench::error::SetupError;
use octant_link::PortError;
use octant_power::PowerError;
use octant_source::SourceError;
use std::path::PathBuf;

/// A solution can't be taken from its port.
#[derive(Debug, thiserror::Error)]
pub enum AcquireError {
    /// Nobody can be asked.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The port can't be opened.
    #[error(transparent)]
    Port(#[from] PortError),
    /// The port carries no bytes, or the scenario has none.
    #[error("found {found}, expected a serial line, UDP or TCP")]
    NoLine {
        /// The port.
        found: String,
    },
    /// The file can't be written.
    #[error("write {}: {error}", file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// Error of the operating system.
        error: std::io::Error,
    },
    /// The supply or relay doesn't obey.
    #[error(transparent)]
    Power(#[from] PowerError),
    /// The table doesn't obey.
    #[error(transparent)]
    Table(#[from] SourceError),
}
