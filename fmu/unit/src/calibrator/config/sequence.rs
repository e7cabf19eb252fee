//! Sequences of stops: a named one, or a table of stops.

use super::field::{label, no_item, whole};
use crate::calibrator::error::CalibratorValueError;
use crate::calibrator::table::slot;
use crate::values::CellValues;
use octant_calibration::positions::{Degrees, NONE, SEQUENCES, SIXTEEN, TETRAHEDRAL, from_degrees};
use octant_calibration::sequence::{STOPS_MAX, Sequence, Stop};

/// Value of the enumerations for a sequence that has no name; the named ones follow it.
const CUSTOM: i32 = 0;

/// The variables of a sequence.
pub(super) struct Slots {
    name: usize,
    count: usize,
    azimuth: usize,
    roll: usize,
    weight: usize,
    passes: usize,
    /// Stops of the named sequences, in the order of their items.
    named: &'static [&'static [Degrees]],
}

const POSITIONS: [&[Degrees]; SEQUENCES.len()] = {
    let (mut all, mut i) = ([SEQUENCES[0].1; SEQUENCES.len()], 0);
    while i < all.len() {
        all[i] = SEQUENCES[i].1;
        i += 1;
    }
    all
};

/// Variables of the calibration's sequence.
pub(super) static CALIBRATION: Slots = Slots {
    name: slot::POSITIONS,
    count: slot::STOPS_COUNT,
    azimuth: slot::STOPS_AZIMUTH,
    roll: slot::STOPS_ROLL,
    weight: slot::STOPS_WEIGHT,
    passes: slot::PASSES,
    named: &POSITIONS,
};

/// Variables of the navigation's sequence.
pub(super) static ROTATION: Slots = Slots {
    name: slot::ROTATION,
    count: slot::ROTATION_COUNT,
    azimuth: slot::ROTATION_AZIMUTH,
    roll: slot::ROTATION_ROLL,
    weight: slot::ROTATION_WEIGHT,
    passes: slot::ROTATION_PASSES,
    named: &[SIXTEEN, NONE, TETRAHEDRAL],
};

fn bits(sequence: &Sequence) -> impl Iterator<Item = [u64; 3]> {
    let of = |stop: &Stop| [stop.azimuth_rad, stop.roll_rad, stop.weight].map(f64::to_bits);
    sequence.stops().iter().map(of)
}

impl Slots {
    pub(super) fn put(&self, sequence: &Sequence, values: &mut CellValues) {
        let passes = sequence.passes();
        let mut name = CUSTOM;
        for (stops, value) in self.named.iter().zip(CUSTOM + 1..) {
            if from_degrees(stops, passes).is_ok_and(|known| bits(&known).eq(bits(sequence))) {
                name = value;
            }
        }
        values.set_integer(self.name, name);
        values.set_integer(self.count, sequence.stops().len() as i32);
        for i in 0..STOPS_MAX {
            let unused = Stop { weight: 1.0, ..Stop::default() };
            let stop = sequence.stops().get(i).unwrap_or(&unused);
            values.set_real(self.azimuth + i, stop.azimuth_rad);
            values.set_real(self.roll + i, stop.roll_rad);
            values.set_real(self.weight + i, stop.weight);
        }
        values.set_count(self.passes, passes.into());
    }

    pub(super) fn get(&self, values: &CellValues) -> Result<Sequence, CalibratorValueError> {
        let passes = whole(self.passes, values)?;
        let name = values.integer(self.name);
        let made = if name == CUSTOM {
            let count = values.integer(self.count);
            let stops = usize::try_from(count).unwrap_or(0);
            if !(1..=STOPS_MAX).contains(&stops) {
                return Err(CalibratorValueError::Stops { label: label(self.count), found: count });
            }
            let stop = |i| Stop {
                azimuth_rad: values.real(self.azimuth + i),
                roll_rad: values.real(self.roll + i),
                weight: values.real(self.weight + i),
            };
            Sequence::new(&(0..stops).map(stop).collect::<Vec<_>>(), passes)
        } else {
            let index = usize::try_from(name - CUSTOM - 1).ok();
            let known = index.and_then(|index| self.named.get(index));
            from_degrees(known.ok_or_else(|| no_item(self.name, values))?, passes)
        };
        made.map_err(|error| CalibratorValueError::Sequence { label: label(self.name), error })
    }
}
