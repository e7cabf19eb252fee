//! SBG's `EKF_NAV` (8), `EKF_EULER` (6), `EKF_QUAT` (7) and `UTC_TIME` (2) of class 0.
//!
//! Stamps are microseconds since power-on. `UTC_TIME` tells which UTC belongs to one of them; the others follow by the same
//! clock. Without a valid one the time is the unit's own: one whose leap seconds aren't known yet is off by whole seconds.

use super::reading::{NavigationReading, NavigationSigma, angles_rad, position_rad};
use super::time::{Calendar, NavigationTime};
use crate::bytes::Reader;
use crate::framing::{Extent, Framing, ReadingDefect};
use crate::rollover::Rollover;
use crate::sbg::{self, CLASS_LOG, MAX_BYTES, Sbg};

const UTC_TIME: u8 = 2;
const EKF_EULER: u8 = 6;
const EKF_QUAT: u8 = 7;
const EKF_NAV: u8 = 8;
/// Fewest bytes: later versions append fields.
const UTC_BYTES: usize = 21;
const EULER_BYTES: usize = 32;
const QUAT_BYTES: usize = 36;
const NAV_BYTES: usize = 72;

/// Status of `UTC_TIME`: UTC is known with its leap seconds. Below it, they aren't (1), or nothing is (0).
const UTC_KNOWN: u16 = 2;
/// Modes of the filter, the lowest bits of the solution's status.
const MODES: [&str; 5] = [
    "mode 0 (not initialised)",
    "mode 1 (vertical gyro)",
    "mode 2 (attitude and heading)",
    "mode 3 (velocity, attitude and heading)",
    "mode 4 (position, velocity, attitude and heading)",
];

// Bits of the solution's status.
const ATTITUDE_VALID: u32 = 1 << 4;
const HEADING_VALID: u32 = 1 << 5;
const VELOCITY_VALID: u32 = 1 << 6;
const POSITION_VALID: u32 = 1 << 7;

/// Navigation messages of SBG.
#[derive(Clone, Copy, Debug)]
pub struct SbgNavigation {
    clock: Rollover,
    /// A stamp, ns, and the UTC that belongs to it, ns since 1970.
    utc: Option<(u64, i64)>,
}

impl Default for SbgNavigation {
    fn default() -> Self {
        Self { clock: Rollover::new(32), utc: None }
    }
}

impl SbgNavigation {
    fn stamp_ns(&mut self, micros: u32) -> u64 {
        self.clock.continued(micros.into()).saturating_mul(1000)
    }

    fn time(&mut self, micros: u32) -> NavigationTime {
        let stamp_ns = self.stamp_ns(micros);
        let utc_ns = self.utc.and_then(|(of_ns, utc_ns)| {
            let since_ns = i64::try_from(stamp_ns).ok()? - i64::try_from(of_ns).ok()?;
            utc_ns.checked_add(since_ns)
        });
        utc_ns.map_or(NavigationTime::Own(stamp_ns), NavigationTime::Utc)
    }
}

impl Framing for SbgNavigation {
    type Found = NavigationReading;
    type Room = [u8; MAX_BYTES];
    const EMPTY: Self::Room = [0; MAX_BYTES];

    fn begins(&self, byte: u8) -> bool {
        Sbg::default().begins(byte)
    }

    fn extent(&self, bytes: &[u8]) -> Extent {
        Sbg::default().extent(bytes)
    }

    fn read(&mut self, frame: &[u8]) -> Result<Option<NavigationReading>, ReadingDefect> {
        let ((class, message), data) = sbg::checked(frame)?;
        let (least, field) = match (class, message) {
            (CLASS_LOG, UTC_TIME) => (UTC_BYTES, "length of UTC_TIME"),
            (CLASS_LOG, EKF_EULER) => (EULER_BYTES, "length of EKF_EULER"),
            (CLASS_LOG, EKF_QUAT) => (QUAT_BYTES, "length of EKF_QUAT"),
            (CLASS_LOG, EKF_NAV) => (NAV_BYTES, "length of EKF_NAV"),
            _ => return Ok(None),
        };
        if data.len() < least {
            return Err(ReadingDefect::Unknown { field, found: data.len() as u32 });
        }
        let fields = &mut Reader::new(data);
        let micros = fields.u32_le();
        if message == UTC_TIME {
            let stamp_ns = self.stamp_ns(micros);
            let is_known = fields.u16_le() >> 6 & 0xF >= UTC_KNOWN;
            let calendar = Calendar {
                year: fields.u16_le().into(),
                month: fields.u8_le(),
                day: fields.u8_le(),
                hour: fields.u8_le(),
                minute: fields.u8_le(),
                second: fields.u8_le(),
                ns: fields.u32_le(),
            };
            if let (true, Some(utc_ns)) = (is_known, calendar.utc_ns()) {
                self.utc = Some((stamp_ns, utc_ns));
            }
            return Ok(None);
        }
        let mut reading = NavigationReading::at(self.time(micros));
        let is_attitude = |status: u32| {
            status & (ATTITUDE_VALID | HEADING_VALID) == ATTITUDE_VALID | HEADING_VALID
        };
        match message {
            EKF_EULER => {
                let angles = fields.three(|fields| f64::from(fields.f32_le()));
                let sigma = fields.three(|fields| f64::from(fields.f32_le()));
                reading.attitude_rad = is_attitude(fields.u32_le()).then_some(angles);
                reading.sigma.attitude_rad = Some(sigma);
            }
            EKF_QUAT => {
                let quaternion = core::array::from_fn(|_| f64::from(fields.f32_le()));
                reading.sigma.attitude_rad =
                    Some(fields.three(|fields| f64::from(fields.f32_le())));
                let status = fields.u32_le();
                reading.attitude_rad = angles_rad(quaternion).filter(|_| is_attitude(status));
            }
            _ => {
                let velocity = fields.three(|fields| f64::from(fields.f32_le()));
                let velocity_sigma = fields.three(|fields| f64::from(fields.f32_le()));
                let [latitude, longitude, altitude_m] = fields.three(Reader::f64_le);
                let undulation_m = f64::from(fields.f32_le());
                // Latitude, longitude and height: in metres, as the velocity is in metres a second.
                let position_sigma = fields.three(|fields| f64::from(fields.f32_le()));
                let status = fields.u32_le();
                reading.quality = MODES.get((status & 0xF) as usize).copied();
                reading.sigma = NavigationSigma {
                    position_m: Some(position_sigma),
                    velocity_mps: Some(velocity_sigma),
                    attitude_rad: None,
                };
                if status & POSITION_VALID != 0 {
                    reading.position_rad = position_rad([latitude, longitude]);
                    reading.height_m = Some(altitude_m + undulation_m);
                }
                reading.velocity_mps = (status & VELOCITY_VALID != 0).then_some(velocity);
            }
        }
        Ok(Some(reading))
    }
}
