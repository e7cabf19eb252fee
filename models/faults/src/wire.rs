//! Faults of a wire: what happens to frames between the harness and a device.
//!
//! A fault is described here; who has the wire realises it and counts what it altered. Random numbers
//! are those of the fault's own streams, counted by the frames that it sees.

use octant_random::normal::uniform;
use octant_random::philox::{Key, block};

/// Which way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Way {
    /// From the harness to the device.
    ToDevice,
    /// From the device to the harness.
    ToHarness,
}

/// Which ways a fault acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Ways {
    /// From the harness to the device.
    pub to_device: bool,
    /// From the device to the harness.
    pub to_harness: bool,
}

impl Ways {
    /// Whether a way is one of them.
    #[must_use]
    pub const fn has(self, way: Way) -> bool {
        match way {
            Way::ToDevice => self.to_device,
            Way::ToHarness => self.to_harness,
        }
    }
}

/// A fault of a wire, while it lasts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WireFault {
    /// Which ways it acts on.
    pub ways: Ways,
    /// Share of the frames that it acts on; 1: all of them.
    pub chance: f64,
    /// What it does.
    pub action: WireAction,
    /// Its random numbers.
    pub key: Key,
}

impl WireFault {
    /// Four random numbers in (0, 1) for the `nth` frame of a way.
    #[must_use]
    pub fn uniforms(&self, way: Way, nth: u64) -> [f64; 4] {
        block(self.key, [nth, way as u64, 0, 0]).map(uniform)
    }

    /// Whether it acts on the `nth` frame of a way, and the numbers that it does so with.
    #[must_use]
    pub fn acts_on(&self, way: Way, nth: u64) -> Option<[f64; 3]> {
        let [chance, a, b, c] = self.uniforms(way, nth);
        (self.ways.has(way) && chance < self.chance).then_some([a, b, c])
    }

    /// A random byte that isn't zero, the `i`th of the `nth` frame.
    #[must_use]
    pub fn byte(&self, way: Way, nth: u64, i: u64) -> u8 {
        let [word, ..] = block(self.key, [nth, way as u64, 1, i]);
        (word % 255) as u8 + 1
    }
}

/// What is done to frames. Of a line of bytes and of UDP a frame is what one message is sent as; on a
/// CAN bus it is a CAN frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum WireAction {
    /// One bit is the other one.
    Flip,
    /// A byte is put in.
    Insert,
    /// A byte is left out.
    Drop,
    /// The end is cut off.
    Truncate,
    /// One bit of the last byte before the end, which is of the checksum, is the other one.
    Checksum,
    /// It comes twice.
    Duplicate,
    /// It comes after the next one.
    Reorder,
    /// It is lost.
    Lose,
    /// It comes late, by a time and up to a jitter more, s.
    Delay {
        /// At least so late.
        by_s: f64,
        /// Up to so much more.
        jitter_s: f64,
    },
    /// One that was sent so many frames ago comes again before it.
    Replay {
        /// How many frames ago, from 1.
        age: u32,
    },
    /// It comes in pieces, so long apart, s.
    Split {
        /// Pieces, 2 or more.
        pieces: u32,
        /// Time between two of them.
        apart_s: f64,
    },
    /// It waits for the next one, and both come at once.
    Coalesce,
    /// Something else is sent before it: so many bytes, of CAN so many frames.
    Babble {
        /// How many.
        count: u32,
    },
    /// The line is held: what comes in that time is lost, and read as one zero.
    Break {
        /// How long, s.
        lasts_s: f64,
    },
    /// One byte is read as a zero: its stop bit wasn't there.
    Framing,
    /// The port goes away, and is back after a time, s.
    HangUp {
        /// How long it is away.
        away_s: f64,
    },
    /// Nothing is taken from the port for a time, s.
    SlowReader {
        /// How long.
        pause_s: f64,
    },
    /// The controller reports an error frame.
    ErrorFrame,
    /// Arbitration is lost: the frame is sent after one of another node.
    ArbitrationLost,
    /// The controller leaves the bus, and is back after a time, s.
    BusOff {
        /// How long it is off.
        off_s: f64,
    },
    /// Another node sends other data under the same identifier before it.
    Collision,
    /// The bus is full: each frame waits for so many others, each of a time, s.
    Overload {
        /// How many frames.
        frames: u32,
        /// Time that each of them takes.
        each_s: f64,
    },
}

/// What a medium is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Medium {
    /// A line of bytes.
    Line,
    /// Datagrams.
    Datagrams,
    /// A CAN bus.
    Bus,
}

impl Medium {
    /// Name for people.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Line => "a serial line",
            Self::Datagrams => "UDP",
            Self::Bus => "a CAN bus",
        }
    }
}

impl WireAction {
    /// Whether this can happen on a medium.
    #[must_use]
    pub const fn happens_on(&self, medium: Medium) -> bool {
        match self {
            Self::Flip
            | Self::Duplicate
            | Self::Reorder
            | Self::Lose
            | Self::Delay { .. }
            | Self::Replay { .. }
            | Self::Babble { .. }
            | Self::SlowReader { .. }
            | Self::HangUp { .. } => true,
            // A controller drops a frame whose bits are damaged, and says so.
            Self::Insert | Self::Drop | Self::Truncate | Self::Checksum | Self::Coalesce => {
                !matches!(medium, Medium::Bus)
            }
            Self::Split { .. } | Self::Break { .. } | Self::Framing => {
                matches!(medium, Medium::Line)
            }
            Self::ErrorFrame
            | Self::ArbitrationLost
            | Self::BusOff { .. }
            | Self::Collision
            | Self::Overload { .. } => matches!(medium, Medium::Bus),
        }
    }
}

/// What a fault has altered since it was asked last, and the checksums over all of it so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Altered {
    /// Frames.
    pub frames: u64,
    /// CRC-32 of what it was given, of the frames that it altered.
    pub clean_crc32: u32,
    /// CRC-32 of what it made of them.
    pub faulted_crc32: u32,
}

/// Somebody with a wire that can be disturbed.
pub trait Wired {
    /// A fault sets in. `handle` names it until its end.
    fn begin(&mut self, handle: u32, fault: &WireFault);
    /// A fault ends. What it holds back goes on.
    fn end(&mut self, handle: u32);
    /// What a fault has altered since this was called last.
    fn altered(&mut self, handle: u32) -> Altered;
}
