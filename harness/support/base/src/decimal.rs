//! Times as decimal text, read to the nanosecond.

/// Converts a decimal number to nanoseconds: exact if it has no digits beyond a nanosecond, else
/// rounded half up. Avoids f64, which holds a present-day epoch only to 200 ns. `exponent_to_ns` is the
/// power of ten from the unit of the number to a nanosecond, 9 for seconds.
#[must_use]
pub fn decimal_ns(text: &str, exponent_to_ns: i32) -> Option<u64> {
    let text = text.strip_prefix('+').unwrap_or(text);
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
        None => (text, 0),
    };
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    if whole.is_empty() && fraction.is_empty() {
        return None;
    }
    let mut digits: u128 = 0;
    for byte in whole.bytes().chain(fraction.bytes()) {
        let digit = byte.is_ascii_digit().then(|| u128::from(byte - b'0'))?;
        digits = digits.checked_mul(10)?.checked_add(digit)?;
    }
    let shift =
        exponent.checked_add(exponent_to_ns)?.checked_sub(i32::try_from(fraction.len()).ok()?)?;
    let ns = if shift >= 0 {
        if digits == 0 {
            0
        } else {
            digits.checked_mul(10u128.checked_pow(shift.unsigned_abs())?)?
        }
    } else {
        match 10u128.checked_pow(shift.unsigned_abs()) {
            Some(power) => (digits + power / 2) / power,
            None => 0,
        }
    };
    u64::try_from(ns).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_to_the_nanosecond() {
        let ns = |text| decimal_ns(text, 9);
        assert_eq!(ns("2.9840000e-02"), Some(29_840_000));
        assert_eq!(ns("1767225600.123456789"), Some(1_767_225_600_123_456_789));
        assert_eq!(ns("0.0000000005"), Some(1));
        assert_eq!(ns(".5"), Some(500_000_000));
        assert_eq!(ns("3."), Some(3_000_000_000));
        assert_eq!(ns("+1e1"), Some(10_000_000_000));
        assert_eq!(ns("0e99"), Some(0));
        assert_eq!(ns("1e-99"), Some(0));
        assert_eq!(decimal_ns("10.5", 6), Some(10_500_000));
        assert_eq!(decimal_ns("7", 0), Some(7));
        for wrong in ["", ".", "-1", "nan", "1e99", "1e", "1.2.3", "0x10", "1e99999999999"] {
            assert_eq!(ns(wrong), None, "{wrong}");
        }
    }
}
