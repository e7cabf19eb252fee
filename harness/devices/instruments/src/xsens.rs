//! Xsens' MTData2: MTi of the 1, 10, 100 and 600 series.
//!
//! A frame is `0xFA 0xFF 0x36`, a length of one byte (`0xFF` and two bytes where it is longer), packets
//! of data, and a byte that makes the sum of all but the first zero; numbers are big-endian. A packet is
//! an identifier of 16 bits, a length and data; the low bits of the identifier choose the precision:
//! float, double, or fixed point with 12.20 or 16.32 bits.
//!
//! The decoder uses `DeltaQ` and `DeltaV`, else `RateOfTurn` and `Acceleration`, else those with `HR`;
//! packet counter, `SampleTimeFine` (0.1 ms), status word and temperature. `DeltaQ` becomes its
//! rotation vector. The interval isn't sent. The packet counter counts every frame; readings are
//! numbered without the frames that hold none, such as those with satellite data alone.
//!
//! The checksum is one byte, so that one damaged frame in 256 passes it. So the packets have to fill
//! the frame exactly, and each must have the length of its kind: only damage inside a number can go
//! unnoticed.

use super::framing::ProtocolFacts;
use crate::bytes::{Frame, Reader};
use crate::carry::Carry;
use crate::checksum;
use crate::encoding::{CannotCarry, Needs};
use crate::framing::{Extent, Framing, ReadingDefect};
use crate::rollover::Rollover;
use crate::{MeasuredTriad, Reading, Stamp, StampClock};
use octant_sample::Status;

const HEAD: [u8; 3] = [0xFA, 0xFF, 0x36];
/// Most data bytes of the protocol.
const MAX_DATA_BYTES: usize = 2048;
pub(crate) const MAX_BYTES: usize = 6 + MAX_DATA_BYTES + 1;

// Identifiers without the bits of precision and coordinates.
const TEMPERATURE: u16 = 0x0810;
const PACKET_COUNTER: u16 = 0x1020;
pub(crate) const SAMPLE_TIME_FINE: u16 = 0x1060;
const DELTA_V: u16 = 0x4010;
const ACCELERATION: u16 = 0x4020;
const ACCELERATION_HR: u16 = 0x4040;
const RATE_OF_TURN: u16 = 0x8020;
const DELTA_Q: u16 = 0x8030;
const RATE_OF_TURN_HR: u16 = 0x8040;
const STATUS_BYTE: u16 = 0xE010;
pub(crate) const STATUS_WORD: u16 = 0xE020;

/// Size of a count of `SampleTimeFine`, ns.
pub(crate) const FINE_NS: u64 = 100_000;

/// Bits of the status word for accelerometers and gyros out of range.
const CLIPPED_ACCELEROMETER: u32 = 0b111 << 8;
const CLIPPED_GYRO: u32 = 0b111 << 11;

/// Facts of the protocol. Floats have 24 bits, of up to 0.1 rad and 1 m/s; the carried remainder adds
/// the same error again.
pub(crate) const FACTS: ProtocolFacts = ProtocolFacts {
    name: "xsens",
    doc: "Xsens' MTData2",
    resolution: [1.2e-8, 1.2e-7],
    false_starts: &[
        &[0xFA],
        &[0xFA, 0xFF],
        &[0xFA, 0xFF, 0x36, 0xFF, 0x07, 0xFF],
        &[0xFA, 0xFF, 0x36, 0xFE],
    ],
};

/// Xsens' protocol, with the state of its counters.
#[derive(Clone, Copy, Debug)]
pub struct Xsens {
    counter: Rollover,
    /// Frames without a reading that advanced the counter.
    others: u64,
    fine: Rollover,
}

impl Default for Xsens {
    fn default() -> Self {
        Self { counter: Rollover::new(16), others: 0, fine: Rollover::new(32) }
    }
}

/// Finds readings in a stream of bytes.
pub type XsensDecoder = crate::framing::FrameDecoder<Xsens>;

