//! Reassembly of messages from CAN frames, whatever arrives.
//!
//! Each slot is reassembled separately, because a frame of higher priority may come between two
//! segments. Segments of a slot have to come in order: one that doesn't follow ends the message begun.
//! The CRC detects segments of two different messages.

use super::segments::checksum;
use super::{BusFrame, CanVersion, Slot};
use crate::message::{EndRole, MAX_PAYLOAD_BYTES, Message, MessageKind};
use crate::{Unreadable, VERSION};

/// Cause of a dropped message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DropCause {
    /// Number of missing segments.
    #[error("{0} segments are missing")]
    Missing(u8),
    /// A segment came after a later one.
    #[error("a segment came after a later one")]
    Disordered,
    /// The next message began before this one ended.
    #[error("the next message began before the end of this one")]
    Incomplete,
    /// Segments of different messages were combined, or one is damaged.
    #[error("the segments are not of one message: CRC-32 {found:#010x}, computed {computed:#010x}")]
    Mixed {
        /// CRC in the first segment.
        found: u32,
        /// CRC of the payload.
        computed: u32,
    },
    /// A frame has another length than its segment, or something else than zeros after the message.
    #[error("the frame has {found} bytes, expected are {expected} with zeros behind the message")]
    Malformed {
        /// Bytes of the frame.
        found: u8,
        /// Bytes of the segment.
        expected: u8,
    },
    /// The message is intact, but can't be decoded.
    #[error(transparent)]
    Unreadable(Unreadable),
}

/// A message that was dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DroppedMessage {
    /// Sender and kind of the message.
    pub slot: Slot,
    /// Cause.
    pub cause: DropCause,
}

/// Fate of a message.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "the large variant is the one that comes")]
pub enum ReassemblyEvent {
    /// The message is complete.
    Received {
        /// Sender.
        sender: EndRole,
        /// The message.
        message: Message,
    },
    /// The message was dropped.
    Lost(DroppedMessage),
}

/// Counts of the traffic so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CanTraffic {
    /// All frames.
    pub frames: u64,
    /// Frames not addressed to this end: other identifiers, the other format, other senders.
    pub foreign: u64,
    /// Messages received.
    pub messages: u64,
    /// Segments that came twice in a row: the second one is dropped, without loss.
    pub duplicated: u64,
    /// Segments that are missing, as far as a later one shows.
    pub missing: u64,
    /// Segments that came after a later one.
    pub disordered: u64,
    /// Segments of a message that was already dropped.
    pub orphaned: u64,
    /// Messages dropped because the next one began.
    pub incomplete: u64,
    /// Messages with a wrong CRC.
    pub mixed: u64,
    /// Frames with a wrong length, or with something else than zeros after their message.
    pub malformed: u64,
    /// Intact messages that this version doesn't know.
    pub unreadable: u64,
}

impl CanTraffic {
    /// True if nothing was lost, damaged or repeated. Foreign frames are allowed.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        let Self { frames, foreign, messages, .. } = *self;
        *self == Self { frames, foreign, messages, ..Self::default() }
    }

    /// Number of messages that were not reassembled as they were sent.
    #[must_use]
    pub fn damaged(&self) -> u64 {
        self.incomplete + self.mixed + self.malformed
    }
}

/// Progress of the message of a slot.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Progress {
    /// Number of segments held, from the first on.
    pub(super) held: usize,
    /// True if the message is given up: the next first segment begins another.
    pub(super) dropped: bool,
}

impl Progress {
    const DROPPED: Self = Self { held: 0, dropped: true };
}

/// Reassembles messages from frames as they arrive.
#[derive(Clone, Debug)]
pub struct Reassembler {
    /// Senders that are listened to; a bit for each role.
    senders: u8,
    pub(super) format: CanVersion,
    pub(super) progress: [Progress; Slot::ALL.len()],
    pub(super) images: [u8; Slot::ALL_IMAGES_BYTES],
    pub(super) counters: CanTraffic,
}

impl Reassembler {
    /// Makes a reassembler for frames of one format from these senders; all others are foreign.
    #[must_use]
    pub fn new(senders: &[EndRole], format: CanVersion) -> Self {
        Self {
            senders: senders.iter().fold(0, |bits, role| bits | 1 << (*role as u8)),
            format,
            progress: [Progress::default(); Slot::ALL.len()],
            images: [0; Slot::ALL_IMAGES_BYTES],
            counters: CanTraffic::default(),
        }
    }

    /// Counts of the traffic so far.
    #[must_use]
    pub fn counters(&self) -> &CanTraffic {
        &self.counters
    }

    /// Number of messages begun and not complete. On a bus that is quiet again these are messages that
    /// lost their end, or frames whose identifier was changed on the way.
    #[must_use]
    pub fn unfinished(&self) -> usize {
        let begun = |slot: &&Slot| {
            let held = self.progress[usize::from(slot.number) - 1].held;
            (1..slot.segments(self.format)).contains(&held)
        };
        Slot::ALL.iter().filter(begun).count()
    }

