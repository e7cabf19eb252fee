//! VectorNav's binary output: VN-100, VN-200, VN-300 and compatible units.
//!
//! A frame is `0xFA`, a byte of groups, a 16-bit mask of fields for each group, the fields, and a
//! CRC-16 with its high byte first; everything else is little-endian. The fields are configured in the
//! unit (registers 75 to 77). Any choice is read, as long as the common, time, IMU, GNSS, attitude and
//! INS groups are used without the fields of variable length (satellites).
//!
//! The decoder uses, in this order: `DeltaTheta` (interval, rotation in degrees, velocity) of the
//! common group; `DeltaTheta` and `DeltaVel` of the IMU group; `Imu` of the common group; `UncompAccel`
//! and `UncompGyro` of the IMU group. `AngularRate` and `Accel` are not used: the unit's own filter has
//! already subtracted its estimate of the biases, which a calibration has to find. For the same reason
//! register 82 has to leave `DeltaTheta` uncompensated, in the body frame.
//!
//! Stamps are `TimeStartup`, else `TimeGps`. Readings have no number: a loss shows in the stamps alone.

use super::framing::ProtocolFacts;
use crate::bytes::{Frame, Reader};
use crate::carry::Carry;
use crate::checksum;
use crate::encoding::{CannotCarry, Needs};
use crate::framing::{Extent, Framing, ReadingDefect};
use crate::{MeasuredTriad, Reading, Stamp, StampClock};
use octant_sample::Status;

const SYNC: u8 = 0xFA;

/// Size of each field of each group, bytes; zero: there is no such field, or its length varies.
const FIELD_BYTES: [[u8; 15]; 7] = [
    // Common.
    [8, 8, 8, 12, 16, 12, 24, 12, 12, 24, 20, 28, 2, 4, 8],
    // Time.
    [8, 8, 8, 2, 8, 8, 8, 4, 4, 1, 0, 0, 0, 0, 0],
    // IMU.
    [2, 12, 12, 12, 4, 4, 16, 12, 12, 12, 12, 2, 40, 0, 0],
    // GNSS 1.
    [8, 8, 2, 1, 1, 24, 24, 12, 12, 12, 4, 4, 2, 28, 0],
    // Attitude.
    [2, 12, 16, 36, 12, 12, 12, 12, 12, 12, 28, 24, 0, 0, 0],
    // INS.
    [2, 24, 24, 12, 12, 12, 12, 12, 12, 4, 4, 68, 64, 0, 0],
    // GNSS 2.
    [8, 8, 2, 1, 1, 24, 24, 12, 12, 12, 4, 4, 2, 28, 0],
];

/// Most bytes of a frame: all fields of all groups, the header and the CRC.
pub(crate) const MAX_BYTES: usize = 1280;

const _: () = assert!(longest() <= MAX_BYTES);

/// Size of a frame with every field, bytes.
const fn longest() -> usize {
    let (mut bytes, mut group) = (MAX_HEADER_BYTES + 2, 0);
    while group < FIELD_BYTES.len() {
        let mut field = 0;
        while field < FIELD_BYTES[group].len() {
            bytes += FIELD_BYTES[group][field] as usize;
            field += 1;
        }
        group += 1;
    }
    bytes
}

/// Size of the longest header, with every group, bytes.
const MAX_HEADER_BYTES: usize = 2 + 2 * FIELD_BYTES.len();

const DEGREE_RAD: f64 = core::f64::consts::PI / 180.0;

// Fields, as group and bit.
pub(crate) const COMMON: usize = 0;
pub(crate) const TIME: usize = 1;
const IMU: usize = 2;
pub(crate) const TIME_STARTUP: u16 = 1 << 0;
pub(crate) const TIME_GPS: u16 = 1 << 1;
const COMMON_IMU: u16 = 1 << 9;
const COMMON_DELTA_THETA: u16 = 1 << 11;
const IMU_UNCOMP_ACCEL: u16 = 1 << 2;
const IMU_UNCOMP_GYRO: u16 = 1 << 3;
const IMU_TEMP: u16 = 1 << 4;
const IMU_DELTA_THETA: u16 = 1 << 6;
const IMU_DELTA_VEL: u16 = 1 << 7;
const IMU_SENS_SAT: u16 = 1 << 11;

/// Bits of `SensSat`.
const SATURATED_ACCELEROMETER: u16 = 0b111 << 3;
const SATURATED_GYRO: u16 = 0b111 << 6;

/// Facts of the protocol. Floats have 24 bits, of up to 0.1 rad and 1 m/s; the carried remainder adds
/// the same error again.
pub(crate) const FACTS: ProtocolFacts = ProtocolFacts {
    name: "vectornav",
    doc: "VectorNav's binary output",
    resolution: [1.2e-8, 1.2e-7],
    false_starts: &[&[0xFA], &[0xFA, 0x01, 0xFF, 0x7F], &[0xFA, 0xFA, 0xFA]],
};

