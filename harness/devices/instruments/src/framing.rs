//! Frames among other bytes.
//!
//! A protocol says where a frame may begin, how long a frame that begins there is, and whether it is
//! valid. The [`FrameDecoder`] does the rest: it takes bytes in pieces of any length. If a supposed frame
//! turns out to be invalid, it searches on from the byte after the first, so that a sync by chance
//! costs no frame after it. Its results don't depend on how the bytes were cut.

use crate::Reading;
use crate::record_defect::RecordDefect;
use core::fmt::Debug;

/// Length of the frame that begins with given bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// No frame begins like this.
    None,
    /// At least this many more bytes are needed to decide.
    Open(usize),
    /// This many bytes, if the frame is valid.
    Bytes(usize),
}

/// Reason why bytes are no reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReadingDefect {
    /// The checksum is wrong.
    #[error("the frame is damaged: checksum {found:#x}, computed {computed:#x}")]
    Checksum {
        /// Checksum in the frame.
        found: u32,
        /// Checksum of the frame.
        computed: u32,
    },
    /// The bytes don't have the form of a frame.
    #[error("this is no frame, or a piece of one")]
    Malformed,
    /// The frame is intact, but a field has an unknown value.
    #[error("the frame is intact, but its {field} {found} isn't known")]
    Unknown {
        /// Name of the field.
        field: &'static str,
        /// Value of the field.
        found: u32,
    },
    /// The frame is intact, but a field is no number.
    #[error("the frame is intact, but its {field} is no such number")]
    NoNumber {
        /// Name of the field.
        field: &'static str,
    },
    /// A record of fixed length is none: nothing after it can be believed.
    #[error("record {number}: {cause}; the records have another length, or begin elsewhere")]
    Record {
        /// Number of the record, from 1.
        number: u64,
        /// Sign by which the loss was seen.
        cause: RecordDefect,
    },
    /// The frame is intact, but is no message of the Octant wire.
    #[error(transparent)]
    Unreadable(octant_wire::Unreadable),
}

impl ReadingDefect {
    /// True if the frame itself was intact.
    #[must_use]
    pub fn is_intact(self) -> bool {
        !matches!(self, Self::Checksum { .. } | Self::Malformed)
    }

    /// True if nothing that follows can be read.
    #[must_use]
    pub fn is_final(self) -> bool {
        matches!(self, Self::Record { .. })
    }
}

/// Content of a frame: a reading, or a navigation message.
pub trait FrameContent: Copy + Debug {
    /// Number among its kind, where the protocol counts them.
    fn sequence(&self) -> Option<u64>;
}

impl FrameContent for Reading {
    fn sequence(&self) -> Option<u64> {
        self.sequence
    }
}

/// A protocol: form and content of its frames.
pub trait Framing {
    /// Content that the frames are read for.
    type Found: FrameContent;
    /// Buffer for the longest frame.
    type Room: AsRef<[u8]> + AsMut<[u8]> + Clone + Debug;
    /// Empty buffer.
    const EMPTY: Self::Room;

    /// True if a frame may begin with this byte.
    fn begins(&self, byte: u8) -> bool;

    /// Length of the frame that begins with these bytes, of which the first one passed
    /// [`Framing::begins`]. Never longer than the buffer, and with [`Extent::Open`] never more than its
    /// room. More bytes don't change an answer other than [`Extent::Open`].
    fn extent(&self, bytes: &[u8]) -> Extent;

    /// Reads a frame of that length; `None`: it is intact and holds nothing of the kind.
    ///
    /// # Errors
    /// If the frame isn't intact or can't be decoded.
    fn read(&mut self, frame: &[u8]) -> Result<Option<Self::Found>, ReadingDefect>;
}

/// Bytes that are no reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnreadBytes {
    /// Reason.
    pub cause: ReadingDefect,
    /// Number of bytes that the frame would have had.
    pub bytes: usize,
}

/// Event in a stream of bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FramingEvent<Found = Reading> {
    /// A reading.
    Reading(Found),
    /// Bytes that looked like a frame, but can't be read.
    Lost(UnreadBytes),
}

