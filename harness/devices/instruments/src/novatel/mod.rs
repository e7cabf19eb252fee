//! NovAtel SPAN: the logs `RAWIMUSX` and `RAWIMUX`, binary and ASCII.
//!
//! The binary form of `RAWIMUSX` has the short header: `0xAA 0x44 0x13`, length of the data, message, week and
//! milliseconds of GPS time; that of `RAWIMUX` the long one: `0xAA 0x44 0x12`, length of the header, message,
//! and the length of the data among others. Then come the data and a CRC-32, all little-endian. The ASCII form
//! is a line from `%`, or `#` with the long header, to `*`, with the same CRC as eight hexadecimal digits, and
//! ends with CR and LF. All have the kind of unit that is connected, and raw increments as integers, whose scale depends on that kind
//! ([`scale_of`]): z, −y, x of velocity and of rotation, in the axes of the unit. Stamps are GPS week
//! and seconds. Readings have neither number nor interval.
//!
//! Other logs pass as frames without a reading, up to the length of the longest log with the short header. The
//! bytes of longer ones count as lost.

pub(crate) mod ascii;
mod scale;

pub use ascii::{RawImu, write_line};
pub use scale::{CountScale, scale_of};

use super::framing::ProtocolFacts;
use crate::bytes::{Frame, Reader};
use crate::carry::Carry;
use crate::checksum;
use crate::encoding::{CannotCarry, Needs};
use crate::framing::{Extent, Framing, ReadingDefect};
use crate::{MeasuredTriad, Reading, ReadingKind, Stamp, StampClock};
use octant_sample::Status;

pub(crate) const SYNC: [u8; 3] = [0xAA, 0x44, 0x13];
const SYNC_LONG: [u8; 3] = [0xAA, 0x44, 0x12];
/// Size of sync, length, message, week and milliseconds.
const HEADER_BYTES: usize = 12;
/// Size of the long header; later versions may append to it.
const LONG_HEADER_BYTES: usize = 28;
/// Bytes of the long header up to the length of the data.
const LONG_LENGTH_BYTES: usize = 10;
const CRC_BYTES: usize = 4;
/// Most bytes of a frame: the length of the data has one byte, and lines are shorter.
const MAX_BYTES: usize = HEADER_BYTES + 255 + CRC_BYTES;
const RAWIMUX: u16 = 1461;
const RAWIMUSX: u16 = 1462;
/// Size of the data of both.
const RAWIMUSX_BYTES: usize = 40;

// Bits of the IMU info.
const ERROR: u8 = 1 << 0;
const ENCRYPTED: u8 = 1 << 1;

/// Name of the field that tells the kind of unit, in defects.
pub const IMU_TYPE: &str = "IMU type";

/// Duration of a week, ns.
pub(crate) const WEEK_NS: u64 = 604_800_000_000_000;

/// Facts of the protocol: the counts are 2⁻³³ rad and 2⁻²⁹ m/s.
pub(crate) const FACTS: ProtocolFacts = ProtocolFacts {
    name: "novatel",
    doc: "NovAtel's RAWIMUSX or RAWIMUX, binary or ASCII",
    resolution: [1.2e-10, 1.9e-9],
    false_starts: &[
        &[0xAA],
        &[0xAA, 0x44, 0x13, 0xFF],
        &[0xAA, 0x44, 0x12, 28, 0, 0, 0, 0, 100, 0],
        b"%",
        b"%RAWIMUSXA,",
        b"#RAWIMUXA,",
    ],
};

/// NovAtel's protocol.
#[derive(Clone, Copy, Debug, Default)]
pub struct NovAtel {
    /// Size of a count, if the kind of unit doesn't determine it. `None`: by the kind.
    pub scale: Option<CountScale>,
}

/// Finds readings in a stream of bytes.
pub type NovatelDecoder = crate::framing::FrameDecoder<NovAtel>;

impl Framing for NovAtel {
    type Found = Reading;
    type Room = [u8; MAX_BYTES];
    const EMPTY: Self::Room = [0; MAX_BYTES];

    #[inline]
    fn begins(&self, byte: u8) -> bool {
        byte == SYNC[0] || ascii::begins(byte)
    }

    #[inline]
    fn extent(&self, bytes: &[u8]) -> Extent {
        extent(bytes, MAX_BYTES)
    }

    #[inline]
    fn read(&mut self, frame: &[u8]) -> Result<Option<Reading>, ReadingDefect> {
        let raw =
            if frame.first() == Some(&SYNC[0]) { binary(frame)? } else { ascii::read(frame)? };
        match raw {
            Some(raw) => self.reading(&raw).map(Some),
            None => Ok(None),
        }
    }
}

