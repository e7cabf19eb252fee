//! Xsens' `LatLon`, `AltitudeEllipsoid`, `VelocityXYZ`, `EulerAngles` and `Quaternion`.
//!
//! Velocity and attitude are in the axes that the identifier tells: east, north, up; north, east, down; north, west, up. The body is
//! forward, left, up in the first and last, and forward, right, down in the second. The time is `UtcTime` where its flags say
//! that it is valid, else `SampleTimeFine`. A frame whose status byte or word says that the filter is not valid has its time alone.

use super::reading::{NavigationReading, angles_rad, position_rad};
use super::time::{Calendar, NavigationTime};
use crate::bytes::Reader;
use crate::framing::{Extent, Framing, ReadingDefect};
use crate::rollover::Rollover;
use crate::xsens::{
    FINE_NS, MAX_BYTES, Precision, SAMPLE_TIME_FINE, STATUS_WORD, Xsens, checked, packet,
};
use core::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

const UTC_TIME: u16 = 0x1010;
const QUATERNION: u16 = 0x2010;
const EULER_ANGLES: u16 = 0x2030;
const ALTITUDE_ELLIPSOID: u16 = 0x5020;
const LAT_LON: u16 = 0x5040;
const VELOCITY_XYZ: u16 = 0xD010;
/// Bits of `UtcTime`: date, time of day, and leap seconds are known.
const UTC_VALID: u8 = 0b111;
const STATUS_BYTE: u16 = 0xE010;
/// Bits of status byte and word: the filter's solution is valid, GNSS has a fix.
const FILTER_VALID: u32 = 1 << 1;
const GNSS_FIX: u32 = 1 << 2;

/// Navigation messages of Xsens.
#[derive(Clone, Copy, Debug)]
pub struct XsensNavigation {
    fine: Rollover,
}

impl Default for XsensNavigation {
    fn default() -> Self {
        Self { fine: Rollover::new(32) }
    }
}

/// Axes of velocity and attitude.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Frame {
    EastNorthUp,
    NorthEastDown,
    NorthWestUp,
}

impl Frame {
    fn of(identifier: u16) -> Option<Self> {
        match identifier & 0xC {
            0x0 => Some(Self::EastNorthUp),
            0x4 => Some(Self::NorthEastDown),
            0x8 => Some(Self::NorthWestUp),
            _ => None,
        }
    }

    /// North, east, down.
    fn ned(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        match self {
            Self::EastNorthUp => [y, x, -z],
            Self::NorthEastDown => [x, y, z],
            Self::NorthWestUp => [x, -y, -z],
        }
    }

    /// Roll, pitch, heading.
    fn angles(self, [roll, pitch, yaw]: [f64; 3]) -> [f64; 3] {
        match self {
            Self::EastNorthUp => [roll, -pitch, FRAC_PI_2 - yaw],
            Self::NorthEastDown => [roll, pitch, yaw],
            Self::NorthWestUp => [roll, -pitch, -yaw],
        }
    }

    /// Rotation from a body forward, right, down to north, east, down.
    fn rotation(self, [w, x, y, z]: [f64; 4]) -> [f64; 4] {
        // Half a turn about the forward axis on both sides, and before it the quarter turn from east to north.
        let nwu = match self {
            Self::NorthEastDown => return [w, x, y, z],
            Self::NorthWestUp => [w, x, y, z],
            Self::EastNorthUp => [w + z, x + y, y - x, z - w].map(|number| number * FRAC_1_SQRT_2),
        };
        let [w, x, y, z] = nwu;
        [w, x, -y, -z]
    }
}

#[derive(Default)]
struct Found {
    utc_ns: Option<i64>,
    fine: Option<u32>,
    position: Option<[f64; 2]>,
    height_m: Option<f64>,
    velocity_mps: Option<[f64; 3]>,
    attitude_rad: Option<[f64; 3]>,
    /// Bits that status byte and word have both, or the one that is there.
    status: Option<u32>,
}

