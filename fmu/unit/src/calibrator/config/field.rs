//! Fields of a configuration that are optional, or of limited range.

use crate::calibrator::error::ValueError;
use crate::calibrator::table::MODEL;
use crate::values::Values;

pub(super) fn put_optional(value: Option<f64>, given: usize, slot: usize, values: &mut Values) {
    values.set_boolean(given, value.is_some());
    if let Some(value) = value {
        values.set_real(slot, value);
    }
}

pub(super) fn optional(given: usize, slot: usize, values: &Values) -> Option<f64> {
    values.boolean(given).then(|| values.real(slot))
}

pub(super) fn whole(slot: usize, values: &Values) -> Result<u32, ValueError> {
    let found = values.count(slot);
    u32::try_from(found).map_err(|_| ValueError::TooLarge { label: label(slot), found })
}

pub(super) fn no_item(slot: usize, values: &Values) -> ValueError {
    ValueError::NoItem { label: label(slot), found: values.integer(slot) }
}

pub(super) fn label(slot: usize) -> &'static str {
    MODEL.label(slot)
}
