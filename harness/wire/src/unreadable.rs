//! Why an intact payload is no message.

use crate::{Kind, TextError, VERSION};

/// Why bytes that arrived undamaged are no message of this version.
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
    /// No message has this code.
    #[error("a message has code {code}, known are 1 to {}", Kind::ALL.len())]
    Code {
        /// The code found.
        code: u8,
    },
    /// The payload has another length than its kind.
    #[error("a message {} has {found} bytes, expected are {}", kind.name(), kind.payload_bytes())]
    Length {
        /// Kind of message.
        kind: Kind,
        /// Bytes found.
        found: usize,
    },
    /// A field has a value without meaning.
    #[error("a message {} has {field} {found}, expected is {expected}", kind.name())]
    Value {
        /// Kind of message.
        kind: Kind,
        /// Name of the field.
        field: &'static str,
        /// Value found.
        found: u32,
        /// What has a meaning.
        expected: &'static str,
    },
    /// A text is none.
    #[error("a message {} has a {field} that is no text: {reason}", kind.name())]
    Text {
        /// Kind of message.
        kind: Kind,
        /// Name of the field.
        field: &'static str,
        /// What is wrong with it.
        reason: TextError,
    },
}
