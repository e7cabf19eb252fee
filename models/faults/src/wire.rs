//! Faults of a wire: alterations of frames between the harness and a device.
//!
//! A fault is described here; the owner of the wire realises it and counts what it altered. Random
//! numbers come from the fault's own streams, counted by the frames that it sees.

use octant_random::normal::uniform;
use octant_random::philox::{StreamKey, block};

/// Direction on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Way {
    /// From the harness to the device.
    ToDevice,
    /// From the device to the harness.
    ToHarness,
}

/// Directions in which a fault acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Ways {
    /// From the harness to the device.
    pub to_device: bool,
    /// From the device to the harness.
    pub to_harness: bool,
}

impl Ways {
    /// Returns whether a direction is included.
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
    /// Directions in which it acts.
    pub ways: Ways,
    /// Share of the frames on which it acts; 1: all of them.
    pub chance: f64,
    /// Action on the frame.
    pub action: WireAction,
    /// Key of its random numbers.
    pub key: StreamKey,
}

impl WireFault {
    /// Four random numbers in (0, 1) for the `nth` frame of a direction.
    #[must_use]
    pub fn uniforms(&self, way: Way, nth: u64) -> [f64; 4] {
        block(self.key, [nth, way as u64, 0, 0]).map(uniform)
    }

    /// Decides whether the fault acts on the `nth` frame of a direction; if so, returns the random
    /// numbers for the action.
    #[must_use]
    pub fn acts_on(&self, way: Way, nth: u64) -> Option<[f64; 3]> {
        let [chance, a, b, c] = self.uniforms(way, nth);
        (self.ways.has(way) && chance < self.chance).then_some([a, b, c])
    }

    /// Random byte that isn't zero, the `i`th of the `nth` frame.
    #[must_use]
    pub fn byte(&self, way: Way, nth: u64, i: u64) -> u8 {
        let [word, ..] = block(self.key, [nth, way as u64, 1, i]);
        (word % 255) as u8 + 1
    }
}

/// Action on a frame. On a line of bytes and on UDP a frame is the unit in which one message is
/// sent; on a CAN bus it is a CAN frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum WireAction {
    /// One bit is inverted.
    Flip,
    /// A byte is inserted.
    Insert,
    /// A byte is removed.
    Drop,
    /// The end is cut off.
    Truncate,
    /// One bit of the last byte before the end, which belongs to the checksum, is inverted.
    Checksum,
    /// The frame arrives twice.
    Duplicate,
    /// The frame arrives after the next one.
    Reorder,
    /// The frame is lost.
    Lose,
    /// The frame arrives late, by a time and up to a jitter more, s.
    Delay {
        /// Smallest delay, s.
        by_s: f64,
        /// Largest additional delay, s.
        jitter_s: f64,
    },
    /// An earlier frame arrives again before this one.
    Replay {
        /// Age of the earlier frame, frames, from 1.
        age: u32,
    },
    /// The frame arrives in pieces.
    Split {
        /// Pieces, 2 or more.
        pieces: u32,
        /// Time between two pieces, s.
        apart_s: f64,
    },
    /// The frame waits for the next one, and both arrive at once.
    Coalesce,
    /// Foreign data is sent before the frame.
    Babble {
        /// Amount: bytes, on CAN frames.
        count: u32,
    },
    /// The line is held: data sent in that time is lost, and read as one zero.
    Break {
        /// Duration, s.
        lasts_s: f64,
    },
    /// One byte is read as a zero: its stop bit was missing.
    Framing,
    /// The port disappears, and returns after a time.
    HangUp {
        /// Duration, s.
        away_s: f64,
    },
    /// Nothing is read from the port for a time.
    SlowReader {
        /// Duration, s.
        pause_s: f64,
    },
    /// The controller reports an error frame.
    ErrorFrame,
    /// Arbitration is lost: the frame is sent after one from another node.
    ArbitrationLost,
    /// The controller leaves the bus, and returns after a time.
    BusOff {
        /// Duration, s.
        off_s: f64,
    },
    /// Another node sends other data under the same identifier before the frame.
    Collision,
    /// The bus is full: each frame waits for a number of others.
    Overload {
        /// Number of other frames.
        frames: u32,
        /// Duration of each of them, s.
        each_s: f64,
    },
}

/// Medium of a wire.
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
    /// Name shown to users.
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
    /// Returns whether the action can happen on a medium.
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
            // A controller discards a damaged frame and reports it.
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

/// Alterations by a fault since the last query, and the checksums over all of them so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Altered {
    /// Number of frames.
    pub frames: u64,
    /// CRC-32 of the altered frames, before.
    pub clean_crc32: u32,
    /// CRC-32 of the altered frames, after.
    pub faulted_crc32: u32,
}

/// A wire that can be disturbed.
pub trait Wired {
    /// Begins a fault. `handle` identifies it until its end.
    fn begin(&mut self, handle: u32, fault: &WireFault);
    /// Ends a fault. Frames that it holds back go on.
    fn end(&mut self, handle: u32);
    /// Alterations by a fault since the last call.
    fn altered(&mut self, handle: u32) -> Altered;
}
