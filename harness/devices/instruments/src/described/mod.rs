//! Any record protocol on a line of bytes, by a description of its frames.
//!
//! A [`FrameDescription`] has the bytes that a frame begins with, its length, its checksum and its fields. A
//! [`RecordDescription`] holds those of a unit, and [`Described`] is the protocol that follows: the decoder around it
//! finds frames among other bytes as for every other protocol. With the feature `descriptions`
//! [`UnitDescription`](crate::description::UnitDescription) reads it from TOML.
//!
//! Values are in the axes of the unit, as its description maps them. A reading has those quantities that its frame
//! has; a frame without an inertial quantity holds no reading.
//!
//! [`FixedRecords`] are records of one length without bytes that they begin with, in a file, and a [`LineDescription`]
//! has lines of text.

mod check;
mod field;
mod gather;
mod lines;
mod number;
mod records;

pub use check::{ChecksumKind, CrcParameters, DescribedCrc, FrameChecksum};
pub use field::{FieldMeaning, FrameField};
pub use lines::{
    BEGINS_BYTES_MAX, LINE_BYTES_MAX, LINE_FIELDS_MAX, LINES_MAX, LineChecksum, LineDescription,
    LineField, LineForm, LineSeparator, LinesDecoder,
};
pub use number::{ByteOrder, FrameNumber, NumberType};
pub use records::{FixedRecords, RECORD_FIELDS_MAX, RecordsDecoder};

use crate::Reading;
use crate::framing::{Extent, FrameDecoder, Framing, ReadingDefect};
use crate::rollover::Rollover;
use gather::Gather;

/// Most bytes of a frame.
pub const FRAME_BYTES_MAX: usize = 1024;
/// Most bytes that tell a frame's beginning.
pub const SYNC_BYTES_MAX: usize = 8;
/// Most frames of a description.
pub const FRAMES_MAX: usize = 32;
/// Most fields of all frames of a description together.
pub const FIELDS_MAX: usize = 384;

/// A frame.
#[derive(Clone, Copy, Debug)]
pub struct FrameDescription<'a> {
    /// Bytes that it begins with.
    pub sync: &'a [u8],
    /// Number of all of its bytes.
    pub bytes: usize,
    /// Checksum; without it damage can't be noticed.
    pub checksum: Option<FrameChecksum>,
    /// Fields.
    pub fields: &'a [FrameField],
}

/// Reason why frames are no description.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RecordDescriptionError {
    /// There is no frame, or there are too many frames or fields.
    #[error("found {found} {what}, expected 1 to {most}")]
    Count {
        /// Number found.
        found: usize,
        /// Counted things.
        what: &'static str,
        /// Largest number.
        most: usize,
    },
    /// A number isn't within its frame.
    #[error("frame {frame}: a number at byte {at} isn't within its {bytes} bytes")]
    Outside {
        /// Frame, from 1.
        frame: usize,
        /// First byte of the number.
        at: usize,
        /// Number of bytes of the frame.
        bytes: usize,
    },
    /// Two frames begin with the same bytes.
    #[error(
        "frames {first} and {second} begin with the same bytes, expected to tell them by their first ones"
    )]
    Alike {
        /// Frame, from 1.
        first: usize,
        /// The other one.
        second: usize,
    },
}

#[derive(Clone, Copy, Debug)]
struct StoredFrame {
    sync: [u8; SYNC_BYTES_MAX],
    sync_bytes: usize,
    bytes: usize,
    checksum: Option<FrameChecksum>,
    /// Fields among all.
    fields: (usize, usize),
}

impl StoredFrame {
    const NONE: Self =
        Self { sync: [0; SYNC_BYTES_MAX], sync_bytes: 0, bytes: 0, checksum: None, fields: (0, 0) };

    fn sync(&self) -> &[u8] {
        &self.sync[..self.sync_bytes]
    }
}

/// The frames of a unit.
#[derive(Clone, Debug)]
pub struct RecordDescription {
    frames: [StoredFrame; FRAMES_MAX],
    frame_count: usize,
    fields: [FrameField; FIELDS_MAX],
    /// Bytes with which a frame may begin, a bit each.
    begins: [u64; 4],
    counter: Rollover,
    stamp: Rollover,
}

