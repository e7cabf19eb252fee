//! Identifiers, which give sender and kind of a message.
//!
//! An identifier is `format (1 bit, FD 1), slot (5 bits), segment (5 bits)`. A slot is a message of
//! one sender; a lower one wins the bus. Slots 0 and 31 stay free: 0 for frames that must win over all
//! others, and 31 because identifiers that begin with seven ones are not allowed on every bus.

use super::{CanVersion, MAX_IMAGE_BYTES};
use crate::message::{EndRole, MessageKind, PARAMETERS_SEGMENTS};

/// A message of one sender; of parameters, each segment is one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Slot {
    /// Slot number, 1 to 28.
    pub number: u8,
    /// Sender.
    pub sender: EndRole,
    /// Kind of the message.
    pub kind: MessageKind,
    /// Segment of the parameters; 0 for other kinds.
    pub parameters: u8,
}

const fn slot(number: u8, sender: EndRole, kind: MessageKind) -> Slot {
    Slot { number, sender, kind, parameters: 0 }
}

const fn sixth(parameters: u8) -> Slot {
    Slot {
        number: 23 + parameters,
        sender: EndRole::Device,
        kind: MessageKind::Parameters,
        parameters,
    }
}

const SLOTS: usize = 22 + PARAMETERS_SEGMENTS;

use EndRole::{Device, Harness, Instrument};

impl Slot {
    /// All slots, in order of priority.
    pub const ALL: [Self; SLOTS] = [
        slot(1, Harness, MessageKind::Bye),
        slot(2, Device, MessageKind::Bye),
        slot(3, Instrument, MessageKind::Bye),
        slot(4, Harness, MessageKind::TimeRequest),
        slot(5, Device, MessageKind::TimeReply),
        slot(6, Instrument, MessageKind::TimeReply),
        slot(7, Instrument, MessageKind::Aiding),
        slot(8, Instrument, MessageKind::Sample),
        slot(9, Harness, MessageKind::Aiding),
        slot(10, Harness, MessageKind::Sample),
        slot(11, Harness, MessageKind::Restart),
        slot(12, Harness, MessageKind::End),
        slot(13, Device, MessageKind::Output),
        slot(14, Device, MessageKind::Ready),
        slot(15, Harness, MessageKind::Hello),
        slot(16, Device, MessageKind::Hello),
        slot(17, Instrument, MessageKind::Hello),
        slot(18, Harness, MessageKind::Heartbeat),
        slot(19, Device, MessageKind::Heartbeat),
        slot(20, Instrument, MessageKind::Heartbeat),
        slot(21, Device, MessageKind::Status),
        slot(22, Instrument, MessageKind::Status),
        sixth(0),
        sixth(1),
        sixth(2),
        sixth(3),
        sixth(4),
        sixth(5),
    ];

    /// Slot of a message, if its sender sends such messages.
    #[must_use]
    pub fn of(sender: EndRole, kind: MessageKind, parameters: u8) -> Option<Self> {
        let parameters = if kind == MessageKind::Parameters { parameters } else { 0 };
        Self::ALL
            .iter()
            .find(|slot| (slot.sender, slot.kind, slot.parameters) == (sender, kind, parameters))
            .copied()
    }

    /// Slot, segment and format of an identifier.
    #[must_use]
    pub fn of_id(id: u16) -> Option<(Self, usize, CanVersion)> {
        let format = if id & 0x400 == 0 { CanVersion::Classic } else { CanVersion::Fd };
        let slot = Self::ALL.get(usize::from(id >> 5 & 0x1F).checked_sub(1)?)?;
        let segment = usize::from(id & 0x1F);
        (id <= 0x7FF && segment < slot.segments(format)).then_some((*slot, segment, format))
    }

    /// Identifier of a segment.
    #[must_use]
    pub const fn id(self, segment: usize, format: CanVersion) -> u16 {
        let format = match format {
            CanVersion::Classic => 0,
            CanVersion::Fd => 0x400,
        };
        format | (self.number as u16) << 5 | (segment as u16 & 0x1F)
    }

    /// Number of bytes of the image.
    #[must_use]
    pub const fn image_bytes(self) -> usize {
        self.kind.payload_bytes() + 4
    }

    /// Number of segments of the image.
    #[must_use]
    pub const fn segments(self, format: CanVersion) -> usize {
        self.image_bytes().div_ceil(format.room())
    }

    /// Length of a segment's frame; bytes after the image are zero.
    #[must_use]
    pub const fn frame_bytes(self, segment: usize, format: CanVersion) -> usize {
        let left = self.image_bytes().saturating_sub(segment * format.room());
        format.length_for(left)
    }

    /// Offset of the slot's image in a buffer that holds one image of each slot.
    pub(super) const fn offset(self) -> usize {
        OFFSETS[self.number as usize - 1]
    }

    /// Size of a buffer that holds one image of each slot, bytes.
    pub(super) const ALL_IMAGES_BYTES: usize = OFFSETS[SLOTS];
}

/// Offset of each slot's image, and the total.
const OFFSETS: [usize; SLOTS + 1] = {
    let mut offsets = [0; SLOTS + 1];
    let mut i = 0;
    while i < SLOTS {
        offsets[i + 1] = offsets[i] + Slot::ALL[i].image_bytes();
        i += 1;
    }
    offsets
};

const _: () = {
    let mut i = 0;
    while i < SLOTS {
        assert!(Slot::ALL[i].number as usize == i + 1, "slots are numbered in order, from 1");
        assert!(Slot::ALL[i].image_bytes() <= MAX_IMAGE_BYTES, "the longest image is the longest");
        assert!(Slot::ALL[i].segments(CanVersion::Classic) <= 32, "five bits number the segments");
        i += 1;
    }
};