/// VectorNav's protocol.
#[derive(Clone, Copy, Debug, Default)]
pub struct VectorNav;

/// Finds readings in a stream of bytes.
pub type VectorNavDecoder = crate::framing::FrameDecoder<VectorNav>;

/// Masks of the groups of a header.
struct Header {
    masks: [u16; 7],
    bytes: usize,
}

/// Reads the header at the beginning of bytes.
fn header(bytes: &[u8]) -> Result<Header, Extent> {
    let groups = *bytes.get(1).ok_or(Extent::Open(1))?;
    // Bit 7 continues the groups with a second byte, which no unit has.
    if groups == 0 || groups & 0x80 != 0 {
        return Err(Extent::None);
    }
    // Nothing can be said before all masks are there.
    let header_bytes = 2 + 2 * groups.count_ones() as usize;
    if bytes.len() < header_bytes {
        return Err(Extent::Open(header_bytes - bytes.len()));
    }
    let mut masks = [0; 7];
    let (mut at, mut rest) = (2, groups);
    while rest != 0 {
        let group = rest.trailing_zeros() as usize;
        rest &= rest - 1;
        let found = bytes.get(at..).and_then(|rest| rest.first_chunk::<2>()).ok_or(Extent::None)?;
        let mask = u16::from_le_bytes(*found);
        // The group has no field, or a second word of fields.
        if mask == 0 || mask & 0x8000 != 0 {
            return Err(Extent::None);
        }
        masks[group] = mask;
        at += 2;
    }
    Ok(Header { masks, bytes: at })
}

impl Framing for VectorNav {
    type Found = Reading;
    type Room = [u8; MAX_BYTES];
    const EMPTY: Self::Room = [0; MAX_BYTES];

    #[inline]
    fn begins(&self, byte: u8) -> bool {
        byte == SYNC
    }

    #[inline]
    fn extent(&self, bytes: &[u8]) -> Extent {
        let header = match header(bytes) {
            Ok(header) => header,
            Err(extent) => return extent,
        };
        let mut length = header.bytes + 2;
        for (group, mask) in header.masks.iter().enumerate() {
            let mut rest = *mask;
            while rest != 0 {
                let bytes = FIELD_BYTES[group][rest.trailing_zeros() as usize];
                if bytes == 0 {
                    return Extent::None;
                }
                length += usize::from(bytes);
                rest &= rest - 1;
            }
        }
        Extent::Bytes(length)
    }

    #[inline]
    fn read(&mut self, frame: &[u8]) -> Result<Option<Reading>, ReadingDefect> {
        let mut reading = Reading::NOTHING;
        let (mut means, mut gps_ns) = (Means::default(), None);
        each_field(frame, |group, bit, mut field| {
            match (group, bit) {
                (COMMON | TIME, TIME_STARTUP) => {
                    let ns = field.u64_le();
                    reading.stamp = Some(Stamp { ns, clock: StampClock::Startup });
                }
                (COMMON | TIME, TIME_GPS) => gps_ns = Some(field.u64_le()),
                (COMMON, COMMON_DELTA_THETA) => {
                    reading.interval_s = Some(f64::from(field.f32_le()));
                    reading.rotation = Some(degrees(&mut field));
                    reading.velocity = Some(MeasuredTriad::increment(floats(&mut field)));
                }
                (COMMON, COMMON_IMU) => {
                    means.common_velocity = Some(floats(&mut field));
                    means.common_rotation = Some(floats(&mut field));
                }
                // The field of the common group, if present, has the same values.
                (IMU, IMU_DELTA_THETA) if reading.rotation.is_none() => {
                    reading.interval_s = Some(f64::from(field.f32_le()));
                    reading.rotation = Some(degrees(&mut field));
                }
                (IMU, IMU_DELTA_VEL) if reading.velocity.is_none() => {
                    reading.velocity = Some(MeasuredTriad::increment(floats(&mut field)));
                }
                (IMU, IMU_UNCOMP_ACCEL) => means.velocity = Some(floats(&mut field)),
                (IMU, IMU_UNCOMP_GYRO) => means.rotation = Some(floats(&mut field)),
                (IMU, IMU_TEMP) => reading.temperature_c = Some(field.f32_le()),
                (IMU, IMU_SENS_SAT) => {
                    let word = field.u16_le();
                    reading.status_word = Some(word.into());
                    let gyro = word & SATURATED_GYRO != 0;
                    let accelerometer = word & SATURATED_ACCELEROMETER != 0;
                    reading.status.set(Status::GYRO_SATURATED, gyro);
                    reading.status.set(Status::ACCELEROMETER_SATURATED, accelerometer);
                }
                _ => {}
            }
        })?;
        if reading.stamp.is_none() {
            reading.stamp = gps_ns.map(|ns| Stamp { ns, clock: StampClock::Gps });
        }
        let mean = |first: Option<[f64; 3]>, second: Option<[f64; 3]>| {
            first.or(second).map(MeasuredTriad::mean)
        };
        reading.rotation = reading.rotation.or_else(|| mean(means.common_rotation, means.rotation));
        reading.velocity = reading.velocity.or_else(|| mean(means.common_velocity, means.velocity));
        Ok(reading.is_inertial().then_some(reading))
    }
}