/// Extent of a binary frame or a line of at most so many bytes.
#[inline]
pub(crate) fn extent(bytes: &[u8], most: usize) -> Extent {
    let Some(first) = bytes.first() else { return Extent::Open(4) };
    if ascii::begins(*first) {
        return ascii::extent(bytes, most);
    }
    let is_start = |sync: [u8; 3]| bytes.iter().zip(sync).all(|(byte, sync)| *byte == sync);
    match bytes.get(3) {
        Some(length) if is_start(SYNC) => {
            Extent::Bytes(HEADER_BYTES + usize::from(*length) + CRC_BYTES)
        }
        Some(header) if is_start(SYNC_LONG) => long_extent(bytes, usize::from(*header), most),
        None if is_start(SYNC) || is_start(SYNC_LONG) => Extent::Open(4 - bytes.len()),
        _ => Extent::None,
    }
}

/// Extent of a frame with a long header of this length.
fn long_extent(bytes: &[u8], header: usize, most: usize) -> Extent {
    if header < LONG_HEADER_BYTES {
        return Extent::None;
    }
    match bytes.get(LONG_LENGTH_BYTES - 2..LONG_LENGTH_BYTES) {
        None => Extent::Open(LONG_LENGTH_BYTES - bytes.len()),
        Some(length) => {
            let data = usize::from(u16::from_le_bytes([length[0], length[1]]));
            match header + data + CRC_BYTES {
                total if total <= most => Extent::Bytes(total),
                _ => Extent::None,
            }
        }
    }
}

/// A binary frame with the right checksum.
pub(crate) struct BinaryLog<'a> {
    /// True if its header is the long one.
    pub(crate) long: bool,
    pub(crate) message: u16,
    /// Week, and milliseconds of the week.
    pub(crate) time: (u16, u32),
    pub(crate) data: &'a [u8],
}

/// Takes a binary frame apart.
#[inline]
pub(crate) fn checked(frame: &[u8]) -> Result<BinaryLog<'_>, ReadingDefect> {
    let (bare, crc) = frame.split_last_chunk::<CRC_BYTES>().ok_or(ReadingDefect::Malformed)?;
    let (found, computed) = (u32::from_le_bytes(*crc), checksum::novatel(bare));
    if found != computed {
        return Err(ReadingDefect::Checksum { found, computed });
    }
    let (header, time_at) = match bare {
        [_, _, sync, header, ..] if *sync == SYNC_LONG[2] => (usize::from(*header), 14),
        _ => (HEADER_BYTES, 6),
    };
    let (head, data) = bare.split_at_checked(header).ok_or(ReadingDefect::Malformed)?;
    let mut fields = Reader::new(head);
    fields.skip(4);
    let message = fields.u16_le();
    fields.skip(time_at - 6);
    let time = (fields.u16_le(), fields.u32_le());
    Ok(BinaryLog { long: time_at == 14, message, time, data })
}

/// Reads the log from a binary frame.
fn binary(frame: &[u8]) -> Result<Option<RawImu>, ReadingDefect> {
    let BinaryLog { long, message, data, .. } = checked(frame)?;
    if message != if long { RAWIMUX } else { RAWIMUSX } {
        return Ok(None);
    }
    if data.len() != RAWIMUSX_BYTES {
        let found = data.len() as u32;
        return Err(ReadingDefect::Unknown { field: "length of the log", found });
    }
    let data = &mut Reader::new(data);
    Ok(Some(RawImu {
        info: data.u8_le(),
        kind: data.u8_le(),
        week: data.u16_le(),
        seconds: data.f64_le(),
        status: data.u32_le(),
        velocity: data.three(Reader::i32_le),
        rotation: data.three(Reader::i32_le),
    }))
}

/// Reorders z, −y, x to x, y, z.
fn xyz([z, minus_y, x]: [i32; 3]) -> [i32; 3] {
    [x, minus_y.saturating_neg(), z]
}

impl NovAtel {
    #[inline]
    fn reading(&self, raw: &RawImu) -> Result<Reading, ReadingDefect> {
        let scale = self
            .scale
            .or_else(|| scale_of(raw.kind))
            .ok_or(ReadingDefect::Unknown { field: IMU_TYPE, found: raw.kind.into() })?;
        if !(0.0..=604_800.0).contains(&raw.seconds) {
            return Err(ReadingDefect::Unknown {
                field: "second of the week",
                found: raw.seconds as u32,
            });
        }
        let counts =
            |counts, lsb| Some(MeasuredTriad::counts(ReadingKind::Increment, xyz(counts), lsb));
        let ns = u64::from(raw.week) * WEEK_NS + libm::rint(raw.seconds * 1e9) as u64;
        let mut status = Status::empty();
        status.set(Status::INERTIAL_INVALID, raw.info & (ERROR | ENCRYPTED) != 0);
        Ok(Reading {
            rotation: counts(raw.rotation, scale.rotation_rad),
            velocity: counts(raw.velocity, scale.velocity_mps),
            stamp: Some(Stamp { ns, clock: StampClock::Gps }),
            status,
            status_word: Some(raw.status),
            ..Reading::NOTHING
        })
    }
}

