//! Fields: their place, and what they mean.

use super::number::FrameNumber;
use crate::ReadingKind;

/// Meaning of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldMeaning {
    /// Rotation about axis x, y or z (0, 1, 2): rad or rad/s = (raw − zero) · scale.
    Rotation {
        /// Axis.
        axis: usize,
        /// Increment or mean.
        kind: ReadingKind,
        /// Raw number of zero.
        zero: f64,
        /// SI units of one raw unit; negative reverses the axis.
        scale: f64,
    },
    /// Velocity or specific force along axis x, y or z: m/s or m/s², likewise.
    Velocity {
        /// Axis.
        axis: usize,
        /// Increment or mean.
        kind: ReadingKind,
        /// Raw number of zero.
        zero: f64,
        /// SI units of one raw unit; negative reverses the axis.
        scale: f64,
    },
    /// Number of the reading, which rolls over.
    Counter,
    /// Time of the unit at the end of the interval, which rolls over; a raw unit is this many ns.
    Stamp(f64),
    /// Temperature, °C = (raw − zero) · scale + offset.
    Temperature {
        /// Raw number of zero.
        zero: f64,
        /// Kelvins of one raw unit.
        scale: f64,
        /// Temperature at zero, °C.
        offset_c: f64,
    },
    /// Bits of a status word.
    Flags {
        /// Bits of which each is set in a reading that is valid.
        good: u64,
        /// Bits of which none is set in a reading that is valid.
        faulty: u64,
        /// Bits of which one is set where a gyro is saturated.
        gyro_saturated: u64,
        /// Bits of which one is set where an accelerometer is saturated.
        accel_saturated: u64,
    },
}

/// A field of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameField {
    /// Place and type.
    pub number: FrameNumber,
    /// Meaning.
    pub meaning: FieldMeaning,
}

impl FrameField {
    /// Number of the field in these bytes.
    #[inline]
    pub(super) fn number(&self, bytes: &[u8]) -> FieldNumber {
        let value = self.number.value(bytes);
        let is_integer = self.number.number.is_integer();
        let raw = match self.meaning {
            FieldMeaning::Stamp(size_ns) if !is_integer => libm::round(value * size_ns) as u64,
            _ => self.number.raw(bytes),
        };
        FieldNumber { value, raw, is_integer }
    }
}

impl FieldMeaning {
    /// Name of the field in messages.
    pub(crate) const fn name(&self) -> &'static str {
        match self {
            Self::Rotation { axis: 0, .. } => "gyro x",
            Self::Rotation { axis: 1, .. } => "gyro y",
            Self::Rotation { .. } => "gyro z",
            Self::Velocity { axis: 0, .. } => "accel x",
            Self::Velocity { axis: 1, .. } => "accel y",
            Self::Velocity { .. } => "accel z",
            Self::Counter => "counter",
            Self::Stamp(_) => "stamp",
            Self::Temperature { .. } => "temperature",
            Self::Flags { .. } => "status",
        }
    }
}

/// Number in a field.
#[derive(Clone, Copy, Debug)]
pub(super) struct FieldNumber {
    /// Value.
    pub(super) value: f64,
    /// Bits of an integer, without its sign; of a stamp that is no integer, its time in ns.
    pub(super) raw: u64,
    /// True for an integer.
    pub(super) is_integer: bool,
}