/// Takes each field of a frame with the right checksum: its group, its bit and its bytes.
#[inline]
pub(crate) fn each_field(
    frame: &[u8],
    mut take: impl FnMut(usize, u16, Reader<'_>),
) -> Result<(), ReadingDefect> {
    let (bare, crc) = frame.split_last_chunk::<2>().ok_or(ReadingDefect::Malformed)?;
    let found = u16::from_be_bytes(*crc);
    let computed = checksum::vectornav(bare.get(1..).unwrap_or_default());
    if found != computed {
        return Err(ReadingDefect::Checksum { found: found.into(), computed: computed.into() });
    }
    let header = header(bare).map_err(|_| ReadingDefect::Malformed)?;
    let mut fields = Reader::new(&bare[header.bytes..]);
    for (group, mask) in header.masks.into_iter().enumerate() {
        let mut rest = mask;
        while rest != 0 {
            let index = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            take(group, 1 << index, fields);
            fields.skip(usize::from(FIELD_BYTES[group][index]));
        }
    }
    Ok(())
}

/// Values that are used if there are no increments.
#[derive(Default)]
struct Means {
    common_rotation: Option<[f64; 3]>,
    common_velocity: Option<[f64; 3]>,
    rotation: Option<[f64; 3]>,
    velocity: Option<[f64; 3]>,
}

pub(crate) fn floats(field: &mut Reader<'_>) -> [f64; 3] {
    field.three(|field| f64::from(field.f32_le()))
}

fn degrees(field: &mut Reader<'_>) -> MeasuredTriad {
    MeasuredTriad::increment(floats(field).map(|degrees| degrees * DEGREE_RAD))
}

/// Encodes readings as a unit does that is configured for `TimeStartup` and `DeltaTheta` of the common
/// group, `Temp` and `SensSat` of the IMU group.
#[derive(Clone, Debug)]
pub struct VectorNavEncoder {
    frame: Frame<{ MAX_HEADER_BYTES + 64 }>,
    rotation: Carry,
    velocity: Carry,
}

impl Default for VectorNavEncoder {
    fn default() -> Self {
        Self::new()
    }
}

impl VectorNavEncoder {
    /// Makes an encoder that has sent nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self { frame: Frame::new(), rotation: Carry::new(), velocity: Carry::new() }
    }

    /// Encodes a reading as a frame, and carries the remainder of the 32-bit floats to the next
    /// reading.
    ///
    /// # Errors
    /// If the reading lacks rotation, velocity, interval or stamp.
    pub fn encode(&mut self, reading: &Reading) -> Result<&[u8], CannotCarry> {
        let needs = Needs("VectorNav");
        let interval_s = needs.some(reading.interval_s, "an interval")?;
        let stamp = needs.some(reading.stamp, "a stamp")?;
        let rotation = needs.increments(reading.rotation, Some(interval_s), "rotation")?;
        let velocity = needs.increments(reading.velocity, Some(interval_s), "velocity")?;
        let mut saturated = 0;
        if reading.status.contains(Status::GYRO_SATURATED) {
            saturated |= SATURATED_GYRO;
        }
        if reading.status.contains(Status::ACCELEROMETER_SATURATED) {
            saturated |= SATURATED_ACCELEROMETER;
        }
        let frame = &mut self.frame;
        frame.clear();
        frame.put(&[SYNC, 1 << COMMON | 1 << IMU]);
        frame.put(&(TIME_STARTUP | COMMON_DELTA_THETA).to_le_bytes());
        frame.put(&(IMU_TEMP | IMU_SENS_SAT).to_le_bytes());
        frame.put(&stamp.ns.to_le_bytes());
        frame.put(&(interval_s as f32).to_le_bytes());
        let rotation = self.rotation.floats(rotation, DEGREE_RAD);
        let velocity = self.velocity.floats(velocity, 1.0);
        for float in rotation.into_iter().chain(velocity) {
            frame.put(&float.to_le_bytes());
        }
        frame.put(&reading.temperature_c.unwrap_or(f32::NAN).to_le_bytes());
        frame.put(&saturated.to_le_bytes());
        let crc = checksum::vectornav(&frame.bytes()[1..]);
        frame.put(&crc.to_be_bytes());
        Ok(frame.bytes())
    }
}
