//! Position sequences: cumulative gimbal angles and relative dwell times, at most 64 stops.

/// Largest number of stops of a sequence.
pub const STOPS_MAX: usize = 64;

/// One stop: cumulative gimbal angles in rad, and dwell relative to the others.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct Stop {
    /// Inner gimbal, rad.
    pub azimuth_rad: f64,
    /// Outer gimbal, rad.
    pub roll_rad: f64,
    /// Dwell relative to weight 1; the tilts of the eight positions have 2.
    pub weight: f64,
}

/// A checked sequence of stops, walked `passes` times.
#[derive(Clone, Debug, PartialEq)]
pub struct Sequence {
    stops: [Stop; STOPS_MAX],
    len: usize,
    passes: u32,
}

/// Reason why stops are not a valid sequence.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SequenceError {
    /// No stop at all.
    #[error("the sequence has no stop")]
    Empty,
    /// More stops than the core can hold.
    #[error("the sequence has {found} stops, at most {STOPS_MAX} are possible")]
    TooLong {
        /// Number of stops given.
        found: usize,
    },
    /// No pass.
    #[error("the sequence is passed 0 times, at least 1 is needed")]
    NoPass,
    /// An angle beyond the encoder's range or not a number.
    #[error("stop {stop}: angle {angle_rad} rad is not within ±15.9 rad (±911 deg)")]
    Angle {
        /// Index of the stop, from 0.
        stop: usize,
        /// The angle found.
        angle_rad: f64,
    },
    /// A dwell weight that is negative or not a number, or all of them zero.
    #[error("stop {stop}: dwell weight {weight} is not a positive number")]
    Weight {
        /// Index of the stop, from 0.
        stop: usize,
        /// The weight found.
        weight: f64,
    },
}

impl Sequence {
    /// Makes a sequence of stops that is repeated `passes` times.
    ///
    /// # Errors
    /// If there are no stops or more than [`STOPS_MAX`], no pass, an angle beyond the encoders'
    /// ±16 rad, or a dwell weight that isn't positive.
    pub fn new(stops: &[Stop], passes: u32) -> Result<Self, SequenceError> {
        if stops.is_empty() {
            return Err(SequenceError::Empty);
        }
        if stops.len() > STOPS_MAX {
            return Err(SequenceError::TooLong { found: stops.len() });
        }
        if passes == 0 {
            return Err(SequenceError::NoPass);
        }
        for (index, stop) in stops.iter().enumerate() {
            for angle_rad in [stop.azimuth_rad, stop.roll_rad] {
                if !(angle_rad.abs() <= 15.9) {
                    return Err(SequenceError::Angle { stop: index, angle_rad });
                }
            }
            if !(stop.weight > 0.0 && stop.weight.is_finite()) {
                return Err(SequenceError::Weight { stop: index, weight: stop.weight });
            }
        }
        let mut held = [Stop::default(); STOPS_MAX];
        held[..stops.len()].copy_from_slice(stops);
        Ok(Self { stops: held, len: stops.len(), passes })
    }

    /// The stops of one pass.
    #[must_use]
    #[inline]
    pub fn stops(&self) -> &[Stop] {
        &self.stops[..self.len]
    }

    /// Number of passes through the stops.
    #[must_use]
    #[inline]
    pub fn passes(&self) -> u32 {
        self.passes
    }
}

/// Serde form: stops and passes, checked on reading.
#[cfg(feature = "state")]
mod value {
    extern crate alloc;

    use super::{Sequence, Stop};
    use alloc::vec::Vec;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    impl Serialize for Sequence {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            (self.stops(), self.passes).serialize(serializer)
        }
    }

    impl<'de> Deserialize<'de> for Sequence {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            let (stops, passes) = <(Vec<Stop>, u32)>::deserialize(deserializer)?;
            Self::new(&stops, passes).map_err(serde::de::Error::custom)
        }
    }
}
