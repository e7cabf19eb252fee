//! Values passed between variables of different types.

use octant_fmu_host::description::VariableType;
use octant_fmu_host::instance::whole;

/// Returns the name of a type.
#[must_use]
pub const fn kind_name(kind: VariableType) -> &'static str {
    match kind {
        VariableType::Float64 => "Float64",
        VariableType::Float32 => "Float32",
        VariableType::Int8 => "Int8",
        VariableType::UInt8 => "UInt8",
        VariableType::Int16 => "Int16",
        VariableType::UInt16 => "UInt16",
        VariableType::Int32 => "Int32",
        VariableType::UInt32 => "UInt32",
        VariableType::Int64 => "Int64",
        VariableType::UInt64 => "UInt64",
        VariableType::Boolean => "Boolean",
        VariableType::String => "String",
        VariableType::Binary => "Binary",
        VariableType::Enumeration => "Enumeration",
        VariableType::Clock => "Clock",
    }
}

/// Returns whether a type is floating-point.
#[must_use]
pub const fn is_float(kind: VariableType) -> bool {
    matches!(kind, VariableType::Float64 | VariableType::Float32)
}

/// Returns whether a type is passed as a number: all except texts, bytes and clocks.
#[must_use]
pub const fn is_numeric(kind: VariableType) -> bool {
    !matches!(kind, VariableType::String | VariableType::Binary | VariableType::Clock)
}

/// Bound up to which whole numbers are exact in f64, the type in which faults act.
const EXACT: f64 = (1u64 << 53) as f64;

/// Returns the smallest and the largest value of a whole-number type (as far as they are exact);
/// `None` for other types.
#[must_use]
pub const fn limits(kind: VariableType) -> Option<(f64, f64)> {
    Some(match kind {
        VariableType::Int8 => (i8::MIN as f64, i8::MAX as f64),
        VariableType::UInt8 => (0.0, u8::MAX as f64),
        VariableType::Int16 => (i16::MIN as f64, i16::MAX as f64),
        VariableType::UInt16 => (0.0, u16::MAX as f64),
        VariableType::Int32 => (i32::MIN as f64, i32::MAX as f64),
        VariableType::UInt32 => (0.0, u32::MAX as f64),
        VariableType::Int64 | VariableType::Enumeration => (-EXACT, EXACT),
        VariableType::UInt64 => (0.0, EXACT),
        VariableType::Boolean => (0.0, 1.0),
        _ => return None,
    })
}

/// Returns whether a whole-number type has a number.
#[must_use]
pub fn has(kind: VariableType, whole: i128) -> bool {
    match kind {
        VariableType::Int64 | VariableType::Enumeration => i64::try_from(whole).is_ok(),
        VariableType::UInt64 => u64::try_from(whole).is_ok(),
        _ => limits(kind).is_some_and(|(from, to)| (from as i128..=to as i128).contains(&whole)),
    }
}

/// Returns a value as it is exchanged as a number; `None` where the bits of a whole number are
/// exchanged that f64 doesn't have.
#[must_use]
pub fn number_of(kind: VariableType, value: f64) -> Option<f64> {
    if whole::is_wide(kind) { whole::exact(whole::from_bits(kind, value)) } else { Some(value) }
}

/// Returns a number as it is exchanged; `None` if the type doesn't have it.
#[must_use]
pub fn carried(kind: VariableType, number: f64) -> Option<f64> {
    if whole::is_wide(kind) { whole::to_bits(kind, whole::of(number)?) } else { Some(number) }
}

/// Returns a value as it is exchanged in words.
#[must_use]
pub fn told(kind: VariableType, value: f64) -> String {
    if whole::is_wide(kind) {
        return whole::from_bits(kind, value).to_string();
    }
    value.to_string()
}

/// Returns whether a type has a value without rounding. Every f64 fits Float32, by rounding.
#[must_use]
pub fn fits(value: f64, kind: VariableType) -> bool {
    match limits(kind) {
        Some((from, to)) => value >= from && value <= to && value == value.trunc(),
        None => is_float(kind),
    }
}

/// Rounds a value to its type: only Float32 changes.
#[inline]
#[must_use]
pub fn rounded(value: f64, kind: VariableType) -> f64 {
    if matches!(kind, VariableType::Float32) { f64::from(value as f32) } else { value }
}
