//! Decoding of messages from bytes, whatever arrives.

use super::{CRC_BYTES, HEADER_BYTES, MAX_STUFFED_BYTES};
use crate::checksum::crc32;
use crate::message::ClockTime;
use crate::{Message, MessageKind, Unreadable};

/// Position of a frame in the sequence of frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameOrder {
    /// First frame, or a hello, at which the numbering begins again.
    First,
    /// Frame after the last one.
    Next,
    /// Frame after a gap of this number of frames.
    Missing(u16),
    /// Frame behind the next expected one by this number: repeated or too late.
    Behind(u16),
}

/// A message received.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Received {
    /// Sequence number of its frame.
    pub sequence: u16,
    /// Position in the sequence.
    pub order: FrameOrder,
    /// Sender's clock when it made the frame.
    pub clock: ClockTime,
    /// The message.
    pub message: Message,
}

/// Reason why bytes are no message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FrameDefect {
    /// Longer than any frame, without a zero.
    #[error("there is no frame so long")]
    Long,
    /// Stuffing contradicts itself, or there are fewer bytes than any frame has.
    #[error("this is no frame, or a piece of one")]
    Malformed,
    /// The CRC is wrong.
    #[error("the frame is damaged: CRC-32 {found:#010x}, computed {computed:#010x}")]
    Checksum {
        /// CRC in the frame.
        found: u32,
        /// CRC of the frame.
        computed: u32,
    },
    /// The frame is intact, but can't be decoded.
    #[error(transparent)]
    Unreadable(Unreadable),
}

/// Bytes that are no message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SkippedBytes {
    /// Reason.
    pub cause: FrameDefect,
    /// Number of bytes, without the zeros around them.
    pub bytes: u64,
}

/// Result for the bytes between two zeros.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "the large variant is the one that comes")]
pub enum DecodeEvent {
    /// A message.
    Received(Received),
    /// No message.
    Lost(SkippedBytes),
}

/// Counts of the traffic so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SerialCounters {
    /// All bytes.
    pub bytes: u64,
    /// Intact frames.
    pub frames: u64,
    /// Bytes that belong to no intact frame, without the zeros.
    pub bytes_lost: u64,
    /// Stretches longer than any frame.
    pub long: u64,
    /// Stretches that are no frame or only a part of one.
    pub malformed: u64,
    /// Frames with a wrong CRC.
    pub checksum: u64,
    /// Intact frames that are no message of this version.
    pub unreadable: u64,
    /// Missing frames, from gaps in the sequence numbers.
    pub missing: u64,
    /// Frames repeated or too late.
    pub behind: u64,
}

impl SerialCounters {
    /// Number of stretches that were no intact frame.
    #[must_use]
    pub fn damaged(&self) -> u64 {
        self.long + self.malformed + self.checksum
    }

    /// True if nothing was lost, damaged, missing, repeated or unreadable.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        *self == Self { bytes: self.bytes, frames: self.frames, ..Self::default() }
    }
}

/// Finds messages in bytes as they arrive, in pieces of any length.
#[derive(Clone, Debug)]
pub struct SerialDecoder {
    /// Bytes since the last zero, up to the length of the longest frame.
    held: [u8; MAX_STUFFED_BYTES],
    /// Number of bytes since the last zero.
    length: u64,
    /// Expected sequence number of the next frame.
    expected: Option<u16>,
    counters: SerialCounters,
}

impl Default for SerialDecoder {
    fn default() -> Self {
        Self::new()
    }
}

impl SerialDecoder {
    /// Makes a decoder that has received nothing.
    #[must_use]
    pub fn new() -> Self {
        Self {
            held: [0; MAX_STUFFED_BYTES],
            length: 0,
            expected: None,
            counters: SerialCounters::default(),
        }
    }

    /// Takes bytes up to the end of the next nonempty stretch, and returns its result. Returns `None`
    /// when all bytes are taken: call it until then.
    #[inline]
    pub fn next(&mut self, bytes: &mut &[u8]) -> Option<DecodeEvent> {
        while let Some(zero) = bytes.iter().position(|byte| *byte == 0) {
            let (stretch, rest) = bytes.split_at(zero);
            *bytes = &rest[1..];
            self.counters.bytes += 1;
            if !stretch.is_empty() {
                self.hold(stretch);
            }
            if self.length > 0 {
                return Some(self.conclude());
            }
        }
        self.hold(bytes);
        *bytes = &[];
        None
    }

