//! Division of messages into CAN frames.

use super::{BusFrame, CanVersion, MAX_IMAGE_BYTES, Slot};
use crate::checksum::crc32_after;
use crate::message::{EndRole, MAX_PAYLOAD_BYTES, Message, MessageKind};

/// Error of a message that its sender has no identifier for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a {} sends no message {} on CAN", sender.name(), kind.name())]
pub struct NotSent {
    /// The sender.
    pub sender: EndRole,
    /// The message.
    pub kind: MessageKind,
}

/// CRC of a message: over its slot number and its payload.
#[inline]
pub(super) fn checksum(slot: Slot, payload: &[u8]) -> u32 {
    crc32_after(slot.number, payload)
}

/// Frames of a message, in the order of sending.
#[derive(Clone, Debug)]
pub struct Segments {
    slot: Slot,
    format: CanVersion,
    next: usize,
    image: [u8; MAX_IMAGE_BYTES],
}

/// Divides a message of a sender into frames.
///
/// # Errors
/// If the sender sends no such message.
pub fn segments(
    message: &Message,
    sender: EndRole,
    format: CanVersion,
) -> Result<Segments, NotSent> {
    let kind = message.kind();
    let parameters = if let Message::Parameters(segment) = message { segment.segment } else { 0 };
    let slot = Slot::of(sender, kind, parameters).ok_or(NotSent { sender, kind })?;
    let mut payload = [0; MAX_PAYLOAD_BYTES];
    message.write(&mut payload);
    let payload = &payload[..kind.payload_bytes()];
    let mut image = [0; MAX_IMAGE_BYTES];
    let (head, rest) = payload.split_at(4);
    image[..4].copy_from_slice(head);
    image[4..8].copy_from_slice(&checksum(slot, payload).to_le_bytes());
    image[8..8 + rest.len()].copy_from_slice(rest);
    Ok(Segments { slot, format, next: 0, image })
}

impl Iterator for Segments {
    type Item = BusFrame;

    fn next(&mut self) -> Option<BusFrame> {
        let segment = self.next;
        if segment >= self.slot.segments(self.format) {
            return None;
        }
        self.next += 1;
        let at = segment * self.format.room();
        let here = (self.slot.image_bytes() - at).min(self.format.room());
        let mut data = [0; 64];
        data[..here].copy_from_slice(&self.image[at..at + here]);
        let length = self.slot.frame_bytes(segment, self.format);
        BusFrame::new(self.slot.id(segment, self.format), self.format, &data[..length])
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = self.slot.segments(self.format).saturating_sub(self.next);
        (left, Some(left))
    }
}

impl ExactSizeIterator for Segments {}
