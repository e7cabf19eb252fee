//! Load of a serial line.

use super::{CRC_BYTES, HEADER_BYTES};
use crate::MessageKind;
use crate::message::{EndRole, PARAMETERS_SEGMENTS};
use crate::traffic::Traffic;

/// Bit rate and framing of a serial line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Baud {
    /// Bit rate, bit/s.
    pub rate: u32,
    /// Bits for each byte, with start, parity and stop bits: 10 for 8N1.
    pub bits_per_byte: u32,
}

/// Share of a line that traffic takes in each direction; 1 is all of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineLoad {
    /// Share of the harness's messages.
    pub from_harness: f64,
    /// Share of the other end's messages.
    pub to_harness: f64,
}

impl Baud {
    /// Line of a bit rate with one start bit, eight data bits and one stop bit.
    #[must_use]
    pub const fn new(rate: u32) -> Self {
        Self { rate, bits_per_byte: 10 }
    }

    /// Load of the traffic, with the longest frame of each kind.
    #[must_use]
    pub fn load(self, traffic: &Traffic) -> LineLoad {
        let way = |harness: bool| {
            let mut bits_per_s = 0.0;
            for (role, kind, rate_hz) in traffic.messages() {
                if (role == EndRole::Harness) == harness {
                    let frames =
                        if kind == MessageKind::Parameters { PARAMETERS_SEGMENTS } else { 1 };
                    let bits = frame_bytes(kind) * frames * self.bits_per_byte as usize;
                    bits_per_s += rate_hz * bits as f64;
                }
            }
            bits_per_s / f64::from(self.rate)
        };
        LineLoad { from_harness: way(true), to_harness: way(false) }
    }
}

/// Most bytes of a frame on the line.
const fn frame_bytes(kind: MessageKind) -> usize {
    2 + cobs::max_encoding_length(HEADER_BYTES + kind.payload_bytes() + CRC_BYTES)
}