    /// Takes a frame. Returns the fate of a message once it is decided.
    pub fn receive(&mut self, frame: &BusFrame) -> Option<ReassemblyEvent> {
        self.counters.frames += 1;
        let known = Slot::of_id(frame.id()).filter(|(slot, _, format)| {
            *format == self.format && self.senders & 1 << (slot.sender as u8) != 0
        });
        let Some((slot, segment, format)) = known else {
            self.counters.foreign += 1;
            return None;
        };
        match self.take(slot, segment, format, frame) {
            Ok(None) => None,
            Ok(Some(message)) => {
                self.counters.messages += 1;
                Some(ReassemblyEvent::Received { sender: slot.sender, message })
            }
            Err(cause) => {
                let counters = &mut self.counters;
                match cause {
                    DropCause::Missing(count) => counters.missing += u64::from(count),
                    DropCause::Disordered => counters.disordered += 1,
                    DropCause::Incomplete => counters.incomplete += 1,
                    DropCause::Mixed { .. } => counters.mixed += 1,
                    DropCause::Malformed { .. } => counters.malformed += 1,
                    DropCause::Unreadable(_) => counters.unreadable += 1,
                }
                Some(ReassemblyEvent::Lost(DroppedMessage { slot, cause }))
            }
        }
    }

    fn take(
        &mut self,
        slot: Slot,
        segment: usize,
        format: CanVersion,
        frame: &BusFrame,
    ) -> Result<Option<Message>, DropCause> {
        let count = slot.segments(format);
        let at = segment * format.room();
        let end = slot.image_bytes().min(at + format.room());
        let progress = &mut self.progress[usize::from(slot.number) - 1];
        let image = &mut self.images[slot.offset()..][..slot.image_bytes()];
        let data = frame.data();

        if let (MessageKind::Hello, 0, Some(version)) =
            (slot.kind, segment, data.first_chunk::<2>())
        {
            let found = u16::from_le_bytes(*version);
            // Only the version of a newer hello is known.
            if found > VERSION {
                *progress = Progress::DROPPED;
                return Err(DropCause::Unreadable(Unreadable::NewerVersion { found }));
            }
        }
        let expected = slot.frame_bytes(segment, format);
        let (here, behind) = data.split_at(data.len().min(end - at));
        if data.len() != expected || behind.iter().any(|byte| *byte != 0) {
            *progress = Progress::DROPPED;
            let [found, expected] = [data.len(), expected].map(|bytes| bytes as u8);
            return Err(DropCause::Malformed { found, expected });
        }
        // Repetition counts for messages of several segments only: a message of one may well be the
        // same again.
        let again = progress.held == segment + 1 && count > 1;
        if again && !(segment == 0 && progress.held == count) && image[at..end] == *here {
            self.counters.duplicated += 1;
            return Ok(None);
        }
        if segment == 0 {
            let incomplete = (1..count).contains(&progress.held);
            *progress = Progress { held: 1, dropped: false };
            image[at..end].copy_from_slice(here);
            if incomplete {
                return Err(DropCause::Incomplete);
            }
        } else {
            if progress.dropped {
                self.counters.orphaned += 1;
                return Ok(None);
            }
            // After the last segment, none of the next message is held.
            let held = if progress.held == count { 0 } else { progress.held };
            if segment > held {
                *progress = Progress::DROPPED;
                return Err(DropCause::Missing((segment - held) as u8));
            }
            if segment < held {
                *progress = Progress::DROPPED;
                return Err(DropCause::Disordered);
            }
            progress.held += 1;
            image[at..end].copy_from_slice(here);
        }
        if progress.held < count {
            return Ok(None);
        }
        read(slot, image).map(Some)
    }
}

/// Reads the message of a complete image.
fn read(slot: Slot, image: &[u8]) -> Result<Message, DropCause> {
    let mut payload = [0; MAX_PAYLOAD_BYTES];
    let payload = &mut payload[..slot.kind.payload_bytes()];
    payload[..4].copy_from_slice(&image[..4]);
    payload[4..].copy_from_slice(&image[8..]);
    let crc = image[4..].first_chunk().copied().unwrap_or_default();
    let (found, computed) = (u32::from_le_bytes(crc), checksum(slot, payload));
    if found != computed {
        return Err(DropCause::Mixed { found, computed });
    }
    let message = Message::read(slot.kind, payload).map_err(DropCause::Unreadable)?;
    // The identifier must agree with the content of the message.
    let contradiction = match message {
        Message::Hello(hello) if hello.role != slot.sender => {
            Some(("role", hello.role as u8, "that of its identifier"))
        }
        Message::Parameters(segment) if segment.segment != slot.parameters => {
            Some(("segment", segment.segment, "that of its identifier"))
        }
        _ => None,
    };
    match contradiction {
        Some((field, found, expected)) => Err(DropCause::Unreadable(Unreadable::Value {
            kind: slot.kind,
            field,
            found: found.into(),
            expected,
        })),
        None => Ok(message),
    }
}