impl Found {
    fn read(mut rest: &[u8]) -> Option<Self> {
        let mut found = Self::default();
        while !rest.is_empty() {
            let (identifier, data) = packet(&mut rest)?;
            let precision = Precision::of(identifier);
            let is = |bytes: usize| (data.len() == bytes).then_some(());
            let fields = &mut Reader::new(data);
            match identifier & 0xFFF0 {
                UTC_TIME => {
                    is(12)?;
                    let calendar = Calendar {
                        ns: fields.u32_be(),
                        year: fields.u16_be().into(),
                        month: fields.u8_be(),
                        day: fields.u8_be(),
                        hour: fields.u8_be(),
                        minute: fields.u8_be(),
                        second: fields.u8_be(),
                    };
                    let is_valid = fields.u8_be() & UTC_VALID == UTC_VALID;
                    found.utc_ns = calendar.utc_ns().filter(|_| is_valid);
                }
                SAMPLE_TIME_FINE => {
                    is(4)?;
                    found.fine = Some(fields.u32_be());
                }
                LAT_LON => {
                    is(2 * precision.bytes())?;
                    found.position = Some(core::array::from_fn(|_| precision.number(fields)));
                }
                ALTITUDE_ELLIPSOID => {
                    is(precision.bytes())?;
                    found.height_m = Some(precision.number(fields));
                }
                VELOCITY_XYZ => {
                    is(3 * precision.bytes())?;
                    let velocity = fields.three(|fields| precision.number(fields));
                    found.velocity_mps = Some(Frame::of(identifier)?.ned(velocity));
                }
                EULER_ANGLES => {
                    is(3 * precision.bytes())?;
                    let angles = fields.three(|fields| precision.number(fields).to_radians());
                    found.attitude_rad = Some(Frame::of(identifier)?.angles(angles));
                }
                QUATERNION => {
                    is(4 * precision.bytes())?;
                    let q = core::array::from_fn(|_| precision.number(fields));
                    let angles = angles_rad(Frame::of(identifier)?.rotation(q));
                    found.attitude_rad = found.attitude_rad.or(angles);
                }
                STATUS_WORD => {
                    is(4)?;
                    found.status = Some(found.status.unwrap_or(u32::MAX) & fields.u32_be());
                }
                STATUS_BYTE => {
                    is(1)?;
                    let byte = u32::from(fields.u8_be());
                    found.status = Some(found.status.unwrap_or(u32::MAX) & byte);
                }
                _ => {}
            }
        }
        Some(found)
    }
}

impl Framing for XsensNavigation {
    type Found = NavigationReading;
    type Room = [u8; MAX_BYTES];
    const EMPTY: Self::Room = [0; MAX_BYTES];

    fn begins(&self, byte: u8) -> bool {
        Xsens::default().begins(byte)
    }

    fn extent(&self, bytes: &[u8]) -> Extent {
        Xsens::default().extent(bytes)
    }

    fn read(&mut self, frame: &[u8]) -> Result<Option<NavigationReading>, ReadingDefect> {
        let found = Found::read(checked(frame)?).ok_or(ReadingDefect::Malformed)?;
        let fine_ns =
            found.fine.map(|fine| self.fine.continued(fine.into()).saturating_mul(FINE_NS));
        let time = found.utc_ns.map(NavigationTime::Utc).or(fine_ns.map(NavigationTime::Own));
        let is = |bit: u32| found.status.map(|status| status & bit != 0);
        Ok(time.map(|time| match is(FILTER_VALID) {
            Some(false) => NavigationReading::at(time),
            _ => NavigationReading {
                time,
                position_rad: found.position.and_then(position_rad),
                height_m: found.height_m,
                velocity_mps: found.velocity_mps,
                attitude_rad: found.attitude_rad,
                quality: is(GNSS_FIX).map(|fix| if fix { "a GNSS fix" } else { "no GNSS fix" }),
                ..NavigationReading::at(time)
            },
        }))
    }
}
