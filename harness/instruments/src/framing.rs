//! Frames among other bytes.
//!
//! A protocol says where a frame may begin, how long the one that begins there is, and whether it is
//! one. The [`Decoder`] does the rest: it takes bytes in pieces of any length, and where a frame turns
//! out to be none it looks for the next one from the byte after its first, so that a sync by chance
//! costs no frame that follows. What it says doesn't depend on how the bytes were cut.

use crate::Reading;
use core::fmt::Debug;

/// How long the frame is that begins with given bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// No frame begins so.
    None,
    /// At least so many more bytes are needed to tell.
    Open(usize),
    /// So many bytes, if it is one.
    Bytes(usize),
}

/// Why bytes are no reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Cause {
    /// The checksum is another one.
    #[error("the frame is damaged: checksum {found:#x}, computed {computed:#x}")]
    Checksum {
        /// Checksum in the frame.
        found: u32,
        /// Checksum of the frame.
        computed: u32,
    },
    /// The bytes have the form of no frame.
    #[error("this is no frame, or a piece of one")]
    Malformed,
    /// Intact, but a field has a value without meaning here.
    #[error("the frame is intact, but its {field} {found} isn't known")]
    Unknown {
        /// Which field.
        field: &'static str,
        /// Its value.
        found: u32,
    },
    /// Intact, but a field is no number.
    #[error("the frame is intact, but its {field} is no such number")]
    NoNumber {
        /// Which field.
        field: &'static str,
    },
    /// Intact, but no message of the wire of this project.
    #[error(transparent)]
    Unreadable(octant_wire::Unreadable),
}

impl Cause {
    /// The frame itself was intact.
    #[must_use]
    pub fn is_intact(self) -> bool {
        !matches!(self, Self::Checksum { .. } | Self::Malformed)
    }
}

/// A protocol: what a frame looks like and says.
pub trait Framing {
    /// Room for the longest frame.
    type Room: AsRef<[u8]> + AsMut<[u8]> + Clone + Debug;
    /// That room, empty.
    const EMPTY: Self::Room;

    /// A frame may begin with this byte.
    fn begins(byte: u8) -> bool;

    /// How long the frame is that begins with these bytes, of which the first one passed
    /// [`Framing::begins`]. Never longer than the room, and never more than
    /// the room with [`Extent::Open`]. More bytes don't change an answer that isn't [`Extent::Open`].
    fn extent(bytes: &[u8]) -> Extent;

    /// What a frame of that length says; `None`: it is intact and holds no reading.
    ///
    /// # Errors
    /// If it is no intact frame, or one that isn't understood.
    fn read(&mut self, frame: &[u8]) -> Result<Option<Reading>, Cause>;
}

/// Bytes that were no reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lost {
    /// Why.
    pub cause: Cause,
    /// How many bytes the frame would have had.
    pub bytes: usize,
}

/// What came.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// A reading.
    Reading(Reading),
    /// What looked like a frame, and isn't one that can be read.
    Lost(Lost),
}

/// What came so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Bytes, all of them.
    pub bytes: u64,
    /// Bytes of intact frames.
    pub bytes_framed: u64,
    /// Bytes that were part of no intact frame.
    pub bytes_lost: u64,
    /// Readings.
    pub readings: u64,
    /// Intact frames that hold no reading.
    pub other: u64,
    /// What looked like a frame and had another checksum. One damaged frame can count more than once:
    /// in its rest there may be bytes that look like another one.
    pub checksum: u64,
    /// What looked like a frame and had no such form.
    pub malformed: u64,
    /// Intact frames that aren't understood.
    pub unknown: u64,
    /// Readings that never came, by gaps in their sequence.
    pub missing: u64,
    /// Readings that came again or too late, or a unit that was switched on anew.
    pub behind: u64,
}

impl Counters {
    /// Counts a reading by its sequence number.
    pub(crate) fn in_sequence(&mut self, last: &mut Option<u64>, sequence: Option<u64>) {
        let Some(sequence) = sequence else { return };
        match *last {
            Some(last) if sequence > last => self.missing += sequence - last - 1,
            Some(_) => self.behind += 1,
            None => {}
        }
        *last = Some(sequence);
    }

    /// Counts what was no reading.
    pub(crate) fn cause(&mut self, cause: Cause) {
        match cause {
            Cause::Checksum { .. } => self.checksum += 1,
            Cause::Malformed => self.malformed += 1,
            Cause::Unknown { .. } | Cause::NoNumber { .. } | Cause::Unreadable(_) => {
                self.unknown += 1;
            }
        }
    }

