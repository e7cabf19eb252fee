//! Samples, aiding and outputs as bytes: what crosses between the harness and a device.
//!
//! One set of messages ([`message`]), each a payload of fixed length ([`layout`]), in two encodings:
//! frames with CRC-32 on a line of bytes, for serial ports and UDP ([`serial`]), and CAN frames, FD or
//! classic ([`can`]). `README.md` beside this crate describes them byte by byte.
//!
//! [`requests`] keeps the steps of a device in order, and [`traffic`] is what the load of a line or bus is
//! computed from.
//!
//! Nothing here allocates, waits or knows a device: bytes go in, messages come out, and the other
//! way round. What a receiver could not use it counts and reports.
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

pub use message::{Kind, Message, Role, Step};
pub use text::{Text, TextError};
pub use unreadable::Unreadable;

/// Version of the protocol that this crate speaks.
pub const VERSION: u16 = 1;
