//! Whole numbers of 64 bits on their way through an exchange of f64: as their bits, since f64 has
//! only the whole numbers up to 2⁵³.

use super::super::description::VariableType;

/// Largest magnitude up to which f64 has every whole number.
pub const EXACT_MAX: i128 = 1 << 53;

/// Returns whether a type has whole numbers of 64 bits.
#[inline]
#[must_use]
pub const fn is_wide(kind: VariableType) -> bool {
    matches!(kind, VariableType::Int64 | VariableType::UInt64 | VariableType::Enumeration)
}

/// Returns the bits of a whole number of a wide type; `None` if the type doesn't have it.
#[inline]
#[must_use]
pub fn to_bits(kind: VariableType, whole: i128) -> Option<f64> {
    let bits = match kind {
        VariableType::UInt64 => u64::try_from(whole).ok()?,
        _ => i64::try_from(whole).ok()? as u64,
    };
    Some(f64::from_bits(bits))
}

/// Returns the whole number of a wide type with these bits.
#[inline]
#[must_use]
pub const fn from_bits(kind: VariableType, bits: f64) -> i128 {
    match kind {
        VariableType::UInt64 => bits.to_bits() as i128,
        _ => bits.to_bits() as i64 as i128,
    }
}

/// Returns a whole number as f64, if f64 has it.
#[inline]
#[must_use]
pub const fn exact(whole: i128) -> Option<f64> {
    let number = whole as f64;
    if number as i128 == whole { Some(number) } else { None }
}

/// Returns a f64 as a whole number, if it is one.
#[inline]
#[must_use]
pub const fn of(number: f64) -> Option<i128> {
    let whole = number as i128;
    // Beyond i128 the conversion saturates.
    if whole as f64 == number && whole != i128::MAX { Some(whole) } else { None }
}

/// Parses a whole number, also one with a decimal point whose digits after it are zeros.
#[must_use]
pub fn parse(text: &str) -> Option<i128> {
    let text = text.trim();
    text.parse().ok().or_else(|| of(text.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_numbers_keep_every_bit() {
        for (kind, whole) in [
            (VariableType::UInt64, i128::from(u64::MAX)),
            (VariableType::UInt64, (1 << 53) + 1),
            (VariableType::Int64, i128::from(i64::MIN)),
            (VariableType::Int64, -1),
            (VariableType::Enumeration, (1 << 62) + 1),
        ] {
            assert_eq!(to_bits(kind, whole).map(|bits| from_bits(kind, bits)), Some(whole));
        }
        assert_eq!(to_bits(VariableType::UInt64, -1), None);
        assert_eq!(to_bits(VariableType::Int64, 1 << 63), None);
    }

    #[test]
    fn a_number_that_f64_lacks_is_said() {
        assert_eq!((exact(EXACT_MAX), exact(EXACT_MAX + 1)), (Some(9_007_199_254_740_992.0), None));
        assert_eq!(
            (of(1e19), of(0.5), of(f64::NAN)),
            (Some(10_000_000_000_000_000_000), None, None)
        );
        assert_eq!(of(f64::INFINITY), None);
        assert_eq!(parse(" 9007199254740993 "), Some(9_007_199_254_740_993));
        assert_eq!((parse("1e3"), parse("2.0"), parse("2.5")), (Some(1000), Some(2), None));
    }
}
