//! Reasons why a port can't be used.

/// Error of a port: it can't be opened, or went away.
#[derive(Debug, thiserror::Error)]
pub enum PortError {
    /// The port can't be opened.
    #[error("open {port}: {reason}")]
    Open {
        /// The port.
        port: String,
        /// Reason.
        reason: String,
    },
    /// The port was open and went away.
    #[error("{port} went away: {reason}")]
    Gone {
        /// The port.
        port: String,
        /// Reason.
        reason: String,
    },
}

impl PortError {
    pub(crate) fn open(port: impl ToString, reason: impl ToString) -> Self {
        Self::Open { port: port.to_string(), reason: reason.to_string() }
    }

    pub(crate) fn gone(port: impl ToString, reason: impl ToString) -> Self {
        Self::Gone { port: port.to_string(), reason: reason.to_string() }
    }
}

/// Reason why no CAN interface can be opened.
#[cfg(not(all(target_os = "linux", feature = "can")))]
pub(super) const WITHOUT_CAN: &str = if cfg!(target_os = "linux") {
    "this program was built without CAN interfaces, expected one built with its default features, \
     or with --features octant/can, or slcan: with an adapter on a serial line"
} else {
    "CAN interfaces are part of Linux alone; expected slcan: with an adapter on a serial line"
};
