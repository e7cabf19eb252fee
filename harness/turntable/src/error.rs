//! What can go wrong with a table.

use crate::Axis;
use std::time::Duration;

/// What went wrong.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A port can't be opened.
    #[error("open {port}: {reason}, expected is tcp:HOST:PORT or serial:DEVICE?baud=RATE")]
    Open {
        /// The port as it was given.
        port: String,
        /// Why.
        reason: String,
    },
    /// A simulated table can't listen.
    #[error("listen at {port}: {reason}, expected is tcp:HOST:PORT or pty:LINK")]
    Listen {
        /// Where.
        port: String,
        /// Why.
        reason: String,
    },
    /// The port is gone.
    #[error("{port} went away: {reason}")]
    Gone {
        /// The port.
        port: String,
        /// What happened.
        reason: std::io::Error,
    },
    /// No reply came.
    #[error("{port}: no reply to `{sent}` within {within:?}")]
    Silent {
        /// The port.
        port: String,
        /// What was sent.
        sent: String,
        /// How long it was waited for.
        within: Duration,
    },
    /// It doesn't come to rest.
    #[error("{port}: the table still moves after {within:?}")]
    Moving {
        /// The port.
        port: String,
        /// How long it was waited for.
        within: Duration,
    },
    /// An axis didn't arrive.
    #[error("{axis} rests at {found:.4}°, expected is {expected:.4}° within {tolerance:.4}°")]
    Elsewhere {
        /// The axis.
        axis: Axis,
        /// Where it is.
        found: f64,
        /// Where it was sent.
        expected: f64,
        /// How far it may be from there.
        tolerance: f64,
    },
    /// An axis has no reference.
    #[error("{axis} was told to find its reference, rests, and has none")]
    NotHomed {
        /// The axis.
        axis: Axis,
    },
    /// A reply that its command has not.
    #[error("{port}: `{reply}` is no reply to `{sent}`, expected is `{expected}`")]
    Nonsense {
        /// The port.
        port: String,
        /// What was sent.
        sent: String,
        /// What came.
        reply: String,
        /// Pattern of a reply.
        expected: String,
    },
    /// The controller doesn't do it.
    #[error("{port}: the controller refused `{sent}` with `{reply}`")]
    Refused {
        /// The port.
        port: String,
        /// What was sent.
        sent: String,
        /// What came.
        reply: String,
    },
    /// The limits are none.
    #[error(
        "the limits of {axis} can't be kept: expected is a least angle below the greatest, a rate and \
         an acceleration above zero"
    )]
    Limits {
        /// The axis.
        axis: Axis,
    },
    /// Beyond the soft limits.
    #[error("{axis} {degrees:.4}° is beyond its limits, {least}° to {most}°")]
    Angle {
        /// The axis.
        axis: Axis,
        /// The angle.
        degrees: f64,
        /// Least angle.
        least: f64,
        /// Greatest angle.
        most: f64,
    },
    /// Too fast.
    #[error("{axis} at {found:.4} °/s is faster than its limit, {most} °/s")]
    Rate {
        /// The axis.
        axis: Axis,
        /// The rate.
        found: f64,
        /// The largest.
        most: f64,
    },
    /// The axis has a fault.
    #[error("the controller reports fault {fault:#x} of {axis}")]
    Fault {
        /// The axis.
        axis: Axis,
        /// The fault word.
        fault: u32,
    },
    /// The emergency stop was tripped.
    #[error("the table was stopped: {why}")]
    Stopped {
        /// Why it was tripped.
        why: String,
    },
    /// The language has no such command.
    #[error("the command language `{dialect}` has no {what}")]
    Lacking {
        /// Name of the dialect.
        dialect: String,
        /// What it lacks.
        what: &'static str,
    },
    /// A table of patterns that is none.
    #[error("{place}: {what}")]
    Dialect {
        /// File, with line or key.
        place: String,
        /// What is wrong, and what was expected.
        what: String,
    },
    /// The stop for other programs can't be offered, or doesn't answer.
    #[error("the stop of {port} for other programs: {reason}")]
    Button {
        /// Port of the table.
        port: String,
        /// Why.
        reason: String,
    },
    /// The guard can't be started, or is gone.
    #[error("the guard of the table: {reason}")]
    Guard {
        /// Why.
        reason: String,
    },
}