/// Counts of the traffic so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReadingCounters {
    /// All bytes.
    pub bytes: u64,
    /// Bytes of intact frames.
    pub bytes_framed: u64,
    /// Bytes that belong to no intact frame.
    pub bytes_lost: u64,
    /// Readings.
    pub readings: u64,
    /// Intact frames that hold no reading.
    pub other: u64,
    /// Supposed frames with a wrong checksum. One damaged frame can count more than once, because its
    /// rest may contain bytes that look like another frame.
    pub checksum: u64,
    /// Supposed frames with a wrong form.
    pub malformed: u64,
    /// Intact frames that can't be decoded.
    pub unknown: u64,
    /// Missing readings, from gaps in their sequence.
    pub missing: u64,
    /// Readings repeated or too late, or restarts of the unit.
    pub behind: u64,
}

impl ReadingCounters {
    /// Counts gaps and repetitions by a reading's sequence number.
    pub(crate) fn in_sequence(&mut self, last: &mut Option<u64>, sequence: Option<u64>) {
        let Some(sequence) = sequence else { return };
        match *last {
            Some(last) if sequence > last => self.missing += sequence - last - 1,
            Some(_) => self.behind += 1,
            None => {}
        }
        *last = Some(sequence);
    }

    /// Counts bytes that are no reading.
    pub(crate) fn cause(&mut self, cause: ReadingDefect) {
        match cause {
            ReadingDefect::Checksum { .. } => self.checksum += 1,
            ReadingDefect::Malformed => self.malformed += 1,
            ReadingDefect::Unknown { .. }
            | ReadingDefect::NoNumber { .. }
            | ReadingDefect::Record { .. }
            | ReadingDefect::Unreadable(_) => {
                self.unknown += 1;
            }
        }
    }

    /// True if nothing was lost, damaged, missing, repeated or unknown.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        let Self { bytes, bytes_framed, readings, other, .. } = *self;
        *self == Self { bytes, bytes_framed, readings, other, ..Self::default() }
    }
}

/// Finds frames in bytes as they arrive.
#[derive(Clone, Debug)]
pub struct FrameDecoder<P: Framing> {
    protocol: P,
    /// Beginning of an incomplete frame.
    held: P::Room,
    length: usize,
    last_sequence: Option<u64>,
    counters: ReadingCounters,
}

impl<P: Framing + Default> Default for FrameDecoder<P> {
    fn default() -> Self {
        Self::new(P::default())
    }
}

impl<P: Framing> FrameDecoder<P> {
    /// Makes a decoder that has received nothing.
    #[must_use]
    pub fn new(protocol: P) -> Self {
        Self {
            protocol,
            held: P::EMPTY,
            length: 0,
            last_sequence: None,
            counters: ReadingCounters::default(),
        }
    }

    /// The protocol.
    #[must_use]
    pub fn protocol(&self) -> &P {
        &self.protocol
    }

    /// Counts of the traffic so far.
    #[must_use]
    pub fn counters(&self) -> &ReadingCounters {
        &self.counters
    }

    /// Number of bytes held of an incomplete frame.
    #[must_use]
    pub fn held(&self) -> usize {
        self.length
    }

    /// Takes bytes up to the end of the next frame with an event, and returns the event. Returns `None`
    /// when all bytes are taken: call it until then.
    #[inline]
    pub fn next(&mut self, bytes: &mut &[u8]) -> Option<FramingEvent<P::Found>> {
        loop {
            if self.length > 0 {
                match self.complete(bytes) {
                    Step::Said(event) => return Some(event),
                    Step::Go => continue,
                    Step::Wait => return None,
                }
            }
            let skipped =
                bytes.iter().position(|byte| self.protocol.begins(*byte)).unwrap_or(bytes.len());
            if skipped > 0 {
                self.take(bytes, skipped);
                self.counters.bytes_lost += skipped as u64;
            }
            if bytes.is_empty() {
                return None;
            }
            let all = bytes.len();
            match self.protocol.extent(bytes) {
                Extent::Bytes(length) if length <= all => {
                    let outcome = self.protocol.read(&bytes[..length]);
                    let intact = self.conclude(&outcome, length);
                    self.take(bytes, if intact { length } else { 1 });
                    if let Some(event) = self.event(outcome, length) {
                        return Some(event);
                    }
                }
                Extent::None => {
                    self.counters.bytes_lost += 1;
                    self.take(bytes, 1);
                }
                Extent::Bytes(_) | Extent::Open(_) => {
                    // Fewer bytes than the frame has, which fits the buffer.
                    self.hold(bytes, all);
                    return None;
                }
            }
        }
    }

    /// Ends the input, also after a long silence: the incomplete frame is dropped, but frames may
    /// follow its first byte. Call it until it returns `None`.
    pub fn end(&mut self) -> Option<FramingEvent<P::Found>> {
        while self.length > 0 {
            match self.complete(&mut &[][..]) {
                Step::Said(event) => return Some(event),
                Step::Go => {}
                Step::Wait => self.drop_held(1),
            }
        }
        None
    }

