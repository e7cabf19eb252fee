//! One epoch: a sample and, when one is due, the aiding that goes with it, the reference that a calibration measures
//! itself against.

use crate::{DeviceTime, Sample};

/// One step of the source, and one step of the core.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Epoch {
    /// The inertial sample.
    pub sample: Sample,
    /// The reference, when one is due.
    pub aiding: Option<Aiding>,
}

impl Epoch {
    /// Compares bit for bit: NaN is equal to itself and zero differs from minus zero.
    #[must_use]
    #[inline]
    pub fn same_bits(&self, other: &Self) -> bool {
        self.sample == other.sample
            && match (&self.aiding, &other.aiding) {
                (None, None) => true,
                (Some(a), Some(b)) => a.same_bits(b),
                _ => false,
            }
    }

    /// Replaces the epoch by `found`; returns `false`, and changes nothing, if `found` is `None`.
    pub fn take(&mut self, found: Option<Self>) -> bool {
        found.map(|found| *self = found).is_some()
    }
}

/// Quantity that the reference measured.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

/// One aiding message, with the stamp of its sample.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Aiding {
    /// Stamp of the sample at whose end the reference holds.
    pub device_time: DeviceTime,
    /// The measured reference.
    pub reference: Reference,
}

impl Aiding {
    /// Compares bit for bit: NaN is equal to itself and zero differs from minus zero.
    #[must_use]
    pub fn same_bits(&self, other: &Self) -> bool {
        let bits = |reference: &Reference| match *reference {
            Reference::Velocity(v) => (0, v.map(f64::to_bits)),
            Reference::Position { latitude_rad, longitude_rad, height_m } => {
                (1, [latitude_rad, longitude_rad, height_m].map(f64::to_bits))
            }
        };
        self.device_time == other.device_time && bits(&self.reference) == bits(&other.reference)
    }
}
