//! Aiding: the reference that a calibration measures itself against.

use crate::DeviceTime;

/// What the reference measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reference {
    /// Velocity over ground in n (north, east, down), m/s.
    Velocity([f64; 3]),
    /// Geodetic position of the instrument.
    Position {
        /// Geodetic latitude, rad.
        latitude_rad: f64,
        /// Longitude, rad.
        longitude_rad: f64,
        /// Height above the ellipsoid, m.
        height_m: f64,
    },
}

/// One aiding message. It carries the stamp of the sample that it goes with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aiding {
    /// Stamp of the sample at whose end the reference holds.
    pub device_time: DeviceTime,
    /// The measured reference.
    pub reference: Reference,
}
