//! A reading from the fields of a frame, a record or a line.

use super::field::{FieldMeaning, FieldNumber};
use crate::rollover::Rollover;
use crate::{MeasuredTriad, Reading, ReadingKind, Stamp, StampClock};
use octant_sample::Status;

/// Puts a reading together.
pub(super) struct Gather<'a> {
    pub(super) reading: Reading,
    /// Counter and clock, which are continued across their roll-over.
    pub(super) counter: &'a mut Rollover,
    pub(super) stamp: &'a mut Rollover,
}

impl<'a> Gather<'a> {
    pub(super) fn new(counter: &'a mut Rollover, stamp: &'a mut Rollover) -> Self {
        Self { reading: Reading::NOTHING, counter, stamp }
    }

    /// Takes a field.
    #[inline]
    pub(super) fn take(&mut self, meaning: &FieldMeaning, number: FieldNumber) {
        let FieldNumber { value, raw, is_integer } = number;
        let reading = &mut self.reading;
        match *meaning {
            FieldMeaning::Rotation { axis, kind, zero, scale } => {
                set(&mut reading.rotation, axis, kind, (value - zero) * scale);
            }
            FieldMeaning::Velocity { axis, kind, zero, scale } => {
                set(&mut reading.velocity, axis, kind, (value - zero) * scale);
            }
            FieldMeaning::Counter => reading.sequence = Some(self.counter.continued(raw)),
            FieldMeaning::Stamp(size_ns) => {
                let raw = self.stamp.continued(raw);
                let ns = if is_integer { nanoseconds(raw, size_ns) } else { raw };
                reading.stamp = Some(Stamp { ns, clock: StampClock::Startup });
            }
            FieldMeaning::Temperature { zero, scale, offset_c } => {
                reading.temperature_c = Some(((value - zero) * scale + offset_c) as f32);
            }
            FieldMeaning::Flags { good, faulty, gyro_saturated, accel_saturated } => {
                reading.status_word = reading.status_word.or(Some(raw as u32));
                let mut set = |flag, is: bool| {
                    if is {
                        reading.status |= flag;
                    }
                };
                set(Status::INERTIAL_INVALID, raw & good != good || raw & faulty != 0);
                set(Status::GYRO_SATURATED, raw & gyro_saturated != 0);
                set(Status::ACCELEROMETER_SATURATED, raw & accel_saturated != 0);
            }
        }
    }

    /// Ends the reading; `None` without an inertial quantity.
    #[inline]
    pub(super) fn end(self) -> Option<Reading> {
        self.reading.is_inertial().then_some(self.reading)
    }
}

#[inline]
fn set(triad: &mut Option<MeasuredTriad>, axis: usize, kind: ReadingKind, value: f64) {
    let triad = triad.get_or_insert(MeasuredTriad { kind, value: [0.0; 3], lsb: None });
    if let Some(room) = triad.value.get_mut(axis) {
        *room = value;
    }
}

/// Time of so many units of a clock, ns: exact where a unit is a whole number of ns.
#[inline]
fn nanoseconds(units: u64, size_ns: f64) -> u64 {
    let whole = size_ns as u64;
    if whole as f64 == size_ns {
        return units.saturating_mul(whole);
    }
    libm::round(units as f64 * size_ns) as u64
}