impl Xsens {
    /// Number of a frame among those with a reading. The unit counts every frame that it sends, so one
    /// with satellite data alone would look like a lost reading.
    fn sequence(&mut self, counter: u16, is_inertial: bool) -> u64 {
        let before = self.counter.last();
        let now = self.counter.continued(counter.into());
        if !is_inertial && before.is_some_and(|before| now > before) {
            self.others += 1;
        }
        // A unit that was switched on anew counts from a value below the frames left out so far.
        self.others = self.others.min(now);
        now - self.others
    }
}

/// Format of a packet's numbers.
#[derive(Clone, Copy)]
pub(crate) enum Precision {
    Float,
    Fixed12,
    Fixed16,
    Double,
}

impl Precision {
    pub(crate) fn of(identifier: u16) -> Self {
        match identifier & 3 {
            0 => Self::Float,
            1 => Self::Fixed12,
            2 => Self::Fixed16,
            _ => Self::Double,
        }
    }

    pub(crate) fn bytes(self) -> usize {
        match self {
            Self::Float | Self::Fixed12 => 4,
            Self::Fixed16 => 6,
            Self::Double => 8,
        }
    }

    pub(crate) fn number(self, data: &mut Reader<'_>) -> f64 {
        match self {
            Self::Float => f64::from(data.f32_be()),
            Self::Fixed12 => f64::from(data.i32_be()) / f64::from(1 << 20),
            // The fraction comes first.
            Self::Fixed16 => {
                let fraction = data.u32_be();
                f64::from(data.i16_be()) + f64::from(fraction) / (1u64 << 32) as f64
            }
            Self::Double => data.f64_be(),
        }
    }
}

impl Framing for Xsens {
    type Found = Reading;
    type Room = [u8; MAX_BYTES];
    const EMPTY: Self::Room = [0; MAX_BYTES];

    #[inline]
    fn begins(&self, byte: u8) -> bool {
        byte == HEAD[0]
    }

    #[inline]
    fn extent(&self, bytes: &[u8]) -> Extent {
        let known = bytes.len().min(3);
        if bytes[..known] != HEAD[..known] {
            return Extent::None;
        }
        match bytes.get(3) {
            None => Extent::Open(4 - bytes.len()),
            Some(0xFF) => match bytes.get(4..6) {
                None => Extent::Open(6 - bytes.len()),
                Some(long) => {
                    let length = usize::from(u16::from_be_bytes([long[0], long[1]]));
                    if length > MAX_DATA_BYTES {
                        return Extent::None;
                    }
                    Extent::Bytes(6 + length + 1)
                }
            },
            Some(length) => Extent::Bytes(4 + usize::from(*length) + 1),
        }
    }

    #[inline]
    fn read(&mut self, frame: &[u8]) -> Result<Option<Reading>, ReadingDefect> {
        let found = Found::read(checked(frame)?).ok_or(ReadingDefect::Malformed)?;
        let mut reading = Reading {
            rotation: found.delta_q.map(rotation).or(found.rate).or(found.rate_hr),
            velocity: found.delta_v.or(found.acceleration).or(found.acceleration_hr),
            status_word: found.status_word.or(found.status_byte.map(u32::from)),
            temperature_c: found.temperature_c,
            ..Reading::NOTHING
        };
        let is_inertial = reading.is_inertial();
        reading.sequence = found.counter.map(|counter| self.sequence(counter, is_inertial));
        if !is_inertial {
            return Ok(None);
        }
        reading.stamp = found.fine.map(|fine| Stamp {
            ns: self.fine.continued(fine.into()).saturating_mul(FINE_NS),
            clock: StampClock::Startup,
        });
        if let Some(word) = found.status_word {
            reading.status.set(Status::GYRO_SATURATED, word & CLIPPED_GYRO != 0);
            let clipped = word & CLIPPED_ACCELEROMETER != 0;
            reading.status.set(Status::ACCELEROMETER_SATURATED, clipped);
        }
        Ok(Some(reading))
    }
}

