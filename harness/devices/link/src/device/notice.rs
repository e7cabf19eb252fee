//! Events that a device reports to its operator.

use octant_wire::Text;
use octant_wire::message::{DeviceStatus, StepPacing};
use std::fmt;

/// Event that a device reports to its operator.
#[derive(Clone, Debug, PartialEq)]
pub enum Notice {
    /// The device listens under this name.
    Listening(String),
    /// A session began.
    Began {
        /// Name of the harness.
        name: Text<24>,
        /// Firmware of the harness.
        firmware: Text<24>,
        /// Pacing of the steps.
        pacing: StepPacing,
    },
    /// A harness was refused, for this reason.
    Refused(String),
    /// A session ended.
    Over {
        /// Reason.
        why: String,
        /// Status of the session at its end.
        status: DeviceStatus,
    },
    /// The port went away, for this reason; the device opens it again when it is back.
    PortGone(String),
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Listening(name) => write!(f, "listening on {name}"),
            Self::Began { name, firmware, pacing } => {
                write!(f, "a session in {} began with {name} ({firmware})", pacing.name())
            }
            Self::Refused(why) => write!(f, "a harness was turned away: {why}"),
            Self::Over { why, status } => {
                write!(
                    f,
                    "the session is over: {why}; {} steps, {} repeated, {} skipped, {} damaged",
                    status.steps, status.repeated, status.skipped, status.damaged
                )
            }
            Self::PortGone(why) => write!(f, "{why}; waiting for it"),
        }
    }
}
