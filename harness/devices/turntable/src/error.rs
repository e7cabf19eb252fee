//! Errors of a table.

use crate::TableAxis;
use octant_base::address::AddressError;
use octant_base::failing::{Failing, FailureKind};
use std::time::Duration;

/// Error of a table.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The text is no port.
    #[error(transparent)]
    Address(AddressError),
    /// A port can't be opened.
    #[error("open {port}: {reason}")]
    Open {
        /// The port, with every default.
        port: String,
        /// Reason.
        reason: String,
    },
    /// A simulated table can't listen.
    #[error("listen at {port}: {reason}")]
    Listen {
        /// Address.
        port: String,
        /// Reason.
        reason: String,
    },
    /// The port is gone.
    #[error("{port} went away: {reason}")]
    Gone {
        /// The port.
        port: String,
        /// Reason.
        reason: std::io::Error,
    },
    /// No reply came.
    #[error("{port}: no reply to `{sent}` within {within:?}")]
    Silent {
        /// The port.
        port: String,
        /// Line sent.
        sent: String,
        /// Time waited.
        within: Duration,
    },
    /// The table doesn't come to rest.
    #[error("{port}: the table still moves after {within:?}")]
    Moving {
        /// The port.
        port: String,
        /// Time waited.
        within: Duration,
    },
    /// An axis didn't reach its target.
    #[error("{axis} is at rest at {found:.4}°, expected {expected:.4}° within {tolerance:.4}°")]
    Elsewhere {
        /// The axis.
        axis: TableAxis,
        /// Angle found, degrees.
        found: f64,
        /// Target, degrees.
        expected: f64,
        /// Tolerance, degrees.
        tolerance: f64,
    },
    /// An axis has no reference.
    #[error("{axis} is at rest after homing without a reference")]
    NotHomed {
        /// The axis.
        axis: TableAxis,
    },
    /// A reply doesn't match its command.
    #[error("{port}: found the reply `{reply}` to `{sent}`, expected `{expected}`")]
    Nonsense {
        /// The port.
        port: String,
        /// Line sent.
        sent: String,
        /// Reply received.
        reply: String,
        /// Pattern of a reply.
        expected: String,
    },
    /// The controller refused a command.
    #[error("{port}: the controller refused `{sent}` with `{reply}`")]
    Refused {
        /// The port.
        port: String,
        /// Line sent.
        sent: String,
        /// Reply received.
        reply: String,
    },
    /// The limits are invalid.
    #[error(
        "the limits of {axis} can't be kept: expected a least angle below the greatest, a rate and an \
         acceleration above zero"
    )]
    Limits {
        /// The axis.
        axis: TableAxis,
    },
    /// An angle is beyond the soft limits.
    #[error("{axis} {degrees:.4}° is beyond its limits, {least}° to {most}°")]
    Angle {
        /// The axis.
        axis: TableAxis,
        /// Angle, degrees.
        degrees: f64,
        /// Least angle, degrees.
        least: f64,
        /// Greatest angle, degrees.
        most: f64,
    },
    /// A rate is above its limit.
    #[error("{axis} at {found:.4} °/s is faster than its limit, {most} °/s")]
    Rate {
        /// The axis.
        axis: TableAxis,
        /// Rate, °/s.
        found: f64,
        /// Largest rate, °/s.
        most: f64,
    },
    /// The controller reports a fault of an axis.
    #[error("the controller reports fault {fault:#x} of {axis}")]
    Fault {
        /// The axis.
        axis: TableAxis,
        /// The fault word.
        fault: u32,
    },
    /// The emergency stop was tripped.
    #[error("the table was stopped: {why}")]
    Stopped {
        /// Reason for the stop.
        why: String,
    },
    /// The language lacks a command.
    #[error("the command language `{dialect}` has no {what}")]
    Lacking {
        /// Name of the dialect.
        dialect: String,
        /// Command that it lacks.
        what: &'static str,
    },
    /// A table of patterns is invalid.
    #[error("{place}: {what}")]
    Dialect {
        /// File, with line or key.
        place: String,
        /// Error, with the expected form.
        what: String,
    },
    /// The stop button can't be offered, or doesn't answer.
    #[error("the stop button of {port}: {reason}")]
    Button {
        /// Port of the table.
        port: String,
        /// Reason.
        reason: String,
    },
    /// Other runs at the table didn't come.
    #[error(
        "{port}: {found} of the {expected} runs of turntable.drive.units came within {within:?}"
    )]
    Alone {
        /// Port of the table.
        port: String,
        /// Number of runs that are there, the driving one among them.
        found: usize,
        /// Number of runs expected.
        expected: usize,
        /// Time waited.
        within: Duration,
    },
    /// The program was interrupted before everybody was there.
    #[error("interrupted while it waited for another run at the table")]
    Interrupted,
    /// Another run at the table doesn't end.
    #[error("another run at the table still goes on {within:?} after the one that drives it")]
    Unended {
        /// Time waited.
        within: Duration,
    },
    /// The table that another run drives can't be used.
    #[error("the table {port}, which another run drives: {reason}")]
    Shared {
        /// Port of the table.
        port: String,
        /// Reason.
        reason: String,
    },
    /// The guard can't be started, or is gone.
    #[error("the guard of the table: {reason}")]
    Guard {
        /// Reason.
        reason: String,
    },
}

impl Failing for Error {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Dialect { .. } | Self::Address(_) => FailureKind::Input,
            Self::Open { .. }
            | Self::Listen { .. }
            | Self::Gone { .. }
            | Self::Silent { .. }
            | Self::Moving { .. }
            | Self::Elsewhere { .. }
            | Self::NotHomed { .. }
            | Self::Nonsense { .. }
            | Self::Refused { .. }
            | Self::Limits { .. }
            | Self::Angle { .. }
            | Self::Rate { .. }
            | Self::Fault { .. }
            | Self::Stopped { .. }
            | Self::Lacking { .. }
            | Self::Button { .. }
            | Self::Alone { .. }
            | Self::Interrupted
            | Self::Unended { .. }
            | Self::Shared { .. }
            | Self::Guard { .. } => FailureKind::Bench,
        }
    }
}

impl Error {
    /// Kind of a failure of a move by hand: what was asked for may be beyond the limits.
    #[must_use]
    pub fn kind_by_hand(&self) -> FailureKind {
        match self {
            Self::Angle { .. }
            | Self::Rate { .. }
            | Self::Lacking { .. }
            | Self::Dialect { .. }
            | Self::Address(_) => FailureKind::Input,
            Self::Open { .. }
            | Self::Listen { .. }
            | Self::Gone { .. }
            | Self::Silent { .. }
            | Self::Moving { .. }
            | Self::Elsewhere { .. }
            | Self::NotHomed { .. }
            | Self::Nonsense { .. }
            | Self::Refused { .. }
            | Self::Limits { .. }
            | Self::Fault { .. }
            | Self::Stopped { .. }
            | Self::Button { .. }
            | Self::Alone { .. }
            | Self::Interrupted
            | Self::Unended { .. }
            | Self::Shared { .. }
            | Self::Guard { .. } => FailureKind::Bench,
        }
    }
}