    /// Makes one step with the bytes held.
    fn complete(&mut self, bytes: &mut &[u8]) -> Step<P::Found> {
        match self.protocol.extent(&self.held.as_ref()[..self.length]) {
            Extent::None => {
                self.drop_held(1);
                Step::Go
            }
            Extent::Open(more) => {
                if bytes.is_empty() {
                    return Step::Wait;
                }
                let room = self.held.as_ref().len() - self.length;
                let more = more.max(1).min(bytes.len()).min(room);
                if more == 0 {
                    // The contract of `extent` excludes this case; dropping a byte avoids an endless
                    // loop if it is broken.
                    self.drop_held(1);
                }
                self.hold(bytes, more);
                Step::Go
            }
            Extent::Bytes(length) => {
                let more = length.saturating_sub(self.length).min(bytes.len());
                self.held.as_mut()[self.length..self.length + more].copy_from_slice(&bytes[..more]);
                self.length += more;
                self.take(bytes, more);
                if self.length < length {
                    return Step::Wait;
                }
                let outcome = self.protocol.read(&self.held.as_ref()[..length]);
                if self.conclude(&outcome, length) {
                    self.remove_held(length);
                } else {
                    // `conclude` has counted the dropped byte.
                    self.remove_held(1);
                }
                self.event(outcome, length).map_or(Step::Go, Step::Said)
            }
        }
    }

    /// Moves bytes to those held; there must be room.
    fn hold(&mut self, bytes: &mut &[u8], count: usize) {
        let room = &mut self.held.as_mut()[self.length..self.length + count];
        room.copy_from_slice(&bytes[..count]);
        self.length += count;
        self.take(bytes, count);
    }

    fn take(&mut self, bytes: &mut &[u8], count: usize) {
        *bytes = &bytes[count..];
        self.counters.bytes += count as u64;
    }

    /// Drops bytes held, and counts them as lost.
    fn drop_held(&mut self, count: usize) {
        self.counters.bytes_lost += count as u64;
        self.remove_held(count);
    }

    /// Removes bytes held, and drops those after them up to a possible beginning of a frame.
    fn remove_held(&mut self, count: usize) {
        let held = &mut self.held.as_mut()[..self.length];
        let rest = held.get(count..).unwrap_or_default();
        let lost = rest.iter().position(|byte| self.protocol.begins(*byte)).unwrap_or(rest.len());
        self.length = rest.len() - lost;
        held.copy_within(count + lost.., 0);
        self.counters.bytes_lost += lost as u64;
    }

    /// Counts an outcome; returns true if the frame was intact.
    fn conclude(
        &mut self,
        outcome: &Result<Option<P::Found>, ReadingDefect>,
        length: usize,
    ) -> bool {
        let counters = &mut self.counters;
        let intact = match outcome {
            Ok(Some(reading)) => {
                counters.readings += 1;
                counters.in_sequence(&mut self.last_sequence, reading.sequence());
                true
            }
            Ok(None) => {
                counters.other += 1;
                true
            }
            Err(cause) => {
                counters.cause(*cause);
                cause.is_intact()
            }
        };
        if intact {
            counters.bytes_framed += length as u64;
        } else {
            counters.bytes_lost += 1;
        }
        intact
    }

    fn event(
        &self,
        outcome: Result<Option<P::Found>, ReadingDefect>,
        bytes: usize,
    ) -> Option<FramingEvent<P::Found>> {
        match outcome {
            Ok(reading) => reading.map(FramingEvent::Reading),
            Err(cause) => Some(FramingEvent::Lost(UnreadBytes { cause, bytes })),
        }
    }
}

/// Result of a step with the bytes held.
enum Step<Found> {
    /// An event.
    Said(FramingEvent<Found>),
    /// Another step is possible.
    Go,
    /// More bytes are needed.
    Wait,
}

/// Facts of a protocol.
#[derive(Debug)]
pub struct ProtocolFacts {
    /// Name in a scenario.
    pub name: &'static str,
    /// Messages that it means, in a few words.
    pub doc: &'static str,
    /// Largest error of its resolution in an increment over 5 ms, and in the sum of all: rad and m/s.
    pub resolution: [f64; 2],
    /// Bytes that look like the beginning of a long frame, and are none.
    pub false_starts: &'static [&'static [u8]],
}
