//! Frames on a CAN bus, FD or classic.
//!
//! A message becomes an image: the first four bytes of its payload, CRC-32, the rest of the payload. The
//! image is cut into segments of 8 bytes (classic) or 64 (FD), each sent under an identifier of its own:
//! so every signal has one place in one frame, and `fixtures/can/octant.dbc` names it. A receiver takes
//! segments in order; it drops, counts and reports those that don't fit together.

mod dbc;
mod frame;
mod load;
mod reassembler;
mod segments;
mod slot;
#[cfg(feature = "state")]
mod state;

pub use dbc::write as write_dbc;
pub use frame::{BusFrame, CanVersion};
pub use load::{Bits, Bus, BusLoad, Overload, classic_bits, fd_bits};
pub use reassembler::{CanTraffic, DropCause, DroppedMessage, Reassembler, ReassemblyEvent};
pub use segments::{NotSent, Segments, segments};
pub use slot::Slot;

use crate::message::MAX_PAYLOAD_BYTES;

/// Bytes of the longest image.
pub const MAX_IMAGE_BYTES: usize = MAX_PAYLOAD_BYTES + 4;