    /// Nothing is lost, damaged, missing, doubled or not understood.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        let Self { bytes, bytes_framed, readings, other, .. } = *self;
        *self == Self { bytes, bytes_framed, readings, other, ..Self::default() }
    }
}

/// Finds frames in bytes as they come.
#[derive(Clone, Debug)]
pub struct Decoder<P: Framing> {
    protocol: P,
    /// The beginning of a frame that has not come whole.
    held: P::Room,
    length: usize,
    last_sequence: Option<u64>,
    counters: Counters,
}

impl<P: Framing> Decoder<P> {
    /// Nothing received yet.
    #[must_use]
    pub fn new(protocol: P) -> Self {
        Self {
            protocol,
            held: P::EMPTY,
            length: 0,
            last_sequence: None,
            counters: Counters::default(),
        }
    }

    /// What came so far.
    #[must_use]
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// Bytes of a frame that has not come whole yet.
    #[must_use]
    pub fn held(&self) -> usize {
        self.length
    }

    /// Takes bytes up to the end of the next frame that says something, and says what it was. `None`
    /// when all bytes are taken: call it until then.
    #[inline]
    pub fn next(&mut self, bytes: &mut &[u8]) -> Option<Event> {
        loop {
            if self.length > 0 {
                match self.complete(bytes) {
                    Step::Said(event) => return Some(event),
                    Step::Go => continue,
                    Step::Wait => return None,
                }
            }
            let skipped = bytes.iter().position(|byte| P::begins(*byte)).unwrap_or(bytes.len());
            self.take(bytes, skipped);
            self.counters.bytes_lost += skipped as u64;
            if bytes.is_empty() {
                return None;
            }
            let all = bytes.len();
            match P::extent(bytes) {
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
                    // Fewer bytes than the frame has, which fits the room.
                    self.hold(bytes, all);
                    return None;
                }
            }
        }
    }

    /// Nothing more comes, or nothing came for long: what is held of a frame is none, and frames may
    /// be behind its first byte. Call it until it says `None`.
    pub fn end(&mut self) -> Option<Event> {
        while self.length > 0 {
            match self.complete(&mut &[][..]) {
                Step::Said(event) => return Some(event),
                Step::Go => {}
                Step::Wait => self.drop_held(1),
            }
        }
        None
    }

    /// One step on with what is held.
    fn complete(&mut self, bytes: &mut &[u8]) -> Step {
        match P::extent(&self.held.as_ref()[..self.length]) {
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
                    // Excluded by the contract of `extent`: nothing is stuck if it is broken.
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
                    // Its byte is counted by `conclude`.
                    self.remove_held(1);
                }
                self.event(outcome, length).map_or(Step::Go, Step::Said)
            }
        }
    }

    /// Holds more bytes, for which there is room.
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

    /// Loses bytes from what is held.
    fn drop_held(&mut self, count: usize) {
        self.counters.bytes_lost += count as u64;
        self.remove_held(count);
    }

    /// Takes bytes from what is held, and loses those behind them with which no frame begins.
    fn remove_held(&mut self, count: usize) {
        let held = &mut self.held.as_mut()[..self.length];
        let rest = held.get(count..).unwrap_or_default();
        let lost = rest.iter().position(|byte| P::begins(*byte)).unwrap_or(rest.len());
        self.length = rest.len() - lost;
        held.copy_within(count + lost.., 0);
        self.counters.bytes_lost += lost as u64;
    }

    /// Counts an outcome; whether the frame was intact.
    fn conclude(&mut self, outcome: &Result<Option<Reading>, Cause>, length: usize) -> bool {
        let counters = &mut self.counters;
        let intact = match outcome {
            Ok(Some(reading)) => {
                counters.readings += 1;
                counters.in_sequence(&mut self.last_sequence, reading.sequence);
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

    fn event(&self, outcome: Result<Option<Reading>, Cause>, bytes: usize) -> Option<Event> {
        match outcome {
            Ok(reading) => reading.map(Event::Reading),
            Err(cause) => Some(Event::Lost(Lost { cause, bytes })),
        }
    }
}

/// What came of a step with held bytes.
enum Step {
    /// An event.
    Said(Event),
    /// Go on.
    Go,
    /// More bytes are needed.
    Wait,
}
