//! Reasons why the process of an FMU ends early.

use std::io;

/// Reason why the process of an FMU ends early.
#[derive(Debug, thiserror::Error)]
pub enum FmuServeError {
    /// No process that provides its input and output started this one.
    #[error("octant fmu host is started by octant itself, for an FMU that runs apart ({error})")]
    NotStarted {
        /// Error of the operating system.
        error: io::Error,
    },
    /// The other process can't be watched.
    #[error("{error}")]
    Watch {
        /// Error of the operating system.
        error: io::Error,
    },
    /// The thread that watches the other process can't be started.
    #[error("start a thread: {error}")]
    Thread {
        /// Error of the operating system.
        error: io::Error,
    },
    /// The other process is gone.
    #[error("octant fmu host lost the process that it serves: {error}")]
    Lost {
        /// Error of the operating system.
        error: io::Error,
    },
}