/// Encodes readings as binary frames of `RAWIMUSX`, or as lines.
#[derive(Clone, Debug)]
pub struct NovatelEncoder {
    kind: u8,
    scale: CountScale,
    frame: Frame<MAX_BYTES>,
    rotation: Carry,
    velocity: Carry,
}

impl Default for NovatelEncoder {
    /// Makes an encoder for an HG4930, which has the finest counts.
    fn default() -> Self {
        const KIND: u8 = 58;
        const SCALE: CountScale = match scale_of(KIND) {
            Some(scale) => scale,
            None => panic!("the kind is in the table"),
        };
        Self::new(KIND, SCALE)
    }
}

impl NovatelEncoder {
    /// Makes an encoder for a kind of unit and the size of its counts ([`scale_of`]).
    #[must_use]
    pub const fn new(kind: u8, scale: CountScale) -> Self {
        let (rotation, velocity) = (Carry::new(), Carry::new());
        Self { kind, scale, frame: Frame::new(), rotation, velocity }
    }

    /// Encodes a reading as a binary frame, and carries the remainder of its counts to the next
    /// reading. A stamp that isn't GPS time is sent as if it were.
    ///
    /// # Errors
    /// If the reading lacks rotation, velocity or stamp, has means without an interval, or has a stamp
    /// after the last week.
    pub fn encode(&mut self, reading: &Reading) -> Result<&[u8], CannotCarry> {
        let raw = self.raw(reading)?;
        let frame = &mut self.frame;
        frame.clear();
        frame.put(&SYNC);
        frame.put(&[RAWIMUSX_BYTES as u8]);
        frame.put(&RAWIMUSX.to_le_bytes());
        frame.put(&raw.week.to_le_bytes());
        frame.put(&(libm::rint(raw.seconds * 1e3) as u32).to_le_bytes());
        frame.put(&[raw.info, raw.kind]);
        frame.put(&raw.week.to_le_bytes());
        frame.put(&raw.seconds.to_le_bytes());
        frame.put(&raw.status.to_le_bytes());
        for count in raw.velocity.into_iter().chain(raw.rotation) {
            frame.put(&count.to_le_bytes());
        }
        let crc = checksum::novatel(frame.bytes());
        frame.put(&crc.to_le_bytes());
        Ok(frame.bytes())
    }

    /// Encodes a reading as a line, like [`NovatelEncoder::encode`]; the stamp has nine decimals.
    ///
    /// # Errors
    /// As [`NovatelEncoder::encode`].
    pub fn encode_line(&mut self, reading: &Reading) -> Result<&[u8], CannotCarry> {
        let raw = self.raw(reading)?;
        self.frame.clear();
        // The buffer has room for the longest line.
        let _ = write_line(&raw, &mut self.frame);
        let crc = checksum::novatel(&self.frame.bytes()[1..]);
        let _ = core::fmt::write(&mut self.frame, format_args!("*{crc:08x}\r\n"));
        Ok(self.frame.bytes())
    }

    fn raw(&mut self, reading: &Reading) -> Result<RawImu, CannotCarry> {
        let needs = Needs("NovAtel");
        let ns = needs.some(reading.stamp, "a stamp")?.ns;
        let week = u16::try_from(ns / WEEK_NS).ok();
        let week = needs.some(week, "a stamp before week 65536")?;
        let interval_s = reading.interval_s;
        let rotation = needs.increments(reading.rotation, interval_s, "rotation")?;
        let velocity = needs.increments(reading.velocity, interval_s, "velocity")?;
        let sent = |[x, y, z]: [i32; 3]| [z, y.saturating_neg(), x];
        let invalid = reading.status.contains(Status::INERTIAL_INVALID);
        Ok(RawImu {
            info: if invalid { ERROR } else { 0 },
            kind: self.kind,
            week,
            seconds: (ns % WEEK_NS) as f64 * 1e-9,
            status: reading.status_word.unwrap_or(0),
            velocity: sent(self.velocity.counts(velocity, self.scale.velocity_mps)),
            rotation: sent(self.rotation.counts(rotation, self.scale.rotation_rad)),
        })
    }
}