/// Packets of a frame with the right checksum.
#[inline]
pub(crate) fn checked(frame: &[u8]) -> Result<&[u8], ReadingDefect> {
    let (checksum, summed) = frame.split_last().ok_or(ReadingDefect::Malformed)?;
    let computed = checksum::sum(summed.get(1..).unwrap_or_default()).wrapping_neg();
    if *checksum != computed {
        return Err(ReadingDefect::Checksum {
            found: (*checksum).into(),
            computed: computed.into(),
        });
    }
    let data = if frame.get(3) == Some(&0xFF) { 6 } else { 4 };
    summed.get(data..).ok_or(ReadingDefect::Malformed)
}

/// Packets of a frame that the decoder uses.
#[derive(Default)]
struct Found {
    counter: Option<u16>,
    fine: Option<u32>,
    delta_q: Option<[f64; 4]>,
    delta_v: Option<MeasuredTriad>,
    rate: Option<MeasuredTriad>,
    rate_hr: Option<MeasuredTriad>,
    acceleration: Option<MeasuredTriad>,
    acceleration_hr: Option<MeasuredTriad>,
    status_byte: Option<u8>,
    status_word: Option<u32>,
    temperature_c: Option<f32>,
}

/// Takes the next packet of a frame: its identifier and data.
#[inline]
pub(crate) fn packet<'a>(rest: &mut &'a [u8]) -> Option<(u16, &'a [u8])> {
    let (head, tail) = rest.split_first_chunk::<3>()?;
    let (data, tail) = tail.split_at_checked(usize::from(head[2]))?;
    *rest = tail;
    Some((u16::from_be_bytes([head[0], head[1]]), data))
}

impl Found {
    /// Reads the packets; `None` if they don't fill the data, or one doesn't have the length of its
    /// kind.
    fn read(mut rest: &[u8]) -> Option<Self> {
        let mut found = Self::default();
        while !rest.is_empty() {
            let (identifier, data) = packet(&mut rest)?;
            let precision = Precision::of(identifier);
            let is = |bytes: usize| (data.len() == bytes).then_some(());
            let data_reader = &mut Reader::new(data);
            let mut three = |kind: fn([f64; 3]) -> MeasuredTriad| {
                is(3 * precision.bytes())?;
                Some(kind(data_reader.three(|data| precision.number(data))))
            };
            match identifier & 0xFFF0 {
                PACKET_COUNTER => {
                    is(2)?;
                    found.counter = Some(data_reader.u16_be());
                }
                SAMPLE_TIME_FINE => {
                    is(4)?;
                    found.fine = Some(data_reader.u32_be());
                }
                DELTA_V => found.delta_v = Some(three(MeasuredTriad::increment)?),
                ACCELERATION => found.acceleration = Some(three(MeasuredTriad::mean)?),
                ACCELERATION_HR => found.acceleration_hr = Some(three(MeasuredTriad::mean)?),
                RATE_OF_TURN => found.rate = Some(three(MeasuredTriad::mean)?),
                RATE_OF_TURN_HR => found.rate_hr = Some(three(MeasuredTriad::mean)?),
                DELTA_Q => {
                    is(4 * precision.bytes())?;
                    let q = core::array::from_fn(|_| precision.number(data_reader));
                    found.delta_q = Some(q);
                }
                STATUS_BYTE => {
                    is(1)?;
                    found.status_byte = Some(data_reader.u8_be());
                }
                STATUS_WORD => {
                    is(4)?;
                    found.status_word = Some(data_reader.u32_be());
                }
                TEMPERATURE => {
                    is(precision.bytes())?;
                    found.temperature_c = Some(precision.number(data_reader) as f32);
                }
                _ => {}
            }
        }
        Some(found)
    }
}

/// Rotation vector of a quaternion, scalar first, whose norm may differ from one by rounding.
fn rotation(q: [f64; 4]) -> MeasuredTriad {
    let [w, v @ ..] = q;
    // q and −q are the same rotation: take the shorter one.
    let sign = if w < 0.0 { -1.0 } else { 1.0 };
    let norm = libm::sqrt(v.iter().map(|v| v * v).sum());
    // 2·atan2(n, w)/n, whose limit is 2/w.
    let factor =
        if norm > 1e-9 { 2.0 * libm::atan2(norm, w * sign) / norm } else { 2.0 / (w * sign) };
    MeasuredTriad::increment(v.map(|v| sign * factor * v))
}

