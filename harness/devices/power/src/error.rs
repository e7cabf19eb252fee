//! Errors of a supply or a relay.

use octant_base::address::AddressError;
use octant_base::failing::{Failing, FailureKind};
use std::time::Duration;

/// Error of a supply or a relay.
#[derive(Debug, thiserror::Error)]
pub enum PowerError {
    /// The text is no port.
    #[error(transparent)]
    Address(AddressError),
    /// The port can't be opened.
    #[error("open {port}: {reason}")]
    Open {
        /// The port, with every default.
        port: String,
        /// Reason.
        reason: String,
    },
    /// The port went away.
    #[error("{port} went away: {reason}")]
    Gone {
        /// The port.
        port: String,
        /// Reason.
        reason: String,
    },
    /// No reply came.
    #[error("{port}: no reply to `{sent}` within {:.1} s", within.as_secs_f64())]
    Silent {
        /// The port.
        port: String,
        /// Query sent.
        sent: String,
        /// Time waited.
        within: Duration,
    },
    /// A reply isn't what the query asks for.
    #[error("{port}: found the reply `{reply}` to `{sent}`, expected {expected}")]
    Nonsense {
        /// The port.
        port: String,
        /// Query sent.
        sent: String,
        /// Reply received.
        reply: String,
        /// Form of a reply.
        expected: &'static str,
    },
    /// The instrument reports an error.
    #[error("{port}: the instrument refuses `{sent}` with {words}")]
    Refused {
        /// The port.
        port: String,
        /// Command or query sent.
        sent: String,
        /// Entries of the error queue, in the words of the instrument.
        words: String,
    },
    /// The output isn't in the state to which it was switched.
    #[error("{port}: the output is {found} after `{sent}`, expected {expected}")]
    State {
        /// The port.
        port: String,
        /// Command sent.
        sent: String,
        /// State found.
        found: &'static str,
        /// State expected.
        expected: &'static str,
    },
    /// The measured voltage didn't come to its value.
    #[error(
        "{port}: {found_v:.3} V measured {:.1} s after `{sent}`, expected {expected}",
        within.as_secs_f64()
    )]
    Voltage {
        /// The port.
        port: String,
        /// Command sent.
        sent: String,
        /// Voltage found, V.
        found_v: f64,
        /// Description of the voltages expected.
        expected: String,
        /// Time waited.
        within: Duration,
    },
    /// A relay has no voltage.
    #[error("{port}: a relay switches and has no voltage to set, expected a channel of a supply")]
    Relay {
        /// The port.
        port: String,
    },
    /// An interrupt came.
    #[error("interrupted while the power was being switched")]
    Interrupted,
}

impl Failing for PowerError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Address { .. } | Self::Relay { .. } => FailureKind::Input,
            Self::Open { .. }
            | Self::Gone { .. }
            | Self::Silent { .. }
            | Self::Nonsense { .. }
            | Self::Refused { .. }
            | Self::State { .. }
            | Self::Voltage { .. }
            | Self::Interrupted => FailureKind::Bench,
        }
    }
}
