//! VectorNav's position, velocity and attitude: of the common group, else of the INS and attitude groups.
//!
//! The mode in `InsStatus` tells what is valid: in mode 2 (tracking) all, in 3 (45 s without GNSS) the attitude alone, because the
//! unit no longer moves its position. Without that field everything counts but a position of zeros. The time is `TimeGps`, else
//! `TimeUtc`, else `TimeStartup`.

use super::reading::{NavigationReading, NavigationSigma, position_rad};
use super::time::{Calendar, NavigationTime};
use crate::bytes::Reader;
use crate::framing::{Extent, Framing, ReadingDefect};
use crate::vectornav::{
    COMMON, MAX_BYTES, TIME, TIME_GPS, TIME_STARTUP, VectorNav, each_field, floats,
};

// Fields, as group and bit.
const ATTITUDE: usize = 4;
const INS: usize = 5;
const COMMON_YPR: u16 = 1 << 3;
const COMMON_POSITION: u16 = 1 << 6;
const COMMON_VELOCITY: u16 = 1 << 7;
const COMMON_INS_STATUS: u16 = 1 << 12;
const TIME_UTC: u16 = 1 << 6;
const TIME_STATUS: u16 = 1 << 9;
const ATTITUDE_YPR: u16 = 1 << 1;
const INS_STATUS: u16 = 1 << 0;
const INS_POS_LLA: u16 = 1 << 1;
const INS_VEL_NED: u16 = 1 << 4;
// Uncertainties, one standard deviation: one number for all axes of position and velocity, deg of the angles.
const INS_POS_U: u16 = 1 << 9;
const INS_VEL_U: u16 = 1 << 10;
const ATTITUDE_YPR_U: u16 = 1 << 8;

/// GPS time of 1999: earlier the unit has no fix yet, ns.
const OLDEST_GPS_NS: u64 = 600_000_000_000_000_000;
/// Bits of `TimeStatus`: time and date are valid, and the leap seconds too.
const GPS_TIME_VALID: u8 = 0b011;
const UTC_TIME_VALID: u8 = 0b111;
const TRACKING: u16 = 2;
const WITHOUT_GNSS: u16 = 3;
const MODES: [&str; 4] =
    ["mode 0 (not tracking)", "mode 1 (aligning)", "mode 2 (tracking)", "mode 3 (without GNSS)"];

/// Navigation messages of VectorNav.
#[derive(Clone, Copy, Debug, Default)]
pub struct VectorNavNavigation;

#[derive(Default)]
struct Found {
    gps_ns: Option<u64>,
    utc_ns: Option<i64>,
    startup_ns: Option<u64>,
    time_status: Option<u8>,
    mode: Option<u16>,
    position: Option<[f64; 3]>,
    velocity_mps: Option<[f64; 3]>,
    yaw_pitch_roll: Option<[f64; 3]>,
    sigma: NavigationSigma,
}

impl Framing for VectorNavNavigation {
    type Found = NavigationReading;
    type Room = [u8; MAX_BYTES];
    const EMPTY: Self::Room = [0; MAX_BYTES];

    fn begins(&self, byte: u8) -> bool {
        VectorNav.begins(byte)
    }

    fn extent(&self, bytes: &[u8]) -> Extent {
        VectorNav.extent(bytes)
    }

    fn read(&mut self, frame: &[u8]) -> Result<Option<NavigationReading>, ReadingDefect> {
        let mut found = Found::default();
        each_field(frame, |group, bit, mut field| match (group, bit) {
            (COMMON | TIME, TIME_STARTUP) => found.startup_ns = Some(field.u64_le()),
            (COMMON | TIME, TIME_GPS) => found.gps_ns = Some(field.u64_le()),
            (TIME, TIME_UTC) => found.utc_ns = utc_ns(&mut field),
            (TIME, TIME_STATUS) => found.time_status = Some(field.u8_le()),
            (COMMON, COMMON_INS_STATUS) | (INS, INS_STATUS) => {
                found.mode = Some(field.u16_le() & 0b11);
            }
            (COMMON, COMMON_POSITION) | (INS, INS_POS_LLA) => {
                found.position.get_or_insert(field.three(Reader::f64_le));
            }
            (COMMON, COMMON_VELOCITY) | (INS, INS_VEL_NED) => {
                found.velocity_mps.get_or_insert(floats(&mut field));
            }
            (COMMON, COMMON_YPR) | (ATTITUDE, ATTITUDE_YPR) => {
                found.yaw_pitch_roll.get_or_insert(floats(&mut field));
            }
            (INS, INS_POS_U) => found.sigma.position_m = Some([f64::from(field.f32_le()); 3]),
            (INS, INS_VEL_U) => found.sigma.velocity_mps = Some([f64::from(field.f32_le()); 3]),
            (ATTITUDE, ATTITUDE_YPR_U) => {
                let [yaw, pitch, roll] = floats(&mut field);
                found.sigma.attitude_rad = Some([roll, pitch, yaw].map(f64::to_radians));
            }
            _ => {}
        })?;
        Ok(found.reading())
    }
}

fn utc_ns(field: &mut Reader<'_>) -> Option<i64> {
    let [year] = field.take::<1>().map(|byte| byte as i8);
    let calendar = Calendar {
        year: 2000 + i64::from(year),
        month: field.u8_le(),
        day: field.u8_le(),
        hour: field.u8_le(),
        minute: field.u8_le(),
        second: field.u8_le(),
        ns: u32::from(field.u16_le()).saturating_mul(1_000_000),
    };
    calendar.utc_ns()
}

impl Found {
    fn time(&self) -> Option<NavigationTime> {
        let has = |bits: u8| self.time_status.is_none_or(|status| status & bits == bits);
        let gps = self.gps_ns.filter(|ns| *ns >= OLDEST_GPS_NS && has(GPS_TIME_VALID));
        let utc = self.utc_ns.filter(|_| has(UTC_TIME_VALID));
        gps.map(NavigationTime::Gps)
            .or(utc.map(NavigationTime::Utc))
            .or(self.startup_ns.map(NavigationTime::Own))
    }

    fn reading(&self) -> Option<NavigationReading> {
        let moves = self.mode.is_none_or(|mode| mode == TRACKING);
        let points = moves || self.mode == Some(WITHOUT_GNSS);
        let position = self.position.filter(|[latitude, longitude, _]| {
            moves && (self.mode.is_some() || (*latitude, *longitude) != (0.0, 0.0))
        });
        let [yaw, pitch, roll] = self.yaw_pitch_roll.unwrap_or_default();
        Some(NavigationReading {
            time: self.time()?,
            position_rad: position.and_then(|[a, b, _]| position_rad([a, b])),
            height_m: position.map(|[_, _, height_m]| height_m),
            velocity_mps: self.velocity_mps.filter(|_| moves),
            attitude_rad: (points && self.yaw_pitch_roll.is_some())
                .then(|| [roll, pitch, yaw].map(f64::to_radians)),
            sigma: self.sigma,
            quality: self.mode.and_then(|mode| MODES.get(usize::from(mode))).copied(),
        })
    }
}