impl RecordDescription {
    /// Puts frames together. Counter and stamp are continued across their roll-over, in raw units.
    ///
    /// # Errors
    /// If there are too many, a number is outside of its frame, or two frames can't be told apart.
    pub fn new(
        frames: &[FrameDescription<'_>],
        counter: Rollover,
        stamp: Rollover,
    ) -> Result<Self, RecordDescriptionError> {
        let within = |found, most, what| match found {
            found if (1..=most).contains(&found) => Ok(()),
            found => Err(RecordDescriptionError::Count { found, what, most }),
        };
        within(frames.len(), FRAMES_MAX, "frames")?;
        let nothing = FrameField {
            number: FrameNumber::whole(0, NumberType::Unsigned(1), ByteOrder::Little),
            meaning: FieldMeaning::Counter,
        };
        let mut all = Self {
            frames: [StoredFrame::NONE; FRAMES_MAX],
            frame_count: frames.len(),
            fields: [nothing; FIELDS_MAX],
            begins: [0; 4],
            counter,
            stamp,
        };
        let mut used = 0;
        for (index, frame) in frames.iter().enumerate() {
            within(frame.bytes, FRAME_BYTES_MAX, "bytes of a frame")?;
            within(frame.sync.len(), SYNC_BYTES_MAX.min(frame.bytes), "bytes of a sync")?;
            within(used + frame.fields.len(), FIELDS_MAX, "fields")?;
            let numbers = frame.fields.iter().map(|field| &field.number);
            for number in numbers.chain(frame.checksum.as_ref().map(|check| &check.number)) {
                let end = number.at.saturating_add(number.number.bytes());
                if end > frame.bytes {
                    let (at, bytes) = (number.at, frame.bytes);
                    return Err(RecordDescriptionError::Outside { frame: index + 1, at, bytes });
                }
            }
            let alike = |other: &FrameDescription<'_>| {
                other.sync.starts_with(frame.sync) || frame.sync.starts_with(other.sync)
            };
            if let Some(first) = frames[..index].iter().position(alike) {
                return Err(RecordDescriptionError::Alike { first: first + 1, second: index + 1 });
            }
            let mut sync = [0; SYNC_BYTES_MAX];
            sync[..frame.sync.len()].copy_from_slice(frame.sync);
            let first = sync[0];
            all.begins[usize::from(first >> 6)] |= 1 << (first & 63);
            let end = used + frame.fields.len();
            all.fields[used..end].copy_from_slice(frame.fields);
            all.frames[index] = StoredFrame {
                sync,
                sync_bytes: frame.sync.len(),
                bytes: frame.bytes,
                checksum: frame.checksum,
                fields: (used, end),
            };
            used = end;
        }
        Ok(all)
    }

    fn frames(&self) -> &[StoredFrame] {
        &self.frames[..self.frame_count]
    }
}

/// A described protocol, with the state of its counter and clock.
#[derive(Clone, Debug)]
pub struct Described {
    description: RecordDescription,
    counter: Rollover,
    stamp: Rollover,
}

impl Described {
    /// Makes the protocol of a description.
    #[must_use]
    pub fn new(description: RecordDescription) -> Self {
        let (counter, stamp) = (description.counter, description.stamp);
        Self { description, counter, stamp }
    }

    /// True if every frame has a checksum.
    #[must_use]
    pub fn has_checksums(&self) -> bool {
        self.description.frames().iter().all(|frame| frame.checksum.is_some())
    }
}

/// Finds readings in a stream of bytes.
pub type DescribedDecoder = FrameDecoder<Described>;

impl Framing for Described {
    type Found = Reading;
    type Room = [u8; FRAME_BYTES_MAX];
    const EMPTY: Self::Room = [0; FRAME_BYTES_MAX];

    #[inline]
    fn begins(&self, byte: u8) -> bool {
        (self.description.begins[usize::from(byte >> 6)] >> (byte & 63)) & 1 == 1
    }

    #[inline]
    fn extent(&self, bytes: &[u8]) -> Extent {
        let mut open = usize::MAX;
        for frame in self.description.frames() {
            let sync = frame.sync();
            if bytes.starts_with(sync) {
                return Extent::Bytes(frame.bytes);
            }
            if sync.starts_with(bytes) {
                open = open.min(sync.len() - bytes.len());
            }
        }
        if open == usize::MAX { Extent::None } else { Extent::Open(open) }
    }

    #[inline]
    fn read(&mut self, bytes: &[u8]) -> Result<Option<Reading>, ReadingDefect> {
        let frames = self.description.frames();
        let found = frames.iter().find(|one| bytes.starts_with(one.sync()));
        let frame = found.ok_or(ReadingDefect::Malformed)?;
        if let Some(checksum) = &frame.checksum {
            let (found, computed) = checksum.found_and_computed(bytes);
            if found != computed {
                return Err(ReadingDefect::Checksum { found, computed });
            }
        }
        let mut gather = Gather::new(&mut self.counter, &mut self.stamp);
        for field in &self.description.fields[frame.fields.0..frame.fields.1] {
            gather.take(&field.meaning, field.number(bytes));
        }
        Ok(gather.end())
    }
}