    /// Ends the input, at the end of a datagram or at a cut of the line: the bytes since the last zero
    /// are concluded as if a zero followed.
    pub fn end(&mut self) -> Option<DecodeEvent> {
        (self.length > 0).then(|| self.conclude())
    }

    /// Counts of the traffic so far.
    #[must_use]
    pub fn counters(&self) -> &SerialCounters {
        &self.counters
    }

    fn hold(&mut self, bytes: &[u8]) {
        let all = bytes.len() as u64;
        self.counters.bytes += all;
        let before = self.length;
        self.length += all;
        let room = MAX_STUFFED_BYTES as u64;
        if self.length <= room {
            let at = before as usize;
            self.held[at..at + bytes.len()].copy_from_slice(bytes);
        } else {
            // The bytes are counted as they arrive, so that a line that babbles without a zero doesn't
            // look silent.
            self.counters.bytes_lost += if before <= room { self.length } else { all };
        }
    }

    fn conclude(&mut self) -> DecodeEvent {
        let bytes = core::mem::take(&mut self.length);
        match self.read(bytes) {
            Ok(received) => DecodeEvent::Received(received),
            Err(cause) => {
                let counters = &mut self.counters;
                match cause {
                    // Bytes of a stretch that is too long are already counted.
                    FrameDefect::Long => counters.long += 1,
                    FrameDefect::Malformed => counters.malformed += 1,
                    FrameDefect::Checksum { .. } => counters.checksum += 1,
                    FrameDefect::Unreadable(_) => counters.unreadable += 1,
                }
                if matches!(cause, FrameDefect::Malformed | FrameDefect::Checksum { .. }) {
                    counters.bytes_lost += bytes;
                }
                DecodeEvent::Lost(SkippedBytes { cause, bytes })
            }
        }
    }

    fn read(&mut self, bytes: u64) -> Result<Received, FrameDefect> {
        let Some(stretch) = usize::try_from(bytes).ok().and_then(|n| self.held.get_mut(..n)) else {
            return Err(FrameDefect::Long);
        };
        let length = cobs::decode_in_place(stretch).map_err(|_| FrameDefect::Malformed)?;
        let (bare, crc) =
            stretch[..length].split_last_chunk::<CRC_BYTES>().ok_or(FrameDefect::Malformed)?;
        let (header, payload) =
            bare.split_first_chunk::<HEADER_BYTES>().ok_or(FrameDefect::Malformed)?;
        let (found, computed) = (u32::from_le_bytes(*crc), crc32(bare));
        if found != computed {
            return Err(FrameDefect::Checksum { found, computed });
        }
        let [code, s0, s1, clock @ ..] = *header;
        let sequence = u16::from_le_bytes([s0, s1]);
        let kind = MessageKind::of(code);
        let message = kind
            .ok_or(Unreadable::Code { code })
            .and_then(|kind| Message::read(kind, payload))
            .map_err(FrameDefect::Unreadable);
        self.counters.frames += 1;
        let order = self.order(sequence, kind == Some(MessageKind::Hello));
        let clock = ClockTime { ns: u64::from_le_bytes(clock) };
        Ok(Received { sequence, order, clock, message: message? })
    }

    fn order(&mut self, sequence: u16, anew: bool) -> FrameOrder {
        let next = Some(sequence.wrapping_add(1));
        let Some(expected) = self.expected.filter(|_| !anew) else {
            self.expected = next;
            return FrameOrder::First;
        };
        let gap = sequence.wrapping_sub(expected);
        if gap < 1 << 15 {
            self.expected = next;
            self.counters.missing += u64::from(gap);
            if gap == 0 { FrameOrder::Next } else { FrameOrder::Missing(gap) }
        } else {
            self.counters.behind += 1;
            // A repetition of the last frame is one behind.
            FrameOrder::Behind(gap.wrapping_neg())
        }
    }
}
