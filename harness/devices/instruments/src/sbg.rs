//! SBG Systems' sbgECom: Ellipse, Ekinox, Apogee, Pulse.
//!
//! A frame is `0xFF 0x5A`, message, class, a length of two bytes, data, a CRC-16 over message to data,
//! and `0x33`; everything is little-endian. The decoder uses, of class 0, `SBG_ECOM_LOG_IMU_SHORT` (44)
//! and the older `SBG_ECOM_LOG_IMU_DATA` (3).
//!
//! Delta velocity and delta angle of both are the increments of the unit's coning and sculling
//! algorithm, divided by its interval: m/s² and rad/s. So a reading has means that include coning and
//! sculling, and the interval, which isn't sent, turns them into increments. Stamps are microseconds in
//! 32 bits, which roll over every 71.6 minutes. Readings have no number.

use super::framing::ProtocolFacts;
use crate::bytes::{Frame, Reader};
use crate::carry::Carry;
use crate::checksum;
use crate::encoding::{CannotCarry, Needs};
use crate::framing::{Extent, Framing, ReadingDefect};
use crate::rollover::Rollover;
use crate::{MeasuredTriad, Reading, ReadingKind, Stamp, StampClock};
use octant_sample::Status;

const SYNC: [u8; 2] = [0xFF, 0x5A];
const END: u8 = 0x33;
/// Size of sync, message, class and length.
const HEADER_BYTES: usize = 6;
/// Size of CRC and end.
const TAIL_BYTES: usize = 3;
/// Most data bytes of the protocol.
const MAX_DATA_BYTES: usize = 4086;
pub(crate) const MAX_BYTES: usize = HEADER_BYTES + MAX_DATA_BYTES + TAIL_BYTES;

pub(crate) const CLASS_LOG: u8 = 0;
const IMU_DATA: u8 = 3;
const IMU_SHORT: u8 = 44;
const IMU_DATA_BYTES: usize = 58;
const IMU_SHORT_BYTES: usize = 32;

/// Sizes of a count of `IMU_SHORT`.
const ACCELERATION_LSB_MPS2: f64 = 1.0 / 1_048_576.0;
const RATE_LSB_RADPS: f64 = 1.0 / 67_108_864.0;
const RATE_HIGH_LSB_RADPS: f64 = 1.0 / 12_304_174.0;
const TEMPERATURE_LSB_C: f32 = 1.0 / 256.0;

// Bits of the status: all but the last are set in good condition.
const COM_OK: u16 = 1 << 0;
const STATUS_OK: u16 = 1 << 1;
const ACCELEROMETERS_OK: u16 = 0b111 << 2;
const GYROS_OK: u16 = 0b111 << 5;
const ACCELEROMETERS_IN_RANGE: u16 = 1 << 8;
const GYROS_IN_RANGE: u16 = 1 << 9;
const GYROS_USE_HIGH_SCALE: u16 = 1 << 10;
/// Bits that are set if the inertial values are valid.
const USABLE: u16 = COM_OK | STATUS_OK | ACCELEROMETERS_OK | GYROS_OK;

/// Facts of the protocol: the counts are 2⁻²⁶ rad/s and 2⁻²⁰ m/s², times the interval.
pub(crate) const FACTS: ProtocolFacts = ProtocolFacts {
    name: "sbg",
    doc: "SBG's sbgECom, IMU_SHORT or IMU_DATA",
    resolution: [7.5e-11, 4.8e-9],
    false_starts: &[&[0xFF], &[0xFF, 0x5A, 0x2C, 0x00, 0xF6, 0x0F], &[0xFF, 0xFF, 0x5A]],
};

/// SBG's protocol, with the state of its clock.
#[derive(Clone, Copy, Debug)]
pub struct Sbg {
    clock: Rollover,
}

impl Default for Sbg {
    fn default() -> Self {
        Self { clock: Rollover::new(32) }
    }
}

/// Finds readings in a stream of bytes.
pub type SbgDecoder = crate::framing::FrameDecoder<Sbg>;

impl Framing for Sbg {
    type Found = Reading;
    type Room = [u8; MAX_BYTES];
    const EMPTY: Self::Room = [0; MAX_BYTES];

    #[inline]
    fn begins(&self, byte: u8) -> bool {
        byte == SYNC[0]
    }

    #[inline]
    fn extent(&self, bytes: &[u8]) -> Extent {
        match bytes.get(1) {
            None => return Extent::Open(1),
            Some(second) if *second != SYNC[1] => return Extent::None,
            Some(_) => {}
        }
        let Some(length) = bytes.get(4..HEADER_BYTES) else {
            return Extent::Open(HEADER_BYTES - bytes.len());
        };
        let length = usize::from(u16::from_le_bytes([length[0], length[1]]));
        if length > MAX_DATA_BYTES {
            return Extent::None;
        }
        Extent::Bytes(HEADER_BYTES + length + TAIL_BYTES)
    }

