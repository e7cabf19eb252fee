//! Encoding of messages as frames.

use super::{HEADER_BYTES, MAX_BARE_BYTES, MAX_FRAME_BYTES};
use crate::Message;
use crate::checksum::crc32;
use crate::message::{ClockTime, MAX_PAYLOAD_BYTES};

/// Encodes and numbers frames.
#[derive(Clone, Debug)]
pub struct SerialEncoder {
    sequence: u16,
    frame: [u8; MAX_FRAME_BYTES],
}

impl Default for SerialEncoder {
    fn default() -> Self {
        Self::new()
    }
}

impl SerialEncoder {
    /// Makes an encoder whose first frame has sequence number 0.
    #[must_use]
    pub fn new() -> Self {
        Self::starting_at(0)
    }

    /// Makes an encoder whose first frame has this sequence number.
    #[must_use]
    pub fn starting_at(sequence: u16) -> Self {
        Self { sequence, frame: [0; MAX_FRAME_BYTES] }
    }

    /// Sequence number of the next frame.
    #[must_use]
    pub fn sequence(&self) -> u16 {
        self.sequence
    }

    /// Encodes a message as a frame with the zeros around it; `clock` is the sender's present time.
    pub fn encode(&mut self, message: &Message, clock: ClockTime) -> &[u8] {
        let kind = message.kind();
        let mut bare = [0; MAX_BARE_BYTES];
        bare[0] = kind.code();
        bare[1..3].copy_from_slice(&self.sequence.to_le_bytes());
        bare[3..HEADER_BYTES].copy_from_slice(&clock.ns.to_le_bytes());
        if let Some((_, rest)) = bare.split_first_chunk_mut::<HEADER_BYTES>()
            && let Some(payload) = rest.first_chunk_mut::<MAX_PAYLOAD_BYTES>()
        {
            message.write(payload);
        }
        let end = HEADER_BYTES + kind.payload_bytes();
        let crc = crc32(&bare[..end]);
        bare[end..end + 4].copy_from_slice(&crc.to_le_bytes());
        self.sequence = self.sequence.wrapping_add(1);
        // The buffer has room for the longest frame.
        let stuffed = cobs::encode(&bare[..end + 4], &mut self.frame[1..]);
        self.frame[0] = 0;
        self.frame[stuffed + 1] = 0;
        &self.frame[..stuffed + 2]
    }
}
