//! Content of navigation messages, in the units and frames of this project.

use super::time::NavigationTime;
use crate::framing::FrameContent;

/// Content of a navigation message. Messages of one time complete each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NavigationReading {
    /// Time for which it is valid.
    pub time: NavigationTime,
    /// Geodetic latitude and longitude, rad.
    pub position_rad: Option<[f64; 2]>,
    /// Height above the ellipsoid, m.
    pub height_m: Option<f64>,
    /// Velocity over ground: north, east, down, m/s.
    pub velocity_mps: Option<[f64; 3]>,
    /// Roll, pitch and heading, rad.
    pub attitude_rad: Option<[f64; 3]>,
    /// Standard deviations that the unit states.
    pub sigma: NavigationSigma,
    /// Mode of the unit's filter, in the words of its manual.
    pub quality: Option<&'static str>,
}

/// Standard deviations that a unit states of its solution.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NavigationSigma {
    /// Position: north, east, down, m.
    pub position_m: Option<[f64; 3]>,
    /// Velocity: north, east, down, m/s.
    pub velocity_mps: Option<[f64; 3]>,
    /// Roll, pitch and heading, rad.
    pub attitude_rad: Option<[f64; 3]>,
}

impl NavigationSigma {
    /// Each of these, or else of others.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self {
            position_m: self.position_m.or(other.position_m),
            velocity_mps: self.velocity_mps.or(other.velocity_mps),
            attitude_rad: self.attitude_rad.or(other.attitude_rad),
        }
    }
}

impl NavigationReading {
    pub(super) fn at(time: NavigationTime) -> Self {
        Self {
            time,
            position_rad: None,
            height_m: None,
            velocity_mps: None,
            attitude_rad: None,
            sigma: NavigationSigma::default(),
            quality: None,
        }
    }
}

impl FrameContent for NavigationReading {
    fn sequence(&self) -> Option<u64> {
        None
    }
}

/// Latitude and longitude of degrees, rad.
pub(super) fn position_rad(degrees: [f64; 2]) -> Option<[f64; 2]> {
    Some(degrees.map(f64::to_radians))
}

/// Roll, pitch and heading of a rotation from the body (forward, right, down) to north, east, down, as a quaternion
/// with its scalar first, which need not be normal (Titterton and Weston, 3.6.5).
pub(super) fn angles_rad([w, x, y, z]: [f64; 4]) -> Option<[f64; 3]> {
    let norm = w * w + x * x + y * y + z * z;
    if !(norm > 0.25 && norm < 4.0) {
        return None;
    }
    let sine = (2.0 * (w * y - z * x) / norm).clamp(-1.0, 1.0);
    Some([
        libm::atan2(2.0 * (w * x + y * z), w * w - x * x - y * y + z * z),
        libm::asin(sine),
        libm::atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z),
    ])
}
