//! Frames on a line of bytes: serial ports and UDP.
//!
//! A frame is `kind u8, sequence u16, clock u64, payload, CRC-32`, stuffed (COBS) so that no byte of
//! it is zero, with a zero before and after. A receiver finds the next frame at the next zero, whatever
//! came before: damage costs only the frames that it touches.

mod decoder;
mod encoder;
mod load;

pub use decoder::{
    DecodeEvent, FrameDefect, FrameOrder, Received, SerialCounters, SerialDecoder, SkippedBytes,
};
pub use encoder::SerialEncoder;
pub use load::{Baud, LineLoad};

use crate::message::MAX_PAYLOAD_BYTES;

/// Number of bytes before the payload: kind, sequence, clock.
pub const HEADER_BYTES: usize = 1 + 2 + 8;
/// Number of bytes after the payload.
pub const CRC_BYTES: usize = 4;
/// Most bytes of a frame before stuffing.
pub const MAX_BARE_BYTES: usize = HEADER_BYTES + MAX_PAYLOAD_BYTES + CRC_BYTES;
/// Most bytes of a stuffed frame, without the zeros around it.
pub const MAX_STUFFED_BYTES: usize = cobs::max_encoding_length(MAX_BARE_BYTES);
/// Most bytes of a frame on the line.
pub const MAX_FRAME_BYTES: usize = MAX_STUFFED_BYTES + 2;
