//! Fields of a configuration that are optional, or of limited range.

use crate::calibrator::error::CalibratorValueError;
use crate::calibrator::table::MODEL;
use crate::values::CellValues;

pub(super) fn put_optional(value: Option<f64>, given: usize, slot: usize, values: &mut CellValues) {
    values.set_boolean(given, value.is_some());
    if let Some(value) = value {
        values.set_real(slot, value);
    }
}

pub(super) fn optional(given: usize, slot: usize, values: &CellValues) -> Option<f64> {
    values.boolean(given).then(|| values.real(slot))
}

pub(super) fn whole(slot: usize, values: &CellValues) -> Result<u32, CalibratorValueError> {
    let found = values.count(slot);
    u32::try_from(found).map_err(|_| CalibratorValueError::TooLarge { label: label(slot), found })
}

pub(super) fn no_item(slot: usize, values: &CellValues) -> CalibratorValueError {
    CalibratorValueError::NoItem { label: label(slot), found: values.integer(slot) }
}

pub(super) fn label(slot: usize) -> &'static str {
    MODEL.label(slot)
}
