//! Wire protocol between the harness and a device: samples, aiding and outputs as bytes.
//!
//! One set of messages ([`message`]), each a payload of fixed length ([`layout`]), in two encodings:
//! frames with CRC-32 on a line of bytes, for serial ports and UDP ([`serial`]), and CAN frames, FD or
//! classic ([`can`]). `README.md` beside this crate describes them byte by byte.
//!
//! [`requests`] keeps the steps of a device in order, and [`traffic`] gives the rates from which the
//! load of a line or bus is computed.
//!
//! Nothing in this crate allocates, waits or depends on a device: it turns bytes into messages and
//! messages into bytes. A receiver counts and reports everything that it can't use.
#![no_std]

pub mod can;
pub mod layout;
pub mod message;
pub mod requests;
pub mod serial;
pub mod traffic;

mod bytes;
mod checksum;
mod text;
mod unreadable;

pub use message::{EndRole, Message, MessageKind, StepNumber};
pub use text::{Text, TextError};
pub use unreadable::Unreadable;

/// Version of the protocol in this crate.
pub const VERSION: u16 = 1;
