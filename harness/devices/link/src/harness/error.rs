//! Reasons why a session can't begin or continue.

use crate::port::PortError;
use octant_base::failing::{Failing, FailureKind};
use octant_wire::Unreadable;
use octant_wire::message::{Bye, Reason, SessionRefusal};
use std::fmt;
use std::time::Duration;

/// Error of a session: it can't begin or continue.
#[derive(Debug, thiserror::Error)]
pub enum SessionError {
    /// The port failed.
    #[error(transparent)]
    Port(#[from] PortError),
    /// The awaited message didn't arrive.
    #[error(
        "{port}: no {waited_for} within {:.1} s, asked for {asked} times; {heard}",
        waited.as_secs_f64()
    )]
    NoAnswer {
        /// The port.
        port: String,
        /// Message waited for.
        waited_for: String,
        /// Time waited.
        waited: Duration,
        /// Number of times that it was asked for.
        asked: u32,
        /// Traffic received instead.
        heard: HeardTraffic,
    },
    /// The two ends are incompatible.
    #[error("{port}: {reason}")]
    Refused {
        /// The port.
        port: String,
        /// Reason.
        reason: SessionRefusal,
    },
    /// A name has a control character, which a terminal would execute and which doesn't belong in a
    /// file.
    #[error(
        "{port}: the device's {field} {found:?} has the control character {character:?}, expected text that can be printed"
    )]
    Control {
        /// The port.
        port: String,
        /// `name` or `firmware`.
        field: &'static str,
        /// Name found.
        found: String,
        /// First control character in it.
        character: char,
    },
    /// The other end speaks a newer version.
    #[error("{port}: {reason}")]
    Newer {
        /// The port.
        port: String,
        /// Versions of both ends, and the remedy.
        reason: octant_wire::Unreadable,
    },
    /// The device said bye.
    #[error("{port}: the device said bye while {during} was waited for: {}", Said(bye))]
    Bye {
        /// The port.
        port: String,
        /// Message waited for.
        during: String,
        /// The bye.
        bye: Bye,
    },
    /// The device has no session any more.
    #[error(
        "{port}: the device started anew in the middle of the session, or gave it up: what its core \
         knew is lost"
    )]
    StartedAnew {
        /// The port.
        port: String,
    },
    /// The device is another one than before it was without power.
    #[error(
        "{port}: {found:?} answers after the power was back, expected {expected:?} as before: another \
         firmware, or another device"
    )]
    OtherDevice {
        /// The port.
        port: String,
        /// Name and firmware found.
        found: String,
        /// Name and firmware before.
        expected: String,
    },
    /// The device lacks a capability that was asked for.
    #[error("{port}: the device doesn't do {what}")]
    Unsupported {
        /// The port.
        port: String,
        /// Capability.
        what: &'static str,
    },
}

impl Failing for SessionError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Refused { .. }
            | Self::Control { .. }
            | Self::Newer { .. }
            | Self::OtherDevice { .. }
            | Self::Unsupported { .. } => FailureKind::Input,
            Self::Port(_) | Self::NoAnswer { .. } | Self::Bye { .. } | Self::StartedAnew { .. } => {
                FailureKind::Bench
            }
        }
    }
}

/// Displays a bye.
struct Said<'a>(&'a Bye);

impl fmt::Display for Said<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.reason.name())?;
        match self.0.text.as_str() {
            "" => Ok(()),
            text => write!(f, " ({text})"),
        }
    }
}

/// Traffic received while something else was waited for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeardTraffic {
    /// Messages received.
    pub messages: u64,
    /// Bytes or frames that belong to no message.
    pub lost: u64,
    /// Damaged frames or messages.
    pub damaged: u64,
    /// Frames (CAN: segments) that never arrived.
    pub missing: u64,
    /// Number of intact messages that could not be read, and the reason for the last one.
    pub unreadable: Option<(u64, Unreadable)>,
    /// Datagrams without the seal of the port's secret, since the port was opened.
    pub unsealed: u64,
    /// Messages that the port did not take.
    pub not_sent: u64,
    /// The CAN controller is off the bus.
    pub off_bus: bool,
    /// Reason of a bye that came earlier.
    pub bye: Option<Reason>,
}

impl fmt::Display for HeardTraffic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { messages, lost, damaged, missing, unreadable, unsealed, not_sent, off_bus, bye } =
            *self;
        match (messages, lost + damaged) {
            (0, 0) if missing > 0 || unreadable.is_some() || unsealed > 0 => {
                f.write_str("no message was received")?;
            }
            (0, 0) => f.write_str("nothing at all was received")?,
            (0, _) => write!(
                f,
                "no message was received, but {lost} bytes or frames that are none ({damaged} \
                 damaged): is it the right rate, and is it our protocol?"
            )?,
            (_, 0) => write!(f, "{messages} other messages were received")?,
            _ => write!(
                f,
                "{messages} other messages were received, and {lost} bytes or frames that are none"
            )?,
        }
        match unreadable {
            Some((1, reason)) => write!(f, "; one intact message could not be read: {reason}")?,
            Some((count, reason)) => {
                write!(f, "; {count} intact messages could not be read, the last: {reason}")?;
            }
            None => {}
        }
        if missing > 0 {
            write!(f, "; {missing} frames or segments never arrived")?;
        }
        if unsealed > 0 {
            write!(
                f,
                "; {unsealed} datagrams without the seal of the secret were dropped: do both ends have the same one?"
            )?;
        }
        if not_sent > 0 {
            write!(f, "; {not_sent} messages were not taken by the port")?;
        }
        if off_bus {
            f.write_str("; the controller is off the bus")?;
        }
        match bye {
            Some(reason) => write!(f, "; a bye came before: {}", reason.name()),
            None => Ok(()),
        }
    }
}