/// Quaternion of a rotation vector, scalar first.
fn quaternion(vector: [f64; 3]) -> [f64; 4] {
    let angle = libm::sqrt(vector.iter().map(|v| v * v).sum());
    let factor = if angle > 1e-9 { libm::sin(0.5 * angle) / angle } else { 0.5 };
    let [x, y, z] = vector.map(|v| factor * v);
    [libm::cos(0.5 * angle), x, y, z]
}

/// Encodes readings as a unit does that is configured for packet counter, `SampleTimeFine`, `DeltaQ`
/// and `DeltaV` as floats, temperature and status word.
#[derive(Clone, Debug)]
pub struct XsensEncoder {
    frame: Frame<80>,
    rotation: Carry,
    velocity: Carry,
}

impl Default for XsensEncoder {
    fn default() -> Self {
        Self::new()
    }
}

impl XsensEncoder {
    /// Makes an encoder that has sent nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self { frame: Frame::new(), rotation: Carry::new(), velocity: Carry::new() }
    }

    /// Encodes a reading as a frame, and carries the remainder of the 32-bit floats to the next
    /// reading; the stamp is truncated to 0.1 ms.
    ///
    /// # Errors
    /// If the reading lacks rotation, velocity, sequence or stamp, or has means without an interval.
    pub fn encode(&mut self, reading: &Reading) -> Result<&[u8], CannotCarry> {
        let needs = Needs("Xsens");
        let sequence = needs.some(reading.sequence, "a sequence number")?;
        let stamp = needs.some(reading.stamp, "a stamp")?;
        let interval_s = reading.interval_s;
        let rotation_meant = needs.increments(reading.rotation, interval_s, "rotation")?;
        let velocity = needs.increments(reading.velocity, interval_s, "velocity")?;
        let mut word = 0;
        if reading.status.contains(Status::GYRO_SATURATED) {
            word |= CLIPPED_GYRO;
        }
        if reading.status.contains(Status::ACCELEROMETER_SATURATED) {
            word |= CLIPPED_ACCELEROMETER;
        }
        let q = self.rotation.send(rotation_meant, |meant| {
            let q = quaternion(meant).map(|number| number as f32);
            (q, rotation(q.map(f64::from)).value)
        });
        let v = self.velocity.floats(velocity, 1.0);
        let frame = &mut self.frame;
        frame.clear();
        frame.put(&HEAD);
        frame.put(&[0]);
        let mut packet = |identifier: u16, numbers: &[&[u8]]| {
            let bytes: usize = numbers.iter().map(|number| number.len()).sum();
            frame.put(&identifier.to_be_bytes());
            frame.put(&[bytes as u8]);
            for number in numbers {
                frame.put(number);
            }
        };
        // The counters roll over.
        packet(PACKET_COUNTER, &[&(sequence as u16).to_be_bytes()]);
        packet(SAMPLE_TIME_FINE, &[&((stamp.ns / FINE_NS) as u32).to_be_bytes()]);
        let q = q.map(f32::to_be_bytes);
        packet(DELTA_Q, &[&q[0], &q[1], &q[2], &q[3]]);
        let v = v.map(f32::to_be_bytes);
        packet(DELTA_V, &[&v[0], &v[1], &v[2]]);
        if let Some(temperature_c) = reading.temperature_c {
            packet(TEMPERATURE, &[&temperature_c.to_be_bytes()]);
        }
        packet(STATUS_WORD, &[&word.to_be_bytes()]);
        let length = frame.bytes().len() - 4;
        frame.set(3, length as u8);
        let checksum = checksum::sum(&frame.bytes()[1..]).wrapping_neg();
        frame.put(&[checksum]);
        Ok(frame.bytes())
    }
}