    #[inline]
    fn read(&mut self, frame: &[u8]) -> Result<Option<Reading>, ReadingDefect> {
        let ((class, message), data) = checked(frame)?;
        let fields = &mut Reader::new(data);
        let unknown = |field, found: usize| ReadingDefect::Unknown { field, found: found as u32 };
        let mut reading = Reading::NOTHING;
        let (micros, status) = match (class, message) {
            (CLASS_LOG, IMU_SHORT) => {
                if data.len() != IMU_SHORT_BYTES {
                    return Err(unknown("length of IMU_SHORT", data.len()));
                }
                let head = (fields.u32_le(), fields.u16_le());
                let high = head.1 & GYROS_USE_HIGH_SCALE != 0;
                let rate_lsb = if high { RATE_HIGH_LSB_RADPS } else { RATE_LSB_RADPS };
                let mut counts = |lsb| {
                    Some(MeasuredTriad::counts(
                        ReadingKind::Mean,
                        fields.three(Reader::i32_le),
                        lsb,
                    ))
                };
                reading.velocity = counts(ACCELERATION_LSB_MPS2);
                reading.rotation = counts(rate_lsb);
                let temperature = f32::from(fields.i16_le());
                reading.temperature_c = Some(temperature * TEMPERATURE_LSB_C);
                head
            }
            (CLASS_LOG, IMU_DATA) => {
                if data.len() != IMU_DATA_BYTES {
                    return Err(unknown("length of IMU_DATA", data.len()));
                }
                let head = (fields.u32_le(), fields.u16_le());
                // The instantaneous values at the stamp are skipped, because the means are better.
                fields.skip(24);
                reading.temperature_c = Some(fields.f32_le());
                let mut mean =
                    || Some(MeasuredTriad::mean(fields.three(|fields| f64::from(fields.f32_le()))));
                reading.velocity = mean();
                reading.rotation = mean();
                head
            }
            _ => return Ok(None),
        };
        let ns = self.clock.continued(micros.into()).saturating_mul(1000);
        reading.stamp = Some(Stamp { ns, clock: StampClock::Startup });
        reading.status_word = Some(status.into());
        let out = |bit: u16| status & bit == 0;
        reading.status.set(Status::ACCELEROMETER_SATURATED, out(ACCELEROMETERS_IN_RANGE));
        reading.status.set(Status::GYRO_SATURATED, out(GYROS_IN_RANGE));
        reading.status.set(Status::INERTIAL_INVALID, status & USABLE != USABLE);
        Ok(Some(reading))
    }
}

/// Class, message and data of a frame with the right checksum.
#[inline]
pub(crate) fn checked(frame: &[u8]) -> Result<((u8, u8), &[u8]), ReadingDefect> {
    let (bare, tail) = frame.split_last_chunk::<TAIL_BYTES>().ok_or(ReadingDefect::Malformed)?;
    if tail[2] != END {
        return Err(ReadingDefect::Malformed);
    }
    let found = u16::from_le_bytes([tail[0], tail[1]]);
    let computed = checksum::sbg(bare.get(2..).unwrap_or_default());
    if found != computed {
        return Err(ReadingDefect::Checksum { found: found.into(), computed: computed.into() });
    }
    let (head, data) = bare.split_at_checked(HEADER_BYTES).ok_or(ReadingDefect::Malformed)?;
    Ok(((head[3], head[2]), data))
}

/// Encodes readings as frames of `IMU_SHORT`.
#[derive(Clone, Debug)]
pub struct SbgEncoder {
    frame: Frame<{ HEADER_BYTES + IMU_SHORT_BYTES + TAIL_BYTES }>,
    rotation: Carry,
    velocity: Carry,
}

impl Default for SbgEncoder {
    fn default() -> Self {
        Self::new()
    }
}

impl SbgEncoder {
    /// Makes an encoder that has sent nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self { frame: Frame::new(), rotation: Carry::new(), velocity: Carry::new() }
    }

    /// Encodes a reading as a frame, and carries the remainder of its counts to the next reading; the
    /// stamp is truncated to a microsecond.
    ///
    /// # Errors
    /// If the reading lacks rotation, velocity or stamp, or has increments without an interval.
    pub fn encode(&mut self, reading: &Reading) -> Result<&[u8], CannotCarry> {
        let needs = Needs("SBG");
        let stamp = needs.some(reading.stamp, "a stamp")?;
        let rotation = needs.means(reading.rotation, reading.interval_s, "rotation")?;
        let velocity = needs.means(reading.velocity, reading.interval_s, "velocity")?;
        let mut status = USABLE | ACCELEROMETERS_IN_RANGE | GYROS_IN_RANGE;
        let mut clear = |flag, bits: u16| {
            if reading.status.contains(flag) {
                status &= !bits;
            }
        };
        clear(Status::INERTIAL_INVALID, STATUS_OK);
        clear(Status::GYRO_SATURATED, GYROS_IN_RANGE);
        clear(Status::ACCELEROMETER_SATURATED, ACCELEROMETERS_IN_RANGE);
        let mut rate_lsb = RATE_LSB_RADPS;
        // Beyond 1833 °/s the unit uses another scale.
        let most = f64::from(i32::MAX) * RATE_LSB_RADPS;
        if rotation.iter().any(|rate| rate.abs() >= most) {
            status |= GYROS_USE_HIGH_SCALE;
            rate_lsb = RATE_HIGH_LSB_RADPS;
        }
        let velocity = self.velocity.counts(velocity, ACCELERATION_LSB_MPS2);
        let rotation = self.rotation.counts(rotation, rate_lsb);
        let temperature = reading.temperature_c.unwrap_or(0.0) / TEMPERATURE_LSB_C;
        let frame = &mut self.frame;
        frame.clear();
        frame.put(&SYNC);
        frame.put(&[IMU_SHORT, CLASS_LOG]);
        frame.put(&(IMU_SHORT_BYTES as u16).to_le_bytes());
        // The clock rolls over.
        frame.put(&((stamp.ns / 1000) as u32).to_le_bytes());
        frame.put(&status.to_le_bytes());
        for count in velocity.into_iter().chain(rotation) {
            frame.put(&count.to_le_bytes());
        }
        frame.put(&(libm::rintf(temperature) as i16).to_le_bytes());
        let crc = checksum::sbg(&frame.bytes()[2..]);
        frame.put(&crc.to_le_bytes());
        frame.put(&[END]);
        Ok(frame.bytes())
    }
}
