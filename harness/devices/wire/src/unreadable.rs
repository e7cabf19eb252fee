//! Reasons why an intact payload is no message.

use crate::{MessageKind, TextError, VERSION};

/// Reason why undamaged bytes are no message of this version.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unreadable {
    /// The peer speaks a newer version than this one.
    #[error(
        "the peer speaks version {found} of the wire protocol, this program version {VERSION}: \
         update this program, or give the peer a firmware of version {VERSION}"
    )]
    NewerVersion {
        /// Version in the peer's hello.
        found: u16,
    },
    /// The code is unknown.
    #[error("a message has code {code}, known are 1 to {}", MessageKind::ALL.len())]
    Code {
        /// Code found.
        code: u8,
    },
    /// The payload has another length than its kind requires.
    #[error("a message {} has {found} bytes, expected are {}", kind.name(), kind.payload_bytes())]
    Length {
        /// Kind of message.
        kind: MessageKind,
        /// Bytes found.
        found: usize,
    },
    /// A field has an invalid value.
    #[error("a message {} has {field} {found}, expected is {expected}", kind.name())]
    Value {
        /// Kind of message.
        kind: MessageKind,
        /// Name of the field.
        field: &'static str,
        /// Value found.
        found: u32,
        /// Valid values.
        expected: &'static str,
    },
    /// A text is invalid.
    #[error("a message {} has a {field} that is no text: {reason}", kind.name())]
    Text {
        /// Kind of message.
        kind: MessageKind,
        /// Name of the field.
        field: &'static str,
        /// Reason.
        reason: TextError,
    },
}
