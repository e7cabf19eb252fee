//! Numbers formatted for people: with a true minus sign and only significant digits.

/// Formats with `decimals` digits after the point and a true minus sign; "–" if not finite.
#[must_use]
pub fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().any(|b| (b'1'..=b'9').contains(&b)) => format!("−{digits}"),
        Some(digits) => digits.to_owned(),
        None => text,
    }
}

/// Formats as [`fixed`] does; "–" for `None`.
#[must_use]
pub fn optional(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| "–".to_owned(), |v| fixed(v, decimals))
}

/// Formats with `digits` significant digits, in powers of ten outside 0.0001 to 99999.
#[must_use]
pub fn significant(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return fixed(value, 0);
    }
    let exponent = exponent_of(value);
    if (-4..=4).contains(&exponent) {
        return fixed(value, (digits - 1 - exponent).max(0) as usize);
    }
    let mantissa = value / libm::pow(10.0, f64::from(exponent));
    format!("{}e{exponent}", fixed(mantissa, (digits - 1).max(0) as usize))
}

/// Formats as [`significant`] does, without trailing zeros: for limits and lengths that somebody wrote
/// down.
#[must_use]
pub fn plain(value: f64, digits: i32) -> String {
    let text = significant(value, digits);
    let (mantissa, exponent) = match text.find('e') {
        Some(at) => text.split_at(at),
        None => (text.as_str(), ""),
    };
    if !mantissa.contains('.') {
        return text;
    }
    format!("{}{exponent}", mantissa.trim_end_matches('0').trim_end_matches('.'))
}

/// Formats a number with its noun in the singular or the plural: "1 case", "2 cases".
#[must_use]
pub fn counted<N: Copy + std::fmt::Display + PartialEq + From<u8>>(
    number: N,
    one: &str,
    many: &str,
) -> String {
    let noun = if number == N::from(1u8) { one } else { many };
    format!("{number} {noun}")
}

/// Number of decimals that shows `value` with `digits` significant digits, at most 8.
#[must_use]
pub fn decimals_for(value: f64, digits: i32) -> usize {
    if value == 0.0 || !value.is_finite() {
        return 3;
    }
    (digits - 1 - exponent_of(value)).clamp(0, 8) as usize
}

/// Power of ten of the leading digit.
fn exponent_of(value: f64) -> i32 {
    libm::floor(libm::log10(value.abs())) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_minus_is_a_minus_and_zero_has_none() {
        assert_eq!(fixed(-1.25, 1), "−1.2");
        assert_eq!(fixed(-0.001, 2), "0.00");
        assert_eq!(fixed(f64::NAN, 2), "–");
        assert_eq!(optional(None, 2), "–");
    }

    #[test]
    fn a_noun_agrees_with_its_number() {
        let told = [0usize, 1, 2].map(|n| counted(n, "case", "cases"));
        assert_eq!(told, ["0 cases", "1 case", "2 cases"]);
    }

    #[test]
    fn significant_digits_stay() {
        assert_eq!(significant(0.000_512_3, 3), "0.000512");
        assert_eq!(significant(12_345.0, 3), "12345");
        assert_eq!(significant(2.5e-7, 2), "2.5e-7");
        assert_eq!(significant(0.0, 3), "0");
        assert_eq!(plain(24.0, 3), "24");
        assert_eq!(plain(0.005, 4), "0.005");
        assert_eq!(plain(100.0, 3), "100");
        assert_eq!(plain(2e-7, 6), "2e-7");
        assert_eq!(decimals_for(0.00065, 2), 5);
        assert_eq!(decimals_for(14.0, 2), 0);
    }
}
